"""Long checks. `make test` runs a fixed-seed sample of each; with MSBVH_SOAK set (`make soak`) each runs whole.

A long check is a test with the marker `soak`. It takes its size from soak_count() and leaves a line for docs/soak.md
by soak_figure().
"""

from __future__ import annotations

import os


def is_soak() -> bool:
    return "MSBVH_SOAK" in os.environ


def soak_count(sample: int, whole: int) -> int:
    """How many cases to run."""
    return whole if is_soak() else sample


def soak_figure(check: str, figure: str) -> None:
    """What a check measured, in a few words with units; appended to the file that MSBVH_SOAK_FIGURES names, if any."""
    if file := os.environ.get("MSBVH_SOAK_FIGURES"):
        with open(file, "a", encoding="utf-8") as lines:
            lines.write(f"{check}\t{figure}\n")
