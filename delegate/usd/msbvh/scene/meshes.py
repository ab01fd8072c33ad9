"""Mesh prims and implicit prims as the translator takes them, all but their transform and material."""

from __future__ import annotations

import numpy as np
from pxr import Usd, UsdGeom

from .._core import MeshInput, binds_faces, face_owners
from ..motion.context import FrameContext, array
from ..motion.held_values import Stretch, warn_of_change
from ..motion.points import RawSamples, Samples, changes, rate_times, sample_points
from ..motion.visibility import common_intervals
from ..stage.value_types import INTS, TOKEN
from ..stage.values import might_vary, required, value
from .implicit import IMPLICIT_TYPES, ImplicitShape, read_implicit
from .normals import add_normals
from .nurbs_patch import NurbsShape, read_nurbs_patch
from .part import Part
from .primvars import constant_primvar, find_primvar, held_by, sample_primvar
from .round import read_round
from .stand_ins import StandIn, read_stand_in
from .subdivision import add_subdivision
from .tet_mesh import surface_faces, surface_source

PRIMVARS = (("display_color", "displayColor", 3), ("display_opacity", "displayOpacity", None))
"""The translator's name of each primvar, USD's, and how many columns it has."""


def has_own_points(prim: Usd.Prim) -> bool:
    """Whether a prim is drawn as a mesh of points that it has itself."""
    return any(prim.IsA(kind) for kind in (UsdGeom.Mesh, UsdGeom.TetMesh, UsdGeom.NurbsPatch))


def is_shape(prim: Usd.Prim) -> bool:
    """Whether a prim is drawn as a mesh."""
    return has_own_points(prim) or prim.GetTypeName() in IMPLICIT_TYPES


Form = Samples | ImplicitShape | NurbsShape | StandIn
"""The points of a mesh, or what has them and the topology."""


def read_shape(part: Part, context: FrameContext) -> tuple[MeshInput, Form] | None:
    """A mesh without its points, transform and material, and its points, or the shape that has them and the topology;
    None if there is nothing to draw.

    `context` has the prim's own shutter (FrameContext.scaled). Nothing is checked here that the translator checks.
    """
    prim = part.prim
    mesh = MeshInput()
    path = mesh.path = prim.GetPath().pathString
    shape = _read_form(mesh, part, context)
    if shape is None:
        return None
    if part.draw_mode:
        return mesh, shape
    for keyword, name, columns in PRIMVARS:
        if part.authors(f"primvars:{name}"):
            found = find_primvar(prim, name, columns, part.authored)
            primvar = sample_primvar(found, context) if found else None
            own = part.is_mesh or part.is_round
            setattr(mesh, keyword, primvar if own else constant_primvar(primvar, name, path, context))
    return mesh, shape


def _read_form(mesh: MeshInput, part: Part, context: FrameContext) -> Form | None:
    prim = part.prim
    if part.draw_mode:
        return read_stand_in(prim, part.draw_mode, context)
    if part.is_round:
        points = read_round(mesh, prim, context, part)
        if not any(len(values) for _, values in points.values):
            context.diagnostics.group(mesh.path, "", "empty: it has no points at this frame", "note")
            return None
        return points
    if not part.is_mesh:
        return read_implicit(prim, context)
    if prim.IsA(UsdGeom.NurbsPatch):
        return _read_nurbs_patch(mesh, prim, context, part)
    read = _read_mesh if prim.IsA(UsdGeom.Mesh) else _read_tet_mesh
    samples = read(mesh, prim, context, part)
    if not len(mesh.face_vertex_counts) and not any(len(points) for _, points in samples.values):
        context.diagnostics.group(mesh.path, "", "empty: it has neither faces nor points at this frame", "note")
        return None
    return samples


def _read_mesh(target: MeshInput, prim: Usd.Prim, context: FrameContext, part: Part) -> Samples:
    """Fills in the target. Returns the points."""
    mesh, code, authored = UsdGeom.Mesh(prim), context.code, part.authored
    counts, indices = mesh.GetFaceVertexCountsAttr(), mesh.GetFaceVertexIndicesAttr()
    samples = _read_points(target, mesh, context, part)
    target.face_vertex_counts = array(required(counts, code, INTS), np.int32)
    target.face_vertex_indices = array(required(indices, code, INTS), np.int32)
    if "holeIndices" in authored:
        target.hole_indices = _holes(mesh, code)
    target.topology_varies = changes(counts, context) or changes(indices, context)
    subdivided = add_subdivision(target, mesh, context, authored)
    target.computed_normals = "smooth" if subdivided else "faceted"
    if not subdivided:
        add_normals(target, mesh, context, authored)
    return samples


def _read_tet_mesh(target: MeshInput, prim: Usd.Prim, context: FrameContext, part: Part) -> Samples:
    """The same of the surface of a TetMesh."""
    mesh = UsdGeom.TetMesh(prim)
    samples = _read_points(target, mesh, context, part)
    source = surface_source(mesh, context.code, part.authored)
    faces = surface_faces(mesh, source, len(samples.at_frame(context)), context)
    target.face_vertex_counts = np.full(len(faces), 3, np.int32)
    target.face_vertex_indices = faces.ravel()
    target.indices_name = source.GetName()
    target.topology_varies = changes(source, context)
    add_normals(target, mesh, context, part.authored)
    return samples


