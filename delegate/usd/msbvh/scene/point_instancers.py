"""Point instancers: which instances are drawn, and how they move by USD's own computation."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache, partial

import numpy as np
from pxr import Usd, UsdGeom

from .._core import InstanceLevel, Turns, uniform_turns
from ..motion.context import FrameContext, array
from ..motion.held_values import Stretch, stretches, values_within
from ..motion.points import optional_samples, rate_times, rates, raw_samples
from ..motion.times import Shutter, breakpoints_of, xform_breakpoints
from ..motion.transforms import Motion, XformCaches
from ..motion.turns import NO_TURNS, xform_turns
from ..motion.visibility import common_intervals
from ..motion.xform_ops import Orders, local_transform, may_vary
from ..stage.stage_metadata import time_codes_per_second
from ..stage.typed_twin import Twin, typed_twin
from ..stage.value_types import FLOAT3S, QUATERNIONS
from ..stage.values import might_vary, required, targets, value
from .instance_choice import choose_prototypes, instances_of
from .material_primvars import find_named, padded
from .primvars import find_primvar, held_by, read_primvar, sample_primvar

_COLOUR = "displayColor"

Colours = np.ndarray | list[tuple[float, np.ndarray]]
"""float32[N, 3], one an instance; where they change inside the shutter, (time01, colours) as MovingPrimvar has it."""


Values = Callable[[str], np.ndarray | None]
"""From a primvar's name to float32[N, 3], one value an instance, the numbers that it has not 0; None: they have none of
their own."""


def no_values(_: str) -> None:
    """Of what is no point instancer's."""


def taken(indices: np.ndarray, every: np.ndarray) -> np.ndarray:
    """Contiguous, as the bindings take it."""
    return np.ascontiguousarray(every[indices])


def each(colours: Colours, change: Callable[[np.ndarray], np.ndarray]) -> Colours:
    """Does something to the colours of every time."""
    if isinstance(colours, np.ndarray):
        return change(colours)
    return [(time01, change(values)) for time01, values in colours]


@dataclass(frozen=True)
class PointInstances:
    """The instances of one prototype."""

    prototype: Usd.Prim
    selected: np.ndarray
    """int32[M]: which of the instancer's instances."""
    arrays: InstanceLevel
    """Of the instancer; shared by all its prototypes."""
    motion: Motion
    """instancer_from_instance, without the prototype's own transform; evaluated by USD, for lights."""
    display_color: Colours | None
    """Of the M instances, where the instancer says."""
    visible: np.ndarray | None
    """float64[K, 2]: the parts of the shutter in which they are those of this prototype; None: always."""
    values: Values
    """Of the M instances."""


def prototypes(instancer: UsdGeom.PointInstancer) -> list[Usd.Prim]:
    """The prototypes' root prims by index; an invalid prim where a target does not exist, is inactive or not
    loaded."""
    stage = instancer.GetPrim().GetStage()
    prims = [stage.GetPrimAtPath(path) for path in targets(instancer.GetPrim(), "prototypes")]
    return [prim if prim and prim.IsActive() and prim.IsLoaded() else Usd.Prim() for prim in prims]


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
    """The instances that are neither invisible nor inactive, by prototype and by when they are.

    `context` has the instancer's own shutter, `caches` have the camera's. Arrays that do not fit leave an error and no
    instances, indices of no prototype an error and the others.
    """
    prims = prototypes(instancer)
    chosen = choose_prototypes(instancer, prims, context, caches.shutter)
    if not chosen or not _is_sound(instancer, len(chosen[0].indices), context):
        return
    count = len(chosen[0].indices)
    arrays = _arrays(instancer, count, context, velocity_scale)
    every = _every_instance(instancer, count, caches, context)
    primvar = find_primvar(instancer.GetPrim(), _COLOUR, 3)
    held = held_by(primvar, context) if primvar else []
    every_value = cache(partial(_values, instancer, count, context))
    for stretch in stretches(held, context.shutter, context.diagnostics):
        colours = _display_color(instancer, count, context, stretch)
        for index, prim in enumerate(prims):
            for selected, shown in instances_of(chosen, index):
                visible = common_intervals(shown, stretch.shown)
                if visible is None or len(visible):
                    colour = None if colours is None else each(colours, partial(taken, selected))
                    motion = _selected(every, selected, context)
                    values = partial(_some_values, every_value, selected)
                    yield PointInstances(prim, selected, arrays, motion, colour, visible, values)


