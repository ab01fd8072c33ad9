"""The command line from outside: exit codes, one clear line for whatever is wrong, no partial files."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import pytest
from conftest import MOVING_SQUARE, Fails, Run

SMALL = ("-w", 48, "--spp", 4)


def size_of(path: Path) -> tuple[int, int]:
    spec = oiio.ImageInput.open(str(path)).spec()
    return spec.width, spec.height


def pixels_of(path: Path) -> np.ndarray:
    return oiio.ImageInput.open(str(path)).read_image(oiio.FLOAT)


def test_records_a_moving_square(msbvh: Run, tmp_path: Path, scene: Path) -> None:
    done = msbvh("record", scene, "a.exr", "a.png", *SMALL)
    assert done.returncode == 0, done.stderr
    assert sorted(os.listdir(tmp_path)) == ["a.exr", "a.png", "scene.usda"]
    assert size_of(tmp_path / "a.exr") == size_of(tmp_path / "a.png") == (48, 32)
    alpha = pixels_of(tmp_path / "a.exr")[..., 3]
    assert alpha.max() > 0.99
    # The edges sweep half a unit, eleven pixels' worth here: the blur is partial coverage.
    assert np.count_nonzero((alpha > 0.05) & (alpha < 0.95)) > 50


def test_log_has_percentages_instead_of_a_bar(msbvh: Run, scene: Path) -> None:
    lines = msbvh("record", scene, "a.exr", *SMALL).stderr.splitlines()
    shown = [int(line.split()[-2]) for line in lines if line.endswith(" %")]
    assert shown == sorted(set(shown)), "each percentage once, rising"
    assert shown[-1] == 100


def test_frames_go_to_their_files(msbvh: Run, tmp_path: Path, scene: Path) -> None:
    done = msbvh("record", scene, "o.##.#.exr", "--frames", "1:2x0.5,3", *SMALL)
    assert done.returncode == 0, done.stderr
    names = {"o.01.0.exr", "o.01.5.exr", "o.02.0.exr", "o.03.0.exr", "scene.usda"}
    assert set(os.listdir(tmp_path)) == names


def test_a_frame_of_a_sequence_equals_the_frame_alone(msbvh: Run, tmp_path: Path, scene: Path) -> None:
    assert msbvh("record", scene, "all.#.exr", "-f", "1:3", *SMALL).returncode == 0
    assert msbvh("record", scene, "alone.exr", "-f", "2", *SMALL).returncode == 0
    assert np.array_equal(pixels_of(tmp_path / "all.2.exr"), pixels_of(tmp_path / "alone.exr"))
    assert not np.array_equal(pixels_of(tmp_path / "all.1.exr"), pixels_of(tmp_path / "alone.exr"))


def test_start_time_is_the_default(msbvh: Run, tmp_path: Path, scene: Path) -> None:
    assert msbvh("record", scene, "start.exr", *SMALL).returncode == 0
    assert msbvh("record", scene, "one.exr", "-f", "1", *SMALL).returncode == 0
    assert np.array_equal(pixels_of(tmp_path / "start.exr"), pixels_of(tmp_path / "one.exr"))


def test_default_time_does_not_move(msbvh: Run, tmp_path: Path, scene: Path) -> None:
    """The square's transform has no default: it stands at the origin, in the middle of the picture."""
    assert msbvh("record", scene, "a.exr", "-d", "--resolution", 48, 32, "--spp", 16).returncode == 0
    alpha = pixels_of(tmp_path / "a.exr")[..., 3]
    assert np.allclose(alpha, alpha[:, ::-1], atol=0.3)
    assert alpha[16, 24] == 1.0


@pytest.mark.parametrize("threads", [1, 2])
def test_threads_and_builder_do_not_change_the_picture(msbvh: Run, tmp_path: Path, scene: Path, threads: int) -> None:
    for name, builder in (("a", "msbvh"), ("b", "mbvh"), ("c", "swept"), ("d", "timesplit")):
        done = msbvh("record", scene, f"{name}.exr", "--threads", threads, "--builder", builder, "--seed", 5, *SMALL)
        assert done.returncode == 0, done.stderr
    for name in "bcd":
        assert np.array_equal(pixels_of(tmp_path / "a.exr"), pixels_of(tmp_path / f"{name}.exr"))


def test_domes_light_but_are_seen_only_on_demand(msbvh: Run, tmp_path: Path, scene: Path) -> None:
    dome = '    def DomeLight "sky"\n    {\n        float inputs:intensity = 0.5\n    }\n}\n'
    scene.write_text(MOVING_SQUARE.rstrip()[:-1] + dome)
    assert msbvh("record", scene, "a.exr", *SMALL).returncode == 0
    assert msbvh("record", scene, "b.exr", "--enableDomeLightVisibility", *SMALL).returncode == 0
    without, shown = pixels_of(tmp_path / "a.exr"), pixels_of(tmp_path / "b.exr")
    assert np.array_equal(without[..., 3], shown[..., 3])
    assert np.array_equal(without[0, 0], [0, 0, 0, 0])
    assert np.array_equal(shown[0, 0], [0.5, 0.5, 0.5, 0])


