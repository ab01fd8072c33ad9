"""The public scenes beside the checkout, in ../shared/scenes; absent on most machines.

A test that needs them has the marker `shared`, and ends in absent() where they are not there: skipped, or
failed with MSBVH_REQUIRE_SHARED=1. A scene that a test leaves out appears as skipped, with the reason.
"""

from __future__ import annotations

import csv
import os
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import NoReturn

import pytest

SCENES = Path(__file__).resolve().parents[3] / "shared" / "scenes"

INCOMPLETE = ("usdwg_foundation", "stage_configuration")
"""Scenes whose sublayers nobody has copied: name, and first folder of the root."""


@dataclass(frozen=True)
class SharedScene:
    """A line of INDEX.tsv."""

    group: str
    name: str
    root: str
    frame: str
    """Time code; empty: the stage's start time."""
    opens: bool
    """False for what is broken on purpose."""
    has_camera: bool

    @property
    def folder(self) -> Path:
        return SCENES / self.group / self.name

    @property
    def path(self) -> Path:
        return self.folder / self.root

    def __str__(self) -> str:
        return f"{self.group}-{self.name}-{Path(self.root).stem}"


def every_scene() -> list[SharedScene]:
    """All scenes in the order of the index; [] where there is no index."""
    index = SCENES / "INDEX.tsv"
    if not index.exists():
        return []
    with index.open(encoding="utf-8", newline="") as lines:
        rows = list(csv.DictReader(lines, delimiter="\t"))
    return [
        SharedScene(
            row["group"],
            row["name"],
            row["root"],
            row["frame"].replace("None", ""),
            row["open"] == "ok",
            row["shutter"] not in ("", "[]") or "cam_" in row["anim"],
        )
        for row in rows
    ]


def broken(scene: SharedScene) -> str:
    """The reason to leave out what no test can read; empty for the others."""
    if not scene.opens:
        return "broken on purpose: USD does not open it"
    if (scene.name, scene.root.partition("/")[0]) == INCOMPLETE:
        return "empty: the sublayers in ../../../_common are not among the public scenes"
    return ""


def scene_parameters(excluded: Callable[[SharedScene], str] = broken) -> list[object]:
    """Every scene as a value of a parameter, skipped where `excluded` has a reason; None where there are no
    scenes: here() takes either."""
    return parameters(every_scene(), excluded)


def parameters(cases: Iterable[object], excluded: Callable[..., str]) -> list[object]:
    """The same of other cases than scenes."""
    found = [
        pytest.param(case, marks=[pytest.mark.skip(reason=reason)] if (reason := excluded(case)) else [], id=str(case))
        for case in cases
    ]
    return found or [pytest.param(None, id="absent")]


def here(scene: SharedScene | None) -> SharedScene:
    """The scene; ends the test where there is none."""
    if scene is None:
        absent(SCENES / "INDEX.tsv")
    require(scene.path)
    return scene


def require(path: Path) -> None:
    """Ends the test where a file or folder of the public scenes is not there."""
    if not path.exists():
        absent(path)


def absent(path: Path) -> NoReturn:
    """Ends a test that needs a public scene."""
    if os.environ.get("MSBVH_REQUIRE_SHARED") == "1":
        pytest.fail(f"MSBVH_REQUIRE_SHARED=1: found no {path}; expected the public scenes beside the checkout")
    pytest.skip(f"no {path} on this machine")
