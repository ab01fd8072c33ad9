"""Implicit shapes in crowds: one prototype for all that are alike, tessellated by its size in pixels, and the
same picture, messages and reports as if each stood for itself."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from msbvh import _core
from msbvh.base.errors import Diagnostics
from msbvh.motion.samples import SampleLog
from msbvh.motion_report.report import motion_report
from msbvh.scene.implicit import IMPLICIT_TYPES
from msbvh.scene.reader import ReadResult, ReadSettings, read_frame
from pxr import Gf, Sdf, UsdGeom, UsdShade
from recording import Shot, messages

KINDS = sorted(IMPLICIT_TYPES)


def crowd(shot: Shot, kind: str, count: int = 24, root: str = "/Crowd") -> list[UsdGeom.Gprim]:
    """Shapes of one type, of several sizes, axes, colours and places, in rows before the camera."""
    made = []
    for i in range(count):
        prim = shot.stage.DefinePrim(f"{root}/{kind}_{i}", kind)
        shape = UsdGeom.Gprim(prim)
        shape.AddTranslateOp().Set(Gf.Vec3d(2.0 * (i % 6) - 5.0, 2.0 * (i // 6) - 3.0, -0.1 * i))
        shape.AddRotateXYZOp().Set(Gf.Vec3f(20.0 * i, 10.0 * i, 0))
        shape.AddScaleOp().Set(Gf.Vec3f(0.5, 0.5, 0.5 if i % 3 else 0.9))
        if i % 2:
            shape.CreateDisplayColorAttr([(i / count, 0.5, 1.0 - i / count)])
        for name, value in (
            ("radius", 0.8),
            ("height", 1.5),
            ("size", 1.6),
            ("radiusTop", 0.6),
            ("width", 1.5),
        ):
            if prim.GetAttribute(name) and i % 4:
                prim.GetAttribute(name).Set(value)
        if prim.GetAttribute("axis"):
            prim.GetAttribute("axis").Set("XYZ"[i % 3])
        made.append(shape)
    return made


Author = Callable[[Shot], None]


def of_each_kind(shot: Shot) -> None:
    for kind in KINDS:
        crowd(shot, kind, 18, f"/{kind}")


def moving(shot: Shot) -> None:
    for i, shape in enumerate(crowd(shot, "Sphere") + crowd(shot, "Cone", 24, "/Cones")):
        translate, rotate, _ = shape.GetOrderedXformOps()
        if i % 3 == 0:
            translate.Set(translate.Get(), 9.0)
            translate.Set(translate.Get(9.0) + Gf.Vec3d(1.5, 0, 0), 11.0)
        if i % 3 == 1:
            rotate.Set(Gf.Vec3f(0), 9.0)
            rotate.Set(Gf.Vec3f(0, 0, 120), 11.0)


def under_parents(shot: Shot) -> None:
    crowd(shot, "Sphere", 24, "/Squashed")
    crowd(shot, "Cylinder", 24, "/Moving")
    UsdGeom.Xformable(shot.stage.DefinePrim("/Squashed", "Xform")).AddScaleOp().Set(Gf.Vec3f(1, 0.5, -2))
    move = UsdGeom.Xformable(shot.stage.DefinePrim("/Moving", "Xform")).AddTranslateOp()
    move.Set(Gf.Vec3d(0, 0, 0), 9.0)
    move.Set(Gf.Vec3d(0, 2, 0), 11.0)


def materials_and_opacity(shot: Shot) -> None:
    for i, shape in enumerate(crowd(shot, "Sphere", 40)):
        if i % 4 == 0:
            shape.CreateDisplayOpacityAttr([0.5])
        if i % 4 == 1:
            path = f"/Looks/M{i % 8}"
            material = UsdShade.Material.Define(shot.stage, path)
            shader = UsdShade.Shader.Define(shot.stage, f"{path}/S")
            shader.CreateIdAttr("UsdPreviewSurface")
            shader.CreateInput("diffuseColor", Sdf.ValueTypeNames.Color3f).Set(Gf.Vec3f(0.8, 0.1 * (i % 8), 0))
            material.CreateSurfaceOutput().ConnectToSource(shader.ConnectableAPI(), "surface")
            UsdShade.MaterialBindingAPI.Apply(shape.GetPrim()).Bind(material)


def inherited_colour(shot: Shot) -> None:
    crowd(shot, "Cube", 40)
    parent = UsdGeom.PrimvarsAPI(shot.stage.DefinePrim("/Crowd", "Xform"))
    parent.CreatePrimvar("displayColor", Sdf.ValueTypeNames.Color3fArray, "constant").Set([(0.1, 0.7, 0.2)])


def blinking_and_scaled(shot: Shot) -> None:
    for i, shape in enumerate(crowd(shot, "Sphere", 40)):
        if i % 2:
            visibility = shape.CreateVisibilityAttr()
            visibility.Set("invisible", 9.0)
            visibility.Set("inherited", 10.0)
    scaled = shot.stage.DefinePrim("/Crowd", "Xform")
    UsdGeom.MotionAPI.Apply(scaled).CreateMotionBlurScaleAttr(0.5)
    move = UsdGeom.Xformable(scaled).AddTranslateOp()
    move.Set(Gf.Vec3d(-1, 0, 0), 9.0)
    move.Set(Gf.Vec3d(1, 0, 0), 11.0)


def in_native_instances(shot: Shot) -> None:
    crowd(shot, "Capsule", 24, "/Prototype")
    shot.stage.GetPrimAtPath("/Prototype").SetSpecifier(Sdf.SpecifierClass)
    for i in range(3):
        prim = shot.stage.DefinePrim(f"/Instance_{i}", "Xform")
        prim.GetReferences().AddInternalReference("/Prototype")
        prim.SetInstanceable(True)
        move = UsdGeom.Xformable(prim).AddTranslateOp()
        move.Set(Gf.Vec3d(0, i - 1, -i), 9.0)
        move.Set(Gf.Vec3d(i, i - 1, -i), 11.0)


def in_a_point_instancer(shot: Shot) -> None:
    crowd(shot, "Sphere", 24, "/Instancer/Prototype")
    shot.stage.DefinePrim("/Instancer/Prototype", "Xform")
    instancer = UsdGeom.PointInstancer.Define(shot.stage, "/Instancer")
    instancer.CreatePrototypesRel().AddTarget("/Instancer/Prototype")
    instancer.CreateProtoIndicesAttr([0, 0, 0])
    instancer.CreatePositionsAttr([Gf.Vec3f(0, 0, 0), Gf.Vec3f(1, 1, -3), Gf.Vec3f(-1, 0, -6)])
    instancer.CreateVelocitiesAttr([Gf.Vec3f(24, 0, 0)] * 3)
    colour = UsdGeom.PrimvarsAPI(instancer).CreatePrimvar("displayColor", Sdf.ValueTypeNames.Color3fArray, "vertex")
    colour.Set([(1, 0, 0), (0, 1, 0), (0, 0, 1)])


SCENES: list[Author] = [
    of_each_kind,
    moving,
    under_parents,
    materials_and_opacity,
    inherited_colour,
    blinking_and_scaled,
    in_native_instances,
    in_a_point_instancer,
]


def read(author: Author, found: SampleLog | None = None) -> tuple[Shot, ReadResult]:
    shot = Shot((-0.25, 0.5))
    shot.camera.CreateFocalLengthAttr(35.0)
    author(shot)
    return shot, read_frame(shot.stage, 10.0, ReadSettings(width=240), Diagnostics(), found=found)


def picture(result: ReadResult) -> np.ndarray:
    size = result.camera.width, result.camera.height
    renderer = _core.Renderer(result.scene, width=size[0], height=size[1], spp=16, max_bounces=0)
    renderer.verify()
    return renderer.render(lambda _: True)


@pytest.fixture
def alone(monkeypatch: pytest.MonkeyPatch) -> Callable[[], None]:
    """From here on every shape stands for itself."""
    return lambda: monkeypatch.setattr("msbvh.scene.shared_shapes.SHARED_FROM", 10**9)


@pytest.mark.parametrize("author", SCENES, ids=lambda author: author.__name__)
def test_the_picture_and_the_messages_are_those_of_shapes_that_stand_alone(author: Author, alone) -> None:
    _, together = read(author)
    alone()
    _, apart = read(author)
    counts = together.scene.statistics(), apart.scene.statistics()
    assert counts[0]["meshes"] < counts[1]["meshes"] / 2
    assert sorted(map(str, together.diagnostics)) == sorted(map(str, apart.diagnostics))
    difference = np.abs(picture(together) - picture(apart))
    # The same triangles but for rounding: a ray in some thousands falls beside an edge. Normals of what is squashed
    # differ by more: those of the unit shape are the exact ones.
    assert (difference[..., 3] > 1e-3).mean() < 0.01
    assert (difference.max(axis=-1) > 0.02).mean() < 0.01
    assert difference.mean() < 3e-4


@pytest.mark.parametrize(
    "author", [moving, blinking_and_scaled, in_native_instances], ids=lambda author: author.__name__
)
def test_motion_reports_every_prim_by_its_path(author: Author, alone) -> None:
    reports = []
    for _ in range(2):
        log = SampleLog()
        shot, result = read(author, log)
        report = motion_report(shot.stage, 10.0, result, log, 0.1, None)
        reports.append({prim.path: prim for prim in report.prims})
        alone()
    together, apart = reports
    assert set(together) == set(apart)
    for path, prim in together.items():
        other = apart[path]
        same = ("source", "segments", "degree", "time_remap", "hidden_partly", "count", "samples")
        if "Instance_" not in path and "Prototype" not in path:
            assert [getattr(prim, name) for name in same] == [getattr(other, name) for name in same], path
        assert prim.error_pixels == pytest.approx(other.error_pixels, abs=0.02)


def test_thousands_share_one_mesh_of_a_type_and_a_size() -> None:
    shot = Shot((0.0, 0.0))
    for i in range(600):
        sphere = UsdGeom.Sphere.Define(shot.stage, f"/S_{i}")
        sphere.CreateRadiusAttr(0.05 + 0.001 * (i % 10))
        sphere.AddTranslateOp().Set(Gf.Vec3d(i % 30 - 15, i // 30 - 10, 0))
    result = read_frame(shot.stage, 10.0)
    figures = result.scene.statistics()
    assert figures["meshes"] <= 3 and figures["instances"] == 600 and figures["triangles"] < 3000
    assert [track.path for track in result.tracks if track.source != "camera"].count("/S_17") == 1


def deviation(surface) -> float:
    """How far the faces of a unit shape lie inside of it at most: 1 less the distance of the nearest."""
    corners = surface.points[surface.indices.reshape(-1, 4)]
    normals = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
    length = np.linalg.norm(normals, axis=1)
    normals = normals[length > 1e-9] / length[length > 1e-9, None]
    return float(1.0 - np.abs((normals * corners[length > 1e-9, 0]).sum(axis=1)).min())


def test_the_silhouette_strays_by_a_tenth_of_a_pixel_at_most() -> None:
    from msbvh.scene.implicit import SIDE_COUNTS, sides_for, sphere

    for silhouette in (0.1, 0.0125):
        for radius_pixels in (0.3, 1.0, 3.0, 10.0, 50.0, 200.0, 700.0):
            sides = int(sides_for(np.array([radius_pixels]), silhouette)[0])
            if sides < SIDE_COUNTS[-1]:
                assert deviation(sphere(1.0, sides)) * radius_pixels <= silhouette * 1.01
    # A sphere that is far larger than any image, or holds the camera, stays affordable.
    assert sides_for(np.array([1e9, np.inf, np.nan]), 0.1).tolist()[:2] == [SIDE_COUNTS[-1]] * 2


@pytest.mark.parametrize("distance", [8.0, 40.0])
def test_a_spheres_disc_is_as_large_as_it_should_be(distance: float) -> None:
    shot = Shot((0.0, 0.0))
    shot.camera.CreateFocalLengthAttr(50.0)
    shot.camera.CreateHorizontalApertureAttr(36.0)
    shot.camera.CreateVerticalApertureAttr(24.0)
    UsdGeom.Sphere.Define(shot.stage, "/Ball").AddTranslateOp().Set(Gf.Vec3d(0, 0, 20.0 - distance))
    result = read_frame(shot.stage, 10.0, ReadSettings(width=600))
    radius = 600 * (50.0 / 36.0) / np.sqrt(distance**2 - 1.0)  # Of the disc that a sphere's tangents make.
    assert np.sqrt(picture(result)[..., 3].sum() / np.pi) == pytest.approx(radius, abs=0.15)


def test_complexity_makes_them_finer() -> None:
    shot = Shot((0.0, 0.0))
    for i in range(20):
        UsdGeom.Sphere.Define(shot.stage, f"/S_{i}").AddTranslateOp().Set(Gf.Vec3d(i - 10, 0, 0))
    UsdGeom.Cone.Define(shot.stage, "/Cone")
    sizes = [
        read_frame(shot.stage, 10.0, ReadSettings(complexity=name)).scene.statistics()["triangles"]
        for name in ("low", "medium", "high", "veryhigh")
    ]
    assert sizes == sorted(set(sizes))


@pytest.mark.parametrize(
    ("radius", "said"),
    [
        (float("nan"), "/S_3.radius: found nan, expected a finite number"),
        (float("-inf"), "/S_3.radius: found -inf, expected a finite number"),
        (1e30, "/S_3.radius: found 1e+30, expected a finite number"),
        (0.0, ""),
        (-0.5, ""),
    ],
)
def test_what_is_no_radius_is_named_and_the_others_are_drawn(radius: float, said: str) -> None:
    shot = Shot()
    for i in range(30):
        sphere = UsdGeom.Sphere.Define(shot.stage, f"/S_{i}")
        sphere.CreateRadiusAttr(radius if i == 3 else 0.3)
        sphere.AddTranslateOp().Set(Gf.Vec3d(i % 6 - 3, i // 6 - 3, 0))
    result = read_frame(shot.stage, 10.0, ReadSettings(width=96))
    errors = [str(d) for d in result.diagnostics if d.severity == "error"]
    if said:
        (error,) = errors
        assert error.startswith(said)
    assert picture(result)[..., 3].sum() > 100
    assert len({track.path for track in result.tracks if track.path != "/S_3"}) >= 30


@pytest.mark.parametrize("count", [3, 24])
def test_needles_are_drawn_alone_and_together(count: int) -> None:
    shot = Shot()
    for i in range(count):
        capsule = UsdGeom.Capsule.Define(shot.stage, f"/S_{i}")
        capsule.CreateRadiusAttr(1e-19)
        capsule.AddTranslateOp().Set(Gf.Vec3d(i, 0, 0))
    result = shot.read()
    assert not messages(result, "error")
    assert {f"/S_{i}" for i in range(count)} <= {track.path for track in result.tracks}


def test_matrices_that_are_singular_or_no_numbers_are_drawn_or_named() -> None:
    shot = Shot()
    for i in range(30):
        sphere = UsdGeom.Sphere.Define(shot.stage, f"/S_{i}")
        scale = {3: (1, 1, 0), 4: (0, 0, 0), 5: (float("nan"), 1, 1)}.get(i, (1, 1, 1))
        sphere.AddScaleOp().Set(Gf.Vec3f(*scale))
    result = shot.read()
    (error,) = messages(result, "error")
    assert error.startswith("/S_5.xformOp:scale: found (nan, 1, 1)")
    paths = {track.path for track in result.tracks}
    assert {f"/S_{i}" for i in range(30)} - paths == {"/S_5"}


def test_animated_radii_follow_the_stage() -> None:
    shot = Shot((0.0, 1.0))
    for i in range(24):
        sphere = UsdGeom.Sphere.Define(shot.stage, f"/S_{i}")
        sphere.AddTranslateOp().Set(Gf.Vec3d(i, 0, 0))
        sphere.GetRadiusAttr().Set(1.0, 10.0)
        sphere.GetRadiusAttr().Set(2.0, 11.0)
    result = shot.read()
    for time01 in (0.0, 0.37, 1.0):
        points = result.scene.points("/S_7", time01)
        assert np.linalg.norm(points - (7, 0, 0), axis=1) == pytest.approx(1.0 + time01, abs=1e-4)


FIGURES = """
import sys, time
from pxr import Usd, UsdGeom
from msbvh import _core
from msbvh.base.errors import Diagnostics
from msbvh.scene.reader import read_frame
from msbvh.stage.opening import open_stage
start = time.process_time()
stage = open_stage(sys.argv[1], Diagnostics())
result = read_frame(stage, 1.0)
renderer = _core.Renderer(result.scene, width=96, height=64)
seconds = time.process_time() - start
# Of this program alone: ru_maxrss begins with that of the process which has started it.
size = int(next(line for line in open('/proc/self/status') if line.startswith('VmHWM')).split()[1]) / 1024
start, places = time.process_time(), UsdGeom.XformCache(1.0)
for prim in stage.GetPseudoRoot().GetChildren():
    prim.GetAuthoredPropertyNames()
    prim.GetAttribute("radius").Get(1.0), prim.GetAttribute("primvars:displayColor").Get(1.0)
    places.GetLocalToWorldTransform(prim)
