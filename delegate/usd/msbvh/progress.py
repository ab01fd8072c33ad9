"""Progress on stderr: a bar on a terminal, plain percentage lines in a log."""

from __future__ import annotations

import sys
from types import TracebackType
from typing import TextIO

from tqdm import tqdm

LINE_STEP = 10
"""Percent between two lines of a log."""


class Progress:
    """One frame's progress; use as a context manager and call with the finished share in [0, 1]."""

    def __init__(self, label: str, stream: TextIO | None = None) -> None:
        self._label = label
        self._stream = stream or sys.stderr
        self._last_percent = -LINE_STEP
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
        if self._bar is not None:
            self._bar.update(min(share, 1.0) - self._bar.n)
            return
        percent = int(100.0 * share) // LINE_STEP * LINE_STEP
        if percent > self._last_percent:
            self._last_percent = percent
            print(f"{self._label}: {percent} %", file=self._stream, flush=True)
