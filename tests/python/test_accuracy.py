"""msbvh accuracy: what its figures mean, that it goes on where it was, what it refuses."""

from __future__ import annotations

import csv
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

import numpy as np
import pytest
from conftest import Run
from msbvh.accuracy import launch
from msbvh.accuracy.options import Options
from msbvh.accuracy.scenes import SCENES
from msbvh.accuracy.store import Figures, Store, fingerprint
from pxr import Gf, Sdf, Usd, UsdGeom, UsdLux

SIDE = 16


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
    assert square["finer"]["error_px"] < square["error_px"]


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


class NoShapes:
    """Of a frame where nothing is cut."""

    def largest(self, options: Options) -> None:
        return None


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
        (
            ("--axes", "toleranc"),
            "--axes: found 'toleranc', expected any of: motion-tolerance, outside-tolerance, segments",
        ),
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
