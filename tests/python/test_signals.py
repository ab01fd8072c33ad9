"""Signals: whenever one comes, the exit code is 128 and its number, and no file is left but whole ones."""

from __future__ import annotations

import os
import random
import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import OpenImageIO as oiio
import pytest
from conftest import ROOT
from soak import soak_count, soak_figure

SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
LONG = ("--spp", 1_000_000)


@pytest.fixture(autouse=True)
def heeded_by_children() -> Iterator[None]:
    """What the tests are started under (nohup, a background job) may ignore signals, and children inherit that."""
    ignored = [number for number in SIGNALS if signal.getsignal(number) == signal.SIG_IGN]
    for number in ignored:
        signal.signal(number, signal.SIG_DFL)
    yield
    for number in ignored:
        signal.signal(number, signal.SIG_IGN)


@contextmanager
def started(
    folder: Path, *arguments: object, before: Callable[[], None] | None = None
) -> Iterator[subprocess.Popen[str]]:
    """A run of msbvh, which does not outlive the test."""
    command = [sys.executable, "-m", "msbvh", *map(str, arguments)]
    with subprocess.Popen(
        command, cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, preexec_fn=before
    ) as process:
        try:
            yield process
        finally:
            process.kill()


def wait_for_handlers(process: subprocess.Popen[str]) -> bool:
    """Until the process heeds SIGTERM: before, Python itself is still starting. False: it never did."""
    status = Path(f"/proc/{process.pid}/status")
    until = time.monotonic() + 20
    while process.poll() is None and time.monotonic() < until:
        caught = re.search(r"^SigCgt:\s*(\w+)$", status.read_text(), re.MULTILINE)
        if caught and int(caught[1], 16) >> (signal.SIGTERM - 1) & 1:
            return True
        time.sleep(0.002)
    return False


def wait_for(process: subprocess.Popen[str], ending: str) -> None:
    assert process.stderr is not None
    line = ""
    while not line.endswith(ending):
        line = process.stderr.readline()
        assert line, "ended too early"


def ended(process: subprocess.Popen[str], number: signal.Signals, may_finish: bool = False) -> float:
    """Waits for the end, which must be that of the signal. Returns how long it took, in seconds."""
    begin = time.monotonic()
    _, errors = process.communicate(timeout=60)
    if process.returncode == 0 and may_finish:
        return 0.0
    assert process.returncode == 128 + number, errors
    lines = [line for line in errors.splitlines() if line.startswith("msbvh: error: ")]
    word = {signal.SIGINT: "interrupted", signal.SIGTERM: "terminated", signal.SIGHUP: "hung up"}[number]
    assert lines == [f"msbvh: error: {word}"], errors
    assert "Traceback" not in errors and "ignored" not in errors
    return time.monotonic() - begin


@pytest.mark.parametrize("number", SIGNALS)
def test_while_modules_load(tmp_path: Path, scene: Path, number: signal.Signals) -> None:
    for delay in (0.0, 0.1):
        with started(tmp_path, "record", scene, "a.exr", *LONG) as process:
            assert wait_for_handlers(process)
            time.sleep(delay)
            process.send_signal(number)
            assert ended(process, number) < 20
    assert os.listdir(tmp_path) == ["scene.usda"]


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP])
def test_while_pixels_are_traced(tmp_path: Path, scene: Path, number: signal.Signals) -> None:
    with started(tmp_path, "record", scene, "a.exr", *LONG) as process:
        wait_for(process, " %\n")
        process.send_signal(number)
        assert ended(process, number) < 20
    assert os.listdir(tmp_path) == ["scene.usda"]


def test_two_at_once(tmp_path: Path, scene: Path) -> None:
    """An impatient user, or a farm that sends both; the first one counts."""
    for first, second in ((signal.SIGTERM, signal.SIGINT), (signal.SIGINT, signal.SIGINT)):
        with started(tmp_path, "record", scene, "a.exr", *LONG) as process:
            wait_for(process, " %\n")
            process.send_signal(first)
            time.sleep(0.01)
            process.send_signal(second)
            assert ended(process, first) < 20
    assert os.listdir(tmp_path) == ["scene.usda"]


