"""What prims inherit that most of them do not: looked up once for siblings."""

from __future__ import annotations

from pxr import Sdf, Usd


class InheritedPrimvars:
    """Whether ancestors of a prim author a primvar; remembered for parents, since siblings come by the
    thousand."""

    def __init__(self) -> None:
        self._names: dict[Sdf.Path, frozenset[str]] = {}

    def has(self, prim: Usd.Prim, name: str) -> bool:
        """Of the ancestors, not of the prim itself."""
        return f"primvars:{name}" in self._at(prim.GetParent())

    def _at(self, prim: Usd.Prim) -> frozenset[str]:
        if not prim or prim.IsPseudoRoot():
            return frozenset()
        path = prim.GetPath()
        if path not in self._names:
            own = frozenset(str(p) for p in prim.GetAuthoredPropertyNames() if str(p).startswith("primvars:"))
            self._names[path] = self._at(prim.GetParent()) | own
        return self._names[path]