def _arrays(
    instancer: UsdGeom.PointInstancer, count: int, context: FrameContext, velocity_scale: float
) -> InstanceLevel:
    """A level of instancing, without the instances that count."""
    level = InstanceLevel()
    orientations = _orientations(instancer, context)
    angular = instancer.GetAngularVelocitiesAttr()
    carried_by = rates(instancer.GetVelocitiesAttr(), instancer.GetAccelerationsAttr(), context)
    spun = context.shutter.moving and angular.HasAuthoredValue()
    level.path, level.count, level.held = str(instancer.GetPath()), count, context.held
    level.positions = raw_samples(instancer.GetPositionsAttr(), context, needs_times=bool(carried_by))
    level.scales = optional_samples(instancer.GetScalesAttr(), context)
    level.orientations = optional_samples(orientations, context, columns=4, needs_times=spun)
    level.orientations_name = orientations.GetName()
    if spun:
        level.angular_velocities = optional_samples(angular, context, needs_times=True)
    for name, given in {**carried_by, **rate_times(context, velocity_scale)}.items():
        setattr(level, name, given)
    return level


def _orientations(instancer: UsdGeom.PointInstancer, context: FrameContext) -> Usd.Attribute:
    """Those in single precision count first, as USD has it."""
    single = instancer.GetOrientationsfAttr()
    return single if _base_count(single, context) else instancer.GetOrientationsAttr()


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
    code = around[0] if around else context.code
    if attribute.GetName() == "positions":
        return len(required(attribute, code, FLOAT3S) or ())
    return len(value(attribute, code, QUATERNIONS if "orientations" in attribute.GetName() else FLOAT3S) or ())


def _every_instance(
    instancer: UsdGeom.PointInstancer, count: int, caches: XformCaches, context: FrameContext
) -> Motion:
    """instancer_from_instance without the prototypes' own transforms."""
    speeds = (instancer.GetVelocitiesAttr(), instancer.GetAngularVelocitiesAttr())
    still = not context.shutter.moving or not (
        any(attribute.HasAuthoredValue() for attribute in speeds)
        or any(might_vary(attribute) for attribute in moving_attributes(instancer))
    )

    @cache
    def typed() -> Twin:
        return typed_twin(instancer.GetPrim(), context.code)

    def evaluate(time01: float) -> np.ndarray:
        computed = UsdGeom.PointInstancer(typed().prim).ComputeInstanceTransformsAtTimes(
            [context.shutter.time_code(time01)],
            context.code,
            UsdGeom.PointInstancer.ExcludeProtoXform,
            UsdGeom.PointInstancer.IgnoreMask,
        )
        if not computed or len(computed[0]) != count:
            return np.full((count, 4, 4), np.nan)
        return np.array(computed[0])

    spin, shutter = _spin(instancer, context), context.shutter
    times = set() if still else {t for each in moving_attributes(instancer) for t in breakpoints_of(each, shutter)}
    breakpoints01 = tuple(sorted(shutter.time01(time) for time in times))
    return Motion(shutter, count, still, evaluate, breakpoints01, turns=lambda _: spin)


def _spin(instancer: UsdGeom.PointInstancer, context: FrameContext) -> Turns:
    """Of the fastest instance, by its angular velocity: degrees per second."""
    rates = array(value(instancer.GetAngularVelocitiesAttr(), context.code, FLOAT3S), np.float64, 3)
    if not len(rates) or not context.shutter.moving:
        return NO_TURNS
    seconds = (context.shutter.close - context.shutter.open) / time_codes_per_second(context.stage)
    return uniform_turns(float(np.linalg.norm(rates, axis=1).max()) * seconds / 360.0)


