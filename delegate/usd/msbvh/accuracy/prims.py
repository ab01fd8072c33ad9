"""Prim by prim: which track it has, and what the next cheaper and the next dearer one would bring."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from pxr import Usd

from ..base.errors import Diagnostics
from ..motion_report.report import DEGREES
from ..scene.reader import ReadSettings, read_frame
from ..stage.opening import tf_messages
from .facts import SceneFacts
from .motion_knobs import TOLERANCES
from .options import Options
from .points import Point

MOST_PRIMS = 500
"""That are listed: those that move, the worst first, then those that take the most bytes."""


@dataclass(frozen=True)
class Track:
    """How a prim's motion is kept; of several tracks of one path, the one that moves most, and the sums."""

    source: str
    segments: int
    degree: int
    error_px: float
    bytes: int
    count: int

    @property
    def words(self) -> str:
        """As reports call it: "3 cubics"."""
        if self.segments == 0:
            return "still"
        name = DEGREES[self.degree] + ("s" if self.segments > 1 else "")
        return f"{self.segments} {name}"

    @property
    def keys(self) -> int:
        """Control points in a row."""
        return self.segments * self.degree + 1

    @property
    def form(self) -> tuple[int, int]:
        return self.segments, self.degree


def tracks_by_path(reports: Sequence[Any]) -> dict[str, Track]:
    """Of what a reading reports, without the camera."""
    by_path: dict[str, list[Any]] = {}
    for report in reports:
        if report.source != "camera":
            by_path.setdefault(report.path, []).append(report)
    return {path: _merged(found) for path, found in by_path.items()}


def _merged(found: Sequence[Any]) -> Track:
    main = max(found, key=lambda track: (track.segments, track.degree))
    return Track(
        source=main.source,
        segments=main.segments,
        degree=main.degree,
        error_px=max(track.error_pixels for track in found),
        bytes=sum(track.bytes for track in found),
        count=max(track.count for track in found),
    )


def prim_rows(
    stage: Usd.Stage,
    facts: SceneFacts,
    settings: ReadSettings,
    points: Mapping[Options, Point],
    base: Options,
) -> list[dict[str, Any]]:
    """Of the prims that are drawn; reads the frame once for each other tolerance."""
    now = tracks_by_path(facts.tracks)
    ladder = _ladder(stage, facts, settings) if facts.moves and not settings.segments else {}
    shares = _shares(points, base)
    rows = [_row(path, track, ladder, settings.motion_tolerance, shares) for path, track in now.items()]
    rows.sort(key=lambda row: (-(row["error_px"] or 0.0), -row["bytes"], row["path"]))
    return rows[:MOST_PRIMS]


def _ladder(stage: Usd.Stage, facts: SceneFacts, settings: ReadSettings) -> dict[float, dict[str, Track]]:
    found = {}
    for tolerance in TOLERANCES:
        if tolerance != settings.motion_tolerance:
            with tf_messages(Diagnostics()):
                read = read_frame(stage, facts.frame, replace(settings, motion_tolerance=tolerance))
            found[tolerance] = tracks_by_path(read.tracks)
    return found


def _shares(points: Mapping[Options, Point], base: Options) -> dict[str, Mapping[str, float]]:
    """What a sample of the base's rays says of each prim."""
    runs = points[base].runs
    costs = runs[0].stats["render"].get("ray_costs") if runs else None
    return {row["path"]: row for row in costs["prims"]} if costs else {}


def _row(
    path: str,
    track: Track,
    ladder: Mapping[float, Mapping[str, Track]],
    tolerance: float,
    shares: Mapping[str, Mapping[str, float]],
) -> dict[str, Any]:
    share = shares.get(path, {})
    cheaper = next((found for found in _others(path, track, ladder, tolerance, 1)), None)
    dearer = next((found for found in _others(path, track, ladder, tolerance, -1)), None)
    return {
        "path": path,
        "source": track.source,
        "track": track.words,
        "error_px": track.error_px,
        "shape_px": None,
        "bytes": track.bytes,
        "keys": track.keys,
        "count": track.count,
        "trace_share": share.get("share"),
        "build_share": share.get("build_share"),
        "cheaper": _plain(cheaper, track),
        "dearer": _plain(dearer, track),
    }


def _others(
    path: str, track: Track, ladder: Mapping[float, Mapping[str, Track]], tolerance: float, way: int
) -> list[tuple[float, Track]]:
    """Other tracks, by the tolerances that ask for them; way 1: cheaper ones, -1: dearer ones; the next first."""
    asked = sorted((value for value in ladder if (value - tolerance) * way > 0.0), key=lambda value: way * value)
    found = [(value, ladder[value][path]) for value in asked if path in ladder[value]]
    return [(value, other) for value, other in found if other.form != track.form]


def _plain(found: tuple[float, Track] | None, track: Track) -> dict[str, Any] | None:
    if found is None:
        return None
    tolerance, other = found
    return {
        "track": other.words,
        "error_px": other.error_px,
        "bytes": other.bytes,
        "bytes_change": other.bytes - track.bytes,
        "tolerance": tolerance,
        "frame_share": None,
    }
