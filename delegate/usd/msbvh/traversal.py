"""What a stage has to draw, as groups: the world, and every subtree that instances share.

A group's parts are known relative to its root. Groups refer to others by native instances and point
instancers, so the whole is an acyclic graph; instances.py flattens it.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterator
from dataclasses import dataclass, field

from pxr import Usd, UsdGeom, UsdShade

from .context import FrameContext
from .lights import is_light
from .meshes import is_shape
from .point_instancers import moving_attributes, prototypes
from .primvars import primvar_source

WORLD: Hashable = "world"

_DEFINED = Usd.TraverseInstanceProxies(Usd.PrimDefaultPredicate)
_PROTOTYPE = Usd.TraverseInstanceProxies(Usd.PrimIsActive & Usd.PrimIsLoaded)
"""Prototypes of point instancers may be mere overs, which keeps them out of the normal traversal."""


@dataclass(frozen=True)
class Part:
    """A prim in a group."""

    prim: Usd.Prim
    varying: bool
    """Whether a transform between the group's root and the prim, its own included, may change over time."""
    blinking: tuple[Usd.Attribute, ...] = ()
    """Visibilities, likewise, that change inside the shutter: lights are switched by them."""


@dataclass
class Group:
    """A subtree that is drawn as a whole."""

    path: str
    root: Usd.Prim | None
    """Its own transform is not the group's but its users'; None: the world."""
    shapes: list[Part] = field(default_factory=list)
    lights: list[Part] = field(default_factory=list)
    instancers: list[Part] = field(default_factory=list)
    instances: dict[Hashable, list[Part]] = field(default_factory=dict)
    """Native instances by the group that they show."""


@dataclass(frozen=True)
class _State:
    """What prims inherit on the way down."""

    varying: bool
    purpose: str
    blinking: tuple[Usd.Attribute, ...] = ()
    hidden: bool = False
    """Invisible at the frame, but not for the whole shutter: only lights are drawn then."""


