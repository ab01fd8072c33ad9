"""msbvh accuracy: what its figures mean, that it goes on where it was, what it refuses."""

from __future__ import annotations

import csv
import dataclasses
import json
import os
import shlex
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import flip_evaluator
import numpy as np
import pytest
from conftest import Run
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
from msbvh.accuracy.scenes import SCENES
from msbvh.accuracy.store import Figures, Store, fingerprint
from msbvh.accuracy.sweep import Axis
from msbvh.cli.main import commands
from msbvh.output.flip import flip_map
from pxr import Gf, Sdf, Usd, UsdGeom, UsdLux

SIDE = 16
EVERYTHING = SceneFacts(
    effects=frozenset(("subdivision", "displacement", "curves", "indirect light")),
    moves=True,
    cut=True,
    frame=1.0,
    frames=9,
    tracks=(),
    statistics={},
)
NOTHING = SceneFacts(frozenset(), False, False, None, 1, (), {})


def arc(path: Path, frames: int = 3) -> str:
    """A square, 0.5 units from the axis, that turns by 120 degrees within the shutter; the picture is 2 units wide."""
    stage = Usd.Stage.CreateNew(str(path))
    stage.SetStartTimeCode(1)
    stage.SetEndTimeCode(frames)
    camera = UsdGeom.Camera.Define(stage, "/camera")
    camera.AddTranslateOp().Set(Gf.Vec3d(0, 0, 10))
    camera.CreateProjectionAttr(UsdGeom.Tokens.orthographic)
    camera.CreateHorizontalApertureAttr(20.0)
    camera.CreateVerticalApertureAttr(20.0)
    camera.CreateShutterOpenAttr(-0.5)
    camera.CreateShutterCloseAttr(0.5)
    mesh = UsdGeom.Mesh.Define(stage, "/square")
    mesh.CreatePointsAttr([(0.3, -0.2, 0), (0.5, -0.2, 0), (0.5, 0.2, 0), (0.3, 0.2, 0)])
    mesh.CreateFaceVertexCountsAttr([4])
    mesh.CreateFaceVertexIndicesAttr([0, 1, 2, 3])
    mesh.CreateSubdivisionSchemeAttr(UsdGeom.Tokens.none)
    turn = mesh.AddRotateZOp()
    turn.Set(-120.0, 0)
    turn.Set(120.0 * frames, frames + 1)
    UsdLux.DistantLight.Define(stage, "/sun").CreateIntensityAttr(2.0)
    stage.GetRootLayer().Save()
    return str(path)


@pytest.fixture(scope="module")
def reported(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, str, dict[str, Any]]:
    """A quick report of the turning square: its folder, its scene and its data."""
    folder = tmp_path_factory.mktemp("accuracy")
    scene = arc(folder / "arc.usda")
    done = quick(scene, folder / "report", "--axes", "segments,spp,edge-length", "--target-error", "0.5px")
    assert done.returncode == 0, done.stderr
    return folder, scene, data_of(folder / "report")


def quick(scene: str, out: Path, *more: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "msbvh", "accuracy", scene, "--out", str(out), "--quick"]
    size = ("--resolution", f"{SIDE}", f"{SIDE}", "--spp", "2", "--threads", "1")
    return subprocess.run([*command, *size, *more], capture_output=True, text=True, timeout=120, check=False)


def data_of(out: Path) -> dict[str, Any]:
    found: dict[str, Any] = json.loads((out / "accuracy.json").read_text(encoding="utf-8"))
    return found


def points_of(data: dict[str, Any], option: str, series: str = "") -> dict[str, dict[str, Any]]:
    axis = next(axis for axis in data["axes"] if axis["option"] == option)
    steps = next(found for found in axis["series"] if found["name"] == series)["points"]
    return {step["value"]: data["points"][step["id"]] for step in steps}


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
    assert float(flip_map(picture, noisy).mean()) == pytest.approx(plain, abs=0.15)
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
    record = commands.commands["record"]
    assert not knob.idle(EVERYTHING)
    steps = [step for found in knob.steps(EVERYTHING, False).values() for step in found]
    few = [step for found in knob.steps(EVERYTHING, True).values() for step in found]
    assert len(steps) >= 2 and {step.options for step in few} <= {step.options for step in steps}
    for step in steps:
        record.make_context("record", ["s.usda", "o.exr", *step.options.without("frames").arguments()])


