"""Writes the table of docs/design/motion.md: bytes of tracks with and without curves.

    python docs/make_motion.py

Needs the installed package; reads the scenes of testenv alone.
"""

from __future__ import annotations

import re
from pathlib import Path

from msbvh.base.errors import Diagnostics
from msbvh.scene.reader import ReadSettings, read_frame
from msbvh.stage.opening import open_stage

ROOT = Path(__file__).resolve().parents[1]
PAGE = ROOT / "docs" / "design" / "motion.md"
SCENES = (
    ("testenv/showcase/showcase.usda", 6.0),
    ("testenv/motion/scenes/rotate_op.usda", None),
    ("testenv/motion/scenes/rotate_two_turns.usda", None),
    ("testenv/motion/scenes/uneven_samples.usda", None),
    ("testenv/motion/scenes/accelerations.usda", None),
    ("testenv/motion/scenes/instancer_angular_velocities.usda", None),
    ("testenv/motion/scenes/shutter_asymmetric.usda", None),
    ("testenv/motion/scenes/skin_rotates.usda", None),
)
RULES_FRAME = 10.0
"""That of the suite's scenes."""
CHOICES = ("linear", "quadratic", "cubic", "auto")


def figures(scene: str, frame: float | None, interpolation: str) -> tuple[int, float]:
    """Bytes of all tracks that move, and the largest error in pixels."""
    stage = open_stage(str(ROOT / scene), Diagnostics())
    at = RULES_FRAME if frame is None else frame
    result = read_frame(stage, at, ReadSettings(width=960, interpolation=interpolation, outside_tolerance=1.0))
    moving = [track for track in result.tracks if track.segments > 0]
    return sum(track.bytes for track in moving), max((track.error_pixels for track in moving), default=0.0)


def table() -> str:
    rows = ["| scene | " + " | ".join(f"{choice}: bytes (pixels)" for choice in CHOICES) + " |"]
    rows.append("|---" * (len(CHOICES) + 1) + "|")
    for scene, frame in SCENES:
        cells = [f"{size} ({error:.3g})" for size, error in (figures(scene, frame, c) for c in CHOICES)]
        rows.append(f"| {Path(scene).stem} | " + " | ".join(cells) + " |")
    return "\n".join(rows)


if __name__ == "__main__":
    text = PAGE.read_text(encoding="utf-8")
    marked = f"<!-- table -->\n{table()}\n<!-- /table -->"
    PAGE.write_text(re.sub(r"<!-- table -->.*<!-- /table -->", marked, text, flags=re.DOTALL), encoding="utf-8")
