"""What msbvh accuracy is made of: errors of pictures, knobs, findings, the front."""

from __future__ import annotations

import dataclasses
import shlex
from typing import Any

import flip_evaluator
import numpy as np
import pytest
from msbvh.accuracy import launch
from msbvh.accuracy.all_knobs import ALL
from msbvh.accuracy.facts import SceneFacts
from msbvh.accuracy.findings import findings
from msbvh.accuracy.front import guesses, promising
from msbvh.accuracy.kinds import DECIDED_BY, FINEST, rid_of
from msbvh.accuracy.knobs import Step
from msbvh.accuracy.options import DEFAULTS, Options
from msbvh.accuracy.picture_errors import noise_flip, own_noise, paired_error, picture_error
from msbvh.accuracy.points import Point, front_of
from msbvh.accuracy.store import Figures
from msbvh.accuracy.sweep import Axis
from msbvh.cli.record_command import record_command
from msbvh.output.flip import flip_map

EVERYTHING = SceneFacts(
    effects=frozenset(("subdivision", "displacement", "curves", "indirect light", "textures")),
    moves=True,
    moves_outside=True,
    cut=True,
    frame=1.0,
    frames=9,
    tracks=(),
    statistics={},
)
NOTHING = SceneFacts(frozenset(), False, False, False, None, 1, (), {})


# Errors of pictures


def test_bias_and_noise_are_told_apart() -> None:
    random = np.random.default_rng(1)
    truth = random.uniform(0.5, 1.5, (64, 64, 3))
    bias, noise = 0.05, 0.2
    pictures = [truth + bias + noise * random.normal(size=truth.shape) for _ in range(4)]
    references = [truth + 0.02 * random.normal(size=truth.shape) for _ in range(2)]
    found = picture_error(pictures, references)
    scale = (1.0 / (truth**2 + 0.01)).mean()
    assert found.bias_relative_mse == pytest.approx(bias**2 * scale, rel=0.15)
    assert found.noise_relative_mse == pytest.approx(noise**2 * scale, rel=0.05)
    assert found.rmse == pytest.approx(np.hypot(bias, noise), rel=0.03)
    assert own_noise(references) == pytest.approx(0.02**2 / 2 * scale, rel=0.1)


def test_one_cause_alone_is_seen_through_noise_in_common() -> None:
    random = np.random.default_rng(2)
    truth = random.uniform(0.5, 1.5, (64, 64, 3))
    noises = [0.3 * random.normal(size=truth.shape) for _ in range(3)]
    moved = [0.01 * random.normal(size=truth.shape) for _ in range(3)]
    without = [truth + noise for noise in noises]
    shifted = [truth + 0.02 + noise + little for noise, little in zip(noises, moved, strict=True)]
    assert paired_error(shifted, without).rmse == pytest.approx(0.02, rel=0.05)
    same = [truth + noise + little for noise, little in zip(noises, moved, strict=True)]
    assert paired_error(same, without).relative_mse == pytest.approx(0.0, abs=2e-6)
    assert paired_error(without, without).flip == 0.0


def test_flip_of_noise_needs_no_reference() -> None:
    random = np.random.default_rng(4)
    truth = np.linspace(0.1, 0.9, 96)[:, None, None] * np.ones((96, 96, 3))
    for amount in (0.02, 0.1):
        pictures = [np.maximum(truth + amount * random.normal(size=truth.shape), 0.0) for _ in range(3)]
        true = np.mean([flip_map(truth, picture).mean() for picture in pictures])
        assert noise_flip(pictures) == pytest.approx(true, rel=0.1)


def test_flip_is_that_of_its_authors() -> None:
    """PyPI's flip-evaluator, by those who wrote the paper, on a picture without black."""
    random = np.random.default_rng(3)
    smooth = np.linspace(0.1, 0.9, 64)[:, None, None] * np.ones((64, 64, 3))
    for amount in (0.02, 0.2):
        noisy = np.maximum(smooth + amount * random.normal(size=smooth.shape), 0.0)
        _, mean, _ = flip_evaluator.evaluate(smooth.astype(np.float32), noisy.astype(np.float32), "HDR")
        assert float(flip_map(smooth, noisy).mean()) == pytest.approx(mean, rel=0.02)
        assert mean > 0.0


