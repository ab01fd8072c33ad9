"""Signals that end a run: it unwinds, removes what it has made beside its outputs, and ends with 128 and the signal's
number.

    loading     modules are imported: the process ends at once. An exception would be raised inside pxr's own
                imports, which swallow it, and there is nothing to unwind yet.
    running     the first signal raises Stopped in the main thread; later ones raise nothing, so that they cannot cut
                the unwinding short.
    overdue     a library below us returns too late (USD composes a stage), or swallows the exception: a thread that
                watches ends the process GRACE_SECONDS after the first signal, or at the second.

Signals that are ignored when the run starts (nohup) stay ignored. Where listen() was not called, as in a program that
imports msbvh, signals are the program's own and everything here does nothing.
"""

from __future__ import annotations

import contextlib
import functools
import os
import select
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Any, ClassVar, NoReturn, TypeVar

from .exit_codes import BY_SIGNAL

ENDING = (
    signal.SIGHUP,
    signal.SIGINT,
    signal.SIGQUIT,
    signal.SIGTERM,
    signal.SIGUSR1,
    signal.SIGUSR2,
    signal.SIGALRM,
    signal.SIGXCPU,
)
"""Those that end a process unless it handles them, and that others send: users, terminals, farms, limits."""
WORDS = {signal.SIGHUP: "hung up", signal.SIGINT: "interrupted", signal.SIGTERM: "terminated"}
GRACE_SECONDS = 3.0
"""Farms wait for 10 to 30 seconds before they kill."""


Made = TypeVar("Made")


class Stopped(KeyboardInterrupt):
    """A signal asks for the run's end."""


class _State:
    """Of the process."""

    loading = True
    received = 0
    """The first signal's number; 0: none."""
    raised = False
    deferred = 0
    """Depth of deferred()."""
    undo: ClassVar[dict[int, Callable[[], object]]] = {}
    """What else to do where the process ends without unwinding."""
    announced = threading.Lock()


def listen() -> None:
    """Handles the signals from now on, as while modules load. In the main thread only."""
    for number in ENDING:
        if signal.getsignal(number) is not signal.SIG_IGN:
            signal.signal(number, _heard)


def loaded() -> None:
    """Modules are loaded: from now on a signal unwinds the run."""
    ours, theirs = os.pipe()
    os.set_blocking(theirs, False)
    signal.set_wakeup_fd(theirs, warn_on_full_buffer=False)
    threading.Thread(target=_watch, args=(ours,), name="signals", daemon=True).start()
    sys.unraisablehook = _unraisable
    _State.loading = False


def finish(code: int) -> int:
    """The exit code of a run that would end with `code`; from now on signals are ignored, because all is done."""
    _State.deferred += 1
    for number in ENDING:
        if signal.getsignal(number) is _heard:
            signal.signal(number, signal.SIG_IGN)
    if not _State.received:
        return code
    announce()
    return exit_code()


def exit_code() -> int:
    """Of a run that was interrupted; by SIGINT where nobody listens."""
    return BY_SIGNAL + (_State.received or signal.SIGINT)


def announce() -> None:
    """Says on stderr, once, which signal ended the run."""
    if _State.received and not _State.announced.acquire(blocking=False):
        return
    number = signal.Signals(_State.received or signal.SIGINT)
    word = WORDS.get(number, f"ended by {number.name}")
    with contextlib.suppress(OSError):
        os.write(2, f"msbvh: error: {word}\n".encode())


def stop_if_received() -> None:
    """Raises Stopped where a signal has come, also inside deferred() and where the first exception got lost."""
    if _State.received:
        _State.raised = True
        raise Stopped


@contextmanager
def deferred(undo: Callable[[], object] | None = None) -> Iterator[None]:
    """A signal raises nothing inside, but at the end. `undo` is called where the process ends without unwinding."""
    _State.deferred += 1
    try:
        if undo is not None:
            _State.undo[id(undo)] = undo
        yield
    finally:
        _State.undo.pop(id(undo), None)
        _State.deferred -= 1
    _stop_late()


@contextmanager
def undone(make: Callable[[], Made], undo: Callable[[Made], object]) -> Iterator[Made]:
    """What `make` makes, until `undo` undoes it: always, whenever a signal comes."""
    _State.deferred += 1
    try:
        made = make()
        call = functools.partial(undo, made)
        _State.undo[id(call)] = call
        _State.deferred -= 1
        try:
            _stop_late()
            yield made
        finally:
            _State.deferred += 1
            call()
            del _State.undo[id(call)]
    finally:
        _State.deferred -= 1
    _stop_late()


def _stop_late() -> None:
    if _State.received and not _State.deferred and not _State.raised:
        stop_if_received()


def _heard(number: int, frame: FrameType | None) -> None:
    if not _State.received:
        _State.received = number
        if _State.loading:
            _end()
        if not _State.deferred:
            stop_if_received()


def _watch(pipe: int) -> None:
    """Ends the process where the main thread does not."""
    first, until = 0, None
    while until is None or time.monotonic() < until:
        left = None if until is None else max(until - time.monotonic(), 0.0)
        ready, _, _ = select.select([pipe], [], [], left)
        for number in os.read(pipe, 256) if ready else b"":
            if number in ENDING and signal.getsignal(number) is _heard:
                until = time.monotonic() + (0.0 if first else GRACE_SECONDS)
                first = first or number
    if signal.getsignal(first) is _heard:  # Otherwise finish() has been called: the main thread is on its way out.
        _State.received = _State.received or first
        _end()


def _end() -> NoReturn:
    for undo in reversed(list(_State.undo.values())):
        with contextlib.suppress(Exception):
            undo()
    announce()
    os._exit(exit_code())


def _unraisable(unraisable: Any) -> None:
    """Nothing for Stopped: where a destructor swallowed it, the watch ends the run."""
    if not issubclass(unraisable.exc_type, Stopped):
        sys.__unraisablehook__(unraisable)
