"""The primvars that the materials of a prim read by their names, to shade it and to displace it."""

from __future__ import annotations

import numpy as np
from pxr import Usd

from .._core import MeshInput
from ..look.materials import Materials
from ..motion.context import FrameContext
from .part import Part
from .primvars import FoundPrimvar, MovingPrimvar, constant_primvar, find_primvar, held_by, sample_primvar

_COLUMNS = {"Vec2": 2, "Vec3": 3, "Vec4": 4}
_SCALARS = frozenset(("float", "double", "GfHalf", "int", "unsigned int", "int64_t", "uint64_t", "unsigned char"))

FIBRE = "msbvh:fibre"
"""Of curves: whether they scatter light as hair does, which is for the translator to say."""


def add_material_primvars(
    mesh: MeshInput, part: Part, instead: str, materials: Materials, context: FrameContext
) -> None:
    """After the mesh's materials. `instead`: what the prim is if it is nothing that can be displaced, and stays as it
    is, with a warning. Nothing is read that no material asks for."""
    own = set() if mesh.material is None else {mesh.material}
    numbers = own if mesh.face_materials is None else set(np.unique(mesh.face_materials).tolist())
    displaced = [each for number in numbers if (each := materials.displacement(number)) is not None]
    needed: dict[str, int] = {}
    for name, width in (each for number in numbers for each in materials.reads(number)):
        needed[name] = max(width, needed.get(name, 0))
    if mesh.round == "curves" and part.authors(f"primvars:{FIBRE}"):
        needed[FIBRE] = 1
    if displaced and instead:
        leave_undisplaced(str(part.prim.GetPath()), context, instead)
        mesh.displaced = False
        displaced = []
    for name in materials.kept:
        if part.authors(f"primvars:{name}"):
            needed.setdefault(name, 2)
    primvars: dict[str, MovingPrimvar] = {}
    for each in displaced:
        if each.primvar and each.primvar not in primvars:
            _add(primvars, part, each.primvar, each.primvar_width, context, "displaced")
    for name, width in sorted(needed.items()):
        if name not in primvars:
            _add(primvars, part, name, width, context, "")
    mesh.named_primvars = primvars or None


def leave_undisplaced(path: str, context: FrameContext, what: str = "an implicit shape") -> None:
    message = f"displacement of {what} is not supported; drawn without it"
    context.diagnostics.group(path, "material:binding", message)


def find_named(prim: Usd.Prim, name: str) -> FoundPrimvar | None:
    """A primvar of any type of one to four numbers, whose own it is or that is inherited; one of another type has 0
    columns."""
    found = find_primvar(prim, name, None)
    if found is not None:
        scalar = str(found.attribute.GetTypeName().scalarType.cppTypeName)
        found.columns = None if scalar in _SCALARS else _COLUMNS.get(scalar.removeprefix("Gf")[:4], 0)
    return found


def padded(values: np.ndarray) -> np.ndarray:
    """float32[K, 3]: the first three numbers, the rest 0."""
    result = np.zeros((len(values), 3), np.float32)
    columns = values.reshape(len(values), -1)[:, :3]
    result[:, : columns.shape[1]] = columns
    return result


def _add(
    primvars: dict[str, MovingPrimvar], part: Part, name: str, width: int, context: FrameContext, done: str
) -> None:
    """`done` with it: displaced, or nothing but shaded."""
    attribute, path = f"primvars:{name}", str(part.prim.GetPath())
    shaded = not done
    done = done or "drawn"
    if not shaded:
        found = find_primvar(part.prim, name, 2 if width == 2 else None)
    else:
        found = find_named(part.prim, name) if part.authors(attribute) else None
        if found is None:
            message = "is not there; drawn as what its reader falls back to, unless instances have their own"
            context.diagnostics.group(path, attribute, message, "note")
            return
    if found is not None and shaded and (found.columns == 0 or (found.columns or 1) < width):
        wanted = "a number" if width == 1 else f"{width} numbers"
        message = f"found {found.attribute.GetTypeName()}, expected {wanted}; {done} as what its reader falls back to"
        context.diagnostics.warning(path, attribute, message)
        return
    primvar = sample_primvar(found, context) if found else None
    if found is None or primvar is None:
        message = f"is not there, or empty; {done} by what its reader falls back to"
        context.diagnostics.warning(path, attribute, message)
        return
    if held_by(found, context):
        message = f"changes in steps within the shutter; {done} by the frame's values"
        context.diagnostics.warning(path, attribute, message)
    if not (part.is_mesh or part.is_round):
        primvar = constant_primvar(primvar, name, path, context) or primvar
    interpolation, values, indices = primvar
    if isinstance(values, list):
        primvars[name] = interpolation, [(time01, padded(v)) for time01, v in values], indices
    else:
        primvars[name] = interpolation, padded(values), indices
