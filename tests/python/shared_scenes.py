"""The public scenes beside the checkout, in ../shared/scenes; absent on most machines."""

from __future__ import annotations

import csv
from dataclasses import dataclass
from pathlib import Path

SCENES = Path(__file__).resolve().parents[3] / "shared" / "scenes"

MOTION_GROUPS = (
    "motion_deform",
    "transform_motion",
    "instancing_motion",
    "varying_topology",
    "velocity_accel",
    "heavy",
)
"""The groups that must render today."""

EVERY_GROUP = (
    *MOTION_GROUPS,
    "skinned",
    "subdiv",
    "lights_materials",
    "cameras",
    "render_settings",
    "edge",
)


@dataclass(frozen=True)
class SharedScene:
    """A line of INDEX.tsv."""

    group: str
    name: str
    root: str
    frame: str
    """Time code; empty: the stage's start time."""

    @property
    def folder(self) -> Path:
        return SCENES / self.group / self.name

    @property
    def path(self) -> Path:
        return self.folder / self.root

    def __str__(self) -> str:
        return f"{self.group}-{self.name}-{Path(self.root).stem}"


def shared_scenes(*groups: str) -> list[SharedScene]:
    """The scenes of some groups in the order of the index; [] where there is no index."""
    return [scene for scene in every_scene() if scene.group in groups]


def every_scene() -> list[SharedScene]:
    """All scenes in the order of the index; [] where there is no index."""
    index = SCENES / "INDEX.tsv"
    if not index.exists():
        return []
    with index.open(encoding="utf-8", newline="") as lines:
        rows = list(csv.DictReader(lines, delimiter="\t"))
    return [
        SharedScene(row["group"], row["name"], row["root"], row["frame"].replace("None", "")) for row in rows
    ]
