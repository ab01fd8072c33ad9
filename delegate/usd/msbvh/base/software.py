"""Who we are."""

from __future__ import annotations

from .. import _core


def software() -> str:
    """Name and version, as images and statistics carry it."""
    return f"msbvh {_core.__version__}"
