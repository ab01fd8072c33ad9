"""Progress: a bar on a terminal, percentages in a log."""

from __future__ import annotations

import io

import pytest
from msbvh.base import progress as progress_module
from msbvh.base.progress import Progress
from msbvh.scene.reader import read_frame
from pxr import Gf, UsdGeom
from recording import Shot


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


class Clock:
    """A clock that stands until it is set."""

    now = 0.0

    def monotonic(self) -> float:
        return self.now


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    clock = Clock()
    monkeypatch.setattr(progress_module, "time", clock)
    return clock


@pytest.mark.parametrize("stream", [io.StringIO, Terminal])
def test_what_is_quick_says_nothing(clock: Clock, stream: type[io.StringIO]) -> None:
    log = stream()
    with Progress("reading", log, delay_seconds=1.0) as progress:
        for share, clock.now in ((0.1, 0.2), (0.9, 0.9), (1.0, 1.5)):
            progress(share)
    assert log.getvalue() == ""


def test_what_takes_longer_shows_from_then_on(clock: Clock) -> None:
    log, terminal = io.StringIO(), Terminal()
    with Progress("reading", log, 1.0) as plain, Progress("reading", terminal, 1.0) as bar:
        for share, clock.now in ((0.1, 0.2), (0.35, 1.5), (1.0, 3.0)):
            plain(share)
            bar(share)
    assert log.getvalue().splitlines() == ["reading: 30 %", "reading: 100 %"]
    assert "100%" in terminal.getvalue()


def test_reading_calls_once_a_mesh_and_not_once_an_instance() -> None:
    shot, shares = Shot(), []
    for index in range(4):
        shot.mesh(f"/square{index}")
    instancer = UsdGeom.PointInstancer.Define(shot.stage, "/dots")
    instancer.CreatePrototypesRel().SetTargets([shot.mesh("/dots/dot").GetPath()])
    instancer.CreateProtoIndicesAttr([0] * 500)
    instancer.CreatePositionsAttr([Gf.Vec3f(x, 0, 0) for x in range(500)])
    read_frame(shot.stage, 10.0, progress=shares.append)
    assert shares == sorted(shares) and shares[-1] == 1.0
    assert 4 < len(shares) < 12
