"""Materials: which one a prim is bound to, handed down once."""

from __future__ import annotations

from typing import Any

from pxr import Tf, Usd, UsdShade

from .._core import Displacement, SurfaceLook, displacement, preview_surface
from ..motion.context import FrameContext
from ..stage.opening import tf_reason
from ..stage.rendering_space import rendering_space
from .networks import surface_network
from .texture_channel import texture_channel
from .texture_files import locate


class Materials:
    """Hands each material down once."""

    def __init__(self, translator: Any, context: FrameContext, kept: tuple[str, ...] = ()) -> None:
        """`kept`: names of primvars that are handed down of every prim that has them."""
        self.kept = kept
        for name in kept:
            translator.keep_primvar(name)
        self._translator = translator
        self._context = context
        self._ids: dict[str, int | None] = {}
        self._displacements: dict[int, Displacement] = {}
        self._reads: dict[int, list[tuple[str, int]]] = {}

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

    @property
    def read_primvars(self) -> list[str]:
        """The names of all that those that have been handed down read to be shaded, and of what is kept."""
        return sorted({*self.kept, *(name for reads in self._reads.values() for name, _ in reads)})

    def reads(self, material: int | None) -> list[tuple[str, int]]:
        """The names of the primvars that a material reads to be shaded, and of how many numbers at least."""
        return [] if material is None else self._reads.get(material, [])

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
        surface, found = preview_surface(network, locate, rendering_space())
        displaced, found_too = displacement(network, texture_channel)
        self._context.diagnostics.take([*found, *found_too])
        if surface is None:
            if displaced is not None:
                message = "not drawn, since the material's surface is not"
                self._context.diagnostics.warning(network.path, "outputs:displacement", message)
            return None
        return self._hand_down(surface, displaced)

    def _hand_down(self, surface: SurfaceLook, displaced: Displacement | None) -> int:
        number: int = self._translator.add_material(surface, displaced)
        if displaced is not None:
            self._displacements[number] = displaced
        if surface.primvars:
            self._reads[number] = surface.primvars
        return number
