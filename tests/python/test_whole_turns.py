"""Rotors that are back where they were at every even time of the shutter are no still ones."""

from __future__ import annotations

import resource
import time
from pathlib import Path

import numpy as np
import pytest
import turning_stages as turning
from msbvh import _core
from msbvh.base.errors import Diagnostics
from msbvh.motion.times import Shutter
from msbvh.scene.reader import ReadResult, ReadSettings, read_frame
from pxr import Gf, Ts, Usd, UsdGeom
from soak import soak_count, soak_figure
from turning_stages import SOURCES, Source

TOLERANCE = 0.1
WIDTH = 960
SEED = 11
DENSE = 61
"""Random times at which the truth is asked for."""
EVERY_QUARTER = np.arange(0.0, 100.25, 0.25)


def some_turns(rng: np.random.Generator, count: int) -> list[float]:
    """Whole turns and near ones by name, then as many quarters and random ones as there is time for."""
    named = [0.0, 0.25, 1.0, 3.99, 4.0, 8.0, 16.0, 64.0, 100.0]
    quarters = rng.permutation(EVERY_QUARTER)[:count].tolist()
    return [*named, *quarters, *rng.uniform(0.0, 100.0, count // 2).tolist()]


def read(stage: Usd.Stage, width: int = WIDTH) -> ReadResult:
    return read_frame(stage, turning.FRAME, ReadSettings(width=width), Diagnostics())


def largest_error(stage: Usd.Stage, result: ReadResult, rng: np.random.Generator) -> float:
    """Pixels between the tracks as they are traced and usd-core's evaluation, at times that no period meets."""
    worst = 0.0
    for time01 in rng.random(DENSE).astype(np.float32).tolist():
        places = np.concatenate([points for _, _, points in result.scene.poses(time01)])
        seen = places[np.abs(places[:, 0, 2]).argmin()]
        worst = max(worst, float(np.linalg.norm(seen - turning.true_points(stage, time01), axis=1).max()))
    return worst * turning.pixels_per_unit(WIDTH)


@pytest.mark.soak
@pytest.mark.parametrize("source", SOURCES, ids=lambda source: source.name)
def test_the_track_follows_or_says_by_how_much_it_does_not(source: Source) -> None:
    rng = np.random.default_rng(SEED)
    worst, lowest, turns = 0.0, np.inf, some_turns(rng, soak_count(6, len(EVERY_QUARTER)))
    for number in turns:
        stage = source.stage(number)
        result = read(stage)
        true = largest_error(stage, result, rng)
        reported = max(track.error_pixels for track in result.tracks)
        if source.periodic or reported <= TOLERANCE:
            assert true <= TOLERANCE, f"{number} turns: off by {true} pixels, reported {reported}"
            worst = max(worst, true)
        else:
            assert reported >= 0.8 * true, f"{number} turns: off by {true} pixels, reported {reported}"
            lowest = min(lowest, reported / true)
    soak_figure(
        f"turns {source.name}",
        f"{len(turns)} rates, within tolerance at most {worst:.4f} px, reported/true >= {lowest:.2f}",
    )


def alpha_of(result: ReadResult, spp: int) -> np.ndarray:
    camera = result.camera
    renderer = _core.Renderer(
        result.scene, width=camera.width, height=camera.height, spp=spp, seed=5, max_bounces=0, threads=2,
        show_domes=False, builder="msbvh",
    )  # fmt: skip
    return np.array(renderer.render(lambda *_: None))[..., 3]


def swept_share(radius: np.ndarray) -> np.ndarray:
    """Of a whole turn, for how much of it the blade covers a point at that distance from its hub."""
    angle = np.arcsin(np.clip(turning.HALF_WIDTH / np.maximum(radius, 1e-9), -1.0, 1.0))
    # Near the hub the blade's straight end counts: x >= 0 is half a turn at most. At the rim x <= RADIUS.
    beyond = np.arccos(np.clip(turning.RADIUS / np.maximum(radius, 1e-9), -1.0, 1.0))
    return np.maximum(2.0 * (np.minimum(angle, np.pi / 2.0) - beyond), 0.0) / (2.0 * np.pi)


PICTURED = [source for source in SOURCES if source.periodic] + [Source(turning.by_camera_roll, True)]


@pytest.mark.parametrize("turns", [4.0, 64.0, 100.0])
@pytest.mark.parametrize("source", PICTURED, ids=lambda source: source.name)
def test_whole_turns_are_a_smear_all_around(source: Source, turns: float) -> None:
    width, spp = 150, 64
    alpha = alpha_of(read(source.stage(turns), width), spp)
    unit = turning.pixels_per_unit(width)
    y, x = np.indices(alpha.shape) + 0.5
    x, y = (x - alpha.shape[1] / 2) / unit, (alpha.shape[0] / 2 - y) / unit
    # The closed form over each pixel, at 6 x 6 places.
    inner = (np.arange(6) + 0.5) / 6 - 0.5
    expected = np.mean([swept_share(np.hypot(x + i / unit, y + j / unit)) for i in inner for j in inner], axis=0)
    noise = np.sqrt(np.maximum(expected * (1.0 - expected), 1e-3) / spp)
    covered = (expected > 0.0) | (alpha > 0.0)
    error = np.abs(alpha - expected)[covered]
    allowed = 0.004 + np.sqrt(2.0 / np.pi) * noise[covered].mean() * (1.0 + 3.0 / np.sqrt(covered.sum()))
    assert error.mean() <= allowed
    assert (error <= 0.06 + 5.0 * noise[covered]).all()
    centroid = np.array([(alpha * x).sum(), (alpha * y).sum()]) / alpha.sum()
    assert np.abs(centroid).max() < 3.0 * turning.RADIUS * np.sqrt(expected.sum() / spp) / alpha.sum()


def test_lights_that_turn_whole_turns_move() -> None:
    stage = turning.new_stage()
    turning.blade(stage)
    hub = UsdGeom.Xform.Define(stage, "/hub")
    turning.turn(hub, 128.0)
    from pxr import Gf, UsdLux

    UsdLux.SphereLight.Define(stage, "/hub/light").AddTranslateOp().Set(Gf.Vec3d(3, 0, 3))
    diagnostics = Diagnostics()
    read_frame(stage, turning.FRAME, ReadSettings(width=WIDTH), diagnostics)
    assert any("the light's motion deviates" in str(found) for found in diagnostics)


def test_knots_that_loops_repeat_are_breakpoints() -> None:
    """A piston that goes up and down four times in the shutter is where it was at its quarters."""
    stage = turning.new_stage()
    mesh = turning.blade(stage)
    spline = Ts.Spline("double")
    for time, value in ((0.0, 0.0), (0.0625, 2.0), (0.125, 0.0)):
        knot = Ts.Knot("double")
        knot.SetTime(time)
        knot.SetValue(value)
        knot.SetNextInterpolation(Ts.InterpLinear)
        spline.SetKnot(knot)
    spline.SetPostExtrapolation(Ts.Extrapolation(Ts.ExtrapLoopRepeat))
    op = mesh.AddTranslateYOp(turning.DOUBLE)
    op.GetAttr().SetSpline(spline)
    result = read(stage)
    rng = np.random.default_rng(SEED)
    assert largest_error(stage, result, rng) <= TOLERANCE
    heights = [result.scene.poses(time01)[0][2][0][:, 1].mean() for time01 in rng.random(200).astype(np.float32)]
    assert max(heights) > 1.9 and min(heights) < 0.1


def test_a_camera_that_rolls_whole_turns_moves() -> None:
    result = read(turning.by_camera_roll(16.0))
    camera = next(track for track in result.tracks if track.source == "camera")
    assert camera.segments > 0 and camera.error_pixels <= TOLERANCE


def test_turns_are_bounded_by_the_ops() -> None:
    from msbvh.motion.turns import xform_turns

    shutter = Shutter(turning.FRAME, *turning.SHUTTER)
    for number in (0.25, 4.0, 99.75):
        for make in (turning.by_op, turning.by_three_angles, turning.by_spline, turning.by_looping_spline):
            stage = make(number)
            mesh = UsdGeom.Mesh.Get(stage, "/blade")
            assert xform_turns(mesh, shutter).total[-1] >= number * (1.0 - 1e-9)


ABSURD = [
    pytest.param(source, turns, id=f"{source.name}-{turns:g}")
    for source in (*(s for s in SOURCES if s.name != "by_skeleton"), Source(turning.by_camera_roll, True))
    for turns in (3e3, 1e5, 1e9, 1e30)
]
BUDGET = 2**28
"""Bytes that a frame of one blade may take beside the libraries."""


@pytest.mark.parametrize(("source", "turns"), ABSURD)
def test_an_absurd_number_of_turns_costs_neither_time_nor_memory(source: Source, turns: float) -> None:
    """No frame has them; a slip of a unit does. The frame is drawn, and what misses the tolerance is said."""
    stage, diagnostics = source.stage(turns), Diagnostics()
    limits, start = resource.getrlimit(resource.RLIMIT_AS), time.process_time()
    resource.setrlimit(resource.RLIMIT_AS, (address_space() + BUDGET, limits[1]))
    try:
        result = read_frame(stage, turning.FRAME, ReadSettings(width=96), diagnostics)
        alpha = alpha_of(result, 4)
    finally:
        resource.setrlimit(resource.RLIMIT_AS, limits)
    assert np.isfinite(alpha).all()
    assert time.process_time() - start < 20.0
    if max(track.error_pixels for track in result.tracks) > TOLERANCE:
        assert any("deviates" in str(found) or "turns" in str(found) for found in diagnostics)


def address_space() -> int:
    """Bytes that this process has mapped."""
    return int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()


def by_orient(_: float) -> Usd.Stage:
    stage = turning.by_op(0.0)
    blade = UsdGeom.Xformable(stage.GetPrimAtPath("/blade"))
    blade.ClearXformOpOrder()
    op = blade.AddOrientOp()
    op.Set(Gf.Quatf(1.0), turning.FRAME - 1.0)
    op.Set(Gf.Quatf(0.7, 0.0, 0.0, 0.7), turning.FRAME + 1.0)
    return stage


@pytest.mark.parametrize("frame", [-1e30, 1e17])
@pytest.mark.parametrize("source", [*SOURCES, Source(by_orient, True)], ids=lambda source: source.name)
def test_a_shutter_whose_ends_are_one_number_has_no_turns(source: Source, frame: float) -> None:
    found = Diagnostics()
    read_frame(source.stage(4.0), frame, ReadSettings(width=32), found)
    assert not [str(each) for each in found if each.severity == "error"]
