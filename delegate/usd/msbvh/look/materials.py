"""Materials: which one a prim is bound to, handed down once."""

from __future__ import annotations

from typing import Any

from pxr import Tf, Usd, UsdShade

from .._core import preview_surface
from ..motion.context import FrameContext
from ..stage.opening import tf_reason
from .networks import surface_network
from .texture_mean import texture_mean


class Materials:
    """Hands each material down once."""

    def __init__(self, translator: Any, context: FrameContext) -> None:
        self._translator = translator
        self._context = context
        self._ids: dict[str, int | None] = {}

    def bound_to(self, prim: Usd.Prim) -> int | None:
        """The translator's id of the material that a prim or subset is bound to; None: displayColor shows."""
        try:
            material, _ = UsdShade.MaterialBindingAPI(prim).ComputeBoundMaterial(UsdShade.Tokens.full)
            return self._id(material)
        except (Tf.ErrorException, UnicodeDecodeError) as error:
            message = f"USD cannot evaluate the material: {tf_reason(error)}; displayColor shows instead"
            self._context.diagnostics.warning(str(prim.GetPath()), "material:binding", message)
            return None

    def bound_to_each(self, prims: list[Usd.Prim]) -> list[int | None]:
        """Likewise of many prims, which is quicker together."""
        try:
            materials, _ = UsdShade.MaterialBindingAPI.ComputeBoundMaterials(prims, UsdShade.Tokens.full)
            return [self._id(material) for material in materials]
        except (Tf.ErrorException, UnicodeDecodeError):
            return [self.bound_to(prim) for prim in prims]

    def _id(self, material: UsdShade.Material) -> int | None:
        if not material:
            return None
        path = str(material.GetPath())
        if path not in self._ids:
            self._ids[path] = self._read(material)
        return self._ids[path]

    def _read(self, material: UsdShade.Material) -> int | None:
        surface, found = preview_surface(surface_network(material, self._context), texture_mean)
        self._context.diagnostics.take(found)
        return None if surface is None else self._translator.add_material(**surface)