def test_resolution_overrides_the_width(msbvh: Run, tmp_path: Path, scene: Path) -> None:
    done = msbvh("record", scene, "a.exr", "-w", 7, "--resolution", 40, 20, "--spp", 1)
    assert done.returncode == 0, done.stderr
    assert size_of(tmp_path / "a.exr") == (40, 20)


def test_stats(msbvh: Run, tmp_path: Path, scene: Path) -> None:
    done = msbvh("record", scene, "a.#.exr", "-f", "1:2", "--stats", "s.json", *SMALL)
    assert done.returncode == 0, done.stderr
    stats = json.loads((tmp_path / "s.json").read_text())
    assert stats["peak_memory_bytes"] > 1_000_000
    assert [frame["output"] for frame in stats["frames"]] == [["a.1.exr"], ["a.2.exr"]]
    first = stats["frames"][0]
    assert set(first["seconds"]) == {"read", "sample", "build", "trace", "write"}
    assert all(seconds > 0.0 for seconds in first["seconds"].values())
    assert first["scene"]["triangles"] == 2
    assert first["render"]["camera_rays"] == 48 * 32 * 4
    assert first["render"]["rays"] >= first["render"]["camera_rays"]
    ways = ("rays_in_packets", "rays_interleaved", "rays_single")
    assert sum(first["render"][way] for way in ways) == first["render"]["rays"]
    assert first["render"]["accel"]["references"] >= 2
    assert {track["path"] for track in first["tracks"]} == {"/world/main_cam", "/world/square"}
    assert any("/world/square" in entry["prim"] for entry in first["plan"])
    square = first["tracks"][1]
    assert {
        name: square[name] for name in ("source", "segments", "degree", "time_remap", "hidden_partly", "count")
    } == {
        "source": "transform",
        "segments": 1,
        "degree": 1,
        "time_remap": False,
        "hidden_partly": False,
        "count": 1,
    }
    assert square["rule"] and square["bytes"] == 2 * 12 * 4  # Two keys of an affine map in floats.


@pytest.mark.parametrize(
    ("interpolation", "segments", "degree"), [("linear", 4, 1), ("quadratic", 2, 2), ("cubic", 1, 3)]
)
def test_interpolation_and_segments_are_as_asked_for(
    msbvh: Run, tmp_path: Path, scene: Path, interpolation: str, segments: int, degree: int
) -> None:
    chosen = ("--interpolation", interpolation, "--segments", segments)
    done = msbvh("record", scene, "a.exr", "--stats", "s.json", *chosen, *SMALL)
    assert done.returncode == 0, done.stderr
    stats = json.loads((tmp_path / "s.json").read_text())
    square = stats["frames"][0]["tracks"][1]
    assert (square["segments"], square["degree"]) == (segments, degree)
    assert stats["settings"]["read"]["interpolation"] == interpolation


def test_plan(msbvh: Run, scene: Path) -> None:
    plain = msbvh("plan", scene)
    assert plain.returncode == 0, plain.stderr
    assert "/world/square" in plain.stdout
    found = json.loads(msbvh("plan", scene, "--json").stdout)
    assert any(entry["prim"] == "/world/square" for entry in found["plan"])
    off = {row["effect"] for row in found["effects"] if not row["on"]}
    assert off.isdisjoint(entry["effect"] for entry in found["plan"])
    assert all(effect in next(line for line in plain.stdout.splitlines() if line.startswith("off ")) for effect in off)
    shares = sum(row["geometry_share"] for row in found["effects"])
    assert shares + found["base_bytes"] / found["geometry_bytes"] == pytest.approx(1.0)


def test_plan_of_a_still_frame_has_no_motion(msbvh: Run, scene: Path) -> None:
    plan = json.loads(msbvh("plan", scene, "--json", "--defaultTime").stdout)["plan"]
    assert not [entry for entry in plan if "moving" in entry["effect"] or "deforming" in entry["effect"]]


def test_version(msbvh: Run) -> None:
    done = msbvh("--version")
    assert (done.returncode, done.stdout.split()[0]) == (0, "msbvh")


