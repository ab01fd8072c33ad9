"""Progress: a bar on a terminal, percentages in a log."""

from __future__ import annotations

import io

from msbvh.progress import Progress


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def test_a_log_gets_a_line_for_every_ten_percent() -> None:
    log = io.StringIO()
    with Progress("frame 1", log) as progress:
        for step in range(101):
            progress(step / 100)
    assert log.getvalue().splitlines() == [f"frame 1: {percent} %" for percent in range(0, 101, 10)]


def test_a_log_of_few_calls_ends_at_a_hundred() -> None:
    log = io.StringIO()
    with Progress("frame 1", log) as progress:
        progress(0.37)
        progress(1.0)
    assert log.getvalue().splitlines() == ["frame 1: 30 %", "frame 1: 100 %"]


def test_a_terminal_gets_a_bar() -> None:
    terminal = Terminal()
    with Progress("frame 1", terminal) as progress:
        progress(0.5)
        progress(1.0)
    assert "frame 1" in terminal.getvalue()
    assert "100%" in terminal.getvalue()
    assert "\n" not in terminal.getvalue().rstrip("\n")
