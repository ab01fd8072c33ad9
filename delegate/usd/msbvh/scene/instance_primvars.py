"""The primvars that a native instance hands on to its prototype, as far as materials in there read them."""

from __future__ import annotations

from functools import lru_cache

from pxr import Usd, UsdGeom, UsdShade

from ..look.networks import primvar_names
from ..motion.context import FrameContext
from .primvars import primvar_source

_OTHERS = ("primvars:displayColor", "primvars:displayOpacity", "primvars:skel:")
"""That are handed on in other ways."""


class InstancePrimvars:
    """Remembers what materials and prototypes read."""

    def __init__(self) -> None:
        self._of_materials: dict[str, frozenset[str]] = {}
        self._of_prototypes: dict[str, frozenset[str]] = {}

    def sources(
        self, instance: Usd.Prim, authored: frozenset[str], inherited: frozenset[str], context: FrameContext
    ) -> tuple[str, ...]:
        """The paths of the attributes that they come from. `authored`, `inherited`: names of properties that have opinions
        at the instance, and above. Nothing is looked through where there are no such primvars."""
        names = named_primvars(authored) | named_primvars(inherited)
        if not names:
            return ()
        read = self._read_by(instance, context) | self._read_in(instance.GetPrototype(), context)
        return tuple(primvar_source(instance, name) for name in sorted(read) if f"primvars:{name}" in names)

    def _read_in(self, prototype: Usd.Prim, context: FrameContext) -> frozenset[str]:
        path = str(prototype.GetPath())
        if path not in self._of_prototypes:
            found: set[str] = set()
            for prim in Usd.PrimRange(prototype, Usd.TraverseInstanceProxies(Usd.PrimDefaultPredicate)):
                if prim.IsA(UsdGeom.Gprim) or prim.IsA(UsdGeom.Subset):
                    found |= self._read_by(prim, context)
            self._of_prototypes[path] = frozenset(found)
        return self._of_prototypes[path]

    def _read_by(self, prim: Usd.Prim, context: FrameContext) -> frozenset[str]:
        """By the material that a prim is bound to."""
        material, _ = UsdShade.MaterialBindingAPI(prim).ComputeBoundMaterial(context.material_purpose)
        if not material:
            return frozenset()
        path = str(material.GetPath())
        if path not in self._of_materials:
            self._of_materials[path] = primvar_names(material, context)
        return self._of_materials[path]


@lru_cache(maxsize=4096)
def named_primvars(names: frozenset[str]) -> frozenset[str]:
    """Of the names of properties, those of primvars that only materials which ask for them read."""
    found = (name for name in names if name.startswith("primvars:") and not name.startswith(_OTHERS))
    return frozenset(name for name in found if not name.endswith(":indices"))
