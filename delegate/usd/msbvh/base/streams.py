"""stdout and stderr that may be closed, full or gone: what cannot be said costs no picture."""

from __future__ import annotations

import contextlib
import errno
import os
import sys
from typing import Any, TextIO


class Unfailing:
    """A text stream whose writes never raise. `failure` keeps the first error."""

    def __init__(self, stream: TextIO | None) -> None:
        self._stream = stream
        self.failure: OSError | None = None

    def write(self, text: str) -> int:
        """Drops the text where it cannot be written."""
        if self._stream is not None:
            try:
                return self._stream.write(text)
            except (OSError, ValueError) as error:  # ValueError: closed, or text that its encoding does not have.
                self._failed(error)
        return len(text)

    def flush(self) -> None:
        """As write()."""
        if self._stream is not None:
            try:
                self._stream.flush()
            except (OSError, ValueError) as error:
                self._failed(error)

    def _failed(self, error: OSError | ValueError) -> None:
        if self.failure is None:
            self.failure = error if isinstance(error, OSError) else OSError(errno.EBADF, str(error))

    def isatty(self) -> bool:
        """False where there is no stream any more."""
        with contextlib.suppress(ValueError):
            return self._stream is not None and self._stream.isatty()
        return False

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)


def guard() -> None:
    """Opens what is closed, so that no picture gets descriptor 2 and with it the messages of C libraries, and
    makes both streams unfailing."""
    for descriptor in (0, 1, 2):
        try:
            os.fstat(descriptor)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # The lowest free one: this.
            os.set_inheritable(descriptor, True)
    for name in ("stdout", "stderr"):
        stream = getattr(sys, name)
        if stream is not None:
            stream.reconfigure(errors="backslashreplace")
        setattr(sys, name, Unfailing(stream))


def settle() -> str:
    """Flushes both. Returns what is wrong with stdout, "" if nothing is, or if its reader has just read enough.

    A stream that fails is pointed at nothing: Python flushes once more at its end, and turns a failure into an exit
    code of its own.
    """
    for stream, descriptor in ((sys.stdout, 1), (sys.stderr, 2)):
        stream.flush()
        if getattr(stream, "failure", None) is not None:
            nothing = os.open(os.devnull, os.O_WRONLY)
            os.dup2(nothing, descriptor)
            os.close(nothing)
    failure = getattr(sys.stdout, "failure", None)
    if failure is None or failure.errno == errno.EPIPE:
        return ""
    return f"cannot write to standard output: {failure.strerror or failure}"
