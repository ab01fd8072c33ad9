"""What the command line says on stderr."""

from __future__ import annotations

import sys


class Reporter:
    """Prints `msbvh: ...`, `msbvh: warning: ...` and `msbvh: error: ...`, a line each, the same one once a
    run."""

    def __init__(self) -> None:
        self.warnings: list[str] = []
        """Everything that was missing or degraded, in the order of its first appearance."""
        self._notes: set[str] = set()

    def warning(self, message: str) -> None:
        """Something was left out or approximated; the run goes on."""
        line = one_line(message)
        if line not in self.warnings:
            self.warnings.append(line)
            print(f"msbvh: warning: {line}", file=sys.stderr, flush=True)

    def note(self, message: str) -> None:
        """Worth saying; nothing is lost."""
        line = one_line(message)
        if line not in self._notes:
            self._notes.add(line)
            print(f"msbvh: {line}", file=sys.stderr, flush=True)

    @staticmethod
    def error(message: str) -> None:
        """The run ends here."""
        print(f"msbvh: error: {one_line(message)}", file=sys.stderr, flush=True)


def one_line(message: str) -> str:
    """Folds line breaks and runs of blanks: messages of libraries below us have them."""
    return " ".join(message.split())