def test_strict_is_about_what_was_degraded(msbvh: Run, tmp_path: Path, scene: Path) -> None:
    assert msbvh("record", scene, "a.exr", "--strict", *SMALL).returncode == 0
    scene.write_text(MOVING_SQUARE.replace('subdivisionScheme = "none"', 'subdivisionScheme = "doo"'))
    assert msbvh("record", scene, "b.exr", *SMALL).returncode == 0
    done = msbvh("record", scene, "c.exr", "--strict", *SMALL)
    assert done.returncode == 3
    assert done.stderr.count("msbvh: warning: /world/square") == 1
    assert (tmp_path / "c.exr").exists()


def test_a_warning_is_said_once_for_all_frames(msbvh: Run, scene: Path) -> None:
    scene.write_text(MOVING_SQUARE.replace('subdivisionScheme = "none"', 'subdivisionScheme = "doo"'))
    done = msbvh("record", scene, "c.#.exr", "-f", "1:3", *SMALL)
    assert done.stderr.count("msbvh: warning: ") == 1


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("record",), "Missing argument"),
        (("record", "scene.usda"), "Missing argument"),
        (("nonsense",), "No such command 'nonsense'"),
        (("record", "scene.usda", "a.exr", "--nonsense"), "--nonsense"),
        (("record", "scene.usda", "a.###.exr", "-f", "1:"), "invalid FrameSpec '1:'"),
        (("record", "scene.usda", "a.###.exr", "-f", "10:1x2"), "invalid FrameSpec '10:1x2'"),
        (("record", "scene.usda", "a.exr", "-f", "1:2"), "exactly one frame placeholder"),
        (("record", "scene.usda", "a.###.exr", "-f", "1:2x0.5"), "need 1 digits"),
        (("record", "scene.usda", "a.###.exr"), "no --frames to fill it"),
        (("record", "scene.usda", "a.#.exr", "-f", "1", "-d"), "exclude each other"),
        (("record", "scene.usda", "a.exr", "a.exr"), "named twice"),
        (("record", "scene.usda", "a.exr", "--spp", "0"), "--spp"),
        (("record", "scene.usda", "a.exr", "-w", "0"), "--imageWidth"),
        (("record", "scene.usda", "a.exr", "--resolution", "10", "x"), "--resolution"),
        (("record", "scene.usda", "a.exr", "--conform", "squash"), "'squash' is not one of"),
        (("record", "scene.usda", "a.exr", "--purposes", "proxy,nonsense"), "found 'nonsense'"),
        (("record", "scene.usda", "a.exr", "--builder", "bvh"), "'bvh' is not one of"),
        (("record", "scene.usda", "a.exr", "-c", "max"), "'max' is not one of"),
        (("record", "scene.usda", "a.exr", "-color", "linear"), "'linear' is not one of"),
        (("record", "scene.usda", "a.exr", "--ocio-view", "Raw"), "need --colorCorrectionMode openColorIO"),
        (
            ("record", "scene.usda", "a.exr", "-color", "openColorIO", "--ocio-display", "CRT"),
            "display 'CRT'",
        ),
        (("record", "scene.usda", "a.exr", "--motion-tolerance", "0"), "--motion-tolerance"),
        (("record", "scene.usda", "a.exr", "--motion-tolerance", "nan"), "expected a finite number"),
        (("record", "scene.usda", "a.exr", "--interpolation", "spline"), "'spline' is not one of"),
        (("record", "scene.usda", "a.exr", "--segments", "0"), "found '0', expected a power of two"),
        (("record", "scene.usda", "a.exr", "--segments", "256"), "found '256', expected a power of two"),
        (("plan", "scene.usda", "--segments", "3"), "found '3', expected a power of two"),
        (("plan", "scene.usda", "--segments", "two"), "found 'two', expected a power of two"),
        (("record", "scene.usda", "a.exr", "-r", "Storm"), "only msbvh renders here"),
        (("record", "scene.usda", "a.exr", "-rp", "/Render"), "--renderPassPrimPath is not supported"),
        (("record", "scene.usda", "a.exr", "--sessionLayer", "b.usda"), "--sessionLayer is not supported"),
        (("plan", "scene.usda", "-f", "1:2"), "plan looks at one frame"),
    ],
)
def test_usage_errors(fails: Fails, scene: Path, arguments: tuple[str, ...], message: str) -> None:
    fails(arguments, 2, message)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("missing.usda", "a.exr"), "missing.usda: no such file"),
        (("broken.usda", "a.exr"), "broken.usda: cannot be read"),
        (("empty.usda", "a.exr"), "the stage is empty"),
        (("text.txt", "a.exr"), "text.txt: cannot be read"),
        (("scene.usda", "a.exr", "-cam", "other"), "found no camera 'other'"),
        (("scene.usda", "a.exr", "--mask", "not/absolute"), "mask"),
        (("scene.usda", "nowhere/a.exr"), "there is no folder 'nowhere'"),
        (("scene.usda", "a.bmp"), "extension '.bmp'"),
        (("scene.usda", "a"), "no extension"),
        (("scene.usda", "folder.exr"), "not a regular file"),
        (("scene.usda", "a.exr", "b.xyz"), "extension '.xyz'"),
        (("scene.usda", "a.exr", "--stats", "nowhere/s.json"), "there is no folder 'nowhere'"),
    ],
)
def test_what_is_wrong_with_the_scene_or_the_settings(
    fails: Fails, tmp_path: Path, scene: Path, arguments: tuple[str, ...], message: str
) -> None:
    (tmp_path / "broken.usda").write_text("#usda 1.0\ndef Mesh {\n")
    (tmp_path / "empty.usda").write_text("#usda 1.0\n")
    (tmp_path / "text.txt").write_text("not a scene")
    (tmp_path / "folder.exr").mkdir()
    fails(("record", *arguments, *SMALL), 1, message)


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write everywhere")
def test_a_folder_without_permission(fails: Fails, tmp_path: Path, scene: Path) -> None:
    (tmp_path / "locked").mkdir(mode=0o500)
    fails(("record", scene, "locked/a.exr", *SMALL), 1, "no permission to write")


