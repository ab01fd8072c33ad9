"""Programs that a command runs and waits for."""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
from collections.abc import Sequence
from typing import IO

from . import signals

LONGEST_LINE = 160


def exit_code(command: Sequence[str], log: IO[bytes], timeout_seconds: float | None = None) -> int | None:
    """Waits for a command, whose output goes to `log`; None: it took too long. What ends the waiting ends its children
    too: renderers come in wrapper scripts. Raises OSError where it cannot be run."""

    def start() -> subprocess.Popen[bytes]:
        return subprocess.Popen(
            command, stdin=subprocess.DEVNULL, stdout=log, stderr=subprocess.STDOUT, start_new_session=True
        )

    def end(process: subprocess.Popen[bytes]) -> None:
        if process.poll() is None:
            with contextlib.suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGKILL)
            process.wait()

    with signals.undone(start, end) as process:
        try:
            return process.wait(timeout_seconds)
        except subprocess.TimeoutExpired:
            return None


def last_line(said: bytes) -> str:
    """The last line of a log that says anything, cut to a length that fits a message."""
    lines = said.decode("utf-8", errors="replace").split("\n")
    return next((" ".join(line.split()) for line in reversed(lines) if line.strip()), "it said nothing")[:LONGEST_LINE]
