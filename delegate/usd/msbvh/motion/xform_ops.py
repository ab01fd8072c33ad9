"""Transforms where ops cannot be evaluated: as UsdGeomXformable has them, and with a warning that names the op.

usd-core's own answer for such ops is the identity (a name without an attribute, a value of another type) or a matrix
too large to draw anything (the inverse of a singular one). From Python it raises an error in place of the answer. Its
caches hold the answer nevertheless.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from pxr import Gf, Tf, Usd, UsdGeom, Vt

from ..stage.values import diagnostics, raw, type_name

RESET = "!resetXformStack!"
INVERT = "!invert!"


def world_transform(cache: UsdGeom.XformCache, prim: Usd.Prim) -> Gf.Matrix4d:
    """cache.GetLocalToWorldTransform(), which raises once for a prim, and answers when it is asked again."""
    try:
        return cache.GetLocalToWorldTransform(prim)
    except Tf.ErrorException:
        _report_above(prim, cache.GetTime())
    return cache.GetLocalToWorldTransform(prim)


def world_transforms(cache: UsdGeom.XformCache, prims: Iterable[Usd.Prim]) -> np.ndarray:
    """The same of several prims, float64[N, 4, 4], without a call for each where all is well."""
    to_world, matrices = cache.GetLocalToWorldTransform, []
    for prim in prims:
        try:
            matrices.append(np.array(to_world(prim)))
        except Tf.ErrorException:
            _report_above(prim, cache.GetTime())
            matrices.append(np.array(to_world(prim)))
    return np.array(matrices)


def local_transform(cache: UsdGeom.XformCache, prim: Usd.Prim) -> Gf.Matrix4d:
    """cache.GetLocalTransformation()."""
    for _ in range(2):
        try:
            return cache.GetLocalTransformation(prim)[0]
        except Tf.ErrorException:
            report_ops(prim, cache.GetTime())
    return _product(prim, cache.GetTime())


def relative_transform(cache: UsdGeom.XformCache, prim: Usd.Prim, root: Usd.Prim) -> Gf.Matrix4d:
    """cache.ComputeRelativeTransform(): root_from_prim."""
    try:
        return cache.ComputeRelativeTransform(prim, root)[0]
    except Tf.ErrorException:
        matrix = Gf.Matrix4d(1.0)
        while prim and prim != root:
            matrix = matrix * local_transform(cache, prim)
            prim = prim.GetParent()
        return matrix


def ordered_ops(xformable: UsdGeom.Xformable) -> list[UsdGeom.XformOp]:
    """xformable.GetOrderedXformOps(), which leaves out names without an attribute but raises on some."""
    try:
        return xformable.GetOrderedXformOps()
    except Tf.ErrorException:
        ops: list[UsdGeom.XformOp] = []
        for name in _order(xformable.GetPrim()):
            op = None if name == RESET else _op(xformable.GetPrim(), name)
            ops = [] if name == RESET else [*ops, *([op] if op else [])]
        return ops


def resets(xformable: UsdGeom.Xformable) -> bool:
    """xformable.GetResetXformStack()."""
    try:
        return xformable.GetResetXformStack()
    except Tf.ErrorException:
        return RESET in _order(xformable.GetPrim())


def may_vary(xformable: UsdGeom.Xformable) -> bool:
    """xformable.TransformMightBeTimeVarying()."""
    try:
        return xformable.TransformMightBeTimeVarying()
    except Tf.ErrorException:
        return any(_may_vary(op) for op in ordered_ops(xformable))


def _may_vary(op: UsdGeom.XformOp) -> bool:
    """True for what USD cannot even count the samples of: whoever evaluates it finds out."""
    try:
        return op.MightBeTimeVarying()
    except Tf.ErrorException:
        return True


def _order(prim: Usd.Prim) -> list[str]:
    found = raw(prim.GetAttribute("xformOpOrder"), Usd.TimeCode.Default())
    return list(found) if isinstance(found, Vt.TokenArray) else []


def _op(prim: Usd.Prim, name: str) -> UsdGeom.XformOp | None:
    """None where the prim has no such op."""
    try:
        attribute = prim.GetAttribute(name.removeprefix(INVERT))
        return UsdGeom.XformOp(attribute, name.startswith(INVERT)) if attribute else None
    except Tf.ErrorException:
        return None


class Orders:
    """Checks prims' xformOpOrder. Most prims of a crowd have the order of the one before them."""

    def __init__(self) -> None:
        self._sound: object = None
        self._names: frozenset[str] = frozenset()

    def check(self, prim: Usd.Prim, authored: frozenset[str]) -> None:
        """Reports ops that USD passes over: an order of another type, names without an attribute. `authored` are the
        names of the prim's properties."""
        found = raw(prim.GetAttribute("xformOpOrder"), Usd.TimeCode.Default())
        if not isinstance(found, Vt.TokenArray):
            report_ops(prim, Usd.TimeCode.Default())
        elif self._names != authored or found != self._sound:
            if authored.issuperset(found) or all(_is_known(name, authored) for name in found):
                self._sound, self._names = found, authored
            else:
                report_ops(prim, Usd.TimeCode.Default())


