"""Portals: rectangles that say where to look for a dome's light, and change no more than the noise."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from pxr import Usd

from .._core import light_times01
from ..motion.context import FrameContext
from ..motion.transforms import Motion
from ..stage.value_types import FLOAT
from .light_look import input_at_frame


@dataclass(frozen=True)
class Portal:
    """A PortalLight, in each of its places."""

    prim: Usd.Prim
    motion: Motion


@dataclass(frozen=True)
class Portals:
    """Of a stage."""

    found: dict[str, list[Portal]]
    """By their paths; more than one where placements differ."""
    used: set[str]
    """Paths that some dome names."""

    def of(self, dome: Usd.Prim, context: FrameContext) -> list[Portal]:
        """Those that guide a light; none for one that is no dome."""
        guides: list[Portal] = []
        for path in portal_targets(dome):
            if path not in self.found:
                message = f"found {path}, expected a PortalLight; ignored"
                context.diagnostics.warning(str(dome.GetPath()), "portals", message)
            guides.extend(self.found.get(path, []))
        return guides


def portal_targets(prim: Usd.Prim) -> list[str]:
    """Paths that a dome names; none of another light."""
    if prim.GetTypeName() not in ("DomeLight", "DomeLight_1"):
        return []
    return [str(path) for path in prim.GetRelationship("portals").GetForwardedTargets()]


def placed_portals(
    portals: Sequence[Portal], context: FrameContext
) -> list[tuple[float, float, np.ndarray, np.ndarray]]:
    """As Translator.add_light takes them: width and height at the frame, times, float64[T, 4, 4]."""
    found = []
    for portal in portals:
        width, height = (float(input_at_frame(portal.prim, name, FLOAT, 1.0, context)) for name in ("width", "height"))
        times01 = np.array(light_times01(portal.motion, context.held))
        places = portal.motion.at_times(times01.tolist())
        for index in range(portal.motion.count):
            found.append((width, height, times01, np.ascontiguousarray(places[:, index])))
    return found