def test_one_pixel_without_bounds_decides_over_itself_alone() -> None:
    picture = np.full((32, 32, 3), 0.4)
    noisy = picture + 0.1 * np.random.default_rng(5).normal(size=picture.shape)
    plain = float(flip_map(picture, noisy).mean())
    picture[3, 4], noisy[20, 20] = np.inf, np.nan
    assert float(flip_map(picture, noisy).mean()) > 0.5 * plain > 0.0
    assert float(flip_map(picture, noisy)[3, 4]) > 0.5


# Options, knobs, kinds


def test_options_are_those_of_a_command_line() -> None:
    base = Options.of({"spp": 16, "motion-tolerance": 0.1})
    turned = Options.of({"spp": 4}).over(base)
    assert turned.text() == "--motion-tolerance 0.1 --spp 4"
    assert turned.beside(base).plain() == {"spp": 4}
    assert turned == Options.of({"spp": 4, "motion-tolerance": 0.1})
    assert turned.without("spp").get("spp", 7) == 7


ALWAYS_ON = ("robust",)
"""Of knobs: they stand in the report with the reason why they cannot be turned."""


@pytest.mark.parametrize("knob", [knob for knob in ALL if knob.option not in ALWAYS_ON], ids=lambda knob: knob.option)
def test_record_takes_every_position_of_a_knob(knob: Any) -> None:
    assert not knob.idle(EVERYTHING)
    steps = [step for found in knob.steps(EVERYTHING, False).values() for step in found]
    few = [step for found in knob.steps(EVERYTHING, True).values() for step in found]
    assert len(steps) >= 2 and {step.options for step in few} <= {step.options for step in steps}
    for step in steps:
        record_command.make_context("record", ["s.usda", "o.exr", *step.options.without("frames").arguments()])


def test_a_still_scene_turns_no_knob_of_motion() -> None:
    idle = {knob.option for knob in ALL if knob.idle(NOTHING)} - {*ALWAYS_ON}
    assert idle == {
        "motion-tolerance",
        "outside-tolerance",
        "segments",
        "edge-length",
        "complexity",
        "displacement",
        "curves",
        "max-bounces",
        "texture-rate",
        "refit",
    }


def test_a_kind_of_error_goes_with_the_options_that_decide_it() -> None:
    options = Options.of({"segments": 1, "interpolation": "linear", "spp": 4})
    assert rid_of("motion", options) == Options.of({"spp": 4, "motion-tolerance": 0.005, "outside-tolerance": 1.0})
    assert all(set(FINEST[kind].plain()) <= set(names) for kind, names in DECIDED_BY.items())


def test_what_is_not_spelt_out_is_what_record_does() -> None:
    parameters = {parameter.name: parameter for parameter in record_command.params}
    assert {name: parameters[name.replace("-", "_")].default for name in DEFAULTS} == dict(DEFAULTS)


def test_commands_survive_a_shell_and_a_fraction_of_a_frame() -> None:
    shot = launch.Shot("my shot (1).usda", 100000.5, (), 1)
    command = Point(Options(), [], "x").plain(Options(), shot)["command"]
    assert shlex.split(command) == ["msbvh", "record", "my shot (1).usda", "frame.exr", "--frames", "100000.5"]
    several = shot.command(Options.of({"frames": 4}), "a.exr_b/picture.exr")
    assert several[2:5] == ["a.exr_b/picture.####.######.exr", "--frames", "100000.5:100003.5"]


# Findings


