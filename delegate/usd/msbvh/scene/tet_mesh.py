"""TetMesh prims as the triangles of their surface."""

from __future__ import annotations

import numpy as np
from pxr import Usd, UsdGeom

from ..motion.context import FrameContext, array
from ..stage.value_types import INT3S, INT4S
from ..stage.values import Unreadable, required


def surface_source(tets: UsdGeom.TetMesh, code: Usd.TimeCode, authored: frozenset[str]) -> Usd.Attribute:
    """The attribute that says what the surface is: its faces where they are authored, else the tetrahedra."""
    faces = tets.GetSurfaceFaceVertexIndicesAttr()
    named = "surfaceFaceVertexIndices" in authored and len(required(faces, code, INT3S) or ())
    return faces if named else tets.GetTetVertexIndicesAttr()


def surface_faces(tets: UsdGeom.TetMesh, source: Usd.Attribute, point_count: int, context: FrameContext) -> np.ndarray:
    """int32[F, 3]: from an attribute of surface_source(), the surface of tetrahedra by USD's own computation. Raises
    Unreadable for values of another type, and for tetrahedra of points that there are not."""
    code = context.code
    if source == tets.GetSurfaceFaceVertexIndicesAttr():
        return array(required(source, code, INT3S), np.int32, 3)
    elements = array(required(source, code, INT4S), np.int32, 4)
    bad = (elements < 0) | (elements >= point_count)
    if bad.any():
        number, corner = np.argwhere(bad)[0]
        expected = f"0 to {point_count - 1}" if point_count else "those of 0 points"
        found = f"element {number} has the point {elements[number, corner]}, expected {expected}"
        raise Unreadable(str(source.GetPrimPath()), source.GetName(), found)
    return array(UsdGeom.TetMesh.ComputeSurfaceFaces(tets, code), np.int32, 3)
