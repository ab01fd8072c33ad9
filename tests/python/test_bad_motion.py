"""Bad input by the command line: one clear line names the fault, the rest of the scene is in the picture, and the
exit code says so."""

from __future__ import annotations

from pathlib import Path

import bad_scenes
import bad_skins  # noqa: F401
import numpy as np
import pytest
from bad_scenes import FAULTS, Fault, scene_with
from bad_unseen import CAMERA_FAULTS, UNSEEN, UNSEEN_SHUTTER
from conftest import Run
from exr import read_exr
from msbvh.cli.main import main
from pxr import UsdGeom

DRAWN = 20.0
"""Pixels that a sound square covers at least, of 48 x 24; it is about 62 of them."""


def record(path: Path, *more: str) -> tuple[int, Path]:
    """The exit code of a small rendering, within this process."""
    out = path.with_suffix(".exr")
    options = [
        "-f",
        "10",
        "-w",
        "48",
        "--spp",
        "4",
        "--max-bounces",
        "0",
        "--threads",
        "1",
        "--camera",
        "Camera",
    ]
    return main(["record", str(path), str(out), *options, *more]), out


def warnings_of(text: str) -> list[str]:
    return [line for line in text.splitlines() if "warning" in line or "error" in line]


def coverage_right(out: Path) -> float:
    alpha = read_exr(out)[..., 3]
    assert np.isfinite(alpha).all()
    return float(alpha[:, 24:].sum())


@pytest.mark.parametrize("fault", FAULTS, ids=str)
def test_a_fault_is_one_line_and_the_rest_is_drawn(fault: Fault, tmp_path: Path, capfd):
    path = tmp_path / "scene.usda"
    scene_with(fault.fill).Export(str(path))
    code, out = record(path, "--strict")
    (line,) = warnings_of(capfd.readouterr().err)
    assert f" {fault.subject}: " in line
    for words in fault.words:
        assert words in line
    assert code == 3 and coverage_right(out) > DRAWN
    assert sorted(p.name for p in tmp_path.iterdir()) == ["scene.exr", "scene.usda"]


@pytest.mark.parametrize("fill", UNSEEN, ids=lambda fill: fill.__name__)
def test_what_the_shutter_does_not_see_does_not_matter(fill, tmp_path: Path, capfd):
    path = tmp_path / "scene.usda"
    scene_with(fill, UNSEEN_SHUTTER).Export(str(path))
    code, out = record(path, "--strict")
    assert code == 0 and warnings_of(capfd.readouterr().err) == []
    pixels = read_exr(out)
    assert np.isfinite(pixels).all()
    assert coverage_right(out) > DRAWN and pixels[:, :24, 3].sum() > DRAWN


@pytest.mark.parametrize("name", CAMERA_FAULTS)
def test_a_camera_that_sees_nothing_ends_the_run(name: str, tmp_path: Path, capfd):
    spoil, line = CAMERA_FAULTS[name]
    path = tmp_path / "scene.usda"
    scene_with(lambda shot: spoil(shot.camera)).Export(str(path))
    code, _ = record(path)
    (error,) = capfd.readouterr().err.splitlines()
    assert code == 1 and f" {line}" in error and ", expected " in error
    assert [p.name for p in tmp_path.iterdir()] == ["scene.usda"]


@pytest.mark.parametrize("name", ["one_sample_of_points-nan", "scales_of_another_length", "joint_indices_out_of_range"])
def test_a_process_of_its_own_exits_with_0_and_with_3_where_it_is_strict(name: str, tmp_path: Path, msbvh: Run):
    """What takes usd-core down, or leaves it to print a traceback at its end, only a process shows."""
    (fault,) = [fault for fault in FAULTS if fault.name == name]
    scene_with(fault.fill).Export(str(tmp_path / "scene.usda"))
    options = ("-f", 10, "-w", 48, "--spp", 4, "--max-bounces", 0)
    for strict, code in ((), 0), (("--strict",), 3):
        done = msbvh("record", "scene.usda", "out.exr", *options, *strict)
        assert done.returncode == code and "Traceback" not in done.stderr
        assert len(warnings_of(done.stderr)) == 1
        assert coverage_right(tmp_path / "out.exr") > DRAWN


def test_a_fault_above_many_meshes_is_said_once(tmp_path: Path, capfd):
    def fill(shot):
        group = UsdGeom.Xform.Define(shot.stage, "/World/Group")
        group.AddTranslateOp().Set((bad_scenes.NAN, 0, 0))
        for index in range(5):
            bad_scenes.square(shot, f"/World/Group/Mesh{index}")

    path = tmp_path / "scene.usda"
    scene_with(fill).Export(str(path))
    assert record(path)[0] == 0
    (line,) = warnings_of(capfd.readouterr().err)
    assert "/World/Group.xformOp:translate: found (nan, 0, 0), expected finite numbers" in line