def _is_known(name: str, authored: frozenset[str]) -> bool:
    return name in authored or name == RESET or name.removeprefix(INVERT) in authored


def _product(prim: Usd.Prim, code: Usd.TimeCode) -> Gf.Matrix4d:
    matrix = Gf.Matrix4d(1.0)
    for op in ordered_ops(UsdGeom.Xformable(prim)):
        matrix = _op_transform(op, code) * matrix
    return matrix


def _op_transform(op: UsdGeom.XformOp, code: Usd.TimeCode) -> Gf.Matrix4d:
    try:
        return op.GetOpTransform(code)
    except Tf.ErrorException:
        found = raw(op.GetAttr(), code)
        singular = op.IsInverseOp() and isinstance(found, Gf.Matrix4d)
        return found.GetInverse() if singular else Gf.Matrix4d(1.0)


def _report_above(prim: Usd.Prim, code: Usd.TimeCode) -> None:
    while prim and not prim.IsPseudoRoot():
        report_ops(prim, code)
        prim = prim.GetParent()


def report_ops(prim: Usd.Prim, code: Usd.TimeCode) -> None:
    """Names the ops of a prim that USD leaves out of its transform."""
    xformable = UsdGeom.Xformable(prim)
    if not xformable:
        return
    path = str(prim.GetPath())
    order = xformable.GetXformOpOrderAttr()
    found = raw(order, Usd.TimeCode.Default())
    if found is not None and not isinstance(found, Vt.TokenArray):
        message = f"found {type_name(order, found)}, expected token[]; no op applies, as USD has it"
        diagnostics().warning(path, "xformOpOrder", message)
        return
    for name in found or ():
        if name != RESET and not _op(prim, name):
            expected = "expected the name of one of the prim's xformOp attributes"
            message = f"found '{name}', {expected}; left out, as USD has it"
            diagnostics().warning(path, "xformOpOrder", message)
    for op in ordered_ops(xformable):
        _report_op(op, path, code)


def singular_op(xformable: UsdGeom.Xformable, code: Usd.TimeCode, largest: float) -> Usd.Attribute | None:
    """The attribute of the first op whose inverse is no usable matrix."""
    for op in ordered_ops(xformable):
        if op.IsInverseOp() and not (np.abs(np.array(_op_transform(op, code))) <= largest).all():
            return op.GetAttr()
    return None


def _expected(op: UsdGeom.XformOp) -> str:
    """The types that an op takes."""
    name = UsdGeom.XformOp.GetOpTypeToken(op.GetOpType())
    if name == "transform":
        return "matrix4d"
    if name == "orient":
        return "quatd, quatf or quath"
    single = name[-1] in "XYZ" and name[-2].islower()
    return "double, float or half" if single else "double3, float3 or half3"


def _report_op(op: UsdGeom.XformOp, path: str, code: Usd.TimeCode) -> None:
    attribute = op.GetAttr()
    found = raw(attribute, code)
    try:
        if found is not None and not (op.IsInverseOp() and isinstance(found, Gf.Matrix4d)):
            op.GetOpTransform(code)
    except Tf.ErrorException:
        message = f"found {type_name(attribute, found)}, expected {_expected(op)}; left out, as USD has it"
        diagnostics().warning(path, attribute.GetName(), message)
