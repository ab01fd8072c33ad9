"""The figures of a run, for --stats: a JSON file that scripts and dashboards read."""

from __future__ import annotations

import json
import resource
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from ..base.atomic import write_whole

PHASES = ("read", "sample", "build", "trace", "write")
"""read: opening and composing the stage. sample: evaluating it over the shutter and fitting tracks. build:
checking the scene, the plan and the trees. trace: pixels. write: colour correction and the file. Where --ray-costs asks,
there is one more, ray_costs: a sample of the rays traced again; with --denoise, denoise."""


@dataclass
class FrameStats:
    """The figures of one frame."""

    frame: float | None
    """Time code; None: USD's default time."""
    output: list[str]
    width: int = 0
    height: int = 0
    shutter: tuple[float, float] = (0.0, 0.0)
    """Of the camera, or of --shutter: open and close, in frames relative to the frame."""
    seconds: dict[str, float] = field(default_factory=lambda: dict.fromkeys(PHASES, 0.0))
    scene: dict[str, Any] = field(default_factory=dict)
    """Meshes, triangles, keys, instances, lights: of the scene as it was rendered."""
    subdivision: dict[str, int] = field(default_factory=dict)
    """How many cages were refined and meshes made of them, and how many of either were taken over from meshes and frames
    before: cages_made, cages_kept, meshes_made, meshes_kept."""
    render: dict[str, Any] = field(default_factory=dict)
    """The renderer's: rays, trees, and of the trees nodes, references and bytes, how many were built,
    refitted and kept from the frame before, and the seconds that it took. Where --ray-costs asks: ray_costs, what threads
    were found at (stages; with a budget, of its last samples), and what each effect took (effects: plan_report/measured.py)."""
    plan: list[dict[str, str]] = field(default_factory=list)
    """The effects that the frame calls for: effect, prim, why."""
    left_out: list[dict[str, Any]] = field(default_factory=list)
    """Prims that are not in the scene, because no ray can reach them: path, why, count (of instances)."""
    coarser_tracks: dict[str, int] = field(default_factory=dict)
    """How many prims and tracks of theirs have fewer keys because they are outside of the picture, and how many fewer: prims,
    tracks, keys_saved."""
    tracks: list[dict[str, Any]] = field(default_factory=list)
    """How the motion of the camera and of each prim was kept, and by which rule: record.TRACK_FIELDS."""

    budget: dict[str, Any] | None = None
    """What came of --target-error, --target-flip and --time-budget: error_px, flip, seconds (those that were asked for),
    samples a pixel, unknown_shapes, the prims whose shape was not measured, and misses, in words."""

    @contextmanager
    def timed(self, phase: str) -> Iterator[None]:
        """Adds the wall-clock time of the block to a phase."""
        start = time.perf_counter()
        try:
            yield
        finally:
            self.seconds[phase] = self.seconds.get(phase, 0.0) + time.perf_counter() - start


@dataclass
class RunStats:
    """The figures of a run. The stage is opened once: its time stands with the first frame."""

    software: str
    scene: str
    settings: dict[str, Any]
    instruction_sets: list[str]
    frames: list[FrameStats] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)
    errors: list[str] = field(default_factory=list)
    """Prims that were not rendered, because they are wrong."""
    peak_memory_bytes: int = 0

    def write(self, path: Path) -> None:
        """Writes JSON, complete or not at all. Raises OutputError."""
        self.peak_memory_bytes = peak_memory_bytes()
        # asdict() would copy every track first.
        text = json.dumps(vars(self), default=vars, indent=2, allow_nan=False)
        write_whole(path, f"{text}\n".encode())


def peak_memory_bytes() -> int:
    """The most memory that this process has held at once."""
    unit = 1 if sys.platform == "darwin" else 1024  # ru_maxrss: bytes on macOS, KiB elsewhere; see getrusage(2).
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * unit
