"""Runs a command on chosen processors and writes what it took: a script that a Python of its own runs.

    python -I -S frame_launch.py RESULT.json PROCESSOR[,...] COMMAND...

A process of its own, because a program's peak of memory (ru_maxrss) begins with that of the process that starts it, and
the harness holds libraries and pictures. It imports nothing of ours.
"""

from __future__ import annotations

import json
import os
import sys
import time
from collections.abc import Sequence
from pathlib import Path


def main(arguments: Sequence[str]) -> int:
    """Returns the command's exit code; 127 where it cannot be run, 128 and the signal's number where one ended it."""
    result, processors, *command = arguments
    os.sched_setaffinity(0, {int(one) for one in processors.split(",")})
    begin = time.perf_counter()
    try:
        process = os.posix_spawnp(command[0], command, os.environ)
    except OSError as error:
        print(f"cannot be run: {command[0]}: {error.strerror}", file=sys.stderr)
        return 127
    _, status, usage = os.wait4(process, 0)
    seconds = time.perf_counter() - begin
    cpu = usage.ru_utime + usage.ru_stime
    figures = {"seconds": seconds, "cpu_seconds": cpu, "memory_bytes": usage.ru_maxrss * 1024}
    Path(result).write_text(json.dumps(figures), encoding="utf-8")
    code = os.waitstatus_to_exitcode(status)
    return code if code >= 0 else 128 - code


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
