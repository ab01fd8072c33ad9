"""What every part of the reader needs to know about the frame."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, TypeVar

import numpy as np
from pxr import Usd

from ..base.errors import Diagnostics
from ..stage.stage_metadata import time_codes_per_second
from .samples import SampleLog
from .times import Shutter

T = TypeVar("T")


@dataclass(frozen=True)
class FrameContext:
    """One frame of one stage."""

    stage: Usd.Stage
    shutter: Shutter
    held: bool
    """The stage's values jump from sample to sample."""
    diagnostics: Diagnostics
    purposes: tuple[str, ...] = ("default",)
    """That are drawn."""
    found: SampleLog | None = None
    """Where the reader notes what moves each prim; None: nobody asks."""
    material_purpose: str = "full"
    """Which material bindings count before those for all purposes."""
    caches: dict[type, Any] = field(default_factory=dict)
    """See cache()."""

    def cache(self, kind: type[T]) -> T:
        """The frame's one instance of a class that remembers what prims share; made when first asked for."""
        if kind not in self.caches:
            self.caches[kind] = kind()
        return self.caches[kind]

    @cached_property
    def seconds_per_shutter(self) -> float:
        """By timeCodesPerSecond, not framesPerSecond."""
        return (self.shutter.close - self.shutter.open) / time_codes_per_second(self.stage)

    def scaled(self, blur: float) -> FrameContext:
        """The context of a prim with that motion:blurScale."""
        return self if blur == 1.0 else replace(self, shutter=self.shutter.scaled(blur))

    def at(self, code: Usd.TimeCode) -> FrameContext:
        """The context to read still things in at another time."""
        return replace(self, shutter=Shutter(None if code.IsDefault() else code.GetValue()))

    @cached_property
    def code(self) -> Usd.TimeCode:
        """The frame's time: where everything is read that is not sampled over the shutter."""
        return self.shutter.frame_code


def array(value: Any, dtype: type, columns: int | None = None) -> np.ndarray:
    """A Vt array as numpy array without a copy where the type allows it: dtype[N] or dtype[N, columns].

    None, what USD gives where no value is authored, becomes an empty array.
    """
    shape = (-1,) if columns is None else (-1, columns)
    if value is None or len(value) == 0:
        return np.zeros((0,) if columns is None else (0, columns), dtype)
    return np.ascontiguousarray(value, dtype=dtype).reshape(shape)