def test_the_process_ends_with_the_code(msbvh: Run) -> None:
    done = msbvh("record", "missing.usda", "a.exr")
    assert done.returncode == 1
    assert done.stderr.startswith("msbvh: error: missing.usda: no such file")


def test_no_camera_is_said(msbvh: Run, tmp_path: Path, scene: Path) -> None:
    scene.write_text(MOVING_SQUARE.replace('def Camera "main_cam"', 'def Xform "main_cam"'))
    done = msbvh("record", scene, "a.exr", *SMALL)
    assert done.returncode == 0, done.stderr
    assert "no camera on the stage" in done.stderr
    assert pixels_of(tmp_path / "a.exr")[..., 3].max() == 1.0


@pytest.mark.parametrize(("shutter", "said"), [("-0.25", "equals"), ("-1", "before shutter:open"), ("nan", "finite")])
def test_a_shutter_that_makes_no_sense_is_said(
    msbvh: Run, tmp_path: Path, scene: Path, shutter: str, said: str
) -> None:
    scene.write_text(MOVING_SQUARE.replace("shutter:close = 0.25", f"shutter:close = {shutter}"))
    done = msbvh("record", scene, "a.exr", *SMALL)
    assert done.returncode == 0, done.stderr
    assert said in done.stderr


@pytest.mark.parametrize(
    ("found", "planted"),
    [
        ("[0, 1, 2, 3]", "[0, 1, 2, 9]"),
        ("[0, 1, 2, 3]", "[0, 1, 2]"),
        ("faceVertexCounts = [4]", "faceVertexCounts = [-4]"),
        ("(0.5, 0.5, 0)", "(nan, 0.5, 0)"),
        ("(0.5, 0.5, 0)", "(inf, 0.5, 0)"),
        ("(-2, 0, 0)", "(inf, 0, 0)"),
    ],
)
def test_a_bad_mesh_is_named_and_the_rest_is_rendered(
    msbvh: Run, tmp_path: Path, scene: Path, found: str, planted: str
) -> None:
    still = MOVING_SQUARE[MOVING_SQUARE.index("    def Mesh") :].replace('"square"', '"still"')
    still = still.replace("translate.timeSamples = { 0: (-2, 0, 0), 4: (2, 0, 0) }", "translate = (0, 0, -1)")
    good = MOVING_SQUARE.rstrip()[:-1] + still
    scene.write_text(good.replace(found, planted, 1))
    done = msbvh("record", scene, "a.exr", *SMALL, "--strict")
    assert done.returncode == 3, done.stderr
    assert "msbvh: error: /world/square" in done.stderr
    assert pixels_of(tmp_path / "a.exr")[..., 3].max() == 1.0


def test_interrupt_leaves_nothing_behind(tmp_path: Path, scene: Path) -> None:
    command = [sys.executable, "-m", "msbvh", "record", str(scene), "a.exr", "--spp", "1000000"]
    with subprocess.Popen(command, cwd=tmp_path, stderr=subprocess.PIPE, text=True) as process:
        assert process.stderr is not None
        line = ""
        while not line.endswith(" %\n"):  # The first sign that pixels are being traced.
            line = process.stderr.readline()
            assert line, "ended before it was interrupted"
        start = time.monotonic()
        process.send_signal(signal.SIGINT)
        rest = process.stderr.read()
        assert process.wait(timeout=60) == 130
        assert time.monotonic() - start < 30.0
    assert "msbvh: error: interrupted" in rest
    assert "Traceback" not in rest
    assert os.listdir(tmp_path) == ["scene.usda"]