def _selected(every: Motion, selected: np.ndarray, context: FrameContext) -> Motion:
    """Some of the instances."""

    def evaluate(time01: float) -> np.ndarray:
        return every.at_time(time01)[selected]

    return Motion(context.shutter, len(selected), every.still, evaluate, every.breakpoints01, turns=every.turns)


def own_transform(prototype: Usd.Prim, caches: XformCaches, shutter: Shutter) -> Motion:
    """A prototype's root's own transform, which counts with the instancer's. `shutter`: the root's own, which is not
    the instancer's where either has a motion:blurScale."""
    xformable = UsdGeom.Xformable(prototype)
    authored = frozenset(prototype.GetAuthoredPropertyNames())
    if "xformOpOrder" in authored:
        Orders().check(prototype, authored)
    moving = bool(xformable) and may_vary(xformable) and shutter.moving
    breakpoints = sorted({shutter.time01(time) for time in xform_breakpoints(xformable, shutter)}) if moving else ()

    def evaluate(time01: float) -> np.ndarray:
        return np.array(local_transform(caches.cache(time01, shutter), prototype))[None]

    def carriers(_: int) -> list[UsdGeom.Xformable]:
        return [xformable] if xformable else []

    def turns(_: int) -> Turns:
        return xform_turns(xformable, shutter) if xformable else NO_TURNS

    return Motion(shutter, 1, not moving, evaluate, tuple(breakpoints), carriers=carriers, turns=turns)


def _display_color(
    instancer: UsdGeom.PointInstancer, count: int, context: FrameContext, stretch: Stretch
) -> Colours | None:
    """Of `count` instances, where displayColor varies over them. A constant one is inherited instead."""
    found = find_primvar(instancer.GetPrim(), _COLOUR, 3)
    primvar = sample_primvar(found, context, stretch) if found else None
    if primvar is None or primvar[0] == "constant":
        return None
    _, values, indices = primvar
    known = len(values if isinstance(values, np.ndarray) else values[0][1])
    indices = np.arange(known) if indices is None else indices
    if len(indices) != count or indices.min() < 0 or indices.max() >= known:
        message = f"found {len(indices)} indices into {known} values, expected one valid index an instance; ignored"
        context.diagnostics.warning(str(instancer.GetPath()), "primvars:displayColor", message)
        return None
    return each(values, lambda one: one[indices])


def _some_values(every: Values, selected: np.ndarray, name: str) -> np.ndarray | None:
    found = every(name)
    return None if found is None else taken(selected, found)


def _values(instancer: UsdGeom.PointInstancer, count: int, context: FrameContext, name: str) -> np.ndarray | None:
    """Those of a primvar at the frame for each of `count` instances. One of another interpolation than constant, which
    is inherited instead, must have as many."""
    prim, attribute = instancer.GetPrim(), f"primvars:{name}"
    if not prim.HasAttribute(attribute):
        return None
    found = find_primvar(prim, name, None) if name == "displayOpacity" else find_named(prim, name)
    if found is None:
        return None
    if found.columns == 0:
        message = f"found {found.attribute.GetTypeName()}, expected numbers; ignored"
        context.diagnostics.warning(str(prim.GetPath()), attribute, message)
        return None
    primvar = read_primvar(found, context.code)
    if primvar is None or primvar[0] == "constant":
        return None
    _, values, indices = primvar
    indices = np.arange(len(values)) if indices is None else indices
    path = str(prim.GetPath())
    if len(indices) != count or indices.min() < 0 or indices.max() >= len(values):
        message = (
            f"found {len(indices)} indices into {len(values)} values, expected one valid index an instance; ignored"
        )
        context.diagnostics.warning(path, attribute, message)
        return None
    if context.shutter.moving and (might_vary(found.attribute) or held_by(found, context)):
        first, *others = values_within(found.attribute, context.shutter)
        if held_by(found, context) or any(other != first for other in others):
            message = "changes within the shutter; each instance has the frame's value"
            context.diagnostics.group(path, attribute, message)
    return padded(values)[indices]
