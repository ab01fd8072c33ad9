"""What is said of --threads."""

from __future__ import annotations

import os
from collections.abc import Sequence

from ..base.reporter import Reporter


def note_threads(counts: Sequence[int], reporter: Reporter) -> None:
    """Says so where more are asked for than this process may use."""
    most = len(os.sched_getaffinity(0))
    for count in counts:
        if count > most:
            reporter.note(f"--threads {count}: this process may use {most} at once, and no more are started")
