"""Points of the report: settings, what a frame takes with them, and how far its picture is off."""

from __future__ import annotations

import hashlib
import shlex
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from statistics import median
from typing import Any

from ..output.stats import PHASES
from .kinds import motion_pixels
from .knobs import Error
from .launch import Shot
from .options import Options
from .picture_errors import PairedError, PictureError
from .store import Figures


@dataclass
class Point:
    """Settings that were measured."""

    options: Options
    runs: list[Figures] = field(default_factory=list)
    """One a seed."""
    failed: str = ""
    """Why they could not be."""
    error: PictureError | None = None
    """Beside the reference."""
    kinds: dict[Error, PairedError] = field(default_factory=dict)
    """Each kind of error alone; those that were looked at."""
    shape_px: float | None = None

    @property
    def id(self) -> str:
        return "p" + hashlib.sha256(repr(self.options.pairs).encode()).hexdigest()[:8]

    @property
    def motion_px(self) -> float:
        return motion_pixels(self.runs[0].tracks)

    def seconds(self, phase: str) -> list[float]:
        """Of each run; `frame`: of all phases."""
        phases = PHASES if phase == "frame" else (phase,)
        return [sum(run.seconds[one] for one in phases) for run in self.runs]

    @property
    def frame_seconds(self) -> float:
        return median(self.seconds("frame"))

    def plain(self, base: Options, shot: Shot) -> dict[str, Any]:
        """As JSON has it."""
        found: dict[str, Any] = {
            "options": self.options.beside(base).plain(),
            "command": shlex.join(["msbvh", *shot.command(self.options, "frame.exr")]),
            "failed": self.failed or None,
        }
        if self.failed:
            return found
        render = self.runs[0].stats["render"]
        costs = render.get("ray_costs") or {}
        error = asdict(self.error) if self.error else dict.fromkeys(PictureError.__annotations__)
        return found | {
            "seconds": {phase: _spread(self.seconds(phase)) for phase in (*PHASES, "frame")},
            "runs": len(self.runs),
            "peak_bytes": max(run.peak_bytes for run in self.runs),
            "tree_bytes": render["accel"]["total_bytes"],
            "motion_bytes": sum(track["bytes"] for track in self.runs[0].tracks),
            "triangles": render["accel"]["triangles"],
            "rays": render["rays"],
            "nodes_per_ray": costs.get("nodes_per_ray"),
            "tests_per_ray": costs.get("tests_per_ray"),
            "motion_px": self.motion_px,
            "shape_px": self.shape_px,
            **error,
            "kinds": {kind: asdict(found) for kind, found in self.kinds.items()},
            **{f"{kind}_flip": found.flip for kind, found in self.kinds.items()},
        }


def _spread(found: Sequence[float]) -> list[float]:
    return [median(found), min(found), max(found)]


def front_of(points: Mapping[str, Point], cost: str = "frame") -> list[str]:
    """Points that no other beats both in time and in error, the cheapest first."""
    known = [
        (median(point.seconds(cost)), max(point.error.relative_mse, 0.0), key)
        for key, point in points.items()
        if point.error is not None
    ]
    front: list[str] = []
    least = float("inf")
    for _, error, key in sorted(known):
        if error < least:
            front.append(key)
            least = error
    return front
