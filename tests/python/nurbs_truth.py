"""NURBS by their definition (Piegl and Tiller, The NURBS Book, equations 2.5 and 4.15), and stages with patches. Nothing
is shared with the renderer's own evaluation."""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np
from pxr import Gf, UsdGeom, Vt
from recording import Shot


def basis(knots: np.ndarray, order: int, count: int, parameter: float) -> np.ndarray:
    """float64[count]: the basis functions at a parameter, by the recursion of Cox and de Boor."""
    last = knots[count]
    inside = max(i for i in range(order - 1, count) if knots[i] <= parameter and knots[i] < last)
    values = np.zeros(len(knots) - 1)
    values[inside] = 1.0
    for p in range(1, order):
        higher = np.zeros(len(values) - 1)
        for i in range(len(higher)):
            for share, width, which in (
                (parameter - knots[i], knots[i + p] - knots[i], i),
                (knots[i + p + 1] - parameter, knots[i + p + 1] - knots[i + 1], i + 1),
            ):
                higher[i] += share / width * values[which] if width > 0 else 0.0
        values = higher
    return values


@dataclass
class Patch:
    """A patch, and its surface by the definition."""

    points: np.ndarray
    """float64[V, U, 3]."""
    u_knots: list[float]
    v_knots: list[float]
    weights: np.ndarray | None = None
    """float64[V, U]."""
    ranges: dict[str, tuple[float, float]] = field(default_factory=dict)

    @property
    def u_order(self) -> int:
        return len(self.u_knots) - self.points.shape[1]

    @property
    def v_order(self) -> int:
        return len(self.v_knots) - self.points.shape[0]

    def at(self, u: float, v: float, values: np.ndarray | None = None, weighted: bool = True) -> np.ndarray:
        """The surface, or what values of the control points (float64[V, U, ...]) are there."""
        rows, columns = self.points.shape[:2]
        share = np.outer(
            basis(np.array(self.v_knots), self.v_order, rows, v),
            basis(np.array(self.u_knots), self.u_order, columns, u),
        )
        if self.weights is not None and weighted:
            share = share * self.weights
        return np.tensordot(share, self.points if values is None else values, axes=2) / share.sum()

    def parameters(self, name: str, cells: int | None = None) -> np.ndarray:
        """The ends of `cells` equal pieces of each span; as many as the degree where None."""
        knots, order = (self.u_knots, self.u_order) if name == "u" else (self.v_knots, self.v_order)
        begin, end = self.ranges.get(name, (knots[order - 1], knots[len(knots) - order]))
        cells = cells or order - 1
        inner = [knot for knot in sorted(set(knots)) if begin < knot < end]
        ends = [begin, *inner, end]
        return np.unique(np.concatenate([np.linspace(a, b, cells + 1) for a, b in pairwise(ends)]))

    def surface(self, cells: int | None = None) -> np.ndarray:
        """float64[N, 3]: where parameters() cross."""
        return np.array([self.at(u, v) for v in self.parameters("v", cells) for u in self.parameters("u", cells)])

    def define(self, shot: Shot, path: str = "/Patch") -> UsdGeom.NurbsPatch:
        patch = UsdGeom.NurbsPatch.Define(shot.stage, path)
        patch.CreatePointsAttr(vectors(self.points))
        patch.CreateUVertexCountAttr(self.points.shape[1])
        patch.CreateVVertexCountAttr(self.points.shape[0])
        patch.CreateUOrderAttr(self.u_order)
        patch.CreateVOrderAttr(self.v_order)
        patch.CreateUKnotsAttr(self.u_knots)
        patch.CreateVKnotsAttr(self.v_knots)
        if self.weights is not None:
            patch.CreatePointWeightsAttr(self.weights.ravel().tolist())
        for name, (begin, end) in self.ranges.items():
            patch.GetPrim().GetAttribute(f"{name}Range").Set(Gf.Vec2d(begin, end))
        return patch


def vectors(points: np.ndarray) -> Vt.Vec3fArray:
    return Vt.Vec3fArray.FromNumpy(np.ascontiguousarray(points.reshape(-1, 3), np.float32))


def clamped(count: int, order: int) -> list[float]:
    """Knots that start and end at the first and the last control point."""
    return [0.0] * order + list(range(1, count - order + 1)) + [float(count - order + 1)] * order


def bumpy(
    seed: int = 1, columns: int = 6, rows: int = 5, orders: tuple[int, int] = (4, 3), rational: bool = False
) -> Patch:
    """A sheet of about 4 x 4 with random heights."""
    random = np.random.default_rng(seed)
    x, y = np.meshgrid(np.linspace(-2, 2, columns), np.linspace(-2, 2, rows))
    points = np.stack([x, y, random.uniform(-0.7, 0.7, x.shape)], axis=-1) + random.uniform(-0.2, 0.2, (*x.shape, 3))
    weights = random.uniform(0.4, 2.5, x.shape) if rational else None
    return Patch(
        points.astype(np.float32).astype(float), clamped(columns, orders[0]), clamped(rows, orders[1]), weights
    )


_CIRCLE = np.array([(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1), (1, 0)], float)
_CIRCLE_WEIGHTS = np.where(np.arange(9) % 2, np.sqrt(0.5), 1.0)
_CIRCLE_KNOTS = [0.0, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 4]


def cylinder(radius: float = 1.0, height: float = 2.0) -> Patch:
    """Around y, its ends open; the circle lies along u."""
    circle = np.stack([_CIRCLE[:, 0], np.zeros(9), -_CIRCLE[:, 1]], axis=-1) * radius
    points = np.stack([circle - (0, height / 2, 0), circle + (0, height / 2, 0)])
    return Patch(points, _CIRCLE_KNOTS, [0.0, 0, 1, 1], np.stack([_CIRCLE_WEIGHTS, _CIRCLE_WEIGHTS]))


def sphere(radius: float = 1.0) -> Patch:
    """From pole to pole along v: half a circle that turns about y."""
    half = np.array([(0, -1), (1, -1), (1, 0), (1, 1), (0, 1)], float)
    half_weights = np.where(np.arange(5) % 2, np.sqrt(0.5), 1.0)
    points = np.stack([np.stack([_CIRCLE[:, 0] * r, np.full(9, y), -_CIRCLE[:, 1] * r], axis=-1) for r, y in half])
    weights = np.outer(half_weights, _CIRCLE_WEIGHTS)
    return Patch(points * radius, _CIRCLE_KNOTS, [0.0, 0, 0, 1, 1, 2, 2, 2], weights)


def torus(tube: float = 0.4) -> Patch:
    """Closed both ways, about y."""
    points = np.stack(
        [
            np.stack([_CIRCLE[:, 0] * (1 + tube * a), np.full(9, tube * b), -_CIRCLE[:, 1] * (1 + tube * a)], axis=-1)
            for a, b in _CIRCLE
        ]
    )
    return Patch(points, _CIRCLE_KNOTS, _CIRCLE_KNOTS, np.outer(_CIRCLE_WEIGHTS, _CIRCLE_WEIGHTS))


def periodic(columns: int = 7) -> Patch:
    """A tube whose last control points are its first ones, on even knots."""
    angles = np.arange(columns + 3) * (2 * np.pi / columns)
    circle = np.stack([np.cos(angles), np.zeros_like(angles), -np.sin(angles)], axis=-1)
    points = np.stack([circle + (0, y, 0) for y in (-1.0, -0.3, 0.4, 1.0)])
    return Patch(points, [float(k) for k in range(columns + 7)], clamped(4, 4))
