"""The types of what UsdSkel reads itself. It passes over values of another type without a word, those too that would
convert."""

from __future__ import annotations

from collections.abc import Iterable

from pxr import Sdf, Usd, UsdSkel

from ..stage.value_types import FLOAT3S, FLOATS, HALF3S, INTS, MATRICES, MATRIX, QUATERNIONS, TOKEN, TOKENS, Kind
from ..stage.values import exact, targets

_SKELETON = (("joints", TOKENS), ("bindTransforms", MATRICES), ("restTransforms", MATRICES))
_ANIMATION = (
    ("joints", TOKENS),
    ("translations", FLOAT3S),
    ("rotations", QUATERNIONS),
    ("scales", HALF3S),
    ("blendShapes", TOKENS),
    ("blendShapeWeights", FLOATS),
)
_BINDING = (
    ("skel:joints", TOKENS),
    ("skel:blendShapes", TOKENS),
    ("primvars:skel:geomBindTransform", MATRIX),
    ("primvars:skel:skinningMethod", TOKEN),
)
_INFLUENCES = (("primvars:skel:jointIndices", INTS), ("primvars:skel:jointWeights", FLOATS))
_SHAPE = (("pointIndices", INTS), ("offsets", FLOAT3S), ("normalOffsets", FLOAT3S))


class SkelTypes:
    """Checks each prim once."""

    def __init__(self) -> None:
        self._checked: set[Sdf.Path] = set()
        self._unsound: set[Sdf.Path] = set()

    def check(self, prim: Usd.Prim, code: Usd.TimeCode) -> bool:
        """Reports what is wrong with a skinned prim, with what it inherits, and with its skeleton and animation.
        Returns whether joints can act on it at all."""
        binding = UsdSkel.BindingAPI(prim)
        skeleton = binding.GetInheritedSkeleton().GetPrim()
        self._once(skeleton, _SKELETON, code)
        animation = UsdSkel.BindingAPI(skeleton).GetInheritedAnimationSource() if skeleton else None
        self._once(animation, _ANIMATION, code)
        for target in targets(prim, "skel:blendShapeTargets"):
            shape = prim.GetStage().GetPrimAtPath(target)
            names = [a.GetName() for a in shape.GetAuthoredAttributes()] if shape else ()
            between = [(name, FLOAT3S) for name in names if name.startswith("inbetweens:")]
            self._once(shape, (*_SHAPE, *between), code)
        sound = True
        while prim and not prim.IsPseudoRoot():
            if prim.GetPath() not in self._checked and not exact(prim, _INFLUENCES, code):
                self._unsound.add(prim.GetPath())
            sound = sound and prim.GetPath() not in self._unsound
            self._once(prim, _BINDING, code)
            prim = prim.GetParent()
        return sound

    def _once(self, prim: Usd.Prim | None, names: Iterable[tuple[str, Kind]], code: Usd.TimeCode) -> None:
        if prim and prim.GetPath() not in self._checked:
            self._checked.add(prim.GetPath())
            exact(prim, names, code)
