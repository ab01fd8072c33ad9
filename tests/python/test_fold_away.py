"""What a stage writes down but does not use costs nothing: counted, not timed, and with the same bits as the stage without it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from msbvh import _core
from msbvh.base.errors import Diagnostics
from msbvh.scene.reader import ReadSettings, read_frame
from pxr import Gf, Sdf, UsdGeom, UsdLux, UsdShade
from recording import Shot

FRAME = 10.0
TIMES = (9.0, 10.0, 11.0)
CORNERS = [(-3, -3, 0), (3, -3, 0), (3, 3, 0), (-3, 3, 0)]


def plain() -> Shot:
    """A square under a dome, which a cube casts its shadow on, with a material; an open shutter."""
    shot = Shot((-0.5, 0.5))
    square = shot.mesh("/Square", CORNERS)
    cube = UsdGeom.Cube.Define(shot.stage, "/Cube")
    cube.AddTranslateOp().Set(Gf.Vec3d(0.5, 0.2, 2))
    UsdLux.DomeLight.Define(shot.stage, "/Dome")
    material = UsdShade.Material.Define(shot.stage, "/Material")
    shader = UsdShade.Shader.Define(shot.stage, "/Material/Surface")
    shader.CreateIdAttr("UsdPreviewSurface")
    shader.CreateInput("diffuseColor", Sdf.ValueTypeNames.Color3f).Set(Gf.Vec3f(0.6, 0.4, 0.2))
    material.CreateSurfaceOutput().ConnectToSource(shader.ConnectableAPI(), "surface")
    UsdShade.MaterialBindingAPI.Apply(square.GetPrim()).Bind(material)
    return shot


def constant_points(shot: Shot) -> None:
    points = UsdGeom.Mesh.Get(shot.stage, "/Square").GetPointsAttr()
    for time in TIMES:
        points.Set([Gf.Vec3f(*corner) for corner in CORNERS], time)


def constant_transform(shot: Shot) -> None:
    op = UsdGeom.Xformable(shot.stage.GetPrimAtPath("/Cube")).GetOrderedXformOps()[0]
    for time in TIMES:
        op.Set(Gf.Vec3d(0.5, 0.2, 2), time)


def constant_camera(shot: Shot) -> None:
    op = shot.camera.GetOrderedXformOps()[0]
    for time in TIMES:
        op.Set(Gf.Vec3d(0, 0, 20), time)
        shot.camera.GetFocalLengthAttr().Set(50.0, time)


def constant_visibility(shot: Shot) -> None:
    visibility = UsdGeom.Imageable(shot.stage.GetPrimAtPath("/Cube")).CreateVisibilityAttr()
    for time in TIMES:
        visibility.Set("inherited", time)


def constant_light(shot: Shot) -> None:
    intensity = UsdLux.DomeLight.Get(shot.stage, "/Dome").CreateIntensityAttr()
    for time in TIMES:
        intensity.Set(1.0, time)


def zero_velocities(shot: Shot) -> None:
    UsdGeom.Mesh.Get(shot.stage, "/Square").CreateVelocitiesAttr([Gf.Vec3f(0)] * 4)


def closed_lens(shot: Shot) -> None:
    shot.camera.CreateFStopAttr(0.0)
    shot.camera.CreateFocusDistanceAttr(18.0)


def black_light(shot: Shot) -> None:
    for light in (UsdLux.RectLight, UsdLux.SphereLight, UsdLux.DistantLight):
        light.Define(shot.stage, f"/Black{light.__name__}").CreateIntensityAttr(0.0)


def opaque(shot: Shot) -> None:
    shader = UsdShade.Shader.Get(shot.stage, "/Material/Surface")
    shader.CreateInput("opacity", Sdf.ValueTypeNames.Float).Set(1.0)
    shader.CreateInput("opacityThreshold", Sdf.ValueTypeNames.Float).Set(0.5)


def opaque_display(shot: Shot) -> None:
    cube = UsdGeom.Gprim(shot.stage.GetPrimAtPath("/Cube"))
    for time in TIMES:
        cube.CreateDisplayOpacityAttr().Set([1.0], time)


def closed_shutter(shot: Shot) -> None:
    """Of things that would move; both cases have it."""
    shot.camera.CreateShutterOpenAttr(0.0)
    shot.camera.CreateShutterCloseAttr(0.0)


def motion_through_the_plain_pose(shot: Shot) -> None:
    op = UsdGeom.Xformable(shot.stage.GetPrimAtPath("/Cube")).GetOrderedXformOps()[0]
    points = UsdGeom.Mesh.Get(shot.stage, "/Square").GetPointsAttr()
    for time in TIMES:
        op.Set(Gf.Vec3d(0.5 + (time - FRAME), 0.2, 2), time)
        points.Set([Gf.Vec3f(x, y, time - FRAME) for x, y, _ in CORNERS], time)
    closed_shutter(shot)


EDITS = (
    constant_points,
    constant_transform,
    constant_camera,
    constant_visibility,
    constant_light,
    zero_velocities,
    closed_lens,
    black_light,
    opaque,
    opaque_display,
    motion_through_the_plain_pose,
)
UNTIMED = ("triangles", "quads", "instances", "references", "nodes", "leaves", "total_bytes", "max_segments", "depth")


def rendered(shot: Shot, **settings: Any) -> tuple[np.ndarray, dict[str, Any]]:
    """The picture, and the figures that do not depend on the clock."""
    result = read_frame(shot.stage, FRAME, ReadSettings(camera="/Camera", width=48), Diagnostics())
    size = {"width": result.camera.width, "height": result.camera.height}
    renderer = _core.Renderer(result.scene, **{**size, "spp": 4, "max_bounces": 1, **settings})
    pixels, _ = renderer.render_with_aovs()
    found = renderer.statistics
    counts = {
        "scene": {name: count for name, count in result.scene.statistics().items() if name != "lights"},
        "trees": {name: found["accel"][name] for name in UNTIMED},
        "rays": (found["rays"], found["camera_rays"]),
        "plan": [effect for effect, _, _ in renderer.plan],
        "track bytes": sum(track.bytes for track in result.tracks if track.source != "light"),
    }
    return pixels, counts


@pytest.mark.parametrize("edit", EDITS, ids=[edit.__name__ for edit in EDITS])
def test_what_is_written_and_not_used_costs_nothing(edit: Callable[[Shot], None]) -> None:
    expected, without = rendered(plain())
    shot = plain()
    edit(shot)
    found, counts = rendered(shot)
    assert counts == without
    np.testing.assert_array_equal(found, expected)


def test_the_same_edits_count_where_they_are_used() -> None:
    """So that the counts above can tell."""
    _, without = rendered(plain())
    shot = plain()
    motion_through_the_plain_pose(shot)
    shot.camera.CreateShutterCloseAttr(0.5)
    _, moving = rendered(shot)
    assert moving["trees"]["total_bytes"] > without["trees"]["total_bytes"]
    assert moving["trees"]["max_segments"] > without["trees"]["max_segments"] == 0
    assert moving["scene"]["keys"] > without["scene"]["keys"]
    shot = plain()
    UsdShade.Shader.Get(shot.stage, "/Material/Surface").CreateInput("opacity", Sdf.ValueTypeNames.Float).Set(0.5)
    closed_lens(shot)
    shot.camera.CreateFStopAttr(1.0)
    _, other = rendered(shot)
    assert {"opacity", "lens"} <= set(other["plan"]) - set(without["plan"])
    assert other["rays"] != without["rays"]


def test_aovs_of_an_unlit_stage_take_camera_rays_alone() -> None:
    shot = plain()
    shot.stage.RemovePrim("/Dome")
    result = read_frame(
        shot.stage, FRAME, ReadSettings(camera="/Camera", width=48, disable_camera_light=True), Diagnostics()
    )
    size = {"width": result.camera.width, "height": result.camera.height}
    renderer = _core.Renderer(result.scene, **size, spp=4, max_bounces=4, aovs=("primId", "depth"))
    renderer.render_with_aovs()
    found = renderer.statistics
    assert found["rays"] == found["camera_rays"] == size["width"] * size["height"] * 4
    assert "indirect light" not in [effect for effect, _, _ in renderer.plan]
