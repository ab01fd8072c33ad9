"""Knobs of the motion model: how far tracks may stray, and what they are made of."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from .facts import SceneFacts
from .knobs import Knob, Step, steps_of

TOLERANCES = (4.0, 2.0, 1.0, 0.5, 0.25, 0.1, 0.05, 0.025)
"""Pixels."""
OUTSIDE_TOLERANCES = (64.0, 32.0, 16.0, 8.0, 4.0, 2.0, 1.0)
"""Times the motion tolerance."""
ORDERS = ("linear", "quadratic", "cubic")
DENSE_TOLERANCE = 0.005
"""Pixels: stands for the stage's own evaluation."""


def _stands_still(facts: SceneFacts) -> str:
    return "" if facts.moves else "nothing moves within the shutter"


def _tolerances(facts: SceneFacts, few: bool) -> Mapping[str, Sequence[Step]]:
    return {"": steps_of("motion-tolerance", TOLERANCES[::3] if few else TOLERANCES)}


def _nothing_outside(facts: SceneFacts) -> str:
    return "" if facts.moves_outside else "nothing moves outside of the picture"


def _outside(facts: SceneFacts, few: bool) -> Mapping[str, Sequence[Step]]:
    return {"": steps_of("outside-tolerance", OUTSIDE_TOLERANCES[::2] if few else OUTSIDE_TOLERANCES)}


def _segments(facts: SceneFacts, few: bool) -> Mapping[str, Sequence[Step]]:
    counts = (1, 2, 8) if few else (1, 2, 4, 8, 16, 32, 64, 128)
    return {order: steps_of("segments", counts, interpolation=order) for order in ORDERS[: 2 if few else 3]}


MOTION_KNOBS = (
    Knob(
        name="Motion tolerance",
        option="motion-tolerance",
        unit="px",
        says="How far a moving point may stray from the stage's own motion. Each prim gets the cheapest track within it.",
        error="motion",
        steps=_tolerances,
        idle=_stands_still,
    ),
    Knob(
        name="Outside tolerance",
        option="outside-tolerance",
        unit="times",
        says="How many times as far prims may stray that move outside of the picture, where shadows and bounces alone show them.",
        error="motion",
        steps=_outside,
        idle=_nothing_outside,
        joint=False,
    ),
    Knob(
        name="Segments by order",
        option="segments",
        unit="segments",
        says="As many motion segments for whatever moves, linear, quadratic or cubic, whether it needs them or not.",
        error="motion",
        steps=_segments,
        idle=_stands_still,
        joint=False,
    ),
)