class Traversal:
    """Scans a stage: groups by key, the world's first."""

    def __init__(self, context: FrameContext, purposes: list[str]) -> None:
        """`purposes` are drawn beside the default one."""
        self.groups: dict[Hashable, Group] = {}
        self.authored_times: set[float] = set()
        """Time codes within the shutter at which a transform or an instancer has a sample."""
        self._context = context
        self._purposes = {"default", *purposes}
        self._add_group(WORLD, None, _State(False, "default"), context.stage.GetPseudoRoot(), _DEFINED)

    @staticmethod
    def prototype_key(prim: Usd.Prim) -> Hashable:
        """The key of the group that a point instancer's prototype makes."""
        return ("prototype", str(prim.GetPath()))

    def _add_group(
        self, key: Hashable, root: Usd.Prim | None, state: _State, top: Usd.Prim, predicate: object
    ) -> None:
        group = Group(str(top.GetPath()), root)
        self.groups[key] = group
        for prim, prim_state in self._descend(top, state, group, predicate):
            self._sort(prim, prim_state, group)

    def _descend(
        self, top: Usd.Prim, state: _State, group: Group, predicate: object
    ) -> Iterator[tuple[Usd.Prim, _State]]:
        """The visible prims of a subtree, in namespace order, down to instances and point instancers."""
        pending = [(top, state)]
        while pending:
            prim, above = pending.pop()
            is_root = group.root is not None and prim == group.root
            here = self._state(prim, above, is_root)
            if here is None:
                continue
            if not here.hidden:
                self._warn_of_reset(prim, group, is_root)
                self._warn_of_draw_mode(prim)
            yield prim, here
            if (prim.IsInstance() and not is_root) or prim.IsA(UsdGeom.PointInstancer):
                continue
            if prim.IsInstance() and predicate is _PROTOTYPE:
                predicate = (
                    _DEFINED  # Inside a native prototype everything is defined, seen from the instance.
                )
            pending.extend((child, here) for child in reversed(prim.GetFilteredChildren(predicate)))

    def _state(self, prim: Usd.Prim, above: _State, is_root: bool) -> _State | None:
        """What holds at a prim; None if it is invisible. A group's root is seen as its users are."""
        if not prim.IsA(UsdGeom.Imageable):
            return above
        imageable = UsdGeom.Imageable(prim)
        blinking, hidden = above.blinking, above.hidden
        if not is_root:
            visibility = imageable.GetVisibilityAttr()
            blinks = self._blinks(visibility)
            if visibility.Get(self._context.code) == UsdGeom.Tokens.invisible:
                if not blinks:
                    return None
                hidden = True
            blinking += (visibility,) if blinks else ()
        purpose = imageable.GetPurposeAttr()
        name = str(purpose.Get()) if purpose.HasAuthoredValue() else above.purpose
        varying = above.varying
        if not is_root and prim.IsA(UsdGeom.Xformable):
            varying = self._varies(UsdGeom.Xformable(prim), above.varying)
        return _State(varying, name, blinking, hidden)

    def _blinks(self, visibility: Usd.Attribute) -> bool:
        """Whether a visibility changes inside the shutter, for more than its last instant."""
        shutter = self._context.shutter
        if not shutter.moving or not visibility.ValueMightBeTimeVarying():
            return False
        opening, closing = shutter.interval.min, shutter.interval.max
        inside = visibility.GetTimeSamplesInInterval(shutter.interval)
        return len({visibility.Get(time) for time in (opening, *inside) if time < closing}) > 1

    def _varies(self, xformable: UsdGeom.Xformable, above: bool) -> bool:
        shutter = self._context.shutter
        own = shutter.moving and xformable.TransformMightBeTimeVarying()
        if own:
            self.authored_times.update(xformable.GetTimeSamplesInInterval(shutter.interval))
        return own or (above and not xformable.GetResetXformStack())

    def _sort(self, prim: Usd.Prim, state: _State, group: Group) -> None:
        """Puts a prim where it belongs, or says that it is not drawn."""
        part = Part(prim, state.varying, state.blinking)
        if is_light(prim):
            group.lights.append(part)
        elif state.blinking and (is_shape(prim) or prim.IsInstance() or prim.IsA(UsdGeom.PointInstancer)):
            message = "changes within the shutter; what is no light is drawn, or not, as at the frame"
            self._context.diagnostics.group(str(prim.GetPath()), "visibility", message, "note")
        if state.hidden:
            return
        if prim.IsInstance() and prim != group.root:
            group.instances.setdefault(self._instanced(prim, state), []).append(part)
        elif prim.IsA(UsdGeom.PointInstancer):
            if state.purpose in self._purposes:
                self._add_instancer(part, group)
        elif is_shape(prim):
            if state.purpose in self._purposes:
                group.shapes.append(part)
        elif prim.IsA(UsdGeom.Gprim) or prim.GetTypeName() == "Volume":
            if state.purpose in self._purposes:
                message = f"prims of type {prim.GetTypeName()} are not supported yet; not drawn"
                self._context.diagnostics.group(str(prim.GetPath()), "", message)
        elif prim.GetTypeName() and not prim.GetPrimTypeInfo().GetSchemaType():
            message = f"prim type '{prim.GetTypeName()}' is unknown; not drawn"
            self._context.diagnostics.group(str(prim.GetPath()), "", message)

    def _add_instancer(self, part: Part, group: Group) -> None:
        group.instancers.append(part)
        instancer, shutter = UsdGeom.PointInstancer(part.prim), self._context.shutter
        if shutter.moving:
            for attribute in moving_attributes(instancer):
                self.authored_times.update(attribute.GetTimeSamplesInInterval(shutter.interval))
        for prim in prototypes(instancer):
            key = self.prototype_key(prim)
            if prim and key not in self.groups:
                xformable = UsdGeom.Xformable(prim)
                if xformable:  # The root's own transform counts with the instancer's.
                    self._varies(xformable, False)
                purpose = (
                    UsdGeom.Imageable(prim).ComputePurpose() if prim.IsA(UsdGeom.Imageable) else "default"
                )
                self._add_group(key, prim, _State(False, str(purpose)), prim, _PROTOTYPE)

    def _warn_of_reset(self, prim: Usd.Prim, group: Group, is_root: bool) -> None:
        """No two-level hierarchy holds what leaves its instance's place."""
        if group.root is not None and not is_root and prim.IsA(UsdGeom.Xformable):
            if UsdGeom.Xformable(prim).GetResetXformStack():
                message = "!resetXformStack! inside an instance is not supported; it moves with the instance"
                self._context.diagnostics.group(str(prim.GetPath()), "xformOpOrder", message)

    def _warn_of_draw_mode(self, prim: Usd.Prim) -> None:
        """They take effect on models: on components, on others by model:applyDrawMode (UsdGeomModelAPI)."""
        if not prim.IsModel():
            return
        model = UsdGeom.ModelAPI(prim)
        mode = model.ComputeModelDrawMode()
        applied = prim.IsComponent() or model.GetModelApplyDrawModeAttr().Get()
        if applied and mode != UsdGeom.Tokens.default_:
            message = f"draw mode '{mode}' is not supported yet; drawn in full"
            self._context.diagnostics.group(str(prim.GetPath()), "model:drawMode", message)

    def _instanced(self, prim: Usd.Prim, state: _State) -> Hashable:
        """The group that a native instance shows; one for each set of looks that instances inherit."""
        material, _ = UsdShade.MaterialBindingAPI(prim).ComputeBoundMaterial(UsdShade.Tokens.full)
        inherited = (
            state.purpose,
            str(material.GetPath()) if material else "",
            primvar_source(prim, "displayColor"),
            primvar_source(prim, "displayOpacity"),
        )
        key = ("instance", str(prim.GetPrototype().GetPath()), inherited)
        if key not in self.groups:
            self._add_group(key, prim, _State(False, state.purpose), prim, _DEFINED)
        return key
