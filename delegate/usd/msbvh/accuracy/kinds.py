"""The kinds of error: what is set to its finest to be rid of one, and so to see it alone."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from .facts import SceneFacts
from .knobs import Error
from .motion_knobs import DENSE_TOLERANCE
from .options import Options
from .sampling_knobs import MOST_BOUNCES
from .shape_knobs import FINEST_COMPLEXITY

REFERENCE_EDGE = 0.25
"""Pixels: half of the finest edge that is swept."""

DECIDED_BY: Mapping[Error, tuple[str, ...]] = {
    "motion": ("motion-tolerance", "outside-tolerance", "segments", "interpolation"),
    "shape": ("edge-length", "complexity", "displacement"),
    "light": ("max-bounces",),
}
"""Options by the error that they decide."""
FINEST: Mapping[Error, Options] = {
    "motion": Options.of({"motion-tolerance": DENSE_TOLERANCE, "outside-tolerance": 1.0}),
    "shape": Options.of({"edge-length": REFERENCE_EDGE, "complexity": FINEST_COMPLEXITY}),
    "light": Options.of({"max-bounces": MOST_BOUNCES}),
}


def kinds_in(facts: SceneFacts) -> list[Error]:
    """Those that a scene can have at all, beside noise."""
    found: dict[Error, bool] = {
        "motion": facts.moves,
        "shape": facts.cut or facts.has("subdivision") or facts.has("displacement"),
        "light": facts.has("indirect light"),
    }
    return [kind for kind, has in found.items() if has]


def rid_of(kind: Error, options: Options) -> Options:
    """The same without one error."""
    return FINEST[kind].over(options.without(*DECIDED_BY[kind]))


def finest(facts: SceneFacts, options: Options) -> Options:
    """The same without any error but noise."""
    for kind in kinds_in(facts):
        options = rid_of(kind, options)
    return options


def motion_pixels(tracks: Any) -> float:
    """The largest deviation from the stage's motion of any prim in the picture."""
    return max((track["error_pixels"] for track in tracks if not track["error_outside"]), default=0.0)
