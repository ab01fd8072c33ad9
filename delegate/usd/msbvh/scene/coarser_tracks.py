"""What moves outside of the picture, where shadows and bounces alone show it, and takes fewer keys therefore."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from .. import _core


@dataclass(frozen=True)
class CoarserTracks:
    """Those of a frame that have fewer keys than the motion tolerance asks for."""

    prims: list[str]
    """Paths, in the order that they were read in."""
    tracks: int
    """One of each prim, or of each instance."""
    keys_saved: int
    """By all of these together."""


def coarser_tracks(tracks: Sequence[_core.TrackReport]) -> CoarserTracks:
    """`tracks`: of a finished scene, which leave out what no ray can reach."""
    coarser = [track for track in tracks if track.coarser]
    return CoarserTracks(
        prims=list(dict.fromkeys(track.path for track in coarser)),
        tracks=sum(track.coarser for track in coarser),
        keys_saved=sum(track.keys_saved for track in coarser),
    )
