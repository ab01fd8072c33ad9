"""What a stage has to draw, as groups: the world, and every subtree that instances share.

A group's parts are known relative to its root. Groups refer to others by native instances and point
instancers, so the whole is an acyclic graph; instances.py flattens it.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterator
from dataclasses import dataclass, field, replace
from typing import Any

from pxr import Sdf, Usd, UsdGeom, UsdShade, UsdSkel

from ..look.lights import is_light
from ..motion.context import FrameContext
from ..motion.motion_scales import MOTION_PROPERTIES, MotionScales, scales_at
from ..motion.times import Shutter, xform_breakpoints
from ..motion.transforms import transform_breakpoints
from ..motion.visibility import changes_inside, visible_at_opening
from ..motion.xform_ops import Orders, may_vary, resets
from ..skel.skeletons import Skeletons
from ..stage.inherited import inheritable, inherited_names
from ..stage.tokens import applied_draw_mode, draw_mode, inherited_purpose
from ..stage.usd_faults import FAULTS, report_left_out
from ..stage.value_types import TOKEN
from ..stage.values import value
from .instance_primvars import InstancePrimvars
from .meshes import has_own_points, is_shape
from .part import Part
from .point_instancers import prototypes
from .primvars import primvar_source
from .round import is_round
from .unsupported import why_not_drawn

WORLD: tuple[Hashable, ...] = ("world",)
DEEPEST_NESTING = 100
"""Instances in instances, far below what Python's stack holds."""

_DRAW_MODES = ("origin", "bounds", "cards")

_DEFINED = Usd.TraverseInstanceProxies(Usd.PrimDefaultPredicate)
_PROTOTYPE = Usd.TraverseInstanceProxies(Usd.PrimIsActive & Usd.PrimIsLoaded)
"""Prototypes of point instancers may be mere overs, which keeps them out of the normal traversal."""


@dataclass
class Group:
    """A subtree that is drawn as a whole."""

    key: tuple[Hashable, ...]
    path: str
    root: Any
    """Usd.Prim; its own transform is not the group's but its users'; None: the world."""
    native: bool = False
    """What native instances show: what hides the root hides the instance, which its users see to."""
    scales: MotionScales = MotionScales()
    """What holds at the root: its own transform, where a point instancer has it, moves by them."""
    other_blurs: dict[float, tuple[Hashable, ...]] = field(default_factory=dict)
    """Of native instances: the group of what has another motion:blurScale than the root, by that scale. It counts for
    the whole motion, so that the same instances place it at other times."""
    resets: list[Sdf.Path] = field(default_factory=list)
    """Of native instances: what has !resetXformStack!, relative to the root. No instance moves it; it is part of the
    group around them."""
    reset: tuple[Hashable, ...] | None = None
    """Of point instancers' prototypes: the group of what has !resetXformStack!, if any; the root's own transform is not
    for it. That is where UsdImaging resets the stack (UsdImagingPiPrototypeSceneIndex)."""
    shapes: list[Part] = field(default_factory=list)
    lights: list[Part] = field(default_factory=list)
    instancers: list[Part] = field(default_factory=list)
    instances: dict[Hashable, list[Part]] = field(default_factory=dict)
    """Native instances by the group that they show."""


@dataclass(frozen=True)
class _Type:
    """What a prim's type alone decides; asking each of a hundred thousand prims takes a while."""

    imageable: bool
    xformable: bool
    instancer: bool
    mesh: bool
    shape: bool
    round: bool

    @staticmethod
    def of(prim: Usd.Prim) -> _Type:
        is_a = prim.IsA
        instancer, mesh = is_a(UsdGeom.PointInstancer), has_own_points(prim)
        return _Type(is_a(UsdGeom.Imageable), is_a(UsdGeom.Xformable), instancer, mesh, is_shape(prim), is_round(prim))


_NO_TYPE = _Type(False, False, False, False, False, False)


@dataclass(slots=True)
class _State:
    """What prims inherit on the way down. Never changed once it is made."""

    varying: bool
    purpose: str
    kind: _Type = _NO_TYPE
    """Of the prim that it holds at."""
    blinking: tuple[Usd.Attribute, ...] = ()
    breakpoints: tuple[float, ...] = ()
    scales: MotionScales = MotionScales()
    authored: frozenset[str] = frozenset()
    inherited: frozenset[str] = frozenset()
    """See Part."""
    has_children: bool = False
    draw_mode: str = ""

    def below(self) -> _State:
        """What children start from."""
        own = inheritable(self.authored)
        return self if own <= self.inherited else replace(self, inherited=self.inherited | own)


