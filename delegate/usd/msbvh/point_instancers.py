"""Point instancers: which instances are drawn, and how they move by USD's own computation."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from pxr import Usd, UsdGeom

from .context import FrameContext, array
from .points import changes, rate_clock, rates, raw_samples
from .primvars import read_primvar, warn_of_change
from .times import Shutter, xform_bends
from .transforms import Motion, XformCaches

_NOT_DRAWN = -1


@dataclass(frozen=True)
class PointInstances:
    """The instances of one prototype."""

    prototype: Usd.Prim
    selected: np.ndarray
    """int32[M]: which of the instancer's instances."""
    arrays: dict
    """The translator's keywords of the instancer's arrays; shared by all its prototypes."""
    motion: Motion
    """instancer_from_instance, without the prototype's own transform; evaluated by USD, for lights."""
    display_color: np.ndarray | None
    """float32[M, 3] where the instancer says."""


def prototypes(instancer: UsdGeom.PointInstancer) -> list[Usd.Prim]:
    """The prototypes' root prims by index; an invalid prim where a target does not exist, is inactive or not
    loaded."""
    stage = instancer.GetPrim().GetStage()
    prims = [stage.GetPrimAtPath(path) for path in instancer.GetPrototypesRel().GetForwardedTargets()]
    return [prim if prim and prim.IsActive() and prim.IsLoaded() else Usd.Prim() for prim in prims]


def _missing(instancer: UsdGeom.PointInstancer, indices: np.ndarray) -> str:
    """Those prototypes of which there is nothing to draw, each with the reason; the first few."""
    targets = instancer.GetPrototypesRel().GetForwardedTargets()
    found = []
    for path in (targets[index] for index in indices[:8].tolist()):
        prim = instancer.GetPrim().GetStage().GetPrimAtPath(path)
        why = "" if not prim else " (inactive)" if not prim.IsActive() else " (not loaded)"
        found.append(f"{path}{why}")
    return ", ".join(found)


def moving_attributes(instancer: UsdGeom.PointInstancer) -> list[Usd.Attribute]:
    """What makes the instances move."""
    return [
        instancer.GetPositionsAttr(),
        instancer.GetOrientationsAttr(),
        instancer.GetOrientationsfAttr(),
        instancer.GetScalesAttr(),
        instancer.GetVelocitiesAttr(),
        instancer.GetAccelerationsAttr(),
        instancer.GetAngularVelocitiesAttr(),
    ]


def read_point_instancer(
    instancer: UsdGeom.PointInstancer, caches: XformCaches, context: FrameContext, velocity_scale: float
) -> Iterator[PointInstances]:
    """The instances that are neither invisible nor inactive at the frame, by prototype.

    `context` has the instancer's own shutter. Arrays that do not fit leave an error and no instances, indices of
    no prototype an error and the others.
    """
    prims = prototypes(instancer)
    chosen = _prototype_indices(instancer, prims, context)
    if not len(chosen) or not _is_sound(instancer, len(chosen), context):
        return
    colours = _display_color(instancer, len(chosen), context)
    _warn_of_opacity(instancer, context)
    arrays = _arrays(instancer, len(chosen), context, velocity_scale)
    every = _every_instance(instancer, len(chosen), caches, context)
    for index, prim in enumerate(prims):
        selected = np.flatnonzero(chosen == index).astype(np.int32)
        if len(selected):
            colour = None if colours is None else colours[selected]
            yield PointInstances(prim, selected, arrays, _selected(every, selected, caches, context), colour)


def _arrays(
    instancer: UsdGeom.PointInstancer, count: int, context: FrameContext, velocity_scale: float
) -> dict:
    """The translator's keywords of a level of instancing (PointInstancerInput)."""
    orientations = _orientations(instancer, context)
    angular = instancer.GetAngularVelocitiesAttr()
    carried_by = rates(instancer.GetVelocitiesAttr(), instancer.GetAccelerationsAttr(), context)
    spun = context.shutter.moving and angular.HasAuthoredValue()
    return {
        "count": count,
        "held": context.held,
        "positions": raw_samples(instancer.GetPositionsAttr(), context, needs_times=bool(carried_by)),
        "scales": raw_samples(instancer.GetScalesAttr(), context),
        "orientations": raw_samples(orientations, context, columns=4, needs_times=spun),
        "orientations_name": orientations.GetName(),
        **({"angular_velocities": raw_samples(angular, context, needs_times=True)} if spun else {}),
        **carried_by,
        **rate_clock(context, velocity_scale),
    }


def _prototype_indices(
    instancer: UsdGeom.PointInstancer, prims: list[Usd.Prim], context: FrameContext
) -> np.ndarray:
    """int32[N]: one an instance, _NOT_DRAWN for some."""
    indices = array(instancer.GetProtoIndicesAttr().Get(context.code), np.int32)
    path, diagnostics = str(instancer.GetPath()), context.diagnostics
    if not len(indices):
        diagnostics.group(path, "", "empty: it has no instances at this frame", "note")
        return indices
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
    if changes(instancer.GetProtoIndicesAttr(), context) and not _may_be_carried(instancer):
        message = "changes within the shutter and no velocities apply; drew the frame's instances"
        diagnostics.warning(path, "protoIndices", message)
    return np.where(exists & _mask(instancer, len(indices), context), indices, _NOT_DRAWN)


