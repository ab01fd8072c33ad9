"""Which attribute makes a transform unusable, found where one is: looking at every op of a stage would cost."""

from __future__ import annotations

import numpy as np
from pxr import Tf, Usd, UsdGeom

from .._core import LARGEST_ELEMENT
from ..base.errors import Diagnostics
from ..stage.values import might_vary, raw
from .times import Shutter, bracketing_times
from .transforms import Motion
from .xform_ops import ordered_ops, singular_op

_EXPECTED = f"expected finite numbers of at most 2^{int(np.log2(LARGEST_ELEMENT))} in size"


def report_unusable(motion: Motion, index: int, diagnostics: Diagnostics) -> None:
    """One error for one fault, whatever hangs below it: on the outermost op with a value that is no number."""
    path, attribute, message = unusable_op(motion.carriers(index), motion.shutter)
    diagnostics.error(path, attribute, f"{message}; what it moves is not drawn")


def unusable_op(carriers: list[UsdGeom.Xformable], shutter: Shutter) -> tuple[str, str, str]:
    """Prim, attribute, and what was found and expected there. `carriers`: the innermost first."""
    for xformable in reversed(carriers):
        for op in ordered_ops(xformable):
            found = _bad_value(op.GetAttr(), shutter)
            if found:
                return str(xformable.GetPath()), op.GetAttr().GetName(), f"{found}, {_EXPECTED}"
    for xformable in reversed(carriers):
        attribute = singular_op(xformable, shutter.frame_code, LARGEST_ELEMENT)
        if attribute is not None:
            found = " ".join(str(raw(attribute, shutter.frame_code)).split())
            return str(xformable.GetPath()), attribute.GetName(), f"found {found}, expected a value with an inverse"
    path = str(carriers[0].GetPath()) if carriers else ""
    return path, "xformOpOrder", f"found a product that is no number or too large, {_EXPECTED}"


def _bad_value(attribute: Usd.Attribute, shutter: Shutter) -> str:
    """In words, the first value of an op that the shutter or the frame lies beside; empty where all are sound."""
    if not shutter.moving or not might_vary(attribute):
        value = raw(attribute, shutter.frame_code)
        return "" if _is_sound(value) else f"found {value}"
    try:
        times = bracketing_times(attribute, shutter)
    except Tf.ErrorException:
        return "found samples at times that are NaN"
    for time in times:
        value = raw(attribute, time)
        if not _is_sound(value):
            return f"found {value} at shutter time {shutter.time01(time):.9g} (0 is the opening, 1 the closing)"
    return ""


def _is_sound(value: object) -> bool:
    """Also what is of no type that an op takes: that is another fault, which xform_ops.py reports."""
    if value is None:
        return True
    if hasattr(value, "GetReal") and hasattr(value, "GetImaginary"):
        value = (value.GetReal(), *value.GetImaginary())
    try:
        numbers = np.array(value, np.float64)
    except (TypeError, ValueError):
        return True
    return bool((np.abs(numbers) <= LARGEST_ELEMENT).all())
