"""Which attribute of an animation makes a pose unusable, found where one is."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from pxr import Usd, UsdSkel

from .._core import LARGEST_ELEMENT
from ..motion.context import FrameContext
from ..stage.value_types import FLOAT3S, HALF3S, QUATERNIONS
from ..stage.values import value
from .bindings import SkelBinding


def report_unusable_pose(
    binding: SkelBinding, joints: np.ndarray, codes: Sequence[Usd.TimeCode], context: FrameContext
) -> bool:
    """Whether float64[T, J, 4, 4] skinning transforms hold what is no number because the animation does: one
    error for it, however many meshes follow. Any other reason is left to the core."""
    good = (np.abs(joints) <= LARGEST_ELEMENT).all(axis=(1, 2, 3))
    if good.all() or not binding.animation:
        return False
    code = codes[int(np.argmin(good))]
    animation = UsdSkel.Animation(binding.animation.GetPrim())
    names = [str(name) for name in binding.animation.GetJointOrder() or ()]
    for attribute, kind in (
        (animation.GetTranslationsAttr(), FLOAT3S),
        (animation.GetRotationsAttr(), QUATERNIONS),
        (animation.GetScalesAttr(), HALF3S),
    ):
        values = (value(attribute, code, kind) if attribute else None) or ()
        sound = [_is_sound(found) for found in values]
        if all(sound):
            continue
        index = sound.index(False)
        joint = names[index] if index < len(names) else str(index)
        message = f"found {values[index]} for joint '{joint}'{_when(code, context)}, expected finite numbers"
        context.diagnostics.error(
            str(animation.GetPath()),
            attribute.GetName(),
            f"{message}; the meshes that follow it are not drawn",
        )
        return True
    return False


def _is_sound(value: object) -> bool:
    if hasattr(value, "GetReal") and hasattr(value, "GetImaginary"):
        value = (value.GetReal(), *value.GetImaginary())
    return bool((np.abs(np.array(value, np.float64)) <= LARGEST_ELEMENT).all())


def _when(code: Usd.TimeCode, context: FrameContext) -> str:
    if not context.shutter.moving or code.IsDefault():
        return ""
    time01 = context.shutter.time01(code.GetValue())
    return f" at shutter time {time01:.9g} (0 is the opening, 1 the closing)"
