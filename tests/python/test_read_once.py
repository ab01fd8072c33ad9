"""Everything that is read of a prim and is no motion, changed within the shutter: docs/design/read-once.md says what
happens to each attribute, and every line of its table is held here.

The truth is what the stage has at any time: stage_truth.py, its projection, or the attribute's own value.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import pytest
from conftest import ROOT
from drawn import assert_as_the_stage
from msbvh import _core
from msbvh.scene.reader import ReadSettings, read_frame
from projection_oracle import Sampling, coverage
from pxr import Gf, Sdf, Usd, UsdGeom, UsdLux, UsdShade, UsdSkel, Vt
from recording import DENSE_TIMES01, Shot, interpolated, messages

SHUTTER = (-0.25, 0.5)
CHANGES = (10.05, 10.2)
"""Time codes within the shutter of frame 10 at which values change."""
SIZE = (48, 32)
RED, GREEN, BLUE = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
COLOURS = np.array([RED, GREEN, BLUE])

Case = Callable[[], None]
CASES: dict[str, list[Case]] = {}
"""By the attribute's name in the table."""


def case(attribute: str) -> Callable[[Case], Case]:
    """Registers what holds a line of the table."""

    def register(check: Case) -> Case:
        CASES.setdefault(attribute, []).append(check)
        return check

    return register


def table() -> dict[str, str]:
    """What happens to each attribute, by docs/design/read-once.md."""
    text = (ROOT / "docs" / "design" / "read-once.md").read_text(encoding="utf-8")
    return dict(re.findall(r"^\| `([^`]+)` \| (followed|held|uniform) \|", text, re.MULTILINE))


TABLE = table()


def set_in_turn(attribute: Usd.Attribute, values: Sequence[Any], times: Sequence[float] = (9.0, *CHANGES)) -> None:
    for time, value in zip(times, values, strict=True):
        attribute.Set(value, time)


def picture(shot: Shot, spp: int = 256) -> np.ndarray:
    """float32[H, W, 4]: the frame, lit by what glows alone."""
    conform = "adjustApertureHeight"  # As the projection has it.
    settings = ReadSettings(width=SIZE[0], height=SIZE[1], conform=conform, disable_camera_light=True)
    result = read_frame(shot.stage, 10.0, settings)
    return _core.Renderer(result.scene, width=SIZE[0], height=SIZE[1], spp=spp, max_bounces=0).render()


def assert_covers_as_the_stage(shot: Shot) -> None:
    """Alpha by the stage's own evaluation at 128 times."""
    expected = coverage(shot.stage, 10.0, "/Camera", SIZE, Sampling(128, 4))
    found = picture(shot)[..., 3]
    assert ((expected > 0.02) & (expected < 0.98)).sum() > 20, "the test sees nothing"
    assert np.abs(found - expected).mean() < 0.003
    assert np.abs(found - expected).max() < 0.1


def glowing(shot: Shot, path: str, colour: tuple[float, float, float] | None) -> UsdShade.Material:
    """A material that shows a colour as it is; None: displayColor."""
    material = UsdShade.Material.Define(shot.stage, path)
    shader = UsdShade.Shader.Define(shot.stage, f"{path}/Surface")
    shader.CreateIdAttr("UsdPreviewSurface")
    shader.CreateInput("diffuseColor", Sdf.ValueTypeNames.Color3f).Set(Gf.Vec3f(0))
    emission = shader.CreateInput("emissiveColor", Sdf.ValueTypeNames.Color3f)
    if colour is None:
        reader = UsdShade.Shader.Define(shot.stage, f"{path}/Reader")
        reader.CreateIdAttr("UsdPrimvarReader_float3")
        reader.CreateInput("varname", Sdf.ValueTypeNames.Token).Set("displayColor")
        emission.ConnectToSource(reader.CreateOutput("result", Sdf.ValueTypeNames.Float3))
    else:
        emission.Set(Gf.Vec3f(*colour))
    material.CreateSurfaceOutput().ConnectToSource(shader.ConnectableAPI(), "surface")
    return material


def bind(prim: Any, material: UsdShade.Material) -> None:
    prim = prim if isinstance(prim, Usd.Prim) else prim.GetPrim()
    UsdShade.MaterialBindingAPI.Apply(prim).Bind(material)


def shares(shutter: tuple[float, float] = SHUTTER, changes: Sequence[float] = CHANGES) -> np.ndarray:
    """Of the shutter: before the first change, between the two, and after."""
    ends = np.array([10.0 + shutter[0], *changes, 10.0 + shutter[1]])
    return np.diff(ends) / (shutter[1] - shutter[0])


