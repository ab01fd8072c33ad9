"""GeomSubsets: parts of a mesh with materials of their own, which stay one mesh."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from msbvh import _core
from pxr import Gf, Sdf, Usd, UsdGeom, UsdShade, Vt
from recording import Shot, messages


def material(
    stage: Usd.Stage, path: str, colour: tuple[float, float, float], opacity: float = 1.0
) -> UsdShade.Material:
    made = UsdShade.Material.Define(stage, path)
    shader = UsdShade.Shader.Define(stage, f"{path}/Surface")
    shader.CreateIdAttr("UsdPreviewSurface")
    shader.CreateInput("diffuseColor", Sdf.ValueTypeNames.Color3f).Set(Gf.Vec3f(*colour))
    shader.CreateInput("opacity", Sdf.ValueTypeNames.Float).Set(opacity)
    made.CreateSurfaceOutput().ConnectToSource(shader.ConnectableAPI(), "surface")
    return made


def strip(shot: Shot, quads: int = 3, path: str = "/Mesh") -> UsdGeom.Mesh:
    """Unit squares side by side along x, from the middle on both sides."""
    points = [(x - quads / 2, y - 0.5, 0) for y in range(2) for x in range(quads + 1)]
    mesh = shot.mesh(path, points)
    row = quads + 1
    mesh.GetFaceVertexCountsAttr().Set([4] * quads)
    mesh.GetFaceVertexIndicesAttr().Set([i for x in range(quads) for i in (x, x + 1, x + 1 + row, x + row)])
    return mesh


def subset(shot: Shot, mesh: UsdGeom.Mesh, name: str, faces: list[int], **look: object) -> None:
    made = UsdGeom.Subset.CreateGeomSubset(mesh, name, "face", Vt.IntArray(faces), "materialBind")
    bound = material(shot.stage, f"/Looks/{name}", look.pop("colour", (0, 0, 0)), **look)
    UsdShade.MaterialBindingAPI.Apply(made.GetPrim()).Bind(bound)


def drawn(shot: Shot, width: int = 96, frame: float = 10.0) -> np.ndarray:
    """float32[H, W, 4] under a dome of unit radiance: diffuse colours as they are."""
    from pxr import UsdLux

    UsdLux.DomeLight.Define(shot.stage, "/Dome")
    shot.camera.CreateHorizontalApertureAttr(24.0)
    shot.camera.CreateVerticalApertureAttr(12.0)
    shot.camera.CreateFocalLengthAttr(80.0)
    from msbvh.scene.reader import ReadSettings, read_frame

    result = read_frame(shot.stage, frame, ReadSettings(width=width))
    renderer = _core.Renderer(result.scene, width=width, height=width // 2, spp=64, max_bounces=0)
    return renderer.render(lambda _: True)


def test_parts_are_one_mesh_with_a_material_a_face():
    shot = Shot()
    mesh = strip(shot)
    subset(shot, mesh, "One", [0])
    subset(shot, mesh, "Two", [2, 99])
    result = shot.read()
    (recorded,) = result.scene.meshes.values()
    assert recorded["face_materials"].tolist() == [0, -1, 1] and recorded["hole_indices"] is None
    assert messages(result, "warning") == ["/Mesh/Two.indices: found 1 indices outside 0 to 2; left out"]
    assert [track.path for track in result.tracks] == ["/Camera", "/Mesh"]


def test_overlaps_are_named_and_the_last_one_has_them():
    shot = Shot()
    mesh = strip(shot)
    subset(shot, mesh, "One", [0, 1])
    subset(shot, mesh, "Two", [1, 2])
    subset(shot, mesh, "None", [])
    result = shot.read()
    assert result.scene.meshes["/Mesh"]["face_materials"].tolist() == [0, 1, 1]
    assert messages(result, "warning") == [
        "/Mesh/Two.indices: found 1 faces that an earlier subset has too, expected each face in one subset; took this one's"
        " material"
    ]


def test_a_subset_without_a_material_leaves_the_meshs_own():
    shot = Shot()
    mesh = strip(shot)
    subset(shot, mesh, "One", [0])
    bare = UsdGeom.Subset.CreateGeomSubset(mesh, "Bare", "face", [1], "materialBind")
    assert bare
    UsdShade.MaterialBindingAPI.Apply(mesh.GetPrim()).Bind(material(shot.stage, "/Looks/Whole", (1, 1, 1)))
    faces = shot.read().scene.meshes["/Mesh"]["face_materials"]
    assert faces[1] == faces[2] != faces[0]


def test_the_picture_shows_each_part_where_it_is():
    shot = Shot((0.0, 0.0))
    mesh = strip(shot, 4)
    mesh.CreateHoleIndicesAttr([3])
    subset(shot, mesh, "Red", [0], colour=(0.8, 0, 0))
    subset(shot, mesh, "Green", [1, 3], colour=(0, 0.8, 0))
    subset(shot, mesh, "Clear", [2], colour=(0.8, 0.8, 0.8), opacity=0.0)
    middle = drawn(shot)[24]
    # 24 units of aperture at a focal length of 80 see 6 units of x at a distance of 20: 16 pixels a unit.
    gloss = middle[24, 1]  # a UsdPreviewSurface of ior 1.5 reflects some of all colours, and lets the rest through
    assert 0.03 < gloss < 0.06
    assert middle[24, :3] == pytest.approx(np.array((0.8, 0, 0)) * (1.0 - gloss) + gloss, abs=0.01)
    assert middle[40, :3] == pytest.approx(np.array((0, 0.8, 0)) * (1.0 - gloss) + gloss, abs=0.01)
    assert middle[56, 3] == pytest.approx(gloss, abs=0.04) and middle[72, 3] == 0.0  # a hole does not even reflect


@pytest.mark.parametrize("instanced", [False, True])
def test_a_moving_mesh_keeps_its_parts_in_a_prototype_too(instanced: bool):
    shot = Shot((0.0, 0.5))
    mesh = strip(shot, 2, "/Instancer/Mesh" if instanced else "/Mesh")
    for time, x in ((10.0, 0.0), (11.0, 2.0)):
        points = np.array([(i % 3 - 1 + x, i // 3 - 0.5, 0) for i in range(6)])
        mesh.GetPointsAttr().Set(Vt.Vec3fArray.FromNumpy(np.float32(points)), time)
    if instanced:
        instancer = UsdGeom.PointInstancer.Define(shot.stage, "/Instancer")
        instancer.CreatePrototypesRel().AddTarget(mesh.GetPath())
        instancer.CreateProtoIndicesAttr([0])
        instancer.CreatePositionsAttr([Gf.Vec3f(0)])
    subset(shot, mesh, "Red", [0], colour=(0.8, 0, 0))
    subset(shot, mesh, "Green", [1], colour=(0, 0.8, 0))
    row = drawn(shot)[24]
    colours = row[:, :3] - (1.0 - row[:, 3:])  # Without the dome behind them.
    # The edge between the parts passes from the middle, pixel 48, to 64 within the shutter.
    assert colours[36] == pytest.approx((0.2, 0, 0), abs=0.05) and colours[76] == pytest.approx((0, 0.2, 0), abs=0.05)
    assert colours[56] == pytest.approx((0.375, 0.425, 0), abs=0.04)


FIGURES = """
import sys, time
from msbvh.stage.opening import open_stage
from msbvh.base.errors import Diagnostics
from msbvh.scene.reader import read_frame
diagnostics = Diagnostics()
stage = open_stage(sys.argv[1], diagnostics)
def peak_kib():
    # Of this program alone: ru_maxrss begins with that of the process which has started it.
    return int(next(line for line in open("/proc/self/status") if line.startswith("VmHWM")).split()[1])
