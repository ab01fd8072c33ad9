"""Progress on stderr: a bar on a terminal, plain percentage lines in a log."""

from __future__ import annotations

import sys
import time
from types import TracebackType
from typing import TextIO

from tqdm import tqdm

from . import signals
from .streams import Unfailing

LINE_STEP = 10
"""Percent between two lines of a log."""
PATIENCE_SECONDS = 1.0
"""What takes no longer needs no bar."""


class Progress:
    """One frame's progress; use as a context manager and call with the finished share in [0, 1]."""

    def __init__(self, label: str, stream: TextIO | None = None, delay_seconds: float = 0.0) -> None:
        """Silent for the first `delay_seconds`, and for good if all is done by then."""
        self._label = label
        self._stream = Unfailing(stream or sys.stderr)
        self._last_percent = -LINE_STEP
        self._shows_at = time.monotonic() + delay_seconds if delay_seconds else None
        self._bar = None
        if self._shows_at is None:
            self._show()

    def _show(self) -> None:
        self._shows_at = None
        self._bar = self._make_bar() if self._stream.isatty() else None

    def _make_bar(self) -> tqdm:
        form = "{l_bar}{bar}| {elapsed} < {remaining}"
        return tqdm(total=1.0, desc=self._label, file=self._stream, bar_format=form, leave=True)

    def __enter__(self) -> Progress:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._bar is not None:
            self._bar.close()

    def __call__(self, share: float) -> None:
        signals.stop_if_received()
        if self._shows_at is not None:
            if share >= 1.0 or time.monotonic() < self._shows_at:
                return
            self._show()
        if self._bar is not None:
            self._bar.update(min(share, 1.0) - self._bar.n)
            return
        percent = int(100.0 * share) // LINE_STEP * LINE_STEP
        if percent > self._last_percent:
            self._last_percent = percent
            print(f"{self._label}: {percent} %", file=self._stream, flush=True)
