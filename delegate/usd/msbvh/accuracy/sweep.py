"""What a report measures: each knob turned with the others held, and settings that have a name."""

from __future__ import annotations

import fnmatch
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from .facts import SceneFacts
from .kinds import kinds_in, rid_of
from .knobs import Knob, Step
from .options import DEFAULTS, Options


@dataclass(frozen=True)
class Axis:
    """A knob and its positions on one scene, with all options spelt out."""

    knob: Knob
    series: Mapping[str, Sequence[Step]]
    left_out: str = ""
    """Why there are none."""

    def steps(self) -> Iterator[Step]:
        for steps in self.series.values():
            yield from steps


@dataclass(frozen=True)
class Named:
    """Settings with a name."""

    name: str
    says: str
    options: Options


def axes(knobs: Sequence[Knob], facts: SceneFacts, base: Options, few: bool, globs: Sequence[str]) -> list[Axis]:
    """Of the knobs whose option matches one of the globs."""
    return [
        _axis(knob, facts, base, few) for knob in knobs if any(fnmatch.fnmatch(knob.option, glob) for glob in globs)
    ]


def _axis(knob: Knob, facts: SceneFacts, base: Options, few: bool) -> Axis:
    if why := knob.idle(facts):
        return Axis(knob, {}, why)
    held = base.without("segments") if knob.option == "motion-tolerance" else base
    series = {
        name: [Step(step.value, _without_defaults(step.options, base).over(held)) for step in steps]
        for name, steps in knob.steps(facts, few).items()
    }
    return Axis(knob, series)


def _without_defaults(options: Options, base: Options) -> Options:
    """Without what `record` does anyway, so that the same settings are the same point."""
    pairs = options.plain().items()
    return Options.of({name: value for name, value in pairs if name in base.plain() or DEFAULTS.get(name) != value})


def named(base: Options, facts: SceneFacts) -> list[Named]:
    """The base settings beside the habits of other renderers."""
    ours = Named("ours", "the base settings: each prim on the cheapest track within the tolerance", base)
    if not facts.moves:
        return [ours]
    habits = (
        (
            "2 keys everywhere",
            "what most renderers do by default: straight lines from the shutter's opening to its closing",
            1,
        ),
        ("Arnold-like 3 keys", "three evenly spaced keys with straight lines between them", 2),
    )
    motion = base.without("segments", "interpolation")
    return [ours] + [
        Named(name, says, Options.of({"segments": segments, "interpolation": "linear"}).over(motion))
        for name, says, segments in habits
    ]


@dataclass(frozen=True)
class Partners:
    """Settings without one kind of error: beside them that kind is seen alone."""

    facts: SceneFacts

    def of_axis(self, axis: Axis) -> Mapping[Options, Options]:
        """Of an axis's positions, for the error that its knob trades."""
        if axis.knob.error not in kinds_in(self.facts):
            return {}
        return {step.options: rid_of(axis.knob.error, step.options) for step in axis.steps()}
