"""Mesh prims and implicit prims as the translator's mesh keywords, all but their transform and material."""

from __future__ import annotations

import numpy as np
from pxr import Usd, UsdGeom

from .context import FrameContext, array
from .implicit import IMPLICIT_TYPES, ChooseSides, read_implicit
from .points import changes, rate_clock, raw_samples, sample_points
from .primvars import MovingPrimvar, sample_primvar


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
    if prim.IsA(UsdGeom.Mesh):
        mesh = _read_mesh(UsdGeom.Mesh(prim), context, velocity_scale, authored)
    else:
        mesh = read_implicit(prim, context, choose_sides)
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
    inherited = context.inherited.above(prim)
    for keyword, name, columns in (("display_color", "displayColor", 3), ("display_opacity", "displayOpacity", None)):
        has = f"primvars:{name}" in authored or f"primvars:{name}" in inherited
        mesh[keyword] = sample_primvar(prim, name, columns, context) if has else None
    if not prim.IsA(UsdGeom.Mesh):
        mesh["display_color"] = _constant(mesh["display_color"], "primvars:displayColor", path, context)
        mesh["display_opacity"] = _constant(mesh["display_opacity"], "primvars:displayOpacity", path, context)
    return mesh


def _read_mesh(
    mesh: UsdGeom.Mesh, context: FrameContext, velocity_scale: float, authored: frozenset[str]
) -> dict:
    code = context.code
    counts, indices = mesh.GetFaceVertexCountsAttr(), mesh.GetFaceVertexIndicesAttr()
    samples, carried_by = sample_points(mesh, context, "velocities" in authored)
    holes = array(mesh.GetHoleIndicesAttr().Get(code) if "holeIndices" in authored else None, np.int32)
    scheme = UsdGeom.Tokens.catmullClark
    if "subdivisionScheme" in authored:
        scheme = mesh.GetSubdivisionSchemeAttr().Get(code)
    keywords = {
        "face_vertex_counts": array(counts.Get(code), np.int32),
        "face_vertex_indices": array(indices.Get(code), np.int32),
        "hole_indices": holes if len(holes) else None,
        "left_handed": "orientation" in authored
        and mesh.GetOrientationAttr().Get(code) == UsdGeom.Tokens.leftHanded,
        "samples": samples,
        "topology_varies": changes(counts, context) or changes(indices, context),
        "computed_normals": "faceted" if scheme == UsdGeom.Tokens.none else "smooth",
        **carried_by,
        **rate_clock(context, velocity_scale),
    }
    if scheme == UsdGeom.Tokens.none:
        if not authored.isdisjoint(("normals", "primvars:normals")):
            keywords.update(_normals(mesh, context))
    else:
        message = (
            f"'{scheme}' is not supported yet; the control cage is drawn as polygons with smooth normals"
        )
        context.diagnostics.group(str(mesh.GetPath()), "subdivisionScheme", message)
    return keywords


def _normals(mesh: UsdGeom.Mesh, context: FrameContext) -> dict:
    """Authored normals: primvars:normals, which may be indexed, before normals (UsdGeomPointBased)."""
    primvar = UsdGeom.PrimvarsAPI(mesh).GetPrimvar("normals")
    indices = None
    if primvar and primvar.HasAuthoredValue():
        attribute, interpolation = primvar.GetAttr(), primvar.GetInterpolation()
        indices = array(primvar.GetIndices(context.code), np.int32) if primvar.IsIndexed() else None
    else:
        attribute, interpolation = mesh.GetNormalsAttr(), mesh.GetNormalsInterpolation()
    if not attribute.HasAuthoredValue():
        return {}
    samples = raw_samples(attribute, context)
    if not samples or not any(len(values) for _, values in samples):
        return {}
    return {
        "normals": samples,
        "normals_interpolation": str(interpolation),
        "normals_indices": indices,
    }


def _constant(
    primvar: MovingPrimvar | None, name: str, path: str, context: FrameContext
) -> MovingPrimvar | None:
    """An implicit shape has no vertices of its own that a primvar could vary over."""
    if primvar is None or primvar[0] == "constant":
        return primvar
    interpolation, values, indices = primvar
    samples = values if isinstance(values, list) else [(0.0, values)]
    count = len(samples[0][1])
    if count > 1:
        message = f"found {count} {interpolation} values on an implicit shape; drew the first"
        context.diagnostics.warning(path, name, message)
    first = [(time01, v[:1] if indices is None else v[indices[:1]]) for time01, v in samples]
    return "constant", first if isinstance(values, list) else first[0][1], None


def faces_by_subset(
    mesh: UsdGeom.Mesh, face_count: int, context: FrameContext
) -> tuple[list[Usd.Prim], np.ndarray]:
    """The subsets that bind materials of their own, and int32[face_count]: the number of the one that each face
    belongs to, -1 for none. A face of several belongs to the last one, which is said."""
    owners = np.full(face_count, -1, np.int32)
    subsets = UsdGeom.Subset.GetGeomSubsets(mesh, UsdGeom.Tokens.face, "materialBind")
    for number, subset in enumerate(subsets):
        faces = array(subset.GetIndicesAttr().Get(context.code), np.int32)
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
