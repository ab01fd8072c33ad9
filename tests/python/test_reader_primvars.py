"""displayColor and displayOpacity that change inside the shutter."""

from __future__ import annotations

import math

import numpy as np
import pytest
from msbvh import _core
from msbvh.scene.reader import ReadSettings, read_frame
from pxr import Gf, Usd, UsdGeom
from recording import DENSE_TIMES01, Shot, interpolated, messages

RED, GREEN, BLUE = Gf.Vec3f(1, 0, 0), Gf.Vec3f(0, 1, 0), Gf.Vec3f(0, 0, 1)


def painted(shutter: tuple[float, float] = (-0.5, 0.5)) -> tuple[Shot, UsdGeom.Primvar]:
    """A square and its displayColor, one colour a point."""
    shot = Shot(shutter)
    primvar = shot.mesh("/Mesh").CreateDisplayColorPrimvar(UsdGeom.Tokens.vertex)
    return shot, primvar


def colour(shot: Shot) -> tuple:
    return shot.read().scene.meshes["/Mesh"]["display_color"]


def test_values_are_the_stages_own_at_any_time():
    shot, primvar = painted()
    primvar.Set([RED, RED, GREEN, GREEN], 9.0)
    primvar.Set([GREEN, BLUE, GREEN, RED], 10.123)
    primvar.Set([RED, BLUE, BLUE, GREEN], 11.0)
    interpolation, samples, indices = colour(shot)
    assert interpolation == "vertex" and indices is None
    times01, values = zip(*samples, strict=True)
    assert len(samples) == 3 and values[0].dtype == np.float32
    shutter = shot.read().camera.shutter
    for time01 in DENSE_TIMES01:
        expected = np.array(primvar.Get(shutter.time_code(time01)))
        assert np.allclose(interpolated(times01, values, time01), expected, atol=1e-6)


def test_one_value_over_many_samples_is_still():
    shot, primvar = painted()
    for time in range(5, 15):
        primvar.Set([RED, GREEN, BLUE, RED], time)
    assert isinstance(colour(shot)[1], np.ndarray)


def test_a_closed_shutter_sees_the_frame():
    shot, primvar = painted((0.0, 0.0))
    primvar.Set([RED] * 4, 9.0)
    primvar.Set([GREEN] * 4, 11.0)
    assert np.allclose(colour(shot)[1], [[0.5, 0.5, 0.0]] * 4)


def test_indices_are_the_frames():
    shot, primvar = painted()
    primvar.SetIndices([0, 0, 1, 1])
    primvar.Set([RED, GREEN], 9.0)
    primvar.Set([GREEN, BLUE], 11.0)
    _, samples, indices = colour(shot)
    assert indices.tolist() == [0, 0, 1, 1] and len(samples) == 2
    assert not messages(shot.read(), "warning")


@pytest.mark.parametrize(
    ("bad", "text"),
    [
        ([RED], "the number of values changes within the shutter; held the frame's 4"),
        ([RED, RED, RED, Gf.Vec3f(math.nan)], "found a value within the shutter that is not finite"),
    ],
)
def test_what_cannot_be_interpolated_is_held_and_named(bad: list, text: str):
    shot, primvar = painted()
    primvar.Set([RED, GREEN, BLUE, RED], 10.0)
    primvar.Set(bad, 10.25)
    assert np.array_equal(colour(shot)[1], [RED, GREEN, BLUE, RED])
    (warning,) = messages(shot.read(), "warning")
    assert warning.startswith(f"/Mesh.primvars:displayColor: {text}")


def test_values_of_a_held_stage_jump():
    shot, primvar = painted((0.0, 1.0))
    shot.stage.SetInterpolationType(Usd.InterpolationTypeHeld)
    primvar.Set([RED] * 4, 10.0)
    primvar.Set([BLUE] * 4, 10.3)
    meshes = shot.read().scene.meshes.values()
    found = [(mesh["visible"].tolist(), mesh["display_color"][1].tolist()) for mesh in meshes]
    assert found == [([[0.0, pytest.approx(0.3)]], [[1, 0, 0]] * 4), ([[pytest.approx(0.3), 2.0]], [[0, 0, 1]] * 4)]
    assert not messages(shot.read(), "warning")


def test_an_inherited_colour_changes_too_and_so_does_an_implicit_shapes():
    shot = Shot()
    parent = UsdGeom.Xform.Define(shot.stage, "/Parent").GetPrim()
    primvar = UsdGeom.PrimvarsAPI(parent).CreatePrimvar("displayColor", _colour_type(), UsdGeom.Tokens.constant)
    primvar.Set([RED], 9.0)
    primvar.Set([BLUE], 11.0)
    UsdGeom.Sphere.Define(shot.stage, "/Parent/Ball")
    interpolation, samples, _ = shot.read().scene.meshes["/Parent/Ball"]["display_color"]
    assert interpolation == "constant" and [value.tolist() for _, value in samples] == [
        [[1, 0, 0]],
        [[0, 0, 1]],
    ]


def _colour_type():
    from pxr import Sdf

    return Sdf.ValueTypeNames.Color3fArray


def test_colours_of_instances_change_with_the_stage():
    shot = Shot()
    instancer = UsdGeom.PointInstancer.Define(shot.stage, "/Points")
    UsdGeom.Cube.Define(shot.stage, "/Points/Cube")
    instancer.CreatePrototypesRel().AddTarget("/Points/Cube")
    instancer.CreateProtoIndicesAttr([0, 0])
    instancer.CreatePositionsAttr([Gf.Vec3f(0), Gf.Vec3f(1)])
    primvar = UsdGeom.PrimvarsAPI(instancer).CreatePrimvar("displayColor", _colour_type(), UsdGeom.Tokens.vertex)
    primvar.Set([RED, GREEN], 9.0)
    primvar.Set([GREEN, RED], 11.0)
    result = shot.read()
    times01, values = zip(*result.scene.instances[0]["display_color"], strict=True)
    assert np.allclose(interpolated(times01, values, 0.0), [[0.75, 0.25, 0], [0.25, 0.75, 0]])
    assert np.allclose(interpolated(times01, values, 0.5), [[0.5, 0.5, 0], [0.5, 0.5, 0]])
    assert not messages(result, "warning")


def test_a_fade_reaches_the_picture():
    shot = Shot((0.0, 1.0))
    corners = ((-50, -50, 0), (50, -50, 0), (50, 50, 0), (-50, 50, 0))
    opacity = shot.mesh("/Card", corners).CreateDisplayOpacityPrimvar(UsdGeom.Tokens.constant)
    for time, value in ((10.0, 1.0), (10.5, 0.25), (11.0, 0.5)):
        opacity.Set([value], time)
    result = read_frame(shot.stage, 10.0, ReadSettings(width=32, height=32))
    assert not messages(result, "warning")
    image = _core.Renderer(result.scene, width=32, height=32, spp=64, max_bounces=0).render()
    assert image[..., 3].mean() == pytest.approx(0.5 * 0.625 + 0.5 * 0.375, abs=0.01)
