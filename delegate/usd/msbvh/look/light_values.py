"""What a light gives over the shutter: radiance and sizes, at the times that say all about them."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from pxr import Usd, UsdGeom, UsdLux

from .._core import BEFORE_JUMP01, FINEST_LEVEL, light_emission, light_radiances
from ..motion.times import Shutter, breakpoints_of
from ..stage.value_types import BOOL, FLOAT, FLOAT3, TOKEN, Kind
from ..stage.values import Unreadable, might_vary, required, value

SIZES = {"angle": 0.53, "radius": 0.5, "width": 1.0, "height": 1.0}
"""Inputs by which lights differ in size, with the values of those that have none. Degrees and stage units."""

SMALLEST_SHARE = 1e-3
"""Of its largest value over the shutter: where a size passes 0, it is taken as that share of it. A light
without any size is another kind of light, whose radiance has another unit."""


def number(attribute: Usd.Attribute, code: Usd.TimeCode) -> float:
    """Raises Unreadable."""
    return float(_known(attribute, code, FLOAT))


def _known(attribute: Usd.Attribute, code: Usd.TimeCode, kind: Kind) -> Any:
    found = required(attribute, code, kind)
    if found is None:
        raise Unreadable(str(attribute.GetPrimPath()), attribute.GetName(), f"found no value, expected {kind.name}")
    return found


def emission(light: UsdLux.LightAPI, code: Usd.TimeCode) -> tuple[float, float, float]:
    """intensity * 2^exposure * color, times the black body's colour where enabled; infinite where it is too large,
    which the translator says. Raises Unreadable."""
    temperature = (1.0, 1.0, 1.0)
    if value(light.GetEnableColorTemperatureAttr(), code, BOOL):
        kelvin = number(light.GetColorTemperatureAttr(), code)
        if not math.isfinite(kelvin):  # usd-core 26.11 crashes on NaN.
            path, message = str(light.GetPath()), f"found {kelvin:g}, expected a finite number"
            raise Unreadable(path, light.GetColorTemperatureAttr().GetName(), message)
        temperature = tuple(UsdLux.BlackbodyTemperatureAsRgb(kelvin))
    intensity, exposure = number(light.GetIntensityAttr(), code), number(light.GetExposureAttr(), code)
    return light_emission(intensity, exposure, tuple(_known(light.GetColorAttr(), code, FLOAT3)), temperature)


@dataclass(frozen=True)
class LightSamples:
    """A light at T times of the shutter."""

    times01: np.ndarray
    """float64[T], increasing; one where nothing changes."""
    emission: np.ndarray
    """float64[T, 3], before normalisation; 0 while the light is invisible."""
    sizes: np.ndarray
    """float64[T, 4], in the order of SIZES."""
    normalize: np.ndarray
    """bool[T]: inputs:normalize."""

    @property
    def still(self) -> bool:
        """Whether nothing but the transform may change."""
        return len(self.times01) == 1

    def at(self, times01: list[float]) -> LightSamples:
        """A still one at more times, for what depends on its transform."""
        return replace(
            self,
            times01=np.array(times01),
            emission=np.repeat(self.emission, len(times01), axis=0),
            sizes=np.repeat(self.sizes, len(times01), axis=0),
            normalize=np.repeat(self.normalize, len(times01)),
        )


@dataclass(frozen=True)
class Switches:
    """What turns a light off for a part of the shutter."""

    visibility: tuple[Usd.Attribute, ...] = ()
    """Of the prim and its ancestors; one that says invisible will do."""
    shown: np.ndarray | None = None
    """float64[K, 2]: where its instances are visible (visible_intervals); None: always."""

    def ends(self, shutter: Shutter) -> set[float]:
        """Time codes at which instances appear or disappear."""
        if self.shown is None:
            return set()
        return {shutter.time_code(time01).GetValue() for time01 in self.shown.ravel().tolist() if 0.0 < time01 < 1.0}

    def on(self, time01: float, code: Usd.TimeCode) -> bool:
        """Whether the light shines."""
        if self.shown is not None and not ((self.shown[:, 0] <= time01) & (time01 < self.shown[:, 1])).any():
            return False
        return all(value(attribute, code, TOKEN) != UsdGeom.Tokens.invisible for attribute in self.visibility)


def sample_light(prim: Usd.Prim, switches: Switches, shutter: Shutter) -> tuple[LightSamples, LightSamples]:
    """The light over the shutter, and at the frame, where no switch counts. Raises Unreadable."""
    attributes = [*_value_attributes(prim), *switches.visibility]
    at_frame = _sampled(prim, Switches(), {0.0: shutter.frame_code})
    codes = _codes(attributes, switches.ends(shutter), shutter)
    samples = _sampled(prim, switches, codes) if codes else at_frame
    if codes and not all(np.isfinite(found).all() for found in (at_frame.emission, at_frame.sizes)):
        at_frame = _first(samples)  # The frame lies outside of the shutter, or the samples show the fault too.
    values = np.concatenate([samples.emission, samples.sizes, samples.normalize[:, None]], axis=1)
    if (values == values[0]).all():
        samples = _first(samples)
    return samples, at_frame


def _first(samples: LightSamples) -> LightSamples:
    return replace(
        samples,
        times01=samples.times01[:1],
        emission=samples.emission[:1],
        sizes=samples.sizes[:1],
        normalize=samples.normalize[:1],
    )


def _value_attributes(prim: Usd.Prim) -> list[Usd.Attribute]:
    light = UsdLux.LightAPI(prim)
    sizes = [prim.GetAttribute(f"inputs:{name}") for name in SIZES]
    return [
        light.GetIntensityAttr(),
        light.GetExposureAttr(),
        light.GetColorAttr(),
        light.GetEnableColorTemperatureAttr(),
        light.GetColorTemperatureAttr(),
        light.GetNormalizeAttr(),
        *(attribute for attribute in sizes if attribute),
    ]


def _codes(attributes: list[Usd.Attribute], switched: set[float], shutter: Shutter) -> dict[float, Usd.TimeCode]:
    """Where to sample: time01 to time code, increasing; empty where nothing varies. `switched` are time codes beside
    those that are authored.

    2^FINEST_LEVEL even intervals, which catch splines and products of what is linear, and the authored times
    inside the shutter with an instant before each, since values may jump there. The closing stands for the
    instant before it: what begins then is not seen.
    """
    varying = [attribute for attribute in attributes if might_vary(attribute)]
    if not shutter.moving or not (varying or switched):
        return {}
    even = np.linspace(0.0, 1.0, 2**FINEST_LEVEL + 1)
    authored = switched.union(*(breakpoints_of(attribute, shutter) for attribute in varying))
    codes = {1.0: shutter.time_code(1.0 - BEFORE_JUMP01)}
    for time in authored:
        time01 = shutter.time01(time)
        if time01 > 1.0 - BEFORE_JUMP01:
            continue
        codes[time01] = Usd.TimeCode(time)
        if time01 > BEFORE_JUMP01:
            codes[time01 - BEFORE_JUMP01] = shutter.time_code(time01 - BEFORE_JUMP01)
    known = np.array(sorted(codes))
    place = np.clip(np.searchsorted(known, even), 1, max(len(known) - 1, 1))
    nearest = known[[place - 1, np.minimum(place, len(known) - 1)]]
    for time01, distance in zip(even.tolist(), np.abs(nearest - even).min(axis=0).tolist(), strict=True):
        if distance > 1e-9:
            codes[time01] = shutter.time_code(time01)
    return dict(sorted(codes.items()))


def _sampled(prim: Usd.Prim, switches: Switches, codes: dict[float, Usd.TimeCode]) -> LightSamples:
    light = UsdLux.LightAPI(prim)
    visible = [switches.on(time01, code) for time01, code in codes.items()]
    glow = np.array([emission(light, code) for code in codes.values()])
    return LightSamples(
        times01=np.array(list(codes)),
        emission=np.where(np.array(visible)[:, None], glow, 0.0),
        sizes=_sizes(prim, list(codes.values())),
        normalize=np.array([bool(value(light.GetNormalizeAttr(), code, BOOL)) for code in codes.values()]),
    )


def _sizes(prim: Usd.Prim, codes: list[Usd.TimeCode]) -> np.ndarray:
    columns = []
    for name, default in SIZES.items():
        attribute = prim.GetAttribute(f"inputs:{name}")
        column = np.array([number(attribute, code) if attribute else default for code in codes])
        if (column == 0.0).any() and (column > 0.0).any():
            column = np.where(column == 0.0, SMALLEST_SHARE * np.nanmax(column), column)
        columns.append(column)
    return np.stack(columns, axis=1)


def radiances(kind: str, samples: LightSamples, world_from_light: np.ndarray) -> np.ndarray:
    """float64[T, 3]. `world_from_light` is float64[T, 4, 4]: normalisation is by the area in the world."""
    matrices = np.ascontiguousarray(world_from_light)
    return light_radiances(kind, samples.emission, samples.sizes, samples.normalize.tolist(), matrices)
