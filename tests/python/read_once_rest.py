"""Cases of docs/design/read-once.md: colours of instances, cameras, lights, topology, materials and skins."""

from __future__ import annotations

from typing import Any

import pytest
from pxr import Gf, Sdf, Usd, UsdGeom, UsdLux, UsdShade, UsdSkel, Vt
from read_once import (
    BLUE,
    COLOURS,
    GREEN,
    RED,
    SHUTTER,
    Case,
    assert_covers_as_the_stage,
    bind,
    case,
    glowing,
    mean_of_halves,
    named,
    picture,
    row_of_squares,
    set_in_turn,
    shares,
)
from read_once_geometry import points
from recording import Shot, messages


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
    named(shot, "/Points.primvars:displayOpacity", "changes within the shutter")


@case("Camera.projection")
def _projection() -> None:
    shot = Shot(SHUTTER)
    row_of_squares(shot)
    set_in_turn(shot.camera.GetProjectionAttr(), ("perspective", "orthographic"), (9.0, 10.2))
    named(shot, "/Camera.projection", "changes within the shutter", "held")
    read = shot.read().camera
    assert read.projection == "perspective" and (read.windows == read.windows[0]).all()


@case("Camera.clippingPlanes")
def _clipping_planes() -> None:
    shot = Shot(SHUTTER)
    row_of_squares(shot)
    planes = [[Gf.Vec4f(1, 0, 0, 0)], [Gf.Vec4f(1, 0, 0, 2)]]
    set_in_turn(shot.camera.CreateClippingPlanesAttr(), planes, (9.0, 10.2))
    named(shot, "/Camera.clippingPlanes", "changes within the shutter", "held")


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
        ("metallic", (0.0, 1.0)),
        ("roughness", (0.0, 1.0)),
        ("ior", (1.0, 1.5)),
        ("clearcoat", (0.0, 1.0)),
        ("clearcoatRoughness", (0.0, 1.0)),
    ):
        shot = Shot(SHUTTER)
        mesh = row_of_squares(shot)
        bind(mesh, glowing(shot, "/Look", RED))
        kind = Sdf.ValueTypeNames.Float if isinstance(values[0], float) else Sdf.ValueTypeNames.Color3f
        shader = UsdShade.Shader.Get(shot.stage, "/Look/Surface")
        set_in_turn(shader.CreateInput(name, kind).GetAttr(), values, (9.0, 10.5))
        named(shot, f"/Look/Surface.inputs:{name}", "changes within the shutter", "held")


@case("inputs:normal")
def _constant_normal() -> None:
    shot = Shot(SHUTTER)
    bind(row_of_squares(shot), glowing(shot, "/Look", RED))
    shader = UsdShade.Shader.Get(shot.stage, "/Look/Surface")
    normal = shader.CreateInput("normal", Sdf.ValueTypeNames.Normal3f).GetAttr()
    set_in_turn(normal, ((0.0, 0.0, 1.0), (0.0, 0.0, 1.0), (1.0, 0.0, 0.0)), (9.0, 10.1, 10.4))
    named(shot, "/Look/Surface.inputs:normal", "changes within the shutter", "held")


@case("inputs:displacement")
def _displacement() -> None:
    shot = Shot(SHUTTER)
    bind(row_of_squares(shot), glowing(shot, "/Look", RED))
    shader = UsdShade.Shader.Get(shot.stage, "/Look/Surface")
    material = UsdShade.Material.Get(shot.stage, "/Look")
    material.CreateDisplacementOutput().ConnectToSource(shader.ConnectableAPI(), "displacement")
    displacement = shader.CreateInput("displacement", Sdf.ValueTypeNames.Float).GetAttr()
    set_in_turn(displacement, (0.0, 0.0, 1.0), (9.0, 10.1, 10.4))
    named(shot, "/Look/Surface.inputs:displacement", "changes within the shutter", "held")


@case("inputs:shaping:cone:angle")
def _unsupported_inputs_of_lights() -> None:
    shot = Shot(SHUTTER)
    light = UsdLux.DistantLight.Define(shot.stage, "/Light")
    angle = UsdLux.ShapingAPI.Apply(light.GetPrim()).CreateShapingConeAngleAttr()
    set_in_turn(angle, (90.0, 90.0, 20.0), (9.0, 10.1, 10.4))
    named(shot, "/Light.inputs:shaping:cone:angle", "shapes no distant light")


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