def mean_of_halves(image: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The mean colour of the left and of the right half, away from the edge between them: float64[3] each."""
    middle = SIZE[0] // 2
    return (image[:, : middle - 2, :3].mean(axis=(0, 1)), image[:, middle + 2 :, :3].mean(axis=(0, 1)))


def named(shot: Shot, attribute: str, *texts: str) -> None:
    """Exactly one warning names the attribute, and says these things."""
    found = [text for text in messages(shot.read(), "warning") if text.startswith(f"{attribute}: ")]
    assert len(found) == 1, messages(shot.read())
    assert all(text in found[0] for text in texts), found[0]


def wide_squares(shot: Shot, path: str = "/Mesh") -> UsdGeom.Mesh:
    """Two faces that fill the left and the right half of the picture."""
    mesh = UsdGeom.Mesh.Define(shot.stage, path)
    mesh.CreateSubdivisionSchemeAttr("none")
    mesh.CreateFaceVertexCountsAttr([4, 4])
    mesh.CreateFaceVertexIndicesAttr([0, 1, 4, 3, 1, 2, 5, 4])
    mesh.CreatePointsAttr([(x, y, 0) for y in (-50, 50) for x in (-50, 0, 50)])
    return mesh


def row_of_squares(shot: Shot, path: str = "/Mesh") -> UsdGeom.Mesh:
    """Three squares of two units side by side that move upwards."""
    mesh = UsdGeom.Mesh.Define(shot.stage, path)
    mesh.CreateSubdivisionSchemeAttr("none")
    mesh.CreateFaceVertexCountsAttr([4, 4, 4])
    mesh.CreateFaceVertexIndicesAttr(range(12))
    corners = [(x + dx, dy, 0) for x in (-3, 0, 3) for dx, dy in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    for time, rise in ((9.0, -1.0), (11.0, 1.0)):
        mesh.CreatePointsAttr().Set([(x, y + rise, z) for x, y, z in corners], time)
    return mesh


@case("visibility")
def _visibility() -> None:
    shot = Shot(SHUTTER)
    visibility = UsdGeom.Imageable(row_of_squares(shot)).CreateVisibilityAttr()
    set_in_turn(visibility, ("inherited", "invisible", "inherited"))
    assert_covers_as_the_stage(shot)


@case("holeIndices")
def _holes() -> None:
    shot = Shot(SHUTTER)
    set_in_turn(row_of_squares(shot).CreateHoleIndicesAttr(), ([0], [1, 2], []))
    assert_covers_as_the_stage(shot)


@case("holeIndices")
def _holes_and_a_blinking_parent_of_instances() -> None:
    shot = Shot(SHUTTER)
    shot.stage.CreateClassPrim("/Asset")
    set_in_turn(row_of_squares(shot, "/Asset/Mesh").CreateHoleIndicesAttr(), ([0], [], [0, 1]))
    for name, y in (("One", 2.0), ("Two", -2.0)):
        prim = UsdGeom.Xform.Define(shot.stage, f"/{name}")
        prim.GetPrim().GetReferences().AddInternalReference("/Asset")
        prim.GetPrim().SetInstanceable(True)
        prim.AddTranslateOp().Set(Gf.Vec3d(0, y, 0))
    visibility = UsdGeom.Imageable.Get(shot.stage, "/Two").CreateVisibilityAttr()
    set_in_turn(visibility, ("inherited", "invisible"), (9.0, 10.1))
    assert_covers_as_the_stage(shot)


@case("holeIndices")
def _holes_under_a_blur_scale() -> None:
    for blur in (0.0, 0.5, 2.0):
        shot = Shot(SHUTTER)
        mesh = row_of_squares(shot)
        set_in_turn(mesh.CreateHoleIndicesAttr(), ([0], [1, 2], []), (9.0, 10.1, 10.6))
        UsdGeom.MotionAPI.Apply(mesh.GetPrim()).CreateMotionBlurScaleAttr(blur)
        assert_covers_as_the_stage(shot)


@case("holeIndices")
def _holes_of_a_topology_that_changes_are_the_frames() -> None:
    shot = Shot(SHUTTER)
    mesh = row_of_squares(shot)
    mesh.GetFaceVertexCountsAttr().Set([4, 4, 4], 9.0)
    mesh.GetFaceVertexCountsAttr().Set([6, 6], 10.1)
    set_in_turn(mesh.CreateHoleIndicesAttr(), ([0], [2], [0]))
    assert_covers_as_the_stage(shot)


@case("holeIndices")
def _more_changes_than_meshes_are_worth_are_named() -> None:
    shot = Shot(SHUTTER)
    mesh = row_of_squares(shot)
    mesh.GetFaceVertexCountsAttr().Set([3, 3, 3, 3])
    subset = UsdGeom.Subset.CreateGeomSubset(mesh, "A", "face", [], "materialBind")
    for step in range(100):
        mesh.CreateHoleIndicesAttr().Set([i for i in range(4) if step >> i & 1], 9.75 + 0.0075 * step)
        subset.GetIndicesAttr().Set([i for i in range(4) if step >> (i + 4) & 1], 9.75 + 0.0075 * step)
    for name in ("/Mesh.holeIndices", "/Mesh/A.indices"):
        named(shot, name, "expected at most 32", "held")


@case("GeomSubset.indices")
def _subsets() -> None:
    shot = Shot(SHUTTER)
    mesh = wide_squares(shot)
    for name, colour, faces in (("A", RED, ([0], [0, 1], [1])), ("B", BLUE, ([1], [], [0]))):
        subset = UsdGeom.Subset.CreateGeomSubset(mesh, name, "face", [], "materialBind")
        set_in_turn(subset.GetIndicesAttr(), faces)
        bind(subset, glowing(shot, f"/Looks/{name}", colour))
    left, right = mean_of_halves(picture(shot))
    before, between, after = shares()
    assert left == pytest.approx([before + between, 0, after], abs=0.02)
    assert right == pytest.approx([between + after, 0, before], abs=0.02)


@case("primvars:normals:indices")
def _indices_of_normals() -> None:
    shot = Shot(SHUTTER)
    api = UsdGeom.PrimvarsAPI(shot.mesh("/Mesh"))
    primvar = api.CreatePrimvar("normals", Sdf.ValueTypeNames.Normal3fArray, "vertex")
    primvar.Set([(0, 0, 1), (0, 1, 0)])
    primvar.CreateIndicesAttr()
    set_in_turn(primvar.GetIndicesAttr(), ([0, 0, 0, 0], [0, 1, 0, 1], [1, 1, 1, 1]))
    meshes = list(shot.read().scene.meshes.values())
    seen = sorted((float(np.ravel(m["visible"])[0]), m["normals_indices"].tolist()) for m in meshes)
    assert [indices for _, indices in seen] == [[0, 0, 0, 0], [0, 1, 0, 1], [1, 1, 1, 1]]
    assert [begin for begin, _ in seen] == pytest.approx([0.0, 0.4, 0.6])


def points(shot: Shot, count: int = 4) -> UsdGeom.PointInstancer:
    """Instances in a row that move upwards: a square and a triangle."""
    instancer = UsdGeom.PointInstancer.Define(shot.stage, "/Points")
    shot.mesh("/Points/Square")
    shot.mesh("/Points/Triangle", [(0, 0, 0), (1.5, 0, 0), (0, 1.5, 0)])
    instancer.CreatePrototypesRel().SetTargets(["/Points/Square", "/Points/Triangle"])
    instancer.CreateProtoIndicesAttr([i % 2 for i in range(count)])
    for time, y in ((9.0, -1.0), (11.0, 1.0)):
        instancer.CreatePositionsAttr().Set([(2 * i - count, y, 0) for i in range(count)], time)
    return instancer


@case("PointInstancer.protoIndices")
def _prototype_indices() -> None:
    shot = Shot(SHUTTER)
    instancer = points(shot)
    set_in_turn(instancer.GetProtoIndicesAttr(), ([0, 1, 0, 1], [1, 1, 0, 0], [0, 1, 1, 0]))
    assert_as_the_stage(shot)
    assert_covers_as_the_stage(shot)
    assert not messages(shot.read(), "warning")


@case("PointInstancer.protoIndices")
def _prototype_indices_under_a_blur_scale() -> None:
    shot = Shot(SHUTTER)
    instancer = points(shot)
    set_in_turn(instancer.GetProtoIndicesAttr(), ([0, 1, 0, 1], [1, 1, 0, 0], [0, 1, 1, 0]), (9.0, 10.1, 10.6))
    UsdGeom.MotionAPI.Apply(instancer.GetPrim()).CreateMotionBlurScaleAttr(2.0)
    assert_as_the_stage(shot)


@case("PointInstancer.protoIndices")
def _prototype_indices_of_another_number_are_the_frames() -> None:
    shot = Shot(SHUTTER)
    set_in_turn(points(shot).GetProtoIndicesAttr(), ([0, 1, 0, 1], [1, 1, 0], [0, 1, 1, 0]))
    assert_as_the_stage(shot)
    (warning,) = messages(shot.read(), "warning")
    assert warning.startswith("/Points.protoIndices: ") and "the frame's" in warning


@case("PointInstancer.protoIndices")
def _prototype_indices_that_velocities_carry_are_the_frames() -> None:
    shot = Shot(SHUTTER)
    instancer = points(shot)
    set_in_turn(instancer.GetProtoIndicesAttr(), ([0, 1, 0, 1], [1, 1, 0, 0], [0, 1, 1, 0]))
    for time in (9.0, 11.0):
        instancer.CreateVelocitiesAttr().Set([(24, 0, 0)] * 4, time)
    assert_as_the_stage(shot)


@case("PointInstancer.invisibleIds")
@case("PointInstancer.ids")
def _invisible_ids() -> None:
    for blur in (1.0, 0.0, 2.0):
        shot = Shot(SHUTTER)
        instancer = points(shot)
        instancer.CreateIdsAttr([7, 5, 3, 1])
        set_in_turn(instancer.CreateInvisibleIdsAttr(), ([5], [7, 3], []))
        UsdGeom.MotionAPI.Apply(instancer.GetPrim()).CreateMotionBlurScaleAttr(blur)
        assert_as_the_stage(shot)


@case("PointInstancer.ids")
def _ids() -> None:
    shot = Shot(SHUTTER)
    instancer = points(shot)
    instancer.CreateInvisibleIdsAttr([5, 1])
    set_in_turn(instancer.CreateIdsAttr(), ([7, 5, 3, 1], [5, 1, 3, 7], [1, 2, 3, 4]))
    set_in_turn(instancer.GetProtoIndicesAttr(), ([0, 1, 0, 1], [1, 1, 0, 0]), (9.0, 10.1))
    assert_as_the_stage(shot)


def primvar_at(primvar: UsdGeom.Primvar, code: Usd.TimeCode) -> np.ndarray:
    """By USD's own flattening."""
    return np.array(primvar.ComputeFlattened(code), float)


def assert_primvar_follows(shot: Shot, primvar: UsdGeom.Primvar, name: str) -> None:
    """What the visible mesh is handed down with is what USD computes at any time."""
    result = shot.read()
    for time01 in DENSE_TIMES01[:-1]:
        (mesh,) = [mesh for mesh in result.scene.meshes.values() if shows(mesh, time01)]
        interpolation, values, indices = mesh[name]
        assert interpolation == str(primvar.GetInterpolation())
        times01, samples = zip(*values, strict=True) if isinstance(values, list) else ((0.0,), (values,))
        assert (np.diff(times01) > 0).all()
        found = interpolated(times01, samples, time01)
        expected = primvar_at(primvar, result.camera.shutter.time_code(time01))
        assert np.abs((found if indices is None else found[indices]) - expected).max() < 1e-5, f"at {time01}"
    assert not messages(result, "warning")


def shows(mesh: dict, time01: float) -> bool:
    visible = mesh["visible"]
    return visible is None or bool(((visible[:, 0] <= time01) & (time01 < visible[:, 1])).any())


@case("primvars:displayColor")
def _colours() -> None:
    shot = Shot(SHUTTER)
    primvar = shot.mesh("/Mesh").CreateDisplayColorPrimvar("vertex")
    set_in_turn(primvar, ([RED, RED, GREEN, BLUE], [GREEN, BLUE, RED, RED], [RED] * 4), (9.0, 10.1, 11.0))
    assert_primvar_follows(shot, primvar, "display_color")


@case("primvars:displayColor:indices")
def _indices_of_colours() -> None:
    shot = Shot(SHUTTER)
    primvar = shot.mesh("/Mesh").CreateDisplayColorPrimvar("vertex")
    set_in_turn(primvar, ([RED, GREEN], [BLUE, GREEN], [RED, RED]), (9.0, 10.1, 11.0))
    primvar.CreateIndicesAttr()
    set_in_turn(primvar.GetIndicesAttr(), ([0, 0, 1, 1], [1, 0, 1, 0], [0, 0, 0, 0]))
    assert_primvar_follows(shot, primvar, "display_color")


@case("primvars:displayColor:indices")
def _values_and_indices_of_another_number_at_each_sample() -> None:
    shot = Shot(SHUTTER)
    primvar = shot.mesh("/Mesh").CreateDisplayColorPrimvar("faceVarying")
    set_in_turn(primvar, ([RED, GREEN], [BLUE, GREEN, RED], [GREEN]))
    primvar.CreateIndicesAttr()
    set_in_turn(primvar.GetIndicesAttr(), ([0, 0, 1, 1], [2, 0, 1, 0], [0, 0, 0, 0]))
    assert_primvar_follows(shot, primvar, "display_color")


@case("primvars:displayColor:indices")
def _indices_on_an_implicit_shape() -> None:
    shot = Shot(SHUTTER)
    shape = UsdGeom.Cube.Define(shot.stage, "/Mesh")
    shape.CreateSizeAttr(200.0)
    shot.camera.GetOrderedXformOps()[0].Set(Gf.Vec3d(0, 0, 120))
    bind(shape, glowing(shot, "/Look", None))
    primvar = shape.CreateDisplayColorPrimvar("constant")
    primvar.Set([RED, GREEN, BLUE])
    primvar.CreateIndicesAttr()
    set_in_turn(primvar.GetIndicesAttr(), ([0], [2], [1]))
    assert picture(shot)[..., :3].mean(axis=(0, 1)) == pytest.approx(shares() @ COLOURS[[0, 2, 1]], abs=0.02)


@case("primvars:displayColor:indices")
def _indices_on_a_held_stage() -> None:
    shot = Shot(SHUTTER)
    shot.stage.SetInterpolationType(Usd.InterpolationTypeHeld)
    primvar = shot.mesh("/Mesh").CreateDisplayColorPrimvar("vertex")
    set_in_turn(primvar, ([RED, GREEN], [BLUE, GREEN]), (9.0, 10.1))
    primvar.CreateIndicesAttr()
    set_in_turn(primvar.GetIndicesAttr(), ([0, 0, 1, 1], [1, 0, 1, 0], [0, 0, 0, 0]))
    assert_primvar_follows(shot, primvar, "display_color")


@case("primvars:displayColor:indices")
def _indices_of_colours_in_the_picture() -> None:
    shot = Shot(SHUTTER)
    mesh = wide_squares(shot)
    bind(mesh, glowing(shot, "/Look", None))
    primvar = mesh.CreateDisplayColorPrimvar("uniform")
    primvar.Set([RED, GREEN, BLUE])
    primvar.CreateIndicesAttr()
    set_in_turn(primvar.GetIndicesAttr(), ([0, 1], [2, 2], [1, 0]))
    left, right = mean_of_halves(picture(shot))
    assert left == pytest.approx(shares() @ COLOURS[[0, 2, 1]], abs=0.02)
    assert right == pytest.approx(shares() @ COLOURS[[1, 2, 0]], abs=0.02)


@case("primvars:displayColor:indices")
def _indices_that_point_nowhere_for_a_while_are_named() -> None:
    shot = Shot(SHUTTER)
    primvar = shot.mesh("/Mesh").CreateDisplayColorPrimvar("vertex")
    primvar.Set([RED, GREEN])
    primvar.CreateIndicesAttr()
    set_in_turn(primvar.GetIndicesAttr(), ([0, 0, 1, 1], [1, 7, 1, 0], [0, 0, 0, 0]))
    (warning,) = messages(shot.read(), "warning")
    assert warning.startswith("/Mesh.primvars:displayColor: index 1 is 7; expected less than 2")


@case("primvars:displayOpacity")
def _opacity() -> None:
    shot = Shot(SHUTTER)
    primvar = shot.mesh("/Mesh").CreateDisplayOpacityPrimvar("vertex")
    set_in_turn(primvar, ([0.5, 1, 1, 1], [1, 0, 1, 0], [1, 1, 0, 0]), (9.0, 10.1, 11.0))
    assert_primvar_follows(shot, primvar, "display_opacity")


@case("primvars:displayOpacity:indices")
def _indices_of_opacity() -> None:
    shot = Shot(SHUTTER)
    primvar = shot.mesh("/Mesh").CreateDisplayOpacityPrimvar("vertex")
    primvar.Set([0.5, 1.0])
    primvar.CreateIndicesAttr()
    set_in_turn(primvar.GetIndicesAttr(), ([0, 0, 1, 1], [1, 0, 1, 0], [0, 0, 0, 0]))
    assert_primvar_follows(shot, primvar, "display_opacity")


def wide_points(shot: Shot) -> UsdGeom.PointInstancer:
    """Two instances that fill the halves of the picture and glow in their displayColor."""
    instancer = UsdGeom.PointInstancer.Define(shot.stage, "/Points")
    mesh = shot.mesh("/Points/Square", [(0, -50, 0), (50, -50, 0), (50, 50, 0), (0, 50, 0)])
    bind(mesh, glowing(shot, "/Look", None))
    instancer.CreatePrototypesRel().SetTargets(["/Points/Square"])
    instancer.CreateProtoIndicesAttr([0, 0])
    instancer.CreatePositionsAttr([(-50, 0, 0), (0, 0, 0)])
    return instancer


def instance_colours(shot: Shot, interpolation: str = "vertex") -> tuple[UsdGeom.PointInstancer, UsdGeom.Primvar]:
    instancer = wide_points(shot)
    api = UsdGeom.PrimvarsAPI(instancer)
    return instancer, api.CreatePrimvar("displayColor", Sdf.ValueTypeNames.Color3fArray, interpolation)


@case("PointInstancer.primvars:displayColor")
def _colours_of_instances() -> None:
    shot = Shot(SHUTTER)
    _, primvar = instance_colours(shot)
    set_in_turn(primvar, ([RED, BLUE], [GREEN, BLUE], [BLUE, RED]), (9.75, 9.9375, 10.5))
    left, right = mean_of_halves(picture(shot))
    assert left == pytest.approx((COLOURS[0] + COLOURS[1]) / 8 + 3 * (COLOURS[1] + COLOURS[2]) / 8, abs=0.02)
    assert right == pytest.approx(COLOURS[2] / 4 + 3 * (COLOURS[2] + COLOURS[0]) / 8, abs=0.02)
    assert not [text for text in messages(shot.read(), "warning") if "displayColor" in text]


@case("PointInstancer.primvars:displayColor")
def _colours_of_nested_instances() -> None:
    """The inner instancer's colours go to both of the outer one's instances."""
    shot = Shot(SHUTTER)
    inner, primvar = instance_colours(shot)
    set_in_turn(primvar, ([RED, BLUE], [GREEN, RED]), (9.75, 10.5))
    inner.GetPositionsAttr().Set([(-25, 0, 0), (0, 0, 0)])
    square = UsdGeom.Mesh.Get(shot.stage, "/Points/Square")
    square.GetPointsAttr().Set([(0, -50, 0), (25, -50, 0), (25, 50, 0), (0, 50, 0)])
    outer = UsdGeom.PointInstancer.Define(shot.stage, "/Outer")
    outer.CreatePrototypesRel().SetTargets(["/Points"])
    outer.CreateProtoIndicesAttr([0, 0])
    outer.CreatePositionsAttr([(-25, 0, 0), (25, 0, 0)])
    shot.stage.GetPrimAtPath("/Points").SetSpecifier(Sdf.SpecifierOver)
    shot.camera.GetHorizontalApertureAttr().Set(200.0)
    image = picture(shot)
    assert image[..., :3].mean(axis=(0, 1)) / image[..., 3].mean() == pytest.approx([0.5, 0.25, 0.25], abs=0.02)


@case("PointInstancer.primvars:displayColor:indices")
def _indices_of_the_colours_of_instances() -> None:
    shot = Shot(SHUTTER)
    _, primvar = instance_colours(shot)
    primvar.Set([RED, GREEN, BLUE])
    primvar.CreateIndicesAttr()
    set_in_turn(primvar.GetIndicesAttr(), ([0, 1], [2, 2], [1, 0]))
    left, right = mean_of_halves(picture(shot))
    assert left == pytest.approx(shares() @ COLOURS[[0, 2, 1]], abs=0.02)
    assert right == pytest.approx(shares() @ COLOURS[[1, 2, 0]], abs=0.02)


def deep_floor(shot: Shot) -> None:
    """A floor from 2 to 60 units before the camera, which looks along it from above."""
    shot.mesh("/Floor", [(-9, -1.5, 18), (9, -1.5, 18), (9, -1.5, -40), (-9, -1.5, -40)])


@case("Camera.clippingRange")
def _clipping_range() -> None:
    for values, times in (
        ([(2, 10), (8, 40)], (9.0, 11.0)),
        ([(2, 10), (4, 50), (3, 12)], (9.8, 10.1, 10.4)),
        ([(1, 100), (4, 100)], (9.0, 10.5)),
    ):
        shot = Shot(SHUTTER)
        deep_floor(shot)
        set_in_turn(shot.camera.CreateClippingRangeAttr(), [Gf.Vec2f(*value) for value in values], times)
        assert_covers_as_the_stage(shot)
        assert not messages(shot.read(), "warning")


@case("Camera.clippingRange")
def _clipping_range_of_a_held_stage_and_of_a_camera_that_moves() -> None:
    for held in (True, False):
        shot = Shot(SHUTTER)
        deep_floor(shot)
        if held:
            shot.stage.SetInterpolationType(Usd.InterpolationTypeHeld)
        set_in_turn(shot.camera.CreateClippingRangeAttr(), [Gf.Vec2f(2, 10), Gf.Vec2f(8, 40), Gf.Vec2f(3, 9)])
        turn = shot.camera.AddRotateZOp()
        set_in_turn(turn, (0.0, 20.0, 10.0), (9.0, 10.1, 11.0))
        assert_covers_as_the_stage(shot)


@case("Camera.clippingRange")
def _clipping_range_of_an_orthographic_camera() -> None:
    shot = Shot(SHUTTER)
    shot.camera.GetProjectionAttr().Set("orthographic")
    shot.camera.GetHorizontalApertureAttr().Set(200.0)
    shot.mesh("/Slope", [(-9, -5, 10), (9, -5, -10), (9, 5, -10), (-9, 5, 10)])
    set_in_turn(shot.camera.CreateClippingRangeAttr(), [Gf.Vec2f(-5, 22), Gf.Vec2f(20, 100)], (9.0, 11.0))
    assert_covers_as_the_stage(shot)


@case("SphereLight.inputs:intensity")
def _lights() -> None:
    shot = Shot(SHUTTER)
    light = UsdLux.SphereLight.Define(shot.stage, "/Light")
    set_in_turn(light.CreateIntensityAttr(), (1.0, 5.0, 2.0), (9.0, 10.1, 11.0))
    (found,) = shot.read().scene.lights
    for time01, radiance in zip(found["values_times01"], found["radiances"], strict=True):
        expected = light.GetIntensityAttr().Get(9.75 + 0.75 * time01)
        assert radiance[0] == pytest.approx(expected, rel=1e-4)


@case("faceVertexCounts")
def _counts() -> None:
    shot = Shot(SHUTTER)
    mesh = row_of_squares(shot)
    set_in_turn(mesh.GetFaceVertexCountsAttr(), ([4, 4, 4], [6, 6]), (9.0, 10.1))
    named(shot, "/Mesh.points", "topology")
    assert_covers_as_the_stage(shot)


@case("faceVertexIndices")
def _indices() -> None:
    shot = Shot(SHUTTER)
    mesh = row_of_squares(shot)
    set_in_turn(mesh.GetFaceVertexIndicesAttr(), (range(12), [*range(11), 0]), (9.0, 10.1))
    named(shot, "/Mesh.points", "topology")
    assert_covers_as_the_stage(shot)


SUBDIVISION: dict[str, tuple[Any, Any]] = {
    "interpolateBoundary": ("edgeOnly", "none"),
    "faceVaryingLinearInterpolation": ("all", "none"),
    "triangleSubdivisionRule": ("catmullClark", "smooth"),
    "creaseIndices": ([0, 1], [1, 2]),
    "creaseLengths": ([], [2]),
    "creaseSharpnesses": ([1.0], [2.0]),
    "cornerIndices": ([0], [1]),
    "cornerSharpnesses": ([1.0], [2.0]),
}
"""Values before and after the change."""


def _rule_of_subdivision(name: str) -> Case:
    def check() -> None:
        shot = Shot(SHUTTER)
        mesh = row_of_squares(shot)
        mesh.CreateSubdivisionSchemeAttr("catmullClark")
        set_in_turn(mesh.GetPrim().GetAttribute(name), SUBDIVISION[name], (9.0, 10.1))
        named(shot, f"/Mesh.{name}", "changes within the shutter", "as the topology")

    return check


for _name in SUBDIVISION:
    case(_name)(_rule_of_subdivision(_name))


@case("PointInstancer.primvars:displayOpacity")
def _opacities_of_instances() -> None:
    shot = Shot(SHUTTER)
    api = UsdGeom.PrimvarsAPI(points(shot))
    primvar = api.CreatePrimvar("displayOpacity", Sdf.ValueTypeNames.FloatArray, "vertex")
    set_in_turn(primvar, ([1.0] * 4, [0.5] * 4), (10.0, 10.4))
    named(shot, "/Points.primvars:displayOpacity", "not supported")


@case("Camera.projection")
def _projection() -> None:
    shot = Shot(SHUTTER)
    row_of_squares(shot)
    set_in_turn(shot.camera.GetProjectionAttr(), ("perspective", "orthographic"), (9.0, 10.2))
    named(shot, "/Camera.projection", "changes within the shutter", "held")
    read = shot.read().camera
    assert read.projection == "perspective" and (read.windows == read.windows[0]).all()


@case("motion:blurScale")
@case("motion:velocityScale")
def _motion_scales() -> None:
    for name in ("motion:blurScale", "motion:velocityScale"):
        shot = Shot(SHUTTER)
        mesh = row_of_squares(shot)
        api = UsdGeom.MotionAPI.Apply(mesh.GetPrim())
        attribute = api.CreateMotionBlurScaleAttr() if "blur" in name else api.CreateVelocityScaleAttr()
        set_in_turn(attribute, (1.0, 2.0), (9.0, 10.5))
        named(shot, f"/Mesh.{name}", "changes within the shutter", "held")


@case("inputs:diffuseColor")
def _materials() -> None:
    for name, values in (
        ("diffuseColor", (Gf.Vec3f(1), Gf.Vec3f(0))),
        ("emissiveColor", (Gf.Vec3f(1), Gf.Vec3f(0))),
        ("opacity", (1.0, 0.0)),
        ("opacityThreshold", (0.0, 1.0)),
    ):
        shot = Shot(SHUTTER)
        mesh = row_of_squares(shot)
        bind(mesh, glowing(shot, "/Look", RED))
        kind = Sdf.ValueTypeNames.Float if isinstance(values[0], float) else Sdf.ValueTypeNames.Color3f
        shader = UsdShade.Shader.Get(shot.stage, "/Look/Surface")
        set_in_turn(shader.CreateInput(name, kind).GetAttr(), values, (9.0, 10.5))
        named(shot, f"/Look/Surface.inputs:{name}", "changes within the shutter", "held")


@case("inputs:normal")
def _unsupported_inputs() -> None:
    shot = Shot(SHUTTER)
    bind(row_of_squares(shot), glowing(shot, "/Look", RED))
    shader = UsdShade.Shader.Get(shot.stage, "/Look/Surface")
    displacement = shader.CreateInput("displacement", Sdf.ValueTypeNames.Float).GetAttr()
    set_in_turn(displacement, (0.0, 0.0, 1.0), (9.0, 10.1, 10.4))
    named(shot, "/Look/Surface.inputs:displacement", "not supported")


@case("inputs:shaping:cone:angle")
def _unsupported_inputs_of_lights() -> None:
    shot = Shot(SHUTTER)
    light = UsdLux.SphereLight.Define(shot.stage, "/Light")
    angle = UsdLux.ShapingAPI.Apply(light.GetPrim()).CreateShapingConeAngleAttr()
    set_in_turn(angle, (90.0, 90.0, 20.0), (9.0, 10.1, 10.4))
    named(shot, "/Light.inputs:shaping:cone:angle", "not supported")


def skinned(shot: Shot) -> tuple[UsdGeom.Mesh, UsdSkel.BindingAPI]:
    root = UsdSkel.Root.Define(shot.stage, "/Root")
    skeleton = UsdSkel.Skeleton.Define(shot.stage, "/Root/Skeleton")
    identity = [Gf.Matrix4d(1)] * 2
    skeleton.CreateJointsAttr(["a", "b"])
    skeleton.CreateBindTransformsAttr(Vt.Matrix4dArray(identity))
    skeleton.CreateRestTransformsAttr(Vt.Matrix4dArray(identity))
    mesh = shot.mesh("/Root/Mesh")
    UsdSkel.BindingAPI.Apply(root.GetPrim()).CreateSkeletonRel().SetTargets([skeleton.GetPath()])
    binding = UsdSkel.BindingAPI.Apply(mesh.GetPrim())
    binding.CreateJointIndicesPrimvar(False, 2).Set([0, 1] * 4)
    binding.CreateJointWeightsPrimvar(False, 2).Set([0.5, 0.5] * 4)
    return mesh, binding


@case("primvars:skel:jointWeights")
def _joint_weights() -> None:
    shot = Shot(SHUTTER)
    _, binding = skinned(shot)
    set_in_turn(binding.GetJointWeightsAttr(), ([0.5, 0.5] * 4, [1.0, 0.0] * 4), (10.0, 11.0))
    named(shot, "/Root/Mesh.primvars:skel:jointWeights", "changes within the shutter", "held")


@case("primvars:skel:jointIndices")
def _joint_indices() -> None:
    shot = Shot(SHUTTER)
    _, binding = skinned(shot)
    set_in_turn(binding.GetJointIndicesAttr(), ([0, 1] * 4, [1, 0] * 4), (9.0, 10.2))
    named(shot, "/Root/Mesh.primvars:skel:jointIndices", "changes within the shutter", "held")


@case("primvars:skel:geomBindTransform")
def _geom_bind() -> None:
    shot = Shot(SHUTTER)
    _, binding = skinned(shot)
    bind_transform = binding.CreateGeomBindTransformAttr()
    set_in_turn(bind_transform, (Gf.Matrix4d(1), Gf.Matrix4d(2)), (10.0, 11.0))
    named(shot, "/Root/Mesh.primvars:skel:geomBindTransform", "changes within the shutter", "held")


@case("normals")
def _rest_normals() -> None:
    shot = Shot(SHUTTER)
    mesh, _ = skinned(shot)
    set_in_turn(mesh.CreateNormalsAttr(), ([(0, 0, 1)] * 4, [(0, 1, 0)] * 4), (9.0, 10.2))
    named(shot, "/Root/Mesh.normals", "change within the shutter", "held")


def _uniform(attribute: str) -> Case:
    def check() -> None:
        kind, _, name = attribute.rpartition(".")
        apis = {"primvars:skel:skinningMethod": "SkelBindingAPI", "model:drawMode": "GeomModelAPI"}
        registry = Usd.SchemaRegistry()
        if name in apis:
            definition = registry.FindAppliedAPIPrimDefinition(apis[name])
        else:
            definition = registry.FindConcretePrimDefinition(kind or "Mesh")
        assert definition.GetAttributeDefinition(name).GetVariability() == Sdf.VariabilityUniform

    return check


for _attribute, _fate in TABLE.items():
    if _fate == "uniform":
        CASES[_attribute] = [_uniform(_attribute)]


def test_every_line_of_the_table_is_held():
    assert TABLE.keys() == CASES.keys()


@pytest.mark.parametrize(
    "check",
    [
        pytest.param(check, id=f"{attribute}-{check.__name__.strip('_')}")
        for attribute, checks in CASES.items()
        for check in checks
    ],
)
def test_what_changes_within_the_shutter(check: Case):
    check()
