"""One line in place of a silent death where a library crashes on a damaged file."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager

from .reporter import one_line

_armed: list[str] = []


@contextmanager
def crash_line(file: str) -> Iterator[None]:
    """While this holds, a crash ends the process with one line that names the file, and exit code 1.

    usd-core follows offsets of binary layers without looking where they lead. MSBVH_TRACEBACK=1 lets it crash.
    """
    if os.environ.get("MSBVH_TRACEBACK"):
        yield
        return
    from .. import _core

    message = "a library crashed while it was read; the file is damaged, or too large or too deep for USD"
    _armed.append(f"msbvh: error: {one_line(file)}: {message} (MSBVH_TRACEBACK=1 lets it crash)\n")
    _core.arm_crash_line(_armed[-1])
    try:
        yield
    finally:
        _armed.pop()
        if _armed:
            _core.arm_crash_line(_armed[-1])
        else:
            _core.disarm_crash_line()