before = peak_kib()
start = time.process_time()
result = read_frame(stage, 1.0)
print(time.process_time() - start, peak_kib() - before,
      result.scene.statistics()["triangles"])
"""


def figures(path: Path) -> tuple[float, float, int]:
    """CPU seconds and KiB that the reading takes, in a process of its own; triangles."""
    done = subprocess.run([sys.executable, "-c", FIGURES, str(path)], capture_output=True, text=True, check=True)
    seconds, size, triangles = done.stdout.split()
    return float(seconds), float(size), int(triangles)


def test_two_hundred_subsets_cost_little_more_than_none(tmp_path: Path):
    side = 350
    grid = np.stack(np.meshgrid(np.arange(side + 1), np.arange(side + 1)), axis=-1).reshape(-1, 2)
    corner = (np.arange(side)[:, None] * (side + 1) + np.arange(side)).ravel()
    indices = np.stack([corner, corner + 1, corner + side + 2, corner + side + 1], axis=-1).ravel()
    for name, count in (("none", 0), ("many", 200)):
        stage = Usd.Stage.CreateNew(str(tmp_path / f"{name}.usdc"))
        mesh = UsdGeom.Mesh.Define(stage, "/Mesh")
        mesh.CreateSubdivisionSchemeAttr("none")
        mesh.CreatePointsAttr(Vt.Vec3fArray.FromNumpy(np.float32(np.c_[grid, 0 * grid[:, :1]])))
        mesh.CreateFaceVertexCountsAttr(Vt.IntArray.FromNumpy(np.full(side * side, 4, np.int32)))
        mesh.CreateFaceVertexIndicesAttr(Vt.IntArray.FromNumpy(indices.astype(np.int32)))
        shot = Shot()
        shot.stage = stage
        for part in range(count):
            faces = np.arange(part, side * side, count)
            subset(shot, mesh, f"Part_{part}", faces.tolist(), colour=(part / count, 0, 0))
        stage.Save()
    plain, parts = figures(tmp_path / "none.usdc"), figures(tmp_path / "many.usdc")
    assert parts[2] == plain[2]
    assert parts[1] <= 1.3 * plain[1]
    assert parts[0] <= 1.3 * plain[0] + 0.1  # Two hundred materials are read.
