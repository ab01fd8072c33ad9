"""`--layout compact`: the same picture from trees in fewer bytes."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import ROOT, Run
from exr import read_exr
from msbvh import _core
from msbvh.base.errors import Diagnostics
from msbvh.scene.reader import ReadSettings, read_frame
from msbvh.stage.opening import open_stage

SHOWCASE = ROOT / "testenv" / "showcase" / "showcase.usda"


def recorded(msbvh: Run, folder: Path, layout: str) -> tuple[np.ndarray, dict[str, Any]]:
    """Pixels and figures of the showcase: a still floor, moving instances and deforming points."""
    done = msbvh(
        "record", SHOWCASE, f"{layout}.exr", "-f", "6", "--layout", layout, "--stats", f"{layout}.json",
        "-w", 96, "--spp", 4, "--seed", 3,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    return read_exr(folder / f"{layout}.exr"), json.loads((folder / f"{layout}.json").read_text())


def test_the_picture_is_the_same_and_trees_are_smaller(msbvh: Run, tmp_path: Path) -> None:
    full, figures = recorded(msbvh, tmp_path, "full")
    compact, compact_figures = recorded(msbvh, tmp_path, "compact")
    assert np.array_equal(full, compact)
    assert figures["settings"]["render"]["layout"] == "full"
    assert compact_figures["settings"]["render"]["layout"] == "compact"
    held, compact_held = (
        sum(run["frames"][0]["render"]["accel"][part] for part in ("node_bytes", "leaf_bytes"))
        for run in (figures, compact_figures)
    )
    assert compact_held < 0.75 * held


def test_another_layout_is_refused(msbvh: Run) -> None:
    done = msbvh("record", SHOWCASE, "a.exr", "--layout", "tiny")
    assert done.returncode == 2 and "tiny" in done.stderr
    stage = open_stage(str(SHOWCASE), Diagnostics())
    frame = read_frame(stage, 6.0, ReadSettings())
    with pytest.raises(ValueError, match='layout: found "tiny"; expected full or compact'):
        _core.Renderer(frame.scene, width=8, height=8, layout="tiny")
