"""What a light says over the shutter, read at the times that the translator asks for."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from pxr import Usd, UsdGeom, UsdLux

from .._core import LIGHT_NUMBERS, LightSamples, SampledLight, light_emission, switch_times01, value_times
from ..motion.times import Shutter, breakpoints_of
from ..stage.rendering_space import rendered_color
from ..stage.value_types import BOOL, FLOAT, FLOAT3, TOKEN, Kind
from ..stage.values import Unreadable, might_vary, required, value

NUMBERS = LIGHT_NUMBERS


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
        temperature = _rgb(rendered_color(UsdLux.BlackbodyTemperatureAsRgb(kelvin), None))
    intensity, exposure = number(light.GetIntensityAttr(), code), number(light.GetExposureAttr(), code)
    color = rendered_color(_known(light.GetColorAttr(), code, FLOAT3), light.GetColorAttr())
    return light_emission(intensity, exposure, _rgb(color), temperature)


def _rgb(color: Sequence[float]) -> tuple[float, float, float]:
    red, green, blue = color
    return red, green, blue


@dataclass(frozen=True)
class Switches:
    """What turns a light off for a part of the shutter."""

    visibility: tuple[Usd.Attribute, ...] = ()
    """Of the prim and its ancestors; one that says invisible will do."""
    shown: np.ndarray | None = None
    """float64[K, 2]: where its instances are visible (visible_intervals); None: always."""

    def visible(self, code: Usd.TimeCode) -> bool:
        """What visibility says."""
        return all(value(attribute, code, TOKEN) != UsdGeom.Tokens.invisible for attribute in self.visibility)


def sample_light(prim: Usd.Prim, switches: Switches, shutter: Shutter) -> SampledLight:
    """The light over the shutter, and at the frame. Raises Unreadable."""
    at_frame = _read(prim, [0.0], [shutter.frame_code])
    attributes = [*_value_attributes(prim), *switches.visibility]
    varying = [attribute for attribute in attributes if might_vary(attribute)]
    switched01 = switch_times01(switches.shown)
    if not shutter.moving or not (varying or switched01):
        return SampledLight(at_frame)
    times01, codes = _times(varying, switched01, shutter)
    visible = [switches.visible(code) for code in codes]
    return SampledLight(at_frame, _read(prim, times01, codes), visible, switches.shown)


def _times(
    varying: list[Usd.Attribute], switched01: list[float], shutter: Shutter
) -> tuple[list[float], list[Usd.TimeCode]]:
    """Where the translator wants samples, and the time code that each is read at."""
    authored = sorted(set().union(*(breakpoints_of(attribute, shutter) for attribute in varying)))
    times = value_times([shutter.time01(time) for time in authored], switched01)
    codes = [
        shutter.time_code(time.read_at01) if time.authored is None else Usd.TimeCode(authored[time.authored])
        for time in times
    ]
    return [time.time01 for time in times], codes


def _value_attributes(prim: Usd.Prim) -> list[Usd.Attribute]:
    light = UsdLux.LightAPI(prim)
    numbers = [prim.GetAttribute(f"inputs:{name}") for name in NUMBERS]
    return [
        light.GetIntensityAttr(),
        light.GetExposureAttr(),
        light.GetColorAttr(),
        light.GetEnableColorTemperatureAttr(),
        light.GetColorTemperatureAttr(),
        light.GetNormalizeAttr(),
        *(attribute for attribute in numbers if attribute),
    ]


def _read(prim: Usd.Prim, times01: list[float], codes: list[Usd.TimeCode]) -> LightSamples:
    light = UsdLux.LightAPI(prim)
    return LightSamples(
        np.array(times01),
        np.array([emission(light, code) for code in codes]),
        np.stack([_number(prim, name, codes) for name in NUMBERS], axis=1),
        [bool(value(light.GetNormalizeAttr(), code, BOOL)) for code in codes],
    )


def _number(prim: Usd.Prim, name: str, codes: list[Usd.TimeCode]) -> list[float]:
    attribute = prim.GetAttribute(f"inputs:{name}")
    return [number(attribute, code) if attribute else NUMBERS[name] for code in codes]
