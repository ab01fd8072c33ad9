"""Mesh prims and implicit prims as the translator's mesh keywords, all but their transform and material."""

from __future__ import annotations

import numpy as np
from pxr import Usd, UsdGeom

from ..motion.context import FrameContext, array
from ..motion.held_values import Stretch, warn_of_change
from ..motion.points import changes, optional_samples, rate_times, sample_points
from ..motion.visibility import common_intervals
from ..stage.inherited import Inherited
from ..stage.value_types import INTS, TOKEN
from ..stage.values import might_vary, required, value
from .implicit import IMPLICIT_TYPES, ChooseSides, read_implicit
from .primvars import MovingPrimvar, held_by, sample_primvar

PRIMVARS = (("display_color", "displayColor", 3), ("display_opacity", "displayOpacity", None))
"""The translator's keyword of each primvar, its name, and how many columns it has."""


def is_shape(prim: Usd.Prim) -> bool:
    """Whether a prim is drawn as a mesh."""
    return prim.IsA(UsdGeom.Mesh) or prim.GetTypeName() in IMPLICIT_TYPES


def read_shape(
    prim: Usd.Prim,
    context: FrameContext,
    velocity_scale: float,
    authored: frozenset[str],
    choose_sides: ChooseSides,
) -> dict | None:
    """The translator's keywords of a mesh, without transform and material; None if there is nothing to draw.

    `context` has the prim's own shutter (FrameContext.scaled), `authored` are the names of its properties that
    have opinions. `points` stands as Samples under "samples". Nothing is checked here that the translator checks.
    """
    is_mesh = prim.IsA(UsdGeom.Mesh)
    mesh = (
        _read_mesh(UsdGeom.Mesh(prim), context, velocity_scale, authored)
        if is_mesh
        else read_implicit(prim, context, choose_sides)
    )
    if mesh is None:
        return None
    path = str(prim.GetPath())
    if not len(mesh["face_vertex_counts"]) and not any(len(points) for _, points in mesh["samples"].values):
        context.diagnostics.group(path, "", "empty: it has neither faces nor points at this frame", "note")
        return None
    mesh.setdefault("normals", None)
    mesh.setdefault("normals_interpolation", "vertex")
    mesh.setdefault("normals_indices", None)
    mesh["path"] = path
    inherited = context.cache(Inherited).above(prim)
    for keyword, name, columns in PRIMVARS:
        has = f"primvars:{name}" in authored or f"primvars:{name}" in inherited
        mesh[keyword] = sample_primvar(prim, name, columns, context) if has else None
        if not prim.IsA(UsdGeom.Mesh):
            mesh[keyword] = _constant(mesh[keyword], name, path, context)
    return mesh


def _read_mesh(mesh: UsdGeom.Mesh, context: FrameContext, velocity_scale: float, authored: frozenset[str]) -> dict:
    code = context.code
    counts, indices = mesh.GetFaceVertexCountsAttr(), mesh.GetFaceVertexIndicesAttr()
    samples, carried_by = sample_points(mesh, context, "velocities" in authored)
    holes = array(value(mesh.GetHoleIndicesAttr(), code, INTS) if "holeIndices" in authored else None, np.int32)
    scheme = UsdGeom.Tokens.catmullClark
    if "subdivisionScheme" in authored:
        scheme = value(mesh.GetSubdivisionSchemeAttr(), code, TOKEN) or scheme
    keywords = {
        "face_vertex_counts": array(required(counts, code, INTS), np.int32),
        "face_vertex_indices": array(required(indices, code, INTS), np.int32),
        "hole_indices": holes if len(holes) else None,
        "left_handed": "orientation" in authored
        and value(mesh.GetOrientationAttr(), code, TOKEN) == UsdGeom.Tokens.leftHanded,
        "samples": samples,
        "topology_varies": changes(counts, context) or changes(indices, context),
        "computed_normals": "faceted" if scheme == UsdGeom.Tokens.none else "smooth",
        **carried_by,
        **rate_times(context, velocity_scale),
    }
    if scheme == UsdGeom.Tokens.none:
        if not authored.isdisjoint(("normals", "primvars:normals")):
            keywords.update(_normals(mesh, context))
    else:
        message = f"'{scheme}' is not supported yet; the control cage is drawn as polygons with smooth normals"
        context.diagnostics.group(str(mesh.GetPath()), "subdivisionScheme", message)
    return keywords


def _normals(mesh: UsdGeom.Mesh, context: FrameContext) -> dict:
    """Authored normals: primvars:normals, which may be indexed, before normals (UsdGeomPointBased)."""
    primvar = UsdGeom.PrimvarsAPI(mesh).GetPrimvar("normals")
    indices = None
    if primvar and primvar.HasAuthoredValue():
        attribute, interpolation = primvar.GetAttr(), primvar.GetInterpolation()
        indices = array(value(primvar.GetIndicesAttr(), context.code, INTS), np.int32) if primvar.IsIndexed() else None
    else:
        attribute, interpolation = mesh.GetNormalsAttr(), mesh.GetNormalsInterpolation()
    if not attribute.HasAuthoredValue():
        return {}
    samples = optional_samples(attribute, context)
    if not samples or not any(len(values) for _, values in samples):
        return {}
    return {
        "normals": samples,
        "normals_interpolation": str(interpolation),
        "normals_indices": indices,
    }


