"""Materials: which one a prim is bound to, handed down once."""

from __future__ import annotations

from typing import Any

from pxr import Tf, Usd, UsdShade

from .._core import Displacement, displacement, preview_surface
from ..motion.context import FrameContext
from ..stage.opening import tf_reason
from .networks import surface_network
from .texture_channel import texture_channel
from .texture_mean import texture_mean


class Materials:
    """Hands each material down once."""

    def __init__(self, translator: Any, context: FrameContext) -> None:
        self._translator = translator
        self._context = context
        self._ids: dict[str, int | None] = {}
        self._displacements: dict[int, Displacement] = {}

    def bound_to(self, prim: Usd.Prim) -> int | None:
        """The translator's id of the material that a prim or subset is bound to; None: displayColor shows."""
        try:
            material, _ = UsdShade.MaterialBindingAPI(prim).ComputeBoundMaterial(self._context.material_purpose)
            return self._id(material)
        except (Tf.ErrorException, UnicodeDecodeError) as error:
            message = f"USD cannot evaluate the material: {tf_reason(error)}; displayColor shows instead"
            self._context.diagnostics.warning(str(prim.GetPath()), "material:binding", message)
            return None

    def bound_to_each(self, prims: list[Usd.Prim]) -> list[int | None]:
        """Likewise of many prims, which is quicker together."""
        try:
            materials, _ = UsdShade.MaterialBindingAPI.ComputeBoundMaterials(prims, self._context.material_purpose)
            return [self._id(material) for material in materials]
        except (Tf.ErrorException, UnicodeDecodeError):
            return [self.bound_to(prim) for prim in prims]

    @property
    def displace(self) -> bool:
        """Whether one of them does."""
        return bool(self._displacements)

    def displacement(self, material: int | None) -> Displacement | None:
        """How a material displaces what is bound to it; None: not at all."""
        return None if material is None else self._displacements.get(material)

    def _id(self, material: UsdShade.Material) -> int | None:
        if not material:
            return None
        path = str(material.GetPath())
        if path not in self._ids:
            self._ids[path] = self._read(material)
        return self._ids[path]

    def _read(self, material: UsdShade.Material) -> int | None:
        network = surface_network(material, self._context)
        surface, found = preview_surface(network, texture_mean)
        displaced, found_too = displacement(network, texture_channel)
        self._context.diagnostics.take([*found, *found_too])
        if surface is None:
            if displaced is not None:
                message = "not drawn, since the material's surface is not"
                self._context.diagnostics.warning(network.path, "outputs:displacement", message)
            return None
        if displaced is None:
            return self._translator.add_material(**surface)
        number = self._translator.add_material(**surface, displacement=displaced)
        self._displacements[number] = displaced
        return number
