"""Writes report.html: everything that it shows is inside it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from ..base.atomic import write_whole
from ..base.errors import SceneError

NEEDED = ("jinja2", "matplotlib")
"""Libraries of the extra `accuracy`."""


def check_libraries() -> None:
    """Raises SceneError where a report could not be written: said before an hour of rendering, not after it."""
    try:
        from .page import page  # noqa: F401
    except ModuleNotFoundError as error:
        library = (error.name or "").partition(".")[0]
        if library not in NEEDED:
            raise
        raise SceneError(
            f"the HTML report needs {library}, which is not installed: pip install 'msbvh[accuracy]'"
        ) from None


def write_report(data: dict[str, Any], folder: Path) -> Path:
    """Writes `folder`/report.html from the data of accuracy.json, and returns its path.

    Pictures are PNG files at paths relative to `folder`; those that are not there are left out, and the report says so.
    Raises SceneError where matplotlib or Jinja2 is not installed, OutputError where the file cannot be written.
    """
    check_libraries()
    from .page import page

    path = folder / "report.html"
    write_whole(path, page(data, folder).encode("utf-8"))
    return path