def test_a_still_scene_turns_no_knob_of_motion() -> None:
    idle = {knob.option for knob in ALL if knob.idle(NOTHING)} - {*ALWAYS_ON}
    assert idle == {
        "motion-tolerance",
        "segments",
        "edge-length",
        "complexity",
        "displacement",
        "curves",
        "max-bounces",
        "refit",
    }


def test_a_kind_of_error_goes_with_the_options_that_decide_it() -> None:
    options = Options.of({"segments": 1, "interpolation": "linear", "spp": 4})
    assert rid_of("motion", options) == Options.of({"spp": 4, "motion-tolerance": 0.005})
    assert all(set(FINEST[kind].plain()) <= set(names) for kind, names in DECIDED_BY.items())


def test_what_is_not_spelt_out_is_what_record_does() -> None:
    parameters = {parameter.name: parameter for parameter in commands.commands["record"].params}
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


class NoShapes:
    """Of a frame where nothing is cut."""

    def largest(self, options: Options) -> None:
        return None


def fake(seconds: float, error: float) -> Point:
    from msbvh.accuracy.picture_errors import PictureError

    times = dict.fromkeys(("read", "sample", "build", "write"), 0.0)
    point = Point(Options.of({"spp": int(error)}), [Figures({**times, "trace": seconds}, 1, {})])
    point.error = PictureError(error, error, 0.0, error, error, 0.0)
    return point


# A report


def test_motion_errors_are_those_of_a_chord(reported: tuple[Path, str, dict[str, Any]]) -> None:
    """One straight segment of an arc of 120 degrees is off by the sagitta, r (1 - cos 60°); two by that of 60 degrees."""
    points = points_of(reported[2], "segments", "linear")
    radius = np.hypot(0.5, 0.2) * SIDE / 2.0
    for count, segments in (("1", 1), ("2", 2), ("8", 8)):
        assert points[count]["motion_px"] == pytest.approx(
            radius * (1 - np.cos(np.pi / 3 / segments)), rel=0.02, abs=0.005
        )
    errors = [points[count]["kinds"]["motion"]["flip"] for count in ("1", "2", "8")]
    assert errors[0] > errors[1] > errors[2]


def test_noise_falls_with_samples_and_nothing_else_does(reported: tuple[Path, str, dict[str, Any]]) -> None:
    points = points_of(reported[2], "spp")
    noises = [points[count]["noise_relative_mse"] for count in ("1", "4", "16")]
    assert noises[0] > 2 * noises[1] > 4 * noises[2] > 0.0
    assert len({points[count]["motion_px"] for count in points}) == 1


def test_what_a_scene_has_no_use_for_is_left_out_with_a_reason(reported: tuple[Path, str, dict[str, Any]]) -> None:
    axis = next(axis for axis in reported[2]["axes"] if axis["option"] == "edge-length")
    assert axis["left_out"] == "nothing in this frame is subdivided" and axis["series"] == []


def test_named_settings_keep_their_errors_apart(reported: tuple[Path, str, dict[str, Any]]) -> None:
    data = reported[2]
    named = {one["name"]: data["points"][one["id"]] for one in data["named"]}
    assert list(named) == ["ours", "2 keys everywhere", "Arnold-like 3 keys"]
    assert named["ours"]["motion_px"] <= 0.1 < named["Arnold-like 3 keys"]["motion_px"]
    assert named["2 keys everywhere"]["kinds"]["motion"]["relative_mse"] > 0.0


