"""Depth of field: f-number and focus distance to a thin lens over the shutter."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from msbvh import _core
from msbvh.scene.reader import ReadSettings, read_frame
from recording import Shot, messages


def lens_shot(f_stop: float = 2.0, focus: float = 10.0) -> Shot:
    """A 50 mm lens, by USD's units 5 stage units."""
    shot = Shot()
    shot.camera.CreateFocalLengthAttr(50.0)
    shot.camera.CreateFStopAttr(f_stop)
    shot.camera.CreateFocusDistanceAttr(focus)
    return shot


def test_the_radius_is_half_the_focal_length_over_the_f_number():
    result = lens_shot().read()
    assert result.camera.lenses.tolist() == [[1.25, 10.0]]
    assert result.scene.camera["lenses"].dtype == np.float32
    assert not messages(result, "warning")


def test_a_pinhole_where_the_f_number_is_zero_or_nothing_says_where_to_focus():
    assert Shot().read().camera.lenses[:, 0].tolist() == [0.0]
    result = lens_shot(2.8, 0.0).read()
    assert result.camera.lenses[:, 0].tolist() == [0.0]
    assert any("/Camera.focusDistance: found 0" in note for note in messages(result, "note"))
    assert not messages(result, "warning")


def test_an_orthographic_camera_has_no_depth_of_field():
    shot = lens_shot()
    shot.camera.CreateProjectionAttr("orthographic")
    result = shot.read()
    assert result.camera.lenses[:, 0].tolist() == [0.0]
    assert any("/Camera.fStop: found 2 on an orthographic camera" in note for note in messages(result, "note"))


def test_focus_f_number_and_focal_length_are_sampled_over_the_shutter():
    shot = lens_shot()
    for attribute, first, last in (
        (shot.camera.GetFocusDistanceAttr(), 4.0, 8.0),
        (shot.camera.GetFStopAttr(), 2.0, 4.0),
        (shot.camera.GetFocalLengthAttr(), 40.0, 80.0),
    ):
        attribute.Set(first, 9.0)
        attribute.Set(last, 11.0)
    camera = shot.read().camera
    for time01, (radius, focus) in zip(camera.times01, camera.lenses, strict=True):
        code = camera.shutter.time_code(time01)
        f_stop, focal = shot.camera.GetFStopAttr().Get(code), shot.camera.GetFocalLengthAttr().Get(code)
        assert radius == pytest.approx(focal * 0.1 / (2 * f_stop), rel=1e-6)
        assert focus == pytest.approx(shot.camera.GetFocusDistanceAttr().Get(code), rel=1e-6)


def test_key_times_of_the_focus_are_kept():
    shot = lens_shot()
    for time, focus in ((9.0, 4.0), (10.0123, 9.0), (11.0, 4.0)):
        shot.camera.GetFocusDistanceAttr().Set(focus, time)
    camera = shot.read().camera
    at = int(np.argmin(np.abs(camera.times01 - camera.shutter.time01(10.0123))))
    assert camera.lenses[at, 1] == pytest.approx(9.0)


@pytest.mark.parametrize(
    ("attribute", "value"),
    [("fStop", math.nan), ("fStop", -1.0), ("focusDistance", -3.0), ("focusDistance", math.inf)],
)
def test_lenses_that_make_no_sense_are_named(attribute: str, value: float):
    shot = lens_shot()
    shot.camera.GetPrim().GetAttribute(attribute).Set(value)
    result = shot.read()
    assert result.camera.lenses[:, 0].tolist() == [0.0]
    (warning,) = messages(result, "warning")
    assert warning.startswith(f"/Camera.{attribute}: found {value:g}, expected a finite number of at least 0")


def test_a_lens_for_a_part_of_the_shutter_is_the_frames():
    shot = lens_shot()
    shot.camera.GetFStopAttr().Set(0.0, 10.25)
    shot.camera.GetFStopAttr().Set(4.0, 10.0)
    result = shot.read()
    assert result.camera.lenses.tolist() == [[0.625, 10.0]]
    (warning,) = messages(result, "warning")
    assert warning.startswith("/Camera.fStop: depth of field is on for a part of the shutter only")


def test_what_is_not_sampled_is_read_at_the_frame():
    shot = Shot((-0.5, 0.5))
    shot.camera.GetShutterOpenAttr().Set(-0.5, 9.0)
    shot.camera.GetShutterOpenAttr().Set(-0.25, 11.0)
    shot.camera.GetProjectionAttr().Set("perspective", 9.0)
    shot.camera.GetProjectionAttr().Set("orthographic", 10.25)
    camera = shot.read().camera
    assert camera.shutter.open == pytest.approx(-0.375)
    assert camera.projection == "perspective"


def test_the_lens_reaches_the_picture():
    """A card far out of focus behind the focus plane has soft edges; at the focus distance it has not."""

    def soft(focus: float) -> int:
        shot = lens_shot(2.0, focus)
        shot.mesh("/Card")
        result: Any = read_frame(shot.stage, 10.0, ReadSettings(width=64, height=64))
        renderer = _core.Renderer(result.scene, width=64, height=64, spp=16)
        assert [reason for reason in renderer.plan if reason[0] == "lens"] == [
            ("lens", "/Camera", f"radius 1.25, focus at {focus:g}")
        ]
        alpha = renderer.render()[..., 3]
        return int(((alpha > 0.0) & (alpha < 1.0)).sum())

    assert soft(5.0) > 4 * soft(20.0)
