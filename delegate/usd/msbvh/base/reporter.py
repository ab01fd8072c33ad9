"""What the command line says on stderr."""

from __future__ import annotations

import sys

from .streams import Unfailing


class Reporter:
    """Prints `msbvh: ...`, `msbvh: warning: ...` and `msbvh: error: ...`, a line each, the same one once a
    run. Where stderr is closed or full, nothing."""

    def __init__(self) -> None:
        self.warnings: list[str] = []
        """Everything that was degraded, in the order of its first appearance."""
        self.errors: list[str] = []
        """Everything that is missing, because it is wrong."""
        self._notes: set[str] = set()

    def warning(self, message: str) -> None:
        """Something was left out or approximated; the run goes on."""
        line = one_line(message)
        if line not in self.warnings:
            self.warnings.append(line)
            _say(f"msbvh: warning: {line}")

    def missing(self, message: str) -> None:
        """A prim is wrong and was not rendered; the run goes on."""
        line = one_line(message)
        if line not in self.errors:
            self.errors.append(line)
            _say(f"msbvh: error: {line}")

    @property
    def degraded(self) -> bool:
        """Whether the picture is less than what was asked for."""
        return bool(self.warnings or self.errors)

    def note(self, message: str) -> None:
        """Worth saying; nothing is lost."""
        line = one_line(message)
        if line not in self._notes:
            self._notes.add(line)
            _say(f"msbvh: {line}")

    @staticmethod
    def error(message: str) -> None:
        """The run ends here."""
        _say(f"msbvh: error: {one_line(message)}")


def _say(line: str) -> None:
    print(line, file=Unfailing(sys.stderr), flush=True)


def one_line(message: str) -> str:
    """Folds line breaks and runs of blanks: messages of libraries below us have them."""
    return " ".join(message.split())