def _read_nurbs_patch(target: MeshInput, prim: Usd.Prim, context: FrameContext, part: Part) -> NurbsShape | None:
    """Sets what carries the control points. The surface has normals of its own."""
    read = read_nurbs_patch(prim, context, part.authored)
    if read is None:
        return None
    shape, carried_by = read
    target.computed_normals = "smooth"
    _set_carriers(target, carried_by, UsdGeom.Gprim(prim), context, part)
    return shape


def _read_points(target: MeshInput, mesh: UsdGeom.PointBased, context: FrameContext, part: Part) -> Samples:
    """Sets what carries the points, and the orientation. Returns the points."""
    samples, carried_by = sample_points(mesh, context, "velocities" in part.authored)
    _set_carriers(target, carried_by, mesh, context, part)
    return samples


def _set_carriers(
    target: MeshInput, carried_by: dict[str, RawSamples], gprim: UsdGeom.Gprim, context: FrameContext, part: Part
) -> None:
    for name, given in {**carried_by, **rate_times(context, part.scales.velocity)}.items():
        setattr(target, name, given)
    if "orientation" in part.authored:
        target.left_handed = value(gprim.GetOrientationAttr(), context.code, TOKEN) == UsdGeom.Tokens.leftHanded


def _holes(mesh: UsdGeom.Mesh, code: Usd.TimeCode) -> np.ndarray | None:
    holes = array(value(mesh.GetHoleIndicesAttr(), code, INTS), np.int32)
    return holes if len(holes) else None


def held_attributes(part: Part, mesh: MeshInput, context: FrameContext) -> list[Usd.Attribute]:
    """What holds until its next sample, changes within the shutter, and says which faces are drawn and how: held_at()
    reads it. Where the topology changes, the frame's stands for all of the shutter, and so does what counts its faces.
    `context` has the prim's own shutter.
    """
    if not context.shutter.moving or part.draw_mode:
        return []
    held: list[Usd.Attribute] = []
    for keyword, name, columns in PRIMVARS:
        primvar = getattr(mesh, keyword)
        # A mesh says itself whether its primvar is indexed, which most are not.
        if primvar is not None and (context.held or primvar[2] is not None or not (part.is_mesh or part.is_round)):
            found = find_primvar(part.prim, name, columns, part.authored)
            held += held_by(found, context) if found else []
    if part.is_mesh:
        held += _held_by_faces(part, mesh)
    held = [attribute for attribute in held if might_vary(attribute)]
    if not mesh.topology_varies:
        return held
    for attribute in held:
        warn_of_change(attribute, ", as its topology", context.shutter, context.diagnostics)
    return []


def _held_by_faces(part: Part, read: MeshInput) -> list[Usd.Attribute]:
    if not part.has_children and read.normals_indices is None and "holeIndices" not in part.authored:
        return []
    mesh = UsdGeom.Imageable(part.prim)
    subsets = UsdGeom.Subset.GetGeomSubsets(mesh, UsdGeom.Tokens.face, "materialBind") if part.has_children else []
    attributes = [subset.GetIndicesAttr() for subset in subsets]
    if "holeIndices" in part.authored:
        attributes.append(part.prim.GetAttribute("holeIndices"))
    if read.normals_indices is not None:
        attributes.append(UsdGeom.PrimvarsAPI(mesh).GetPrimvar("normals").GetIndicesAttr())
    return attributes


def held_at(part: Part, whole: MeshInput, stretch: Stretch, context: FrameContext) -> MeshInput:
    """A shape over a part of the shutter."""
    prim, mesh = part.prim, whole.copy()
    mesh.visible = common_intervals(whole.visible, stretch.shown)
    for keyword, name, columns in PRIMVARS:
        if getattr(whole, keyword) is not None:
            found = find_primvar(prim, name, columns, part.authored)
            primvar = sample_primvar(found, context, stretch) if found else None
            own = part.is_mesh or part.is_round
            setattr(mesh, keyword, primvar if own else constant_primvar(primvar, name, whole.path, context))
    if prim.IsA(UsdGeom.Mesh):
        mesh.hole_indices = _holes(UsdGeom.Mesh(prim), stretch.code)
    if whole.normals_indices is not None:
        indices = value(UsdGeom.PrimvarsAPI(prim).GetPrimvar("normals").GetIndicesAttr(), stretch.code, INTS)
        mesh.normals_indices = array(indices, np.int32)
    return mesh


def _binds_faces(subset: UsdGeom.Subset) -> bool:
    code = Usd.TimeCode.Default()
    element, family = subset.GetElementTypeAttr(), subset.GetFamilyNameAttr()
    return binds_faces(value(element, code, TOKEN) or "", value(family, code, TOKEN) or "")


def faces_by_subset(
    mesh: UsdGeom.Imageable, face_count: int, context: FrameContext
) -> tuple[list[Usd.Prim], np.ndarray]:
    """The subsets that bind materials of their own, and int32[face_count]: the number of the one that each face
    belongs to, -1 for none."""
    subsets = [each for each in UsdGeom.Subset.GetAllGeomSubsets(mesh) if _binds_faces(each)]
    indices = [array(value(each.GetIndicesAttr(), context.code, INTS), np.int32) for each in subsets]
    paths = [str(each.GetPath()) for each in subsets]
    owners, said = face_owners(list(zip(paths, indices, strict=True)), face_count)
    context.diagnostics.take(said)
    return [subset.GetPrim() for subset in subsets], owners
