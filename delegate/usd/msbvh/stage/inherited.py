"""What prims inherit that most of them do not: primvars and material bindings."""

from __future__ import annotations

from collections.abc import Iterable

from pxr import Usd

PREFIXES = ("primvars:", "material:binding")


def inheritable(authored: Iterable[str]) -> frozenset[str]:
    """Those of a prim's property names that prims below inherit."""
    return frozenset(name for name in authored if name.startswith(PREFIXES))


def inherited_names(prim: Usd.Prim) -> frozenset[str]:
    """The names of such properties that have opinions on ancestors, not on the prim itself."""
    names: set[str] = set()
    prim = prim.GetParent()
    while prim and not prim.IsPseudoRoot():
        names.update(inheritable(prim.GetAuthoredPropertyNames()))
        prim = prim.GetParent()
    return frozenset(names)
