"""What displaces a mesh beside its materials: the primvars that they read."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from pxr import Usd

from .._core import Displacement, MeshInput
from ..look.materials import Materials
from ..motion.context import FrameContext
from .primvars import MovingPrimvar, find_primvar, held_by, sample_primvar


def add_displacement(
    mesh: MeshInput, prim: Usd.Prim, instead: str, materials: Materials, context: FrameContext
) -> None:
    """After the mesh's materials. `instead`: what the prim is if it is no mesh, and stays as it is, with a warning."""
    if not materials.displace:
        return
    numbers = {mesh.material} if mesh.face_materials is None else set(np.unique(mesh.face_materials).tolist())
    found = [each for number in numbers if (each := materials.displacement(number)) is not None]
    if not found:
        return
    if instead:
        leave_undisplaced(str(prim.GetPath()), context, instead)
        mesh.displaced = False
        return
    mesh.named_primvars = _named_primvars(prim, found, context)


def leave_undisplaced(path: str, context: FrameContext, what: str = "an implicit shape") -> None:
    message = f"displacement of {what} is not supported; drawn without it"
    context.diagnostics.group(path, "material:binding", message)


def _named_primvars(
    prim: Usd.Prim, displacements: Iterable[Displacement], context: FrameContext
) -> dict[str, MovingPrimvar]:
    primvars: dict[str, MovingPrimvar] = {}
    for each in displacements:
        if not each.primvar or each.primvar in primvars:
            continue
        found = find_primvar(prim, each.primvar, 2 if each.primvar_width == 2 else None)
        primvar = sample_primvar(found, context) if found else None
        if found is None or primvar is None:
            message = "is not there, or empty; displaced by what its reader falls back to"
            context.diagnostics.warning(str(prim.GetPath()), f"primvars:{each.primvar}", message)
        else:
            if held_by(found, context):
                message = "changes in steps within the shutter; displaced by the frame's values"
                context.diagnostics.warning(str(prim.GetPath()), f"primvars:{each.primvar}", message)
            interpolation, values, indices = primvar
            if isinstance(values, list):
                primvars[each.primvar] = interpolation, [(time01, _padded(v)) for time01, v in values], indices
            else:
                primvars[each.primvar] = interpolation, _padded(values), indices
    return primvars


def _padded(values: np.ndarray) -> np.ndarray:
    """float32[K, 3], the rest 0."""
    result = np.zeros((len(values), 3), np.float32)
    columns = values.reshape(len(values), -1)
    result[:, : columns.shape[1]] = columns
    return result
