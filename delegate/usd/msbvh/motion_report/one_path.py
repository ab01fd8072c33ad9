"""The tracks of one path as one: instances that take different numbers of keys, a mesh that is itself an instance, and a crowd's
first prim, whose path is that of the shape as well."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any


def worst_track(tracks: Sequence[Any]) -> Any:
    """The one whose error counts most: what misses its tolerance before what does not, and what is seen before what is outside
    of the picture, as in TrackReport. What stands still says nothing where another moves."""
    return max([track for track in tracks if not _stands_still(track)] or tracks, key=_weight)


def instance_count(tracks: Sequence[Any]) -> int:
    """Of all together; 1 of what no instances place."""
    return sum(track.count for track in tracks) or 1


def _stands_still(track: Any) -> bool:
    return bool(track.segments == 0 and track.error_pixels == 0.0)


def _weight(track: Any) -> tuple[bool, bool, float]:
    share = track.error_pixels / track.tolerance_pixels
    return not share <= 1.0, not track.error_outside, share
