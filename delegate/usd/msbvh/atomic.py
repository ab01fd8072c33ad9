"""Files that appear under their final name complete or not at all."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


class OutputError(Exception):
    """A file cannot be written; str() is one line that names it and says why."""


def check_writable(path: Path) -> None:
    """Raises OutputError where `path` could not be written: said before an hour of rendering, not after
    it."""
    folder = path.parent
    if not folder.is_dir():
        raise OutputError(f"cannot write '{path}': there is no folder '{folder}'")
    if path.exists() and not path.is_file():
        raise OutputError(f"cannot write '{path}': it is not a regular file")
    if not os.access(folder, os.W_OK | os.X_OK):
        raise OutputError(f"cannot write '{path}': no permission to write in folder '{folder}'")


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """Yields a temporary name beside `path`; renames it to `path` on success, removes it on anything else.

    The extension stays the same, for writers that choose their format by it. An interrupt counts as failure.
    Raises OutputError for what the operating system refuses.
    """
    temporary = path.with_name(f".{path.stem}.{os.getpid()}{path.suffix}")
    try:
        yield temporary
        os.replace(temporary, path)
    except OSError as error:
        raise OutputError(f"cannot write '{path}': {error.strerror or error}") from error
    finally:
        temporary.unlink(missing_ok=True)
