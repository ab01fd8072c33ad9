"""Which of a point instancer's instances show which prototype, over the shutter: indices, ids and masks."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from pxr import Sdf, Usd, UsdGeom

from ..motion.context import FrameContext, array
from ..motion.held_values import Stretch, stretches
from ..motion.times import Shutter
from ..motion.visibility import common_intervals, steps
from ..stage.value_types import INTS, LONGS
from ..stage.values import might_vary, required, targets, value
from .instance_mask import instance_mask

_NOT_DRAWN = -1


@dataclass(frozen=True)
class Choice:
    """What the instances show for a part of the shutter."""

    indices: np.ndarray
    """int32[N]: of a prototype, _NOT_DRAWN for some."""
    shown: np.ndarray | None
    """float64[K, 2]: [begin, end) in time01; None: always."""


def choose_prototypes(
    instancer: UsdGeom.PointInstancer, prims: list[Usd.Prim], context: FrameContext, camera: Shutter
) -> list[Choice]:
    """One choice for each part of the shutter over which indices and masks are the same; [] where there are no
    instances at the frame.

    `context` has the instancer's own shutter. Masks are visibility: they keep the camera's.
    """
    at_frame = array(required(instancer.GetProtoIndicesAttr(), context.code, INTS), np.int32)
    if not len(at_frame):
        context.diagnostics.group(str(instancer.GetPath()), "", "empty: it has no instances at this frame", "note")
        return []
    stays = _stays(instancer, len(at_frame), context)
    choices = []
    for indices in _indices(instancer, stays, context):
        drawn = _checked(instancer, prims, indices.indices, context)
        for mask in _masks(instancer, len(at_frame), stays, camera, context):
            shown = common_intervals(indices.shown, mask.shown)
            if shown is None or len(shown):
                choices.append(Choice(np.where(mask.indices, drawn, _NOT_DRAWN), shown))
    return choices


def instances_of(choices: list[Choice], prototype: int) -> Iterator[tuple[np.ndarray, np.ndarray | None]]:
    """int32[M] of the instances that show a prototype, and when they do: those together that come and go together."""
    shows = np.array([choice.indices == prototype for choice in choices])
    if len(choices) == 1:
        patterns, which = shows.T[:1] | True, np.where(shows[0], 0, -1)
    else:
        packed, which = np.unique(np.packbits(shows, axis=0).T, axis=0, return_inverse=True)
        patterns = np.unpackbits(packed, axis=1, count=len(choices)).astype(bool)
    for number, pattern in enumerate(patterns):
        selected = np.flatnonzero(which.ravel() == number).astype(np.int32)
        if pattern.any() and len(selected):
            yield selected, _when(choices, pattern)


def _when(choices: list[Choice], pattern: np.ndarray) -> np.ndarray | None:
    """The parts of the shutter of some choices, None where these are all."""
    if pattern.all():
        return choices[0].shown if len(choices) == 1 else None
    intervals = np.concatenate([choices[index].shown for index in np.flatnonzero(pattern)])
    return intervals[np.argsort(intervals[:, 0])]


def _stays(instancer: UsdGeom.PointInstancer, count: int, context: FrameContext) -> bool:
    """Whether an instance is the same one throughout the shutter: none is carried by velocities, which take all from
    one sample, and their number stays."""
    attribute, shutter = instancer.GetProtoIndicesAttr(), context.shutter
    speeds = (instancer.GetVelocitiesAttr(), instancer.GetAngularVelocitiesAttr())
    if any(speed.GetNumTimeSamples() for speed in speeds):
        return False  # The translator says so if they do not apply.
    if not shutter.moving or not might_vary(attribute):
        return True
    if all(len(value(attribute, time, INTS) or ()) == count for time in steps(attribute, shutter)):
        return True
    message = "their number changes within the shutter and no velocities apply; drew the frame's instances"
    context.diagnostics.warning(str(instancer.GetPath()), "protoIndices", message)
    return False


def _indices(instancer: UsdGeom.PointInstancer, stays: bool, context: FrameContext) -> list[Choice]:
    attribute = instancer.GetProtoIndicesAttr()
    parts = stretches([attribute], context.shutter, context.diagnostics) if stays else [Stretch(context.code)]
    return [Choice(array(value(attribute, part.code, INTS), np.int32), part.shown) for part in parts]


def _checked(
    instancer: UsdGeom.PointInstancer, prims: list[Usd.Prim], indices: np.ndarray, context: FrameContext
) -> np.ndarray:
    """int32[N]: _NOT_DRAWN, with an error, for those of no prototype."""
    path, diagnostics = str(instancer.GetPath()), context.diagnostics
    in_range = (indices >= 0) & (indices < len(prims))
    if not in_range.all():
        found = ", ".join(map(str, np.unique(indices[~in_range])[:8]))
        message = f"found {found}, expected the index of one of {len(prims)} prototypes"
        diagnostics.error(path, "protoIndices", f"{message}; those instances are not drawn")
    exists = np.isin(indices, [index for index, prim in enumerate(prims) if prim])
    if not exists[in_range].all():
        found = _missing(instancer, np.unique(indices[in_range & ~exists]))
        message = f"found {found}, expected prims that exist, active and loaded; their instances are not drawn"
        diagnostics.error(path, "prototypes", message)
    return np.where(exists, indices, _NOT_DRAWN)


def _missing(instancer: UsdGeom.PointInstancer, indices: np.ndarray) -> str:
    """Those prototypes of which there is nothing to draw, each with the reason; the first few."""
    roots = targets(instancer.GetPrim(), "prototypes")
    found = []
    for path in (roots[index] for index in indices[:8].tolist()):
        prim = instancer.GetPrim().GetStage().GetPrimAtPath(path)
        why = "" if not prim else " (inactive)" if not prim.IsActive() else " (not loaded)"
        found.append(f"{path}{why}")
    return ", ".join(found)


def _masks(
    instancer: UsdGeom.PointInstancer, count: int, stays: bool, camera: Shutter, context: FrameContext
) -> list[Choice]:
    """bool[count] for each part of the shutter: neither invisible nor inactive."""
    ids, invisible = instancer.GetIdsAttr(), instancer.GetInvisibleIdsAttr()
    parts = stretches([ids, invisible] if stays else [invisible], camera, context.diagnostics)
    if len(parts) == 1 and (stays or parts[0].code == context.code):
        mask = instance_mask(instancer, count, parts[0].code)
        return [Choice(_checked_mask(instancer, mask, count, context), None)]
    inactive = (instancer.GetPrim().GetMetadata("inactiveIds") or Sdf.Int64ListOp()).ApplyOperations([])
    choices = []
    for part in parts:
        known = array(value(ids, part.code if stays else context.code, LONGS), np.int64)
        known = known if len(known) else np.arange(count)
        hidden = np.concatenate([array(value(invisible, part.code, LONGS), np.int64), np.array(inactive, np.int64)])
        choices.append(Choice(_checked_mask(instancer, ~np.isin(known, hidden), count, context), part.shown))
    return choices


def _checked_mask(instancer: UsdGeom.PointInstancer, mask: np.ndarray, count: int, context: FrameContext) -> np.ndarray:
    """Without a mask nothing is masked; nor is it, with a warning, where it does not fit."""
    if len(mask) not in (0, count):
        found = f"found {len(mask)} ids, expected {count}, one an instance; nothing is masked"
        context.diagnostics.warning(str(instancer.GetPath()), "ids", found)
    return mask if len(mask) == count else np.ones(count, bool)
