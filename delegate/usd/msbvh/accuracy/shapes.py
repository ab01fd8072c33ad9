"""Shape errors in pixels, for settings that cut surfaces differently: from a reading of the frame that measures them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from pxr import Usd

from ..base.errors import Diagnostics, SceneError
from ..render.fine_enough import read_within
from ..scene.reader import ReadResult, ReadSettings, read_frame
from ..stage.opening import tf_messages
from .kinds import DECIDED_BY
from .options import Options


class ShapeErrors:
    """Of one frame; each way of cutting is read once."""

    def __init__(self, stage: Usd.Stage, frame: float | None, settings: ReadSettings, has_shapes: bool) -> None:
        """`has_shapes`: whether anything in the frame is cut at all; if not, no error is 0 and nothing is read."""
        self._stage = stage
        self._frame = frame
        self._settings = settings
        self._has_shapes = has_shapes
        self._known: dict[Options, Mapping[str, float | None]] = {}

    def by_prim(self, options: Options) -> Mapping[str, float | None]:
        """Pixels by path; None where it is not known how far a prim strays."""
        if not self._has_shapes:
            return {}
        plain = options.plain()
        key = Options.of({name: plain[name] for name in DECIDED_BY["shape"] if name in plain})
        if key not in self._known:
            self._known[key] = self._measured(key)
        return self._known[key]

    def largest(self, options: Options) -> float | None:
        """Of all prims that it is known of; None where it is known of none."""
        known = [error for error in self.by_prim(options).values() if error is not None]
        return max(known) if known else None

    def fine_enough(self, pixels: float) -> Options:
        """A tolerance, and the coarsest ways of cutting that keep an error: render/fine_enough.py. Raises SceneError."""
        tolerance = Options.of({"motion-tolerance": pixels})
        if not self._has_shapes:
            return tolerance

        def read(settings: ReadSettings) -> ReadResult:
            with tf_messages(Diagnostics()):
                return read_frame(self._stage, self._frame, settings)

        settings = replace(self._settings, segments=0)
        _, used = read_within(self._stage, read, settings, pixels)
        assert used.edge_length is not None
        return Options.of({"edge-length": used.edge_length, "complexity": used.complexity}).over(tolerance)

    def _measured(self, options: Options) -> Mapping[str, float | None]:
        chosen: dict[str, Any] = {name.replace("-", "_"): value for name, value in options.pairs}
        settings = replace(self._settings, measure_shape=True, **chosen)
        try:
            with tf_messages(Diagnostics()):
                tracks = read_frame(self._stage, self._frame, settings).tracks
        except SceneError:
            return {}
        return shape_errors(tracks)


def shape_errors(tracks: Sequence[Any]) -> dict[str, float | None]:
    """By path, without the camera; of several tracks of a path the largest."""
    found: dict[str, float | None] = {}
    for track in tracks:
        if track.source == "camera":
            continue
        known = [error for error in (found.get(track.path), track.shape_error_pixels) if error is not None]
        found[track.path] = max(known) if known else None
    return found
