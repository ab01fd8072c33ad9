"""What prims inherit that most of them do not: looked up once for siblings."""

from __future__ import annotations

from pxr import Sdf, Usd

PREFIXES = ("primvars:", "material:binding")


class Inherited:
    """Whether ancestors of a prim author a primvar or bind a material; remembered for parents, since siblings come
    by the thousand."""

    def __init__(self) -> None:
        self._names: dict[Sdf.Path, frozenset[str]] = {}

    def above(self, prim: Usd.Prim) -> frozenset[str]:
        """The names of such properties on ancestors, not on the prim itself."""
        return self._at(prim.GetParent())

    def binds_material(self, prim: Usd.Prim, authored: frozenset[str]) -> bool:
        """Whether a prim with those properties or its ancestors may have a material."""
        return any(name.startswith("material:binding") for names in (authored, self.above(prim)) for name in names)

    def _at(self, prim: Usd.Prim) -> frozenset[str]:
        unknown = []  # A loop: stages may be deeper than Python's stack.
        while prim and not prim.IsPseudoRoot() and prim.GetPath() not in self._names:
            unknown.append(prim)
            prim = prim.GetParent()
        names = self._names.get(prim.GetPath(), frozenset()) if prim else frozenset()
        for each in reversed(unknown):
            own = frozenset(name for name in each.GetAuthoredPropertyNames() if name.startswith(PREFIXES))
            names = self._names[each.GetPath()] = names | own
        return names
