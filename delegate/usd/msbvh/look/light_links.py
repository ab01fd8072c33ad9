"""Light linking: which lights illuminate which prims, and which of their shadows they cast (UsdLux, "Linking Lights to
Geometry"). Prims that the same lights treat alike are a light group; group 0 is what all lights reach."""

from __future__ import annotations

from collections.abc import Iterable

from pxr import Sdf, Usd

from ..stage.value_types import BOOL
from ..stage.values import value

LINKS = ("lightLink", "shadowLink")


class Links:
    """Of all lights of a stage. Those whose collections hold everything take no part."""

    def __init__(self, lights: Iterable[Usd.Prim]) -> None:
        self._queries: list[tuple[str, str, Usd.CollectionMembershipQuery]] = []
        for prim in lights:
            for name in LINKS:
                collection = Usd.CollectionAPI(prim, name)
                if _is_restricted(collection):
                    self._queries.append((str(prim.GetPath()), name, collection.ComputeMembershipQuery()))
        self._groups: dict[tuple[bool, ...], int] = {(True,) * len(self._queries): 0}

    @property
    def any(self) -> bool:
        """Whether anything may be left out."""
        return bool(self._queries)

    def group(self, path: Sdf.Path) -> int:
        """Of a prim that is drawn."""
        key = tuple(bool(query.IsPathIncluded(path)) for _, _, query in self._queries)
        return self._groups.setdefault(key, len(self._groups))

    def group_of_all(self, paths: Iterable[Sdf.Path]) -> int | None:
        """Of prims that stand for each other; None where links tell them apart."""
        found = {self.group(path) for path in paths}
        return found.pop() if len(found) == 1 else None

    def of(self, light: Usd.Prim) -> tuple[list[bool], list[bool]]:
        """Whether it illuminates each group, and is shadowed by it; empty: all. After all prims have a group."""
        return self._held(light, "lightLink"), self._held(light, "shadowLink")

    def _held(self, light: Usd.Prim, name: str) -> list[bool]:
        path = str(light.GetPath())
        for place, (owner, link, _) in enumerate(self._queries):
            if (owner, link) == (path, name):
                return [key[place] for key in self._groups]
        return []


def _is_restricted(collection: Usd.CollectionAPI) -> bool:
    """Whether a light's collection may leave out prims; by default it holds all."""
    targets = (collection.GetIncludesRel(), collection.GetExcludesRel())
    return (
        any(relationship and relationship.GetTargets() for relationship in targets)
        or value(collection.GetIncludeRootAttr(), Usd.TimeCode.Default(), BOOL) is False
        or collection.GetMembershipExpressionAttr().HasAuthoredValue()
    )