def test_a_target_is_met_and_its_command_gives_it(reported: tuple[Path, str, dict[str, Any]], tmp_path: Path) -> None:
    data = reported[2]
    [target] = data["targets"]
    assert target["holds"] and 0.0 < target["found"] <= 0.55
    command = shlex.split(data["points"][target["id"]]["command"])
    command[0:1] = [sys.executable, "-m", "msbvh"]
    done = subprocess.run([*command, "--stats", "s.json"], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    tracks = json.loads((tmp_path / "s.json").read_text())["frames"][0]["tracks"]
    assert max(track["error_pixels"] for track in tracks) == pytest.approx(target["found"])


def test_prims_say_what_other_tracks_would_bring(reported: tuple[Path, str, dict[str, Any]]) -> None:
    [square] = [prim for prim in reported[2]["prims"] if prim["path"] == "/square"]
    assert square["error_px"] <= 0.1 < square["cheaper"]["error_px"]
    assert square["cheaper"]["bytes"] <= square["bytes"]
    assert square["dearer"]["error_px"] < square["error_px"]


def test_tables_have_a_row_a_position(reported: tuple[Path, str, dict[str, Any]]) -> None:
    folder, _, data = reported
    rows = list(csv.DictReader((folder / "report" / "points.csv").open(encoding="utf-8")))
    steps = sum(len(series["points"]) for axis in data["axes"] for series in axis["series"])
    assert len([row for row in rows if row["axis"] in ("segments", "spp")]) == steps
    assert all(float(row["frame_s"]) > 0.0 and row["command"].startswith("msbvh record ") for row in rows)
    prims = list(csv.DictReader((folder / "report" / "prims.csv").open(encoding="utf-8")))
    assert {row["path"] for row in prims} == {prim["path"] for prim in data["prims"]}


def test_a_second_run_takes_over_all_and_says_the_same(reported: tuple[Path, str, dict[str, Any]]) -> None:
    folder, scene, before = reported
    lost = next(iter(sorted((folder / "report" / "points").iterdir())))
    (lost / "figures.json").unlink()
    done = quick(scene, folder / "report", "--axes", "segments,spp,edge-length", "--target-error", "0.5px")
    assert done.returncode == 0, done.stderr
    after = data_of(folder / "report")
    assert after["rendered"] == 1 and after["taken_over"] == before["rendered"] - 1
    for key, point in after["points"].items():
        for name in ("relative_mse", "flip", "motion_px"):
            assert point[name] == before["points"][key][name]


def test_a_scene_is_known_by_its_content(tmp_path: Path) -> None:
    scene = arc(tmp_path / "arc.usda")
    before = [fingerprint(Usd.Stage.Open(Sdf.Layer.OpenAsAnonymous(scene))), fingerprint(Usd.Stage.Open(scene))]
    os.utime(scene)
    assert fingerprint(Usd.Stage.Open(scene)) == before[1]
    text = Path(scene).read_text()
    Path(scene).write_text(text.replace("120", "90"))
    stage = Usd.Stage.Open(scene)
    stage.Reload()
    assert len({*before, fingerprint(stage)}) == 3


def test_an_interrupted_run_goes_on(tmp_path: Path) -> None:
    scene = arc(tmp_path / "arc.usda")
    command = [sys.executable, "-m", "msbvh", "accuracy", scene, "--out", "report", "--quick", "--axes", "none"]
    size = ["--resolution", f"{SIDE}", f"{SIDE}", "--spp", "2", "--threads", "1"]
    process = subprocess.Popen(
        [*command, *size], cwd=tmp_path, stderr=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )
    wait_for(lambda: len(list((tmp_path / "report" / "points").glob("*/figures.json"))) >= 2)
    process.send_signal(signal.SIGTERM)
    _, said = process.communicate(timeout=60)
    assert process.returncode == 143 and "Traceback" not in said
    assert not list((tmp_path / "report").glob("*.*"))
    done = subprocess.run([*command, *size], cwd=tmp_path, capture_output=True, text=True, timeout=120, check=False)
    assert done.returncode == 0, done.stderr
    assert data_of(tmp_path / "report")["taken_over"] >= 2
    assert (tmp_path / "report" / "report.html").stat().st_size > 10_000


def wait_for(condition: Callable[[], bool], seconds: float = 60.0) -> None:
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.02)


