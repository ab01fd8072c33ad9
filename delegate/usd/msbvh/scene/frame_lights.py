"""The lights of a frame in their places, and what light links say of what is drawn."""

from __future__ import annotations

from typing import Any

from pxr import Sdf

from ..look.light_links import Links
from ..look.light_values import Switches
from ..look.lights import add_lights, add_mesh_light, shining_mesh
from ..look.portals import Portal, Portals, portal_targets
from ..motion.context import FrameContext
from ..motion.transforms import Motion, XformCaches
from ..stage.usd_faults import leaving_out
from .instances import Placement
from .part import Part
from .traversal import WORLD, Traversal


class FrameLights:
    """Hands lights and light groups down."""

    def __init__(self, traversal: Traversal, caches: XformCaches, context: FrameContext, translator: Any) -> None:
        self._traversal = traversal
        self._caches = caches
        self._context = context
        self._translator = translator

    def links(self) -> Links:
        """Of all lights of the frame."""
        return Links(part.prim for group in self._traversal.groups.values() for part in group.lights)

    def _links(self, placements: list[Placement]) -> Links:
        """With the light groups of all that is drawn, which the translator gets."""
        groups = self._traversal.groups
        links = self.links()
        if not links.any:
            return links
        found = {str(part.prim.GetPath()): [links.group(part.prim.GetPath())] for part in groups[WORLD].shapes}
        for placement in placements[1:]:
            own = self._groups_of(placement, links)
            if found.setdefault(placement.path, own) != own:
                message = "light links that tell nested instances apart by more than one prim are not supported yet"
                self._context.diagnostics.group(placement.path, "", f"{message}; those of the first count for all")
        self._translator.set_light_groups(groups=found)
        return links

    def _groups_of(self, placement: Placement, links: Links) -> list[int]:
        """Of each instance that is placed together, or of all of them."""
        group = self._traversal.groups[placement.key]
        start = group.root.GetPath()
        inside = [part.prim.GetPath() for part in group.shapes] if group.native else [start]
        known: dict[Sdf.Path, int] = {}
        for home in placement.homes():
            if home in known:
                continue
            paths = [path.ReplacePrefix(start, home) if group.native else home for path in inside]
            found = links.group_of_all(paths or [home])
            if found is None:
                found = links.group(home)
                message = "light links that tell parts of an instance apart are not supported yet"
                self._context.diagnostics.group(str(home), "", f"{message}; the instance's own count for all of it")
            known[home] = found
        if len(set(known.values())) == 1:
            return [next(iter(known.values()))]
        return [known[home] for home in placement.homes()]

    def add(self, placements: list[Placement]) -> int:
        """Hands down all lights that are placed, and the light groups of all that is drawn. Returns how many lights."""
        count = 0
        links = self._links(placements)
        portals = self._portals(placements)
        shining: set[str] = set()
        for placement in placements:
            group = self._traversal.groups[placement.key]
            for part in group.lights:
                with leaving_out(part.prim, self._context.code):
                    count += self._add_light(part, placement, links, portals, shining)
        return count

    def _add_light(self, part: Part, placement: Placement, links: Links, portals: Portals, shining: set[str]) -> int:
        """In all places that are placed together; one whose mesh shines is handed down once."""
        path = str(part.prim.GetPath())
        geometry = shining_mesh(part.prim)
        if geometry is None:
            if path in portals.used:
                return 0
            motion = self._light_motion(part, placement)
            switches = Switches(part.blinking, placement.visible)
            guides = portals.of(part.prim, self._context)
            return add_lights(self._translator, part.prim, switches, motion, self._context, links, guides)
        if path in shining:
            return 0
        shining.add(path)
        return add_mesh_light(self._translator, part.prim, geometry, self._context, links)

    def _light_motion(self, part: Part, placement: Placement) -> Motion:
        root = self._traversal.groups[placement.key].root
        shutter = self._context.shutter.scaled(part.scales.blur)
        motion = self._caches.motion([part.prim], root, part.varying, shutter, part.breakpoints)
        return motion.inside(placement.motion)

    def _portals(self, placements: list[Placement]) -> Portals:
        found: dict[str, list[Portal]] = {}
        used: set[str] = set()
        for placement in placements:
            for part in self._traversal.groups[placement.key].lights:
                if part.prim.GetTypeName() == "PortalLight":
                    portal = Portal(part.prim, self._light_motion(part, placement))
                    found.setdefault(str(part.prim.GetPath()), []).append(portal)
                else:
                    used.update(portal_targets(part.prim))
        return Portals(found, used)
