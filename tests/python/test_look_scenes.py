"""Scenes of one look each, beside Cycles: what they hold, and that a diffuse and a metal ball are Cycles' own."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest
from conftest import ROOT
from msbvh.bench.cycles_peer import find_cycles, installed
from msbvh.bench.frame_sides import Job, rendered, this_build
from msbvh.bench.look_scenes import LOOK_SCENES, write_images
from pxr import Usd, UsdGeom, UsdShade
from test_bench_frames import cycles_folder

sys.path.insert(0, str(ROOT / "docs"))
from make_look_sheets import Difference, _sheet, _subject


@pytest.mark.parametrize("name", LOOK_SCENES)
def test_a_scene_has_its_look(name: str, tmp_path: Path) -> None:
    write_images(tmp_path)
    scene, file = LOOK_SCENES[name], tmp_path / "scene.usda"
    scene.write(file)
    stage = Usd.Stage.Open(str(file))
    subject = stage.GetPrimAtPath("/subject")
    material, _ = UsdShade.MaterialBindingAPI(subject).ComputeBoundMaterial()
    assert bool(material) == (scene.looks["subject"] is not None)
    assert bool(UsdGeom.Mesh(subject).GetNormalsAttr().HasAuthoredValue()) == ("subject" in scene.smooth)
    for prim in stage.Traverse():
        for attribute in prim.GetAttributes():
            if str(attribute.GetTypeName()) == "asset" and attribute.Get():
                assert attribute.Get().resolvedPath, attribute.GetPath()


def test_differences_are_ours_over_theirs() -> None:
    where = _subject(40, 60)
    assert 0.2 < where.mean() < 0.6 and where[20, 30] and not where[0].any()
    theirs = np.full((40, 60, 3), 0.5)
    ours = theirs * (1.0, 0.97, 1.02)
    found = Difference.of(ours, theirs, where)
    assert found.mean == pytest.approx(-0.03) and found.absolute == pytest.approx(0.05 / 3)
    sheet = _sheet("a look", 1.2 * theirs, theirs)
    assert sheet.shape[1] == 180 and sheet[40, 150, 0] > 0.85 and sheet[40, 150, 2] < 0.1


@pytest.mark.skipif(not installed(cycles_folder()), reason="no environment with bpy")
@pytest.mark.slow
@pytest.mark.parametrize("name", ["diffuse", "metal"])
def test_a_ball_is_as_bright_as_cycles_has_it(name: str, tmp_path: Path) -> None:
    write_images(tmp_path)
    scene, file = LOOK_SCENES[name], tmp_path / "scene.usda"
    scene.write(file)
    job = Job(scene, file, 96, 64, 4, 128, 1, 1)
    ours, theirs = (
        rendered(side, job, tmp_path / side.name).pixels for side in (this_build(), find_cycles(cycles_folder(), print))
    )
    assert abs(Difference.of(ours, theirs, _subject(64, 96)).mean) < 0.02