def test_a_run_without_figures_never_happened(tmp_path: Path) -> None:
    store = Store(tmp_path, "this scene")
    options = Options.of({"spp": 1})
    folder = store.folder(options, 1)
    folder.mkdir(parents=True)
    (folder / "figures.json").write_text('{"seconds": {}')
    assert store.figures(options, 1) is None
    assert store.folder(options, 2) != folder != Store(tmp_path, "another").folder(options, 1)


def test_settings_that_fail_are_told_and_the_rest_is_reported(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from msbvh.accuracy.measure import Measurement
    from msbvh.base.errors import SceneError

    shot = launch.Shot("s.usda", 1.0, (), 1)
    measurement = Measurement(shot, Store(tmp_path, "x"), [1, 2], lambda share: None, NoShapes())

    def run(shot: launch.Shot, options: Options, seed: int, folder: Path) -> Figures:
        raise SceneError("out of memory")

    monkeypatch.setattr("msbvh.accuracy.measure.run", run)
    measurement.expect([Options()], 1.0)
    measurement.measure([Options()])
    assert measurement.points[Options()].plain(Options(), shot)["failed"] == "out of memory"


# Built-in scenes, and what is refused


@pytest.mark.parametrize("name", SCENES)
def test_a_built_in_scene_is_the_same_file_every_time(name: str, tmp_path: Path) -> None:
    files = [tmp_path / "a.usdc", tmp_path / "b.usdc"]
    for file in files:
        SCENES[name].write(file, 0.1)
    assert files[0].read_bytes() == files[1].read_bytes()
    assert files[0].stat().st_size > 1000


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("--target-error", "-1px"), "found '-1px', expected more than 0, such as 0.25px"),
        (("--time-budget", "soon"), "found 'soon', expected more than 0, such as 40s"),
        (("--target-flip", "nan"), "found 'nan', expected more than 0.0001 and at most 1, such as 0.02"),
        (("--rounds", "1"), "1 is not in the range 2<=x<=100"),
        (("--frame", "1:3"), "accuracy looks at one frame"),
        (("--axes", "toleranc"), "--axes: found 'toleranc', expected any of: motion-tolerance, segments"),
        (("--target-flip", "1e-9"), "expected more than 0.0001 and at most 1, such as 0.02"),
    ],
)
def test_bad_values_are_refused_in_one_line(arguments: tuple[str, ...], says: str, msbvh: Run, tmp_path: Path) -> None:
    done = msbvh("accuracy", arc(tmp_path / "arc.usda"), "--out", "report", *arguments)
    assert done.returncode == 2
    assert says in done.stderr and done.stderr.count("\n") == 1


def test_a_scene_that_is_not_there_is_one_line(msbvh: Run) -> None:
    done = msbvh("accuracy", "nowhere.usda", "--out", "report")
    assert done.returncode == 1
    assert [line for line in done.stderr.splitlines() if "%" not in line] == [done.stderr.splitlines()[-1]]
    assert "nowhere.usda" in done.stderr.splitlines()[-1]


def test_a_folder_that_would_be_taken_for_frames_is_refused(msbvh: Run, tmp_path: Path) -> None:
    done = msbvh("accuracy", arc(tmp_path / "arc.usda"), "--out", "take#2")
    assert done.returncode == 2 and "expected a name without '#'" in done.stderr


def test_a_folder_that_cannot_be_made_is_one_line(msbvh: Run, tmp_path: Path) -> None:
    (tmp_path / "report").write_text("a file")
    done = msbvh("accuracy", arc(tmp_path / "arc.usda"), "--out", "report")
    assert done.returncode == 1 and done.stderr.count("\n") == 1 and "report" in done.stderr


def test_nothing_is_left_where_all_fails(msbvh: Run, tmp_path: Path) -> None:
    """The camera looks nowhere: the run ends before a file has its final name."""
    done = msbvh("accuracy", arc(tmp_path / "arc.usda"), "--out", "report", "--camera", "/nobody")
    assert done.returncode == 1
    assert [name for name in os.listdir(tmp_path / "report") if "." in name] == []
