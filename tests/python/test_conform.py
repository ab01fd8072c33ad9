"""msbvh conform: the table, with renderers that are right, that do not blur, and that fail in every way."""

from __future__ import annotations

import json
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from conftest import ROOT, Run
from msbvh.conform.suite import allowed_errors, errors
from msbvh.output.images import read_alpha

SUITE = ROOT / "testenv" / "motion"
RULES = "rotate_op,shutter_zero,velocity_at_48,frame_fractional,frame_in_sequence,large_world"
"""Of every kind: one without blur, one at a fraction of a frame, one of three frames."""
MOVING = set(RULES.split(",")) - {"shutter_zero"}

FAKE = """
import sys, time
from pathlib import Path
import numpy as np
import OpenImageIO as oiio

sys.path.insert(0, {tests!r})

def write(out, alpha, channels=("R", "G", "B", "A")):
    pixels = np.repeat(np.asarray(alpha, np.float32)[..., None], len(channels), axis=-1)
    output = oiio.ImageOutput.create(out)
    spec = oiio.ImageSpec(pixels.shape[1], pixels.shape[0], len(channels), oiio.FLOAT)
    spec.channelnames = channels
    assert output.open(out, spec) and output.write_image(np.ascontiguousarray(pixels)) and output.close()

def expected(scene):
    path = scene.replace(".usda", ".expected.png")
    return oiio.ImageInput.open(path).read_image(oiio.FLOAT)[..., 0]

def still(scene, frame, camera, width):
    from projection_oracle import Sampling, coverage
    from pxr import Usd, UsdGeom
    stage = Usd.Stage.Open(scene)
    UsdGeom.Camera.Get(stage, camera).GetShutterCloseAttr().Set(-9.0)
    return coverage(stage, frame, camera, (width, width // 2), Sampling(16, 4))

frames, width, camera, scene, out = sys.argv[2], int(sys.argv[4]), sys.argv[6], *sys.argv[7:9]
frame = float(frames.split(",")[-1])
image = out.replace("####.###", f"{{frame:08.3f}}").replace("####", f"{{frame:04.0f}}")
{body}
"""


def fake(folder: Path, body: str) -> str:
    """A command line that runs `body` with scene, image, frame, camera and width at hand."""
    script = folder / "fake renderer.py"
    script.write_text(FAKE.format(tests=str(ROOT / "tests" / "python"), body=body), encoding="utf-8")
    return f"'{sys.executable}' '{script}'"


def outcomes(msbvh: Run, command: str, rules: str = RULES, *more: object) -> tuple[int, dict[str, dict]]:
    done = msbvh("conform", "--json", "--rules", rules, "--command", command, *more)
    found = json.loads(done.stdout)
    assert found["renderer"] == command
    return done.returncode, {entry["rule"]: entry for entry in found["rules"]}


def test_the_expected_answers_pass(msbvh: Run, tmp_path: Path) -> None:
    code, found = outcomes(msbvh, fake(tmp_path, "write(image, expected(scene))"))
    assert code == 0
    assert set(found) == set(RULES.split(","))
    for entry in found.values():
        assert entry["passed"] and entry["error"] < 1e-6 and entry["reason"] == ""
        assert 0.0 < entry["allowed"] < 0.05


def test_a_still_frame_fails_what_moves(msbvh: Run, tmp_path: Path) -> None:
    code, found = outcomes(msbvh, fake(tmp_path, "write(image, still(scene, frame, camera, width))"))
    assert code == 1
    assert {name for name, entry in found.items() if not entry["passed"]} == MOVING
    assert all(found[name]["reason"].startswith("mean alpha error") for name in MOVING)


@pytest.mark.parametrize(
    ("body", "reason"),
    [
        ("print('no such camera', file=sys.stderr); sys.exit(7)", "exit code 7: no such camera"),
        ("import os; os.kill(os.getpid(), 11)", "killed by signal 11: it said nothing"),
        ("raise ValueError('oh')", "exit code 1: ValueError: oh"),
        ("pass", "wrote no image.0010.exr"),
        ("write(image, expected(scene), ('R', 'G', 'B'))", "has no alpha channel: found R, G, B"),
        ("write(image, expected(scene)[:, :-1])", "image is 95x48 pixels, expected 96x48"),
        ("write(image, expected(scene) * np.nan)", "alpha is not finite everywhere"),
        ("Path(image).write_text('no image')", "cannot read"),
        ("time.sleep(30)", "ran for more than 3 s"),
    ],
)
def test_what_a_renderer_does_wrong_is_a_row(msbvh: Run, tmp_path: Path, body: str, reason: str) -> None:
    code, found = outcomes(msbvh, fake(tmp_path, body), "rotate_op", "--timeout", 3)
    assert code == 1
    entry = found["rotate_op"]
    assert not entry["passed"] and entry["error"] is None
    assert reason in entry["reason"]


def test_a_wrapper_that_hangs_takes_its_renderer_along(msbvh: Run, tmp_path: Path) -> None:
    late = tmp_path / "late"
    child = f"import time, pathlib; time.sleep(3); pathlib.Path({str(late)!r}).touch()"
    body = f"import subprocess; subprocess.run([sys.executable, '-c', {child!r}])"
    _, found = outcomes(msbvh, fake(tmp_path, body), "rotate_op", "--timeout", 1)
    assert found["rotate_op"]["reason"] == "ran for more than 1 s"
    time.sleep(3)
    assert not late.exists()


