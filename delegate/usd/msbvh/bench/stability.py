"""The stability bench: rays from inside of closed moving shapes, of which none may get out, and into tubes and spheres,
which must stop them, by us and by Embree.

Shapes, motions, keys and places are those of bench/stability_cells.h; every side gets the same rays.
"""

from __future__ import annotations

import fnmatch
import json
import os
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from .. import _core
from ..base.errors import SceneError
from .rays import find_peer, host

Row = dict[str, Any]

QUICK_MOTIONS = ("flight", "inversion", "slivers at the centre")
QUICK_FORMS = ((1, 1), (128, 1), (2, 3))
"""(segments, degree)."""
QUICK_PLACES = ((0.0, 1e-6), (1e4, 1.0), (1e7, 1e3))
"""(position, scale)."""


@dataclass(frozen=True)
class StabilitySettings:
    """What is tried, and by how many rays."""

    scenes: Sequence[str] = ("*",)
    """Globs of shapes, or of shapes and numbers of keys: `ball`, `ball-129`."""
    peer: str | None = None
    quick: bool = False
    """Three motions, three tracks, three places and few rays."""
    seed: int = 1

    @property
    def rays(self) -> int:
        """About so many a row; of the ball of 39600 triangles ten times as many."""
        return 3_000 if self.quick else 5_000

    @property
    def oracle_tests(self) -> float:
        """Primitives that the oracle tests for a row, a side and an instruction set of ours."""
        return 1e5 if self.quick else 5e5


def cells(settings: StabilitySettings) -> list[_core.StabilityCell]:
    """What is tried, in order. Raises SceneError for none."""
    found = [cell for cell in _core.stability_cells() if _wanted(cell, settings)]
    if not found:
        known = ", ".join(_core.stability_shapes())
        raise SceneError(f"--scenes {','.join(settings.scenes)}: matches nothing; expected globs of {known}")
    return found


def _wanted(cell: _core.StabilityCell, settings: StabilitySettings) -> bool:
    shape, motion, segments, degree, *place = cell
    names = (shape, f"{shape}-{segments + 1}")
    if not any(fnmatch.fnmatchcase(name, pattern) for pattern in settings.scenes for name in names):
        return False
    if not settings.quick:
        return True
    return motion in QUICK_MOTIONS and (segments, degree) in QUICK_FORMS and tuple(place) in QUICK_PLACES


def run(
    settings: StabilitySettings, progress: Callable[[float], object], note: Callable[[str], None]
) -> dict[str, Any]:
    """Measures; {"machine": ..., "rows": [...]}. `note` hears that our column stands alone. Raises SceneError where the
    peer that is asked for is not there."""
    load, begin = os.getloadavg()[0], time.monotonic()
    every = cells(settings)
    peer = find_peer(settings.peer) if settings.peer else None
    if peer is None:
        note("bench: no peer beside us: Embree is measured with --peer embree (pip install embreex==4.4.*)")
    about = {**host(), "peer": peer.name if peer else None, "seed": settings.seed, "quick": settings.quick}
    library, folder = (str(peer.library), str(peer.folder)) if peer else ("", "")
    rows: list[Row] = []
    for done, cell in enumerate(every):
        progress(done / len(every))
        row = _core.stability_run(
            cell,
            rays=settings.rays,
            seed=settings.seed,
            oracle_tests=settings.oracle_tests,
            peer=library,
            peer_folder=folder,
        )
        rows.append(json.loads(row))
    progress(1.0)
    what = {"scenes": list(settings.scenes), "rays": settings.rays}
    return {"machine": {**about, **what, "load_average": load, "seconds": time.monotonic() - begin}, "rows": rows}


def per_million(rows: Sequence[Row], figure: str, of: str = "rays") -> float | None:
    """Of all rays of the rows that have the figure; None where none has one, or no rays."""
    measured = [row for row in rows if row[figure] is not None]
    total = sum(row[of] for row in measured)
    return 1e6 * sum(row[figure] for row in measured) / total if total else None
