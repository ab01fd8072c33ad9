"""Subdivision by its rules, written out: what a cage's limit surface is held against.

Nothing here is OpenSubdiv's. E. Catmull, J. Clark, CAD 10(6), 1978; C. Loop, "Smooth Subdivision Surfaces Based on
Triangles", 1987; creases and their decay by T. DeRose, M. Kass, T. Truong, "Subdivision Surfaces in Character Animation",
SIGGRAPH 1998. After n steps the polygons lie off the limit surface by 4^-n of how far the cage does.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

INFINITE = 10.0
"""Sharpness that does not run down, as USD has it."""
Edge = tuple[int, int]


def edge_of(a: int, b: int) -> Edge:
    """The same from either end."""
    return (min(a, b), max(a, b))


def sides(face: Sequence[int]) -> Iterator[tuple[int, int]]:
    """Of a polygon, from each corner to the next."""
    return zip(face, (*face[1:], face[0]), strict=True)


@dataclass(frozen=True)
class Cage:
    """A cage's topology after some steps, and where its vertices are as sums of the first one's."""

    faces: tuple[tuple[int, ...], ...]
    scheme: str
    weights: np.ndarray
    """float64[V, N] of V vertices by the N of the first cage."""
    boundary: str = "edgeAndCorner"
    creases: Mapping[Edge, float] = field(default_factory=dict)
    corners: Mapping[int, float] = field(default_factory=dict)
    hidden: tuple[bool, ...] = ()
    """Of each face, whether it shapes the others and is not drawn."""

    @staticmethod
    def of(
        faces: Sequence[Sequence[int]],
        count: int,
        scheme: str = "catmullClark",
        boundary: str = "edgeAndCorner",
        creases: Mapping[Edge, float] | None = None,
        corners: Mapping[int, float] | None = None,
        holes: Sequence[int] = (),
    ) -> Cage:
        """A cage of `count` vertices."""
        cage = Cage(
            tuple(map(tuple, faces)),
            scheme,
            np.eye(count),
            boundary,
            {edge_of(*edge): sharpness for edge, sharpness in (creases or {}).items()},
            corners or {},
        )
        rim = {vertex for edge, around in cage.edge_faces().items() if len(around) == 1 for vertex in edge}
        open_rim = boundary == "none" and scheme != "bilinear"
        hidden = tuple(i in holes or (open_rim and not rim.isdisjoint(face)) for i, face in enumerate(cage.faces))
        return replace(cage, hidden=hidden)

    def refined(self, steps: int) -> Cage:
        """After some more steps."""
        return self._step().refined(steps - 1) if steps else self

    def drawn(self) -> tuple[np.ndarray, np.ndarray]:
        """Counts int[F] and indices int[sum(counts)] of the faces that are not hidden."""
        faces = [face for face, hidden in zip(self.faces, self.hidden, strict=True) if not hidden]
        return np.array([len(face) for face in faces], int), np.array([v for face in faces for v in face], int)

    def edge_faces(self) -> dict[Edge, list[int]]:
        """The faces at each edge, in the order of the faces."""
        found: dict[Edge, list[int]] = {}
        for i, face in enumerate(self.faces):
            for a, b in sides(face):
                found.setdefault(edge_of(a, b), []).append(i)
        return found

    def _step(self) -> Cage:
        return _Step(self).result()


def less_sharp(sharpness: float) -> float:
    """After a step."""
    return sharpness if sharpness >= INFINITE else max(0.0, sharpness - 1.0)


class _Step:
    """One step of refinement."""

    def __init__(self, cage: Cage) -> None:
        self._cage = cage
        self._edge_faces = cage.edge_faces()
        self._edges = list(self._edge_faces)
        self._vertex_faces: dict[int, list[int]] = {}
        for i, face in enumerate(cage.faces):
            for vertex in face:
                self._vertex_faces.setdefault(vertex, []).append(i)
        self._vertex_edges: dict[int, list[Edge]] = {}
        for edge in self._edges:
            for vertex in edge:
                self._vertex_edges.setdefault(vertex, []).append(edge)
        self._centres = np.array([cage.weights[list(face)].mean(axis=0) for face in cage.faces])

    def result(self) -> Cage:
        """Vertices are the old ones, then one an edge, then, but for Loop, one a face."""
        cage, count = self._cage, len(self._cage.weights)
        old = np.array([self._vertex_point(vertex) for vertex in range(count)])
        middles = np.array([self._edge_point(edge) for edge in self._edges])
        by_edge = {edge: count + i for i, edge in enumerate(self._edges)}
        parts = [old, middles] if cage.scheme == "loop" else [old, middles, self._centres]
        faces, hidden = self._children(by_edge, count + len(self._edges))
        return replace(
            cage,
            faces=tuple(faces),
            weights=np.concatenate(parts),
            hidden=tuple(hidden),
            creases={
                edge_of(vertex, by_edge[edge]): less_sharp(sharpness)
                for edge, sharpness in cage.creases.items()
                if edge in by_edge
                for vertex in edge
            },
            corners={vertex: less_sharp(sharpness) for vertex, sharpness in cage.corners.items()},
        )

    def _children(self, by_edge: Mapping[Edge, int], first_centre: int) -> tuple[list[tuple[int, ...]], list[bool]]:
        faces: list[tuple[int, ...]] = []
        hidden: list[bool] = []
        for i, face in enumerate(self._cage.faces):
            out = [by_edge[edge_of(a, b)] for a, b in sides(face)]
            back = [*out[-1:], *out[:-1]]
            if self._cage.scheme == "loop":
                made = [*zip(face, out, back, strict=True), tuple(out)]
            else:
                made = [(v, after, first_centre + i, before) for v, after, before in zip(face, out, back, strict=True)]
            faces += made
            hidden += [self._cage.hidden[i]] * len(made)
        return faces, hidden

    def _sharpness(self, edge: Edge) -> float:
        """Boundaries, and edges of more than two faces, are sharp."""
        return INFINITE if len(self._edge_faces[edge]) != 2 else self._cage.creases.get(edge, 0.0)

    def _corner(self, vertex: int) -> float:
        alone = len(self._vertex_faces.get(vertex, ())) == 1
        if alone and self._cage.boundary == "edgeAndCorner":
            return INFINITE
        return self._cage.corners.get(vertex, 0.0)

    def _edge_point(self, edge: Edge) -> np.ndarray:
        weights, around = self._cage.weights, self._edge_faces[edge]
        middle = weights[list(edge)].mean(axis=0)
        share = min(self._sharpness(edge), 1.0)
        if self._cage.scheme == "bilinear" or share == 1.0:
            return middle
        if self._cage.scheme == "loop":
            opposite = [vertex for i in around for vertex in self._cage.faces[i] if vertex not in edge]
            smooth = 0.75 * middle + 0.125 * weights[opposite].sum(axis=0)
        else:
            smooth = 0.5 * middle + 0.25 * self._centres[around].sum(axis=0)
        return share * middle + (1.0 - share) * smooth

    def _vertex_point(self, vertex: int) -> np.ndarray:
        """By the rule of this step and of the next one, where sharpness runs down in between."""
        own = self._cage.weights[vertex]
        if self._cage.scheme == "bilinear" or vertex not in self._vertex_edges:
            return own
        edges = self._vertex_edges[vertex]
        now = [self._sharpness(edge) for edge in edges]
        corner = self._corner(vertex)
        rule = self._by_rule(vertex, edges, now, corner)
        later = self._by_rule(vertex, edges, [less_sharp(s) for s in now], less_sharp(corner))
        if rule[0] == later[0]:
            return rule[1]
        running_out = [s for s in (*now, corner) if s > 0.0 and less_sharp(s) == 0.0]
        share = float(np.mean(running_out))
        return share * rule[1] + (1.0 - share) * later[1]

    def _by_rule(
        self, vertex: int, edges: Sequence[Edge], sharpness: Sequence[float], corner: float
    ) -> tuple[str, np.ndarray]:
        weights = self._cage.weights
        own = weights[vertex]
        far = [b if a == vertex else a for a, b in edges]
        sharp = [v for v, s in zip(far, sharpness, strict=True) if s > 0.0]
        if corner > 0.0 or len(sharp) > 2:
            return "corner", own
        if len(sharp) == 2:
            return "crease", 0.75 * own + 0.125 * weights[sharp].sum(axis=0)
        n = len(edges)
        if self._cage.scheme == "loop":
            beta = (0.625 - (0.375 + 0.25 * np.cos(2.0 * np.pi / n)) ** 2) / n
            return "smooth", (1.0 - n * beta) * own + beta * weights[far].sum(axis=0)
        middles = 0.5 * (own + weights[far].mean(axis=0))
        centres = self._centres[self._vertex_faces[vertex]].mean(axis=0)
        return "smooth", (centres + 2.0 * middles + (n - 3.0) * own) / n
