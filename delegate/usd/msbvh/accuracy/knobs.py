"""What a setting can be turned by: each knob with its range, the error that it trades for time, and whether a scene has any
use for it.

A module that brings a new knob adds a Knob to a list of its own (motion_knobs.py and its like) and the list to ALL in
all_knobs.py; the sweep, the front, the targets and the report take it from there.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

from .facts import SceneFacts
from .options import Options

Error = Literal["motion", "shape", "noise", "light", "look", "none"]
"""What a knob trades for time. motion: where things are at a ray's time. shape: how finely surfaces are cut. noise: what more
samples mend. light: what paths of a limited length leave out. look: none is wrong, they are
different pictures. none: the picture stays the same, only its cost changes."""

ERRORS: Mapping[Error, str] = {
    "motion": "motion model",
    "shape": "shape",
    "noise": "noise",
    "light": "path depth",
    "look": "look",
    "none": "none",
}


@dataclass(frozen=True)
class Step:
    """One position of a knob."""

    value: str
    """As reports show it."""
    options: Options


@dataclass(frozen=True)
class Knob:
    """A knob of the renderer."""

    name: str
    option: str
    """Of `msbvh record`, the one that matters most."""
    unit: str
    says: str
    """What it does, in a sentence."""
    error: Error
    steps: Callable[[SceneFacts, bool], Mapping[str, Sequence[Step]]]
    """Its positions by series, from cheap to dear; `True` asks for few of them. Empty: this scene has no use for it."""
    idle: Callable[[SceneFacts], str] = lambda _: ""
    """Why a scene has no use for it; empty: it has."""
    joint: bool = True
    """Whether the joint front combines its positions with those of other knobs."""


def steps_of(option: str, values: Sequence[str | int | float], **others: str | int | float) -> list[Step]:
    """Positions of one option, with others that go along with each."""
    return [Step(str(value), Options.of({option: value, **others})) for value in values]