class Traversal:
    """Scans a stage: groups by key, the world's first."""

    def __init__(self, context: FrameContext, draw_modes: bool = True) -> None:
        """`draw_modes`: models that have one are drawn as it says, not in full."""
        self.groups: dict[Hashable, Group] = {}
        self._context = context
        self._depth = 0
        self._orders = Orders()
        self._types: dict[str, _Type] = {}
        self._purposes = set(context.purposes)
        self._draw_modes = draw_modes
        top = context.stage.GetPseudoRoot()
        self._add_group(Group(WORLD, str(top.GetPath()), None), _State(False, "default"), top, _DEFINED)

    @staticmethod
    def prototype_key(prim: Usd.Prim) -> tuple[Hashable, ...]:
        """The key of the group that a point instancer's prototype makes."""
        return ("prototype", str(prim.GetPath()))

    def _add_group(self, group: Group, state: _State, top: Usd.Prim, predicate: object) -> None:
        self.groups[group.key] = group
        if self._depth > DEEPEST_NESTING:
            message = f"found instances nested more than {DEEPEST_NESTING} deep, expected fewer levels; not drawn"
            self._context.diagnostics.error(str(top.GetPath()), "", message)
            return
        self._depth += 1
        self._scan(top, state, group, predicate)
        self._depth -= 1
        if group.resets:
            self._take_skins_along(group)

    def _scan(self, top: Usd.Prim, state: _State, group: Group, predicate: object) -> None:
        """Adds what is below `top` to a group."""
        for prim, prim_state in self._descend(top, state, group, predicate):
            try:
                self._sort(prim, prim_state, group)
            except FAULTS as error:
                report_left_out(prim, error, self._context.code)

    def _descend(
        self, top: Usd.Prim, state: _State, group: Group, predicate: object
    ) -> Iterator[tuple[Usd.Prim, _State]]:
        """The visible prims of a subtree, in namespace order, down to instances and point instancers."""
        pending = [(top, state)]
        root = group.root
        while pending:
            prim, above = pending.pop()
            is_root = root is not None and prim == root
            try:
                here = self._state(prim, above, is_root, group)
                if here is None:
                    continue
                if not is_root and self._leaves(prim, above, here, group, predicate):
                    continue
                here.draw_mode = self._draw_mode(prim)
            except FAULTS as error:
                report_left_out(prim, error, self._context.code)
                continue
            if here.draw_mode:
                yield prim, here
                continue
            is_instance = prim.IsInstance()
            if is_instance and predicate is _PROTOTYPE and is_root:
                predicate = _DEFINED  # Inside a native prototype everything is defined, seen from the instance.
            children = prim.GetFilteredChildren(predicate)
            here.has_children = bool(children)
            yield prim, here
            if not children or (is_instance and not is_root) or here.kind.instancer:
                continue
            below = here.below()
            pending.extend((child, below) for child in reversed(children))

    def _type(self, prim: Usd.Prim) -> _Type:
        name = prim.GetTypeName()
        return self._types.get(name) or self._types.setdefault(name, _Type.of(prim))

    def _leaves(self, prim: Usd.Prim, above: _State, here: _State, group: Group, predicate: object) -> bool:
        """Whether a prim resets its transform stack inside a group, and so belongs elsewhere."""
        if group.root is None or not here.kind.xformable or group.key[0] == "reset":
            return False
        if "xformOpOrder" not in here.authored:
            return False
        if not resets(UsdGeom.Xformable(prim)):
            return False
        if group.native:
            group.resets.append(prim.GetPath().MakeRelativePath(group.root.GetPath()))
            return True
        if group.reset is None:
            group.reset = ("reset", *group.key)
            self.groups[group.reset] = Group(group.reset, group.path, group.root, scales=group.scales)
        self._scan(prim, above, self.groups[group.reset], predicate)
        return True

    def _state(self, prim: Usd.Prim, above: _State, is_root: bool, group: Group) -> _State | None:
        """What holds at a prim; None if it is invisible."""
        kind = self._type(prim)
        if not kind.imageable:
            return replace(above, kind=kind, authored=frozenset(prim.GetAuthoredPropertyNames()))
        authored = frozenset(prim.GetAuthoredPropertyNames())
        scales = above.scales
        if not authored.isdisjoint(MOTION_PROPERTIES):
            scales = scales.below(prim, self._context.shutter, self._context.diagnostics)
        blinking, purpose = above.blinking, above.purpose
        if not (is_root and group.native) and "visibility" in authored:
            visibility = UsdGeom.Imageable(prim).GetVisibilityAttr()
            if changes_inside(visibility, self._context.shutter):  # Not motion: no blur scale stretches it.
                blinking += (visibility,)
            elif not visible_at_opening(visibility, self._context.shutter):
                return None
        if "purpose" in authored:
            purpose = value(UsdGeom.Imageable(prim).GetPurposeAttr(), Usd.TimeCode.Default(), TOKEN) or purpose
        state = _State(above.varying, purpose, kind, blinking, above.breakpoints, scales, authored, above.inherited)
        if is_root or "xformOpOrder" not in authored or not kind.xformable:
            return state
        self._orders.check(prim, authored)
        shutter = self._context.shutter.scaled(scales.blur)
        return self._moved(state, above, UsdGeom.Xformable(prim), group.root, shutter)

    def _moved(
        self,
        state: _State,
        above: _State,
        xformable: UsdGeom.Xformable,
        group_root: Usd.Prim | None,
        shutter: Shutter,
    ) -> _State:
        """The state below a transform, which may vary or leave what is above. A prim that its motion:blurScale holds
        varies all the same: what is below may have another one."""
        own = self._context.shutter.moving and may_vary(xformable)
        inherits = above.varying and not resets(xformable)
        if not (own or inherits):
            return state if not (state.varying or state.breakpoints) else replace(state, varying=False, breakpoints=())
        breakpoints = set(above.breakpoints) if inherits else set()
        if own and shutter.moving:
            breakpoints.update(xform_breakpoints(xformable, shutter))
        if inherits and state.scales.blur > above.scales.blur:  # Its shutter is open for longer.
            breakpoints = transform_breakpoints(xformable.GetPrim(), group_root, shutter)
        return replace(state, varying=True, breakpoints=tuple(sorted(breakpoints)))

    def _sort(self, prim: Usd.Prim, state: _State, group: Group) -> None:
        """Puts a prim where it belongs, or says that it is not drawn."""
        around, group = group, self._at_blur(group, state.scales.blur)
        kind = state.kind
        part = Part(
            prim,
            state.varying,
            state.breakpoints,
            state.scales,
            state.blinking,
            state.authored,
            state.inherited,
            kind.mesh and not state.draw_mode,
            state.has_children,
            kind.round and not state.draw_mode,
            state.draw_mode,
        )
        if state.draw_mode:
            if state.purpose in self._purposes:
                group.shapes.append(part)
            return
        if is_light(prim):
            group.lights.append(part)
        if prim.IsInstance() and prim != group.root:
            self._add_instance(part, state, around)
        elif kind.instancer:
            if state.purpose in self._purposes:
                self._add_instancer(part, group)
        elif kind.shape or kind.round:
            if state.purpose in self._purposes:
                group.shapes.append(part)
        elif state.purpose in self._purposes:
            message = why_not_drawn(prim)
            if message is not None:
                self._context.diagnostics.group(str(prim.GetPath()), "", message)

    def _add_instancer(self, part: Part, group: Group) -> None:
        group.instancers.append(part)
        for prim in prototypes(UsdGeom.PointInstancer(part.prim)):
            key = self.prototype_key(prim)
            if prim and key not in self.groups:
                scales = scales_at(prim, self._context.shutter, self._context.diagnostics)
                state = _State(False, inherited_purpose(prim), scales=scales, inherited=inherited_names(prim))
                self._add_group(Group(key, str(prim.GetPath()), prim, scales=scales), state, prim, _PROTOTYPE)

    def _at_blur(self, group: Group, blur: float) -> Group:
        """Where in a group something with that motion:blurScale belongs."""
        if not group.native or blur == group.scales.blur:
            return group
        if blur not in group.other_blurs:
            key = ("blur", blur, group.key)
            scales = replace(group.scales, blur=blur)
            self.groups[key] = Group(key, group.path, group.root, native=True, scales=scales)
            group.other_blurs[blur] = key
        return self.groups[group.other_blurs[blur]]

    def _add_instance(self, part: Part, state: _State, group: Group) -> None:
        """A native instance: everything in it by its motion:blurScale, and what leaves its motion altogether."""
        shown = self.groups[self._instanced(part.prim, state)]
        self._at_blur(group, part.scales.blur).instances.setdefault(shown.key, []).append(part)
        for blur, key in shown.other_blurs.items():
            breakpoints: set[float] = set()
            if part.varying:
                breakpoints = transform_breakpoints(part.prim, group.root, self._context.shutter.scaled(blur))
            other = replace(part, breakpoints=tuple(sorted(breakpoints)), scales=replace(part.scales, blur=blur))
            self._at_blur(group, blur).instances.setdefault(key, []).append(other)
        path = part.prim.GetPath()
        if group.native:
            inner = path.MakeRelativePath(group.root.GetPath())
            group.resets.extend(inner.AppendPath(below) for below in shown.resets)
            return
        for below in shown.resets:
            self._add_apart(path.AppendPath(below), part.prim, state, group)

    def _add_apart(self, path: Sdf.Path, instance: Usd.Prim, state: _State, group: Group) -> None:
        """A subtree inside an instance, as if there were no instance."""
        stage = instance.GetStage()
        for prefix in path.GetParentPath().GetPrefixes()[instance.GetPath().pathElementCount :]:
            here = self._state(stage.GetPrimAtPath(prefix), state.below(), False, group)
            if here is None:
                return
            state = here
        self._scan(stage.GetPrimAtPath(path), state.below(), group, _DEFINED)

    def _take_skins_along(self, group: Group) -> None:
        """A skeleton places what it moves: where one has left its instance, so has all beside it."""
        root = group.root.GetPath()
        stage = group.root.GetStage()
        subtrees = (Usd.PrimRange(stage.GetPrimAtPath(root.AppendPath(path)), _DEFINED) for path in group.resets)
        if not any(prim.IsA(UsdSkel.Skeleton) for subtree in subtrees for prim in subtree):
            return
        for key in (group.key, *group.other_blurs.values()):
            emptied = self.groups[key]
            for parts in (emptied.shapes, emptied.lights, emptied.instancers):
                parts[:] = [part for part in parts if part.prim == group.root]
            emptied.instances.clear()
        children = group.root.GetFilteredChildren(_DEFINED)
        group.resets[:] = [child.GetPath().MakeRelativePath(root) for child in children]

    def _draw_mode(self, prim: Usd.Prim) -> str:
        """What is drawn in place of a prim; empty: the prim itself."""
        if not self._draw_modes:
            return ""
        mode = applied_draw_mode(prim)
        if mode == UsdGeom.Tokens.default_:
            return ""
        if mode in _DRAW_MODES:
            return mode
        message = f"found '{mode}', expected default, inherited, {', '.join(_DRAW_MODES)}; drawn in full"
        self._context.diagnostics.group(str(prim.GetPath()), "model:drawMode", message)
        return ""

    def _instanced(self, prim: Usd.Prim, state: _State) -> Hashable:
        """The group that a native instance shows; one for each set of looks and skeletal bindings that
        instances inherit."""
        material, _ = UsdShade.MaterialBindingAPI(prim).ComputeBoundMaterial(self._context.material_purpose)
        inherited = (
            state.purpose,
            str(material.GetPath()) if material else "",
            primvar_source(prim, "displayColor"),
            primvar_source(prim, "displayOpacity"),
            self._context.cache(InstancePrimvars).sources(prim, state.authored, state.inherited, self._context),
            self._context.cache(Skeletons).inherited_binding(prim),
            draw_mode(prim),
            state.scales,
        )
        key = ("instance", str(prim.GetPrototype().GetPath()), inherited)
        if key not in self.groups:
            group = Group(key, str(prim.GetPath()), prim, native=True, scales=state.scales)
            top = _State(False, state.purpose, scales=state.scales, inherited=state.inherited)
            self._add_group(group, top, prim, _DEFINED)
        return key