def _may_be_carried(instancer: UsdGeom.PointInstancer) -> bool:
    """Whether there are rates that may carry the instances of one base sample through the shutter, whatever
    follows it. The translator says if they do not."""
    speeds = (instancer.GetVelocitiesAttr(), instancer.GetAngularVelocitiesAttr())
    return any(attribute.GetNumTimeSamples() for attribute in speeds)


def _orientations(instancer: UsdGeom.PointInstancer, context: FrameContext) -> Usd.Attribute:
    """Those in single precision count first, as USD has it."""
    single = instancer.GetOrientationsfAttr()
    return single if _base_count(single, context) else instancer.GetOrientationsAttr()


def _mask(instancer: UsdGeom.PointInstancer, count: int, context: FrameContext) -> np.ndarray:
    """bool[count]: neither invisible nor inactive at the frame."""
    mask = np.array(instancer.ComputeMaskAtTime(context.code), bool)
    if len(mask) not in (0, count):
        found = f"found {len(mask)} ids, expected {count}, one an instance; nothing is masked"
        context.diagnostics.warning(str(instancer.GetPath()), "ids", found)
    return mask if len(mask) == count else np.ones(count, bool)


def _is_sound(instancer: UsdGeom.PointInstancer, count: int, context: FrameContext) -> bool:
    """Whether every array has one value an instance.

    usd-core 26.11 reads behind the end of scales and orientations that are too short.
    """
    sound = True
    optional_arrays = (instancer.GetScalesAttr(), _orientations(instancer, context))
    for attribute in (instancer.GetPositionsAttr(), *optional_arrays):
        found = _base_count(attribute, context)
        optional = attribute.GetName() != "positions"
        if found != count and not (optional and found == 0):
            message = f"found {found} values, expected {count}, one an instance; not drawn"
            context.diagnostics.error(str(instancer.GetPath()), attribute.GetName(), message)
            sound = False
    return sound


def _base_count(attribute: Usd.Attribute, context: FrameContext) -> int:
    """The length of an array at the sample at or before the frame, which is where USD starts from."""
    frame = context.shutter.frame
    around = () if frame is None else attribute.GetBracketingTimeSamples(frame)
    value = attribute.Get(around[0]) if around else attribute.Get(context.code)
    return 0 if value is None else len(value)


def _every_instance(
    instancer: UsdGeom.PointInstancer, count: int, caches: XformCaches, context: FrameContext
) -> Motion:
    """instancer_from_instance without the prototypes' own transforms."""
    speeds = (instancer.GetVelocitiesAttr(), instancer.GetAngularVelocitiesAttr())
    still = not context.shutter.moving or not (
        any(attribute.HasAuthoredValue() for attribute in speeds)
        or any(attribute.ValueMightBeTimeVarying() for attribute in moving_attributes(instancer))
    )

    def evaluate(time01: float) -> np.ndarray:
        computed = instancer.ComputeInstanceTransformsAtTimes(
            [context.shutter.time_code(time01)],
            context.code,
            UsdGeom.PointInstancer.ExcludeProtoXform,
            UsdGeom.PointInstancer.IgnoreMask,
        )
        return np.array(computed[0])

    return Motion(caches.grid(context.shutter), count, still, evaluate)


def _selected(every: Motion, selected: np.ndarray, caches: XformCaches, context: FrameContext) -> Motion:
    """Some of the instances."""
    grid = caches.grid(context.shutter)
    return Motion(grid, len(selected), every.still, lambda time01: every.at_time(time01)[selected])


def own_transform(prototype: Usd.Prim, caches: XformCaches, shutter: Shutter) -> Motion:
    """A prototype's root's own transform, which counts with the instancer's. `shutter`: the root's own, which is not
    the instancer's where either has a motion:blurScale."""
    xformable = UsdGeom.Xformable(prototype)
    moving = bool(xformable) and xformable.TransformMightBeTimeVarying() and shutter.moving
    bends = sorted({shutter.time01(time) for time in xform_bends(xformable, shutter)}) if moving else ()

    def evaluate(time01: float) -> np.ndarray:
        return np.array(caches.cache(time01, shutter).GetLocalTransformation(prototype)[0])[None]

    def carriers(_: int) -> list[UsdGeom.Xformable]:
        return [xformable] if xformable else []

    return Motion(caches.grid(shutter), 1, not moving, evaluate, tuple(bends), carriers=carriers)


def _display_color(instancer: UsdGeom.PointInstancer, count: int, context: FrameContext) -> np.ndarray | None:
    """float32[count, 3] where displayColor varies over the instances. A constant one is inherited instead."""
    primvar = read_primvar(instancer.GetPrim(), "displayColor", 3, context)
    if primvar is None or primvar[0] == "constant":
        return None
    warn_of_change(instancer.GetPrim(), "displayColor", 3, context)
    _, values, indices = primvar
    indices = np.arange(len(values)) if indices is None else indices
    if len(indices) != count or indices.min() < 0 or indices.max() >= len(values):
        found = (
            f"found {len(indices)} indices into {len(values)} values, expected one valid index an instance"
        )
        context.diagnostics.warning(str(instancer.GetPath()), "primvars:displayColor", f"{found}; ignored")
        return None
    return values[indices]


def _warn_of_opacity(instancer: UsdGeom.PointInstancer, context: FrameContext) -> None:
    primvar = read_primvar(instancer.GetPrim(), "displayOpacity", None, context)
    if primvar is not None and primvar[0] != "constant" and (primvar[1] != 1.0).any():
        message = "an opacity for each instance is not supported yet; the prototypes' own is drawn"
        context.diagnostics.group(str(instancer.GetPath()), "primvars:displayOpacity", message)
