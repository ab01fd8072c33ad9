"""A prim that a traversal has found something to draw at."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

from pxr import Usd

from ..motion.motion_scales import MotionScales


@dataclass(slots=True)
class Part:
    """A prim in a group. Never changed once it is made."""

    prim: Usd.Prim
    varying: bool
    """Whether a transform between the group's root and the prim, its own included, may change over time."""
    breakpoints: tuple[float, ...] = ()
    """Time codes inside the prim's shutter at which such a transform may change its course."""
    scales: MotionScales = MotionScales()
    blinking: tuple[Usd.Attribute, ...] = ()
    """Visibilities, likewise, that change inside the shutter."""
    authored: frozenset[str] = frozenset()
    """Names of the prim's own properties that have opinions: most of what may be there is not, and asking once
    is cheaper."""
    inherited: frozenset[str] = frozenset()
    """Names of primvars and material bindings that have opinions above the prim (inherited_names())."""
    is_mesh: bool = False
    """A shape of points that it has itself, such as a Mesh: not an implicit one."""
    has_children: bool = True
    is_round: bool = False
    """Curves or points."""
    draw_mode: str = ""
    """origin, bounds or cards in place of the prim and all below it; empty: it is drawn in full."""

    def authors(self, name: str) -> bool:
        """Whether a primvar is authored at the prim or above."""
        return name in self.authored or name in self.inherited

    @property
    def binds_material(self) -> bool:
        """Whether the prim may have a material."""
        return _binds_material(self.authored) or _binds_material(self.inherited)


@lru_cache(maxsize=4096)
def _binds_material(names: frozenset[str]) -> bool:
    """Most prims have the same few sets of names."""
    return any(name.startswith("material:binding") for name in names)
