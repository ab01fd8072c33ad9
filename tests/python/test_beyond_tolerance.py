"""Motion that no track follows within the tolerance: the blur is as close as it gets, and the message says what
helps."""

from __future__ import annotations

import numpy as np
import turning_stages as turning
from msbvh.base.errors import Diagnostics
from msbvh.scene.reader import ReadSettings, read_frame
from pxr import Gf, Usd
from recording import interpolated

SEED = 3
SAMPLES, STEP = 500, 0.0012


def zigzag() -> tuple[Usd.Stage, np.ndarray, np.ndarray]:
    """A blade that is thrown from side to side at 500 times in and around the shutter, with those times and its
    places."""
    stage = turning.new_stage()
    times = 0.7 + STEP * np.arange(SAMPLES)
    places = np.where(np.arange(SAMPLES) % 2, -4.0, 4.0)
    op = turning.blade(stage).AddTranslateOp()
    for time, place in zip(times.tolist(), places.tolist(), strict=True):
        op.Set(Gf.Vec3d(place, 0, 0), time)
    return stage, (times - turning.OPEN) / turning.LENGTH, places


def blur_error(stage: Usd.Stage, times01: np.ndarray, places: np.ndarray, segments: int) -> float:
    """The mean distance between where the blade is over the shutter and where it should be, whenever that is: stage
    units."""
    result = read_frame(stage, turning.FRAME, ReadSettings(segments=segments), Diagnostics())
    shown, true = [], []
    for time01 in np.random.default_rng(SEED).random(4000).astype(np.float32).tolist():
        ((_, _, points),) = result.scene.poses(time01)
        shown.append(points[0][0, 0])
        true.append(interpolated(times01, places, time01))
    return float(np.abs(np.sort(shown) - np.sort(true)).mean())


def test_the_blur_is_as_close_as_any_number_of_segments_gets_it() -> None:
    stage, times01, places = zigzag()
    fixed = {n: blur_error(stage, times01, places, n) for n in (1, 2, 4, 8, 16, 32, 64, 128)}
    chosen = blur_error(stage, times01, places, 0)
    assert chosen <= 1.05 * min(fixed.values()), fixed
    assert chosen < 0.5 * fixed[1]


def test_the_message_says_what_helps() -> None:
    stage, _, _ = zigzag()
    for settings, advice in (
        (ReadSettings(), "no track has more segments; a shorter shutter or a larger --motion-tolerance helps"),
        (ReadSettings(segments=4), "more --segments help"),
        (ReadSettings(interpolation="linear"), "--interpolation auto may help"),
    ):
        diagnostics = Diagnostics()
        read_frame(stage, turning.FRAME, settings, diagnostics)
        (said,) = [str(found) for found in diagnostics if found.severity == "warning"]
        assert said.startswith("/blade.xformOpOrder: the motion deviates by up to") and advice in said


def test_points_with_many_samples_report_their_true_error() -> None:
    """Five hundred samples are not read as 129 even ones, of which nothing would be left to report."""
    stage = turning.new_stage()
    mesh = turning.blade(stage)
    for index, time in enumerate((turning.OPEN + turning.LENGTH * np.linspace(0.0, 1.0, 500)).tolist()):
        shift = 4.0 if index % 2 else -4.0
        mesh.GetPointsAttr().Set([Gf.Vec3f(x + shift, y, z) for x, y, z in turning.BLADE], time)
    result = read_frame(stage, turning.FRAME, ReadSettings(), Diagnostics())
    track = next(track for track in result.tracks if track.path == "/blade")
    assert track.error_pixels > 4.0 * turning.pixels_per_unit(960)
