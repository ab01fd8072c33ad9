"""What stands in for a model by its draw mode: its origin, its bounds, or cards (UsdGeomModelAPI)."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np
from pxr import Usd, UsdGeom

from .._core import MeshInput, PixelSize
from ..motion.boxes import Box
from ..motion.context import FrameContext
from ..motion.points import Samples, still
from ..motion.times import sample_times
from ..stage.rendering_space import rendered_color
from ..stage.value_types import FLOAT3, FLOAT3S
from ..stage.values import value
from .cards import Cards, read_cards

_CORNERS = np.array(list(product((0, 1), repeat=3)), float)
_EDGES = np.array([(a, b) for a in range(8) for b in range(8) if a < b and (_CORNERS[a] != _CORNERS[b]).sum() == 1])
_AXES = np.stack([np.zeros((3, 3)), np.eye(3)], axis=1)
"""float64[3, 2, 3]: the lines of an origin."""
_FACES = np.array([(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)])
"""Of a box by its corners, counter-clockwise seen from outside."""
_FALLBACK_COLOUR = (0.18, 0.18, 0.18)
_THICKEST = 0.02
"""Of the model's size: how thick a line is at most."""


@dataclass
class StandIn:
    """A stand-in over the shutter. Lines are bars along the axes, a pixel thick where they are seen nearest: Storm's
    lines, which are a pixel wide anywhere, have no place in a scene that others reflect."""

    mode: str
    boxes: list[tuple[float | None, Box]]
    """By time01; of the model, in its own space."""
    colour: np.ndarray
    """float32[3]."""
    cards: Cards | None
    held: bool

    @property
    def box(self) -> Box:
        """Around all there is."""
        points = [self._lines(box).reshape(-1, 3) if self.cards is None else self._quads(box) for _, box in self.boxes]
        return Box.around(np.concatenate(points))

    def fill(self, mesh: MeshInput, matrices: np.ndarray, pixel_size: PixelSize) -> Samples:
        """Sets the topology and what is seen on it, under float64[T, 4, 4] matrices. Returns the points."""
        if self.cards is None:
            half = self._half_thickness(matrices, pixel_size)
            poses = [(time01, _bars(self._lines(box), half)) for time01, box in self.boxes]
            count = len(poses[0][1]) // 8
            faces = (np.arange(count)[:, None, None] * 8 + _FACES).reshape(-1, 4)
            mesh.display_color = "constant", self.colour[None], None
        else:
            poses = [(time01, self._quads(box)) for time01, box in self.boxes]
            faces = np.arange(len(poses[0][1])).reshape(-1, 4)
            mesh.display_color = "uniform", self.cards.colours, None
            mesh.display_opacity = "uniform", self.cards.opacities, None
        mesh.face_vertex_counts = np.full(len(faces), 4, np.int32)
        mesh.face_vertex_indices = faces.ravel().astype(np.int32)
        samples = [(time01, points.astype(np.float32)) for time01, points in poses]
        return Samples(samples[:1] if still(samples) else samples, self.held)

    def _lines(self, box: Box) -> np.ndarray:
        """float64[K, 2, 3]."""
        if self.mode == UsdGeom.Tokens.origin:
            return _AXES
        return (box.lo + (box.hi - box.lo) * _CORNERS)[_EDGES]

    def _quads(self, box: Box) -> np.ndarray:
        """float64[4 K, 3]."""
        assert self.cards is not None
        places = self.cards.places.reshape(-1, 3)
        return places if self.cards.absolute else box.lo + (box.hi - box.lo) * places

    def _half_thickness(self, matrices: np.ndarray, pixel_size: PixelSize) -> np.ndarray:
        """float64[3]: half a pixel along each axis of the model, where a line comes nearest."""
        box = self.box
        corners = np.ascontiguousarray((box.corners() @ matrices[..., :3])[:, None])
        stretch = np.linalg.norm(matrices[:, :3, :3], axis=-1).max(axis=0)
        most = 0.5 * _THICKEST * (box.hi - box.lo).max()
        return np.minimum(0.5 * pixel_size.at_boxes(corners)[0] / np.maximum(stretch, 1e-30), most)


def _bars(lines: np.ndarray, half: np.ndarray) -> np.ndarray:
    """float64[8 K, 3]: the corners of boxes around float64[K, 2, 3] lines."""
    low, high = lines.min(axis=1) - half, lines.max(axis=1) + half
    return (low[:, None] + (high - low)[:, None] * _CORNERS).reshape(-1, 3)


def read_stand_in(prim: Usd.Prim, mode: str, context: FrameContext) -> StandIn | None:
    """None, with a note, for a model without an extent that would need one."""
    given = prim.GetAttribute("model:drawModeColor")
    found = value(given, context.code, FLOAT3) if given else None
    colour = np.array(rendered_color(found, given) if found else _FALLBACK_COLOUR, np.float32)
    cards = read_cards(prim, colour, context) if mode == UsdGeom.Tokens.cards else None
    if mode == UsdGeom.Tokens.origin or (cards is not None and cards.absolute):
        boxes: list[tuple[float | None, Box]] = [(None, Box(np.zeros(3), np.zeros(3)))]
    else:
        boxes = _extents(prim, context)
    if not boxes or (cards is not None and not len(cards.places)):
        message = f"empty: draw mode '{mode}' finds no extent" if not boxes else "empty: it has no cards"
        context.diagnostics.group(str(prim.GetPath()), "", message, "note")
        return None
    return StandIn(mode, boxes, colour, cards, context.held)


def _extents(prim: Usd.Prim, context: FrameContext) -> list[tuple[float | None, Box]]:
    """The model's box at the frame, and, where its extentsHint changes within the shutter, at the hint's samples. [] where
    there is none at one of these times."""
    hint = prim.GetAttribute("extentsHint")
    known = bool(hint) and value(hint, context.code, FLOAT3S) is not None
    times = sample_times([hint], context.shutter) if known else []
    boxes: list[tuple[float | None, Box]] = []
    for time in times:
        boxes.append((context.shutter.time01(time), _extent(prim, Usd.TimeCode(time), context)))
    boxes = boxes or [(None, _extent(prim, context.code, context))]
    sound = all(np.isfinite(box.ends()).all() and (box.lo <= box.hi).all() for _, box in boxes)
    return boxes if sound else []


def _extent(prim: Usd.Prim, code: Usd.TimeCode, context: FrameContext) -> Box:
    cache = UsdGeom.BBoxCache(code, list(context.purposes), useExtentsHint=True)
    bound = cache.ComputeUntransformedBound(prim).ComputeAlignedRange()
    if bound.IsEmpty():
        return Box.empty()
    return Box(np.array(bound.GetMin()), np.array(bound.GetMax()))
