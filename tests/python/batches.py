"""Scripts that try seeds, in processes of their own: a crash or a hang costs a test a message."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

HERE = Path(__file__).resolve().parent
BATCH = 500
SECONDS_A_CASE = 20.0
CRASHED = "a library crashed while it was read"


def batches(script: str, arguments: Sequence[object], count: int) -> Iterator[dict]:
    """The lines of a script that tries seeds, from processes of their own, two at once."""

    def run(first: int) -> list[dict]:
        """One batch. Where USD crashes, which ends a process of ours in one line, the next one goes on behind that."""
        end, lines = min(first + BATCH, count), []
        while first < end:
            lines += run_some(first, end - first)
            crashed = CRASHED in lines[-1].get("outcome", "")
            if crashed:
                lines[-1]["outcome"] = f"crashed: {CRASHED}"
            first = lines[-1]["seed"] + 1 if crashed else end
        return lines

    def run_some(first: int, size: int) -> list[dict]:
        command = [sys.executable, str(HERE / script), *map(str, arguments), str(first), str(size)]
        try:
            done = subprocess.run(
                command, capture_output=True, text=True, timeout=60 + SECONDS_A_CASE * size, check=False
            )
        except subprocess.TimeoutExpired as late:
            return [{"seed": f"{first} and on", "outcome": f"WRONG: hangs after {str(late.stdout)[-200:]}"}]
        lines = [json.loads(line) for line in done.stdout.splitlines()]
        if done.returncode:
            lines.append({**lines[-1], "outcome": f"WRONG: exit {done.returncode}: {done.stderr[-500:]}"})
        return lines

    with ThreadPoolExecutor(2) as pool:
        for lines in pool.map(run, range(0, count, BATCH)):
            yield from lines