def test_nohup_is_respected(tmp_path: Path, scene: Path) -> None:
    def ignored() -> None:
        signal.signal(signal.SIGHUP, signal.SIG_IGN)

    with started(tmp_path, "record", scene, "a.exr", "--spp", 4, "-w", 48, before=ignored) as process:
        for _ in range(5):
            process.send_signal(signal.SIGHUP)
            time.sleep(0.1)
        process.communicate(timeout=60)
        assert process.returncode == 0
    assert sorted(os.listdir(tmp_path)) == ["a.exr", "scene.usda"]


SCRIPT = """
import os, signal, sys, time
from msbvh.base import signals
signals.listen()
signals.loaded()
kill = lambda: os.kill(os.getpid(), signal.SIGTERM)
{body}
os._exit(signals.finish(0))
"""
SWALLOWED = """
try:
    kill()
except KeyboardInterrupt:
    pass
time.sleep(60)
"""
DEFERRED = """
seen = []
try:
    with signals.undone(lambda: seen.append("made"), lambda _: seen.append("undone")):
        with signals.deferred():
            kill()
            seen.append("written")
        seen.append("never")
except signals.Stopped:
    assert seen == ["made", "written", "undone"], seen
    kill()  # A second one interrupts no unwinding.
"""
IMPATIENT = """
open("temporary", "w").close()
with signals.deferred(undo=lambda: os.unlink("temporary")):
    kill()
    time.sleep(0.1)
    kill()
    time.sleep(60)
"""


@pytest.mark.parametrize(("body", "at_least"), [(SWALLOWED, 2.5), (DEFERRED, 0.0), (IMPATIENT, 0.0)])
def test_what_the_main_thread_does_not_do(tmp_path: Path, body: str, at_least: float) -> None:
    """Where a library swallows the exception, or does not come back in time, the run ends all the same."""
    command = [sys.executable, "-c", SCRIPT.format(body=body)]
    begin = time.monotonic()
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=30, check=False)
    assert (done.returncode, done.stderr) == (143, "msbvh: error: terminated\n")
    assert time.monotonic() - begin > at_least
    assert os.listdir(tmp_path) == []


COMMANDS: dict[str, tuple[object, ...]] = {
    "record": ("record", "scene.usda", "a.exr", "b.png", "c.jpg", "d.tif", "--stats", "s.json", "--spp", 8, "-w", 900),
    "frames": ("record", "scene.usda", "o.####.exr", "-f", "1:200", "--spp", 4, "-w", 64),
    "plan": ("plan", "scene.usda"),
    "motion": ("motion", "scene.usda", "-v"),
    "conform": ("conform", "--suite", ROOT / "testenv" / "motion", "--rules", "r*", "--out", "kept"),
    "bench": ("bench", "--quick", "--scenes", "room", "--out", "kept"),
}
SECONDS = {"plan": 0.9, "motion": 0.9}
"""Moments are spread over as long as a command takes; the others take longer than two seconds."""


def check_files(folder: Path) -> None:
    """Every file is a whole one, and there is none that nobody asked for."""
    for path in folder.rglob("*"):
        if path.is_dir() or path.name in ("scene.usda", "s.json", "bench.json", "renderer.log"):
            continue
        assert re.fullmatch(r"[abcd]\.(exr|png|jpg|tif)|o\.\d{4}\.exr|image\.\d{4}\.exr", path.name), path
        image = oiio.ImageInput.open(str(path))
        assert image and image.read_image(oiio.FLOAT) is not None, path


@pytest.mark.soak
@pytest.mark.parametrize("command", COMMANDS)
def test_at_random_moments(tmp_path: Path, scene: Path, command: str) -> None:
    """20 moments of each signal on `make soak`; of `make test` a few."""
    chosen = random.Random(command)
    rounds = soak_count(1, 20)
    longest = 0.0
    temporary = tmp_path / "temporary"
    temporary.mkdir()
    environment = {"TMPDIR": str(temporary)}
    for _ in range(rounds):
        for number in SIGNALS:
            with started(tmp_path, *COMMANDS[command], before=lambda: os.environ.update(environment)) as process:
                if wait_for_handlers(process):
                    time.sleep(chosen.uniform(0.0, SECONDS.get(command, 2.0)))
                    process.send_signal(number)
                longest = max(longest, ended(process, number, may_finish=True))
            assert os.listdir(temporary) == []
            check_files(tmp_path)
    soak_figure(f"signals, {command}", f"{rounds * len(SIGNALS)} moments, at most {longest:.1f} s to the end")
