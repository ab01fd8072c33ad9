"""A setting of `msbvh record`, as options that a user can type."""

from __future__ import annotations

import shlex
from collections.abc import Mapping
from dataclasses import dataclass

Value = str | int | float


DEFAULTS: Mapping[str, Value] = {
    "builder": "msbvh",
    "curves": "ribbon",
    "displacement": "auto",
    "layout": "full",
    "outside-tolerance": 8.0,
    "sampler": "sobol",
    "split-budget": 1.0,
    "texture-rate": 1.0,
}
"""Of options that are not always spelt out."""


@dataclass(frozen=True)
class Options:
    """Options of `msbvh record` by name, without the dashes: {"spp": 16, "interpolation": "linear"}."""

    pairs: tuple[tuple[str, Value], ...] = ()
    """Sorted by name, each name once."""

    @staticmethod
    def of(values: Mapping[str, Value]) -> Options:
        return Options(tuple(sorted(values.items())))

    def get(self, name: str, otherwise: Value) -> Value:
        """An option's value, where it is given."""
        return self.plain().get(name, otherwise)

    def plain(self) -> dict[str, Value]:
        return dict(self.pairs)

    def over(self, base: Options) -> Options:
        """Base, with these in place of its own of the same names."""
        return Options.of({**base.plain(), **self.plain()})

    def without(self, *names: str) -> Options:
        return Options(tuple(pair for pair in self.pairs if pair[0] not in names))

    def beside(self, base: Options) -> Options:
        """Those that base does not have, or has otherwise."""
        return Options(tuple(pair for pair in self.pairs if pair not in base.pairs))

    def arguments(self) -> list[str]:
        """As `msbvh record` takes them."""
        return [text for name, value in self.pairs for text in (f"--{name}", f"{value}")]

    def text(self) -> str:
        return shlex.join(self.arguments())
