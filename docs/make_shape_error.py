"""Writes the table of docs/design/subdivision.md: how far surfaces stray from their limit, by complexity.

    python docs/make_shape_error.py SCENES

Needs the installed package, and the public scenes that it names under the folder SCENES.
"""

from __future__ import annotations

import re
import sys
from pathlib import Path

from msbvh.base.errors import Diagnostics
from msbvh.scene.reader import ReadSettings, read_frame
from msbvh.stage.opening import open_stage

PAGE = Path(__file__).resolve().parent / "design" / "subdivision.md"
SCENES = (
    ("heavy/OpenChessSet/chess_set.usda", None),
    ("subdiv/CreasesSpinningPyramids/Creases_SpinningPyramids.usda", 24.0),
    ("subdiv/usdgl_SubdivisionOsd3/subdivMesh.usda", None),
    ("subdiv/usdgl_SubdivisionOsd3/lefthandedMesh.usda", None),
    ("subdiv/hdmoonray_subdivision/subdivision.usd", None),
    ("motion_deform/arnold_0216/data/test.usda", 1.0),
)
"""With the frame; None: USD's default time."""
COMPLEXITIES = ("low", "medium", "high", "veryhigh")
NO_SHAPE = ("camera", "light", "instances")
"""Reports of what has no shape of its own."""


def worst(scene: Path, frame: float | None, complexity: str) -> tuple[float, str, int, int]:
    """The largest shape error of a frame, whose it is, and how many reports have one and how many meshes' have none."""
    stage = open_stage(str(scene), Diagnostics())
    result = read_frame(stage, frame, ReadSettings(complexity=complexity, measure_shape=True))
    measured = [(t.shape_error_pixels, t.path) for t in result.tracks if t.shape_error_pixels is not None]
    unmeasured = [t for t in result.tracks if t.shape_error_pixels is None and t.source not in NO_SHAPE]
    error, path = max(measured, default=(0.0, ""))
    return error, path, len(measured), len(unmeasured)


def table(root: Path) -> str:
    """A row a scene: the largest error at each complexity, and the prim that has it at high."""
    rows = ["| scene | " + " | ".join(COMPLEXITIES) + " | measured, not | worst at high |"]
    rows.append("|---" * (len(COMPLEXITIES) + 3) + "|")
    for scene, frame in SCENES:
        found = {complexity: worst(root / scene, frame, complexity) for complexity in COMPLEXITIES}
        cells = [f"{found[complexity][0]:.3g}" for complexity in COMPLEXITIES]
        _, path, measured, unmeasured = found["high"]
        rows.append(f"| {scene} | " + " | ".join(cells) + f" | {measured}, {unmeasured} | `{path}` |")
        print(rows[-1], flush=True)
    return "\n".join(rows)


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit("expected the folder of the public scenes")
    text = PAGE.read_text(encoding="utf-8")
    marked = f"<!-- shape error -->\n{table(Path(sys.argv[1]))}\n<!-- /shape error -->"
    PAGE.write_text(
        re.sub(r"<!-- shape error -->.*<!-- /shape error -->", lambda _: marked, text, flags=re.DOTALL),
        encoding="utf-8",
    )
