"""How finely surfaces have to be cut to stay within an error in pixels: tried out on the frame itself."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

from pxr import Usd, UsdGeom

from .._core import EDGE_LENGTHS, SILHOUETTES
from ..scene.reader import ReadResult, ReadSettings

READINGS = 4
"""At most; each takes as long as reading the frame does."""
LONGEST_EDGE = 8.0
SHORTEST_EDGE = 0.125
"""Pixels."""
COARSER_FROM = 0.5
"""Of what is allowed: an error below it lets edges be longer."""


class FineEnough:
    """Remembers what an earlier frame of the run was cut by: edges that still keep the error stay as they are, so that a
    surface is cut alike from frame to frame."""

    def __init__(self) -> None:
        self._edge: float | None = None

    def read(
        self, stage: Usd.Stage, read: Callable[[ReadSettings], ReadResult], settings: ReadSettings, pixels: float
    ) -> ReadResult:
        """As read_within(), beginning with the last frame's edges."""
        start = settings if self._edge is None else replace(settings, edge_length=self._edge)
        result, used = read_within(stage, read, start, pixels, may_be_longer=self._edge is None)
        self._edge = used.edge_length
        return result


def read_within(
    stage: Usd.Stage,
    read: Callable[[ReadSettings], ReadResult],
    settings: ReadSettings,
    pixels: float,
    may_be_longer: bool = True,
) -> tuple[ReadResult, ReadSettings]:
    """The frame, with the coarsest complexity whose shapes stray by so many pixels, and edges about as long as do; and the
    settings that it was read with. Where no length does, the best that was found: what its tracks say of it is for the caller
    to tell."""
    edge = settings.edge_length or EDGE_LENGTHS[settings.complexity] or EDGE_LENGTHS["medium"]
    fine = [name for name, strays in SILHOUETTES.items() if strays <= pixels]
    settings = replace(
        settings,
        motion_tolerance=pixels,
        measure_shape=True,
        complexity=max(fine, key=lambda name: SILHOUETTES[name]) if fine else "veryhigh",
    )
    best: tuple[float, ReadResult, ReadSettings] | None = None
    for _ in range(READINGS):
        used = replace(settings, edge_length=edge)
        result = read(used)
        error = _worst_by_edges(stage, result)
        rank = _rank(error, edge, pixels)
        if best is None or rank > best[0]:
            best = rank, result, used
        other = _next_edge(edge, error, pixels)
        if other is None or (other > edge and not may_be_longer):
            break
        edge = other
    assert best is not None
    return best[1], best[2]


def _worst_by_edges(stage: Usd.Stage, result: ReadResult) -> float:
    """The largest shape error that is known of any prim whose edges have a length, pixels: spheres and the like go by the
    complexity alone."""
    found = (track.shape_error_pixels or 0.0 for track in result.tracks if _has_edges(stage, track.path))
    return max(found, default=0.0)


def _has_edges(stage: Usd.Stage, path: str) -> bool:
    """Meshes and patches, and what instances them."""
    prim = stage.GetPrimAtPath(path) if path.startswith("/") else Usd.Prim()
    return bool(prim) and (prim.IsA(UsdGeom.PointBased) or not prim.IsA(UsdGeom.Gprim))


def _rank(error: float, edge: float, pixels: float) -> float:
    """Those that are fine enough by the length of their edges, above all others by their error."""
    return edge if error <= pixels else -error


def _next_edge(edge: float, error: float, pixels: float) -> float | None:
    """A surface strays with the square of its edges. None: this one will do."""
    if error == 0.0 or COARSER_FROM * pixels <= error <= pixels:
        return None
    wanted = min(max(float(f"{edge * math.sqrt(0.8 * pixels / error):.3g}"), SHORTEST_EDGE), LONGEST_EDGE)
    return None if math.isclose(wanted, edge, rel_tol=0.05) else wanted