def test_a_command_that_does_not_exist_is_a_row(msbvh: Run) -> None:
    _, found = outcomes(msbvh, "no-such-renderer", "rotate_op,matrix_op")
    assert len(found) == 2
    assert all("cannot be run: no-such-renderer" in entry["reason"] for entry in found.values())


def test_placeholders_replace_the_usual_options(msbvh: Run, tmp_path: Path) -> None:
    command = fake(tmp_path, "write(image, expected(scene))") + " -f {frames} -w {width} -c {camera} {scene} {out}"
    code, found = outcomes(msbvh, command, "frame_in_sequence")
    assert code == 0 and found["frame_in_sequence"]["passed"]


def test_our_own_renderer_and_the_table(msbvh: Run, tmp_path: Path) -> None:
    done = msbvh("conform", "--rules", "rotate_op,shutter_*", "--out", tmp_path / "kept")
    assert done.returncode == 0, done.stdout
    lines = done.stdout.splitlines()
    assert lines[0].split() == ["rule", "result", "error", "allowed", "statement"]
    assert lines[-1] == f"{len(lines) - 2} of {len(lines) - 2} rules pass"
    column = lines[0].index("statement")
    assert all(line[column - 1] == " " and line[column] != " " for line in lines[1:-1])
    assert (tmp_path / "kept" / "rotate_op" / "image.0010.exr").is_file()
    assert "msbvh: conform: 100 %" in done.stderr


def test_a_failing_rule_says_what_was_found_and_allowed(msbvh: Run, tmp_path: Path) -> None:
    command = fake(tmp_path, "write(image, expected(scene) * 0.5)")
    done = msbvh("conform", "--rules", "rotate_op", "--command", command)
    assert done.returncode == 1
    assert "FAIL" in done.stdout and "0 of 1 rules pass" in done.stdout
    assert "mean alpha error" in done.stdout


def test_without_a_suite_there_is_one_line(msbvh: Run, tmp_path: Path) -> None:
    done = msbvh("conform", "--suite", tmp_path)
    assert done.returncode == 1 and done.stdout == ""
    assert done.stderr.count("\n") == 1
    assert "expected a folder with rules.json, give --suite DIR" in done.stderr


def test_no_matching_rule_and_a_broken_manifest(msbvh: Run, tmp_path: Path) -> None:
    assert "none of the" in msbvh("conform", "--rules", "nothing*").stderr
    (tmp_path / "rules.json").write_text('{"rules": [{"rule": "a"}]}')
    done = msbvh("conform", "--suite", tmp_path)
    assert done.returncode == 1
    assert "rules.json: found KeyError: 'topic'" in done.stderr


def test_errors_are_over_what_either_image_covers() -> None:
    expected = np.zeros((10, 10))
    expected[0, :2] = 0.5
    found = np.zeros((10, 10))
    found[0, 1:3] = 0.25
    mean, worst = errors(found, expected)
    assert mean == pytest.approx((0.5 + 0.25 + 0.25) / 3)
    assert worst == 0.5
    assert errors(np.zeros((2, 2)), np.zeros((2, 2))) == (0.0, 0.0)


def test_the_allowed_error_is_that_of_independent_samples() -> None:
    expected = np.linspace(0.05, 0.95, 100).reshape(10, 10)
    rng = np.random.default_rng(0)
    for spp in (16, 256):
        sampled = rng.binomial(spp, expected) / spp
        mean, worst = errors(sampled, expected)
        allowed, worst_allowed = allowed_errors(expected, spp)
        assert 0.5 * allowed < mean <= allowed
        assert worst <= worst_allowed


def test_another_shutter_has_answers_of_its_own(msbvh: Run, tmp_path: Path) -> None:
    done = msbvh("conform", "--json", "--rules", "shutter_zero", "--shutter", "-0.1:0.3", "--out", tmp_path / "out")
    found = {entry["rule"]: entry for entry in json.loads(done.stdout)["rules"]}
    assert set(found) == {"shutter_zero"} and done.returncode == 0, found
    # What a closed shutter shows is sharp; it moves now.
    answer = read_alpha(tmp_path / "out" / "shutter_zero" / "expected.png")
    assert np.abs(answer - read_alpha(SUITE / "scenes" / "shutter_zero.expected.png")).max() > 0.2


def test_another_renderer_gets_scenes_with_that_shutter(msbvh: Run, tmp_path: Path) -> None:
    body = """
from pxr import Usd
from projection_oracle import Sampling, coverage, shutter_of
stage = Usd.Stage.Open(scene)
assert shutter_of(stage, frame, camera) == (-0.25, 0.125), shutter_of(stage, frame, camera)
write(image, coverage(stage, frame, camera, (width, width // 2), Sampling(128, 4)))
"""
    command = fake(tmp_path, body)
    code, found = outcomes(msbvh, command, "shutter_animated", "--shutter", "-0.25:0.125")
    assert code == 0, found


def test_a_suite_that_cannot_make_answers_says_so(msbvh: Run, tmp_path: Path) -> None:
    (tmp_path / "rules.json").write_text((SUITE / "rules.json").read_text())
    done = msbvh("conform", "--suite", tmp_path, "--rules", "rotate_op", "--shutter", "0:1")
    assert done.returncode == 1
    assert "found no make_expected.py" in done.stderr and "--shutter" in done.stderr