print(seconds, size, time.process_time() - start)
"""
IDLE_SECONDS = 0.27
"""What USD's own calls of that loop take for 20,000 prims where nothing else runs: how busy the machine
is."""


def test_twenty_thousand_spheres_take_two_seconds_and_three_hundred_megabytes(tmp_path: Path) -> None:
    rng = np.random.default_rng(1)
    layer = Sdf.Layer.CreateNew(str(tmp_path / "spheres.usda"))
    with Sdf.ChangeBlock():
        for i in range(20000):
            prim = Sdf.PrimSpec(layer, f"s{i}", Sdf.SpecifierDef, "Sphere")
            Sdf.AttributeSpec(prim, "radius", Sdf.ValueTypeNames.Double).default = float(rng.uniform(0.1, 1.0))
            where = Sdf.AttributeSpec(prim, "xformOp:translate", Sdf.ValueTypeNames.Double3)
            where.default = Gf.Vec3d(*rng.uniform(-50, 50, 3).tolist())
            order = Sdf.AttributeSpec(prim, "xformOpOrder", Sdf.ValueTypeNames.TokenArray, Sdf.VariabilityUniform)
            order.default = ["xformOp:translate"]
            colour = Sdf.AttributeSpec(prim, "primvars:displayColor", Sdf.ValueTypeNames.Color3fArray)
            colour.default = [Gf.Vec3f(*rng.uniform(0, 1, 3).tolist())]
    layer.Save()
    command = [sys.executable, "-c", FIGURES, layer.realPath]
    times = []
    for _ in range(3):  # One run in ten meets another program's caches.
        done = subprocess.run(command, capture_output=True, text=True, check=True)
        seconds, megabytes, busy_seconds = map(float, done.stdout.split())
        assert megabytes < 300
        times.append(seconds / max(1.0, busy_seconds / IDLE_SECONDS))
        if times[-1] < 2.0:
            break
    assert min(times) < 2.0