def held_attributes(
    prim: Usd.Prim, keywords: dict, authored: frozenset[str], context: FrameContext
) -> list[Usd.Attribute]:
    """What holds until its next sample, changes within the shutter, and says which faces are drawn and how: held_at()
    reads it. Where the topology changes, the frame's stands for all of the shutter, and so does what counts its faces.
    `context` has the prim's own shutter.
    """
    if not context.shutter.moving:
        return []
    held: list[Usd.Attribute] = []
    for keyword, name, _ in PRIMVARS:
        primvar = keywords[keyword]
        # A mesh says itself whether its primvar is indexed, which most are not.
        if primvar is not None and (context.held or primvar[2] is not None or not prim.IsA(UsdGeom.Mesh)):
            held += held_by(prim, name, context)
    if prim.IsA(UsdGeom.Mesh):
        held += _held_by_faces(UsdGeom.Mesh(prim), keywords, authored)
    held = [attribute for attribute in held if might_vary(attribute)]
    if not keywords.get("topology_varies"):
        return held
    for attribute in held:
        warn_of_change(attribute, ", as its topology", context.shutter, context.diagnostics)
    return []


def _held_by_faces(mesh: UsdGeom.Mesh, keywords: dict, authored: frozenset[str]) -> list[Usd.Attribute]:
    subsets = UsdGeom.Subset.GetGeomSubsets(mesh, UsdGeom.Tokens.face, "materialBind")
    attributes = [subset.GetIndicesAttr() for subset in subsets]
    if "holeIndices" in authored:
        attributes.append(mesh.GetHoleIndicesAttr())
    if keywords["normals_indices"] is not None:
        attributes.append(UsdGeom.PrimvarsAPI(mesh).GetPrimvar("normals").GetIndicesAttr())
    return attributes


def held_at(prim: Usd.Prim, keywords: dict, stretch: Stretch, context: FrameContext) -> dict:
    """The translator's keywords of a shape over a part of the shutter."""
    changed: dict = {"visible": common_intervals(keywords["visible"], stretch.shown)}
    for keyword, name, columns in PRIMVARS:
        if keywords[keyword] is not None:
            primvar = sample_primvar(prim, name, columns, context, stretch)
            is_mesh = prim.IsA(UsdGeom.Mesh)
            changed[keyword] = primvar if is_mesh else _constant(primvar, name, keywords["path"], context)
    if prim.IsA(UsdGeom.Mesh):
        holes = array(value(UsdGeom.Mesh(prim).GetHoleIndicesAttr(), stretch.code, INTS), np.int32)
        changed["hole_indices"] = holes if len(holes) else None
    if keywords["normals_indices"] is not None:
        indices = value(UsdGeom.PrimvarsAPI(prim).GetPrimvar("normals").GetIndicesAttr(), stretch.code, INTS)
        changed["normals_indices"] = array(indices, np.int32)
    return {**keywords, **changed}


def _constant(primvar: MovingPrimvar | None, name: str, path: str, context: FrameContext) -> MovingPrimvar | None:
    """An implicit shape has no vertices of its own that a primvar could vary over."""
    if primvar is None or primvar[0] == "constant":
        return primvar
    interpolation, values, indices = primvar
    samples = values if isinstance(values, list) else [(0.0, values)]
    count = len(samples[0][1])
    if count > 1:
        message = f"found {count} {interpolation} values on an implicit shape; drew the first"
        context.diagnostics.warning(path, f"primvars:{name}", message)
    first = [(time01, v[:1] if indices is None else v[indices[:1]]) for time01, v in samples]
    return "constant", first if isinstance(values, list) else first[0][1], None


def _binds_faces(subset: UsdGeom.Subset) -> bool:
    """Whether a subset's faces may have a material of their own."""
    code = Usd.TimeCode.Default()
    element = value(subset.GetElementTypeAttr(), code, TOKEN) or UsdGeom.Tokens.face
    return element == UsdGeom.Tokens.face and value(subset.GetFamilyNameAttr(), code, TOKEN) == "materialBind"


def faces_by_subset(mesh: UsdGeom.Mesh, face_count: int, context: FrameContext) -> tuple[list[Usd.Prim], np.ndarray]:
    """The subsets that bind materials of their own, and int32[face_count]: the number of the one that each face
    belongs to, -1 for none. A face of several belongs to the last one, which is said."""
    owners = np.full(face_count, -1, np.int32)
    subsets = [each for each in UsdGeom.Subset.GetAllGeomSubsets(mesh) if _binds_faces(each)]
    for number, subset in enumerate(subsets):
        faces = array(value(subset.GetIndicesAttr(), context.code, INTS), np.int32)
        inside = faces[(faces >= 0) & (faces < face_count)]
        if len(inside) < len(faces):
            message = f"found {len(faces) - len(inside)} indices outside 0 to {face_count - 1}; left out"
            context.diagnostics.warning(str(subset.GetPath()), "indices", message)
        taken = np.unique(inside[owners[inside] >= 0])
        if len(taken):
            message = (
                f"found {len(taken)} faces that an earlier subset has too, expected each face in one subset; took this"
                " one's material"
            )
            context.diagnostics.warning(str(subset.GetPath()), "indices", message)
        owners[inside] = number
    return [subset.GetPrim() for subset in subsets], owners