def report_of(error: str, flips: list[float], seconds: list[float], noise: float = 1.0) -> dict[str, Any]:
    """A report with one axis of positions a, b ..."""
    kinds = [{error: {"flip": flip, "relative_mse": flip}} if error != "none" else {} for flip in flips]
    points = {
        str(k): {
            "failed": None,
            "seconds": {"frame": [time, time, time]},
            "motion_px": 0.1,
            "noise_relative_mse": 0.01,
            "kinds": kind,
        }
        for k, (time, kind) in enumerate(zip(seconds, kinds, strict=True))
    }
    steps = [{"value": "abcdef"[k], "id": str(k)} for k in range(len(flips))]
    axis = {"name": "Knob", "option": "knob", "error": error, "series": [{"name": "", "points": steps}]}
    named = [{"name": "ours", "id": "0"}]
    return {"points": points, "axes": [axis], "named": named, "targets": [], "machine": {"noise": noise}}


@pytest.mark.parametrize(
    ("error", "flips", "seconds", "says"),
    [
        (
            "motion",
            [0.01, 0.0005, 0.0003, 0.0003],
            [1, 1, 1.5, 2],
            "Knob: b is enough (FLIP below 0.001); finer ones take up to 2.00",
        ),
        (
            "motion",
            [0.0005, 0.0003],
            [2, 1],
            "Knob: no position changes what the picture looks like (FLIP below 0.001); b is",
        ),
        ("motion", [0.01, 0.0005], [1, 2], ""),
        ("motion", [0.01, 0.0005, 0.0003], [1, 1, 1.01], ""),
        ("none", [0, 0], [1, 1.5], "Knob: a is the fastest, b takes 1.50 times as long; the picture is the same."),
        ("none", [0, 0], [1, 1.01], "Knob makes no difference here that the clock can tell."),
        ("look", [0, 0], [1, 1.5], "Knob: a is the fastest, b takes 1.50 times as long."),
    ],
)
def test_findings_follow_from_the_figures(error: str, flips: list[float], seconds: list[float], says: str) -> None:
    found = [sentence for sentence in findings(report_of(error, flips, seconds)) if sentence.startswith("Knob")]
    assert found == [] if not says else found[0].startswith(says)


def test_what_the_clock_cannot_tell_is_no_finding() -> None:
    found = findings(report_of("none", [0, 0], [1, 1.5], noise=1.6))
    assert "Knob makes no difference here that the clock can tell." in found
    assert any(sentence.startswith("The machine was noisy") for sentence in found)


# The front


def test_combinations_multiply_times_and_add_up_errors() -> None:
    base = Options.of({"spp": 4, "max-bounces": 2})
    knobs = {knob.option: knob for knob in ALL}
    spp = [Step("1", Options.of({"spp": 1}).over(base)), Step("16", Options.of({"spp": 16}).over(base))]
    bounces = [Step("0", Options.of({"max-bounces": 0}).over(base))]
    axes = [Axis(knobs["spp"], {"": spp}), Axis(knobs["max-bounces"], {"": bounces})]
    points = {
        options: dataclasses.replace(fake(seconds, error), options=options)
        for options, seconds, error in [
            (base, 4, 4),
            (spp[0].options, 2, 16),
            (spp[1].options, 8, 1),
            (bounces[0].options, 3, 6),
        ]
    }
    found = {guess.options: guess for guess in guesses(axes, base, points)}
    assert len(found) == 6
    both = found[Options.of({"spp": 16, "max-bounces": 0})]
    assert both.seconds == pytest.approx(4 * 2 * 0.75) and both.error == pytest.approx(4 - 3 + 2)
    assert promising(list(found.values()), list(points)) == [Options.of({"spp": 1, "max-bounces": 0}), both.options]


def test_the_front_has_what_nothing_beats() -> None:
    points = {
        name: fake(seconds, error) for name, seconds, error in [("a", 1, 9), ("b", 2, 9), ("c", 3, 1), ("d", 4, 2)]
    }
    assert front_of(points) == ["a", "c"]


def fake(seconds: float, error: float) -> Point:
    from msbvh.accuracy.picture_errors import PictureError

    times = dict.fromkeys(("read", "sample", "build", "write"), 0.0)
    point = Point(Options.of({"spp": int(error)}), [Figures({**times, "trace": seconds}, 1, {})])
    point.error = PictureError(error, error, 0.0, error, error, 0.0)
    return point
