"""Instructions that the bench of effects takes, counted by callgrind."""

from __future__ import annotations

import json
import subprocess
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

FRAME = ("2000", "64")
"""Triangles and width of the base scene's frame."""
SMALL_FRAME = ("500", "32")
"""Of frames with an effect and without."""
FUNCTION = "msbvh::render_tile(*"


class Failed(Exception):
    """Ends the run, with a message for people."""


def base_count(bench: Path, instructions: str) -> dict[str, Any]:
    """What the bench prints of the base scene's frame, and how many instructions its tiles took."""
    (row,), count = _counted([bench, "base", instructions, *FRAME])
    return row | {"count": count}


def effect_count(bench: Path, effect: str) -> dict[str, Any]:
    """Of a frame with an effect and one without, each drawn twice, by the best kernels that valgrind knows: `count`
    instructions, and the effects that both scenes call for, `scenes`."""
    (row,), count = _counted([bench, "effects", *SMALL_FRAME, "1", effect])
    return {"count": count, "scenes": sorted(name for name in (row["effect"], *row["needs"].split(", ")) if name)}


def beside_counts(whole: Mapping[str, dict[str, Any]], without: Path, omitted: str) -> dict[str, tuple[int, int]]:
    """Of each effect whose frames do without the omitted one: instructions of a build with everything and of that without.
    `whole`: effect_count() of each."""
    return {
        effect: (found["count"], effect_count(without, effect)["count"])
        for effect, found in whole.items()
        if omitted not in found["scenes"]
    }


def total_of(callgrind: str) -> int:
    """Instructions that a callgrind file counts. Raises Failed for none, as where the function was not called."""
    totals = [line.split()[1] for line in callgrind.splitlines() if line.startswith(("summary:", "totals:"))]
    if not totals or int(totals[-1]) == 0:
        raise Failed(f"callgrind: found no instructions of {FUNCTION}; expected some")
    return int(totals[-1])


def output(command: Sequence[str | Path]) -> str:
    """What a command prints. Raises Failed where it fails."""
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode != 0:
        said = (done.stderr.strip() or done.stdout.strip()).splitlines()[-5:]
        raise Failed(f"{' '.join(map(str, command))}: found exit code {done.returncode}: {' '.join(said)}")
    return done.stdout


def _counted(command: Sequence[str | Path]) -> tuple[list[dict[str, Any]], int]:
    """The lines of JSON that the bench prints, and the instructions of its tiles."""
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "callgrind.out"
        text = output(
            ["valgrind", "--tool=callgrind", f"--toggle-collect={FUNCTION}", f"--callgrind-out-file={out}", "--quiet",
             *command]
        )  # fmt: skip
        return [json.loads(line) for line in text.splitlines()], total_of(out.read_text(encoding="utf-8"))
