"""Prim by prim: which track it has, and what the next cheaper and the next finer one would bring."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from pxr import Usd

from ..base.errors import Diagnostics
from ..motion_report.one_path import instance_count, worst_track
from ..motion_report.report import DEGREES
from ..scene.reader import ReadSettings, read_frame
from ..stage.opening import tf_messages
from .facts import SceneFacts
from .measure import Measurement
from .motion_knobs import TOLERANCES
from .options import Options
from .points import Point


@dataclass(frozen=True)
class Track:
    """How a prim's motion is kept; of several tracks of one path, the one that moves most, and the sums."""

    source: str
    segments: int
    degree: int
    error_px: float
    outside: bool
    """Its error is of what is outside of the picture."""
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
    worst = worst_track(found)
    return Track(
        source=main.source,
        segments=main.segments,
        degree=main.degree,
        error_px=worst.error_pixels,
        outside=worst.error_outside,
        bytes=sum(track.bytes for track in found),
        count=instance_count(found),
    )


def prim_rows(
    stage: Usd.Stage,
    facts: SceneFacts,
    settings: ReadSettings,
    measurement: Measurement,
    base: Options,
) -> list[dict[str, Any]]:
    """Of the prims that are drawn; reads the frame once for each other tolerance."""
    now = tracks_by_path(facts.tracks)
    ladder = _ladder(stage, facts, settings) if facts.moves and not settings.segments else {}
    shares = _shares(measurement.points[base])
    shapes = measurement.shapes.by_prim(base)
    changes = FrameChanges(now, ladder, shares, measurement, base)
    rows = [
        {
            **_row(path, track, ladder, settings.motion_tolerance, changes),
            "shape_px": shapes.get(path),
            "trace_share": changes.rays(path),
            "build_share": changes.rays(path, "build_share"),
        }
        for path, track in now.items()
    ]
    rows.sort(key=lambda row: (row["outside"], -(row["error_px"] or 0.0), -row["bytes"], row["path"]))
    return rows


def _ladder(stage: Usd.Stage, facts: SceneFacts, settings: ReadSettings) -> dict[float, dict[str, Track]]:
    found = {}
    for tolerance in TOLERANCES:
        if tolerance != settings.motion_tolerance:
            with tf_messages(Diagnostics()):
                read = read_frame(stage, facts.frame, replace(settings, motion_tolerance=tolerance))
            found[tolerance] = tracks_by_path(read.tracks)
    return found


def _shares(point: Point) -> dict[str, Mapping[str, float]]:
    """What a sample of a point's rays says of each prim."""
    costs = point.runs[0].stats["render"].get("ray_costs") if point.runs else None
    return {row["path"]: row for row in costs["prims"]} if costs else {}


@dataclass(frozen=True)
class FrameChanges:
    """What another track of one prim does to the frame's time.

    No frame was rendered with one prim changed alone. Those of the motion axis change all prims whose track another tolerance
    changes: the difference in time is split among them, by their shares of the rays' time. What the clock cannot tell from the
    machine's own noise is not told.
    """

    now: Mapping[str, Track]
    ladder: Mapping[float, Mapping[str, Track]]
    shares: Mapping[str, Mapping[str, float]]
    measurement: Measurement
    base: Options

    def rays(self, path: str, name: str = "share") -> float | None:
        """A prim's share of the base's rays; of an instancer that of its prototypes, where they lie below it."""
        if path in self.shares:
            return self.shares[path][name]
        below = [row[name] for one, row in self.shares.items() if one.startswith(f"{path}/")]
        return sum(below) if below else None

    def share(self, path: str, tolerance: float) -> float | None:
        """Of the frame's time, below 0 for less; None where it is not known."""
        points = self.measurement.points
        held = self.base.without("segments")
        other = points.get(Options.of({"motion-tolerance": tolerance}).over(held))
        start = points[self.base]
        own = self.rays(path)
        if other is None or not other.runs or not start.runs or own is None:
            return None
        change = other.frame_seconds / start.frame_seconds
        if 1.0 / self.measurement.noise <= change <= self.measurement.noise:
            return None
        others = self.ladder[tolerance]
        changed = [one for one, track in self.now.items() if one in others and others[one].form != track.form]
        together = sum(self.rays(one) or 0.0 for one in changed)
        return (change - 1.0) * own / together if together > 0.0 else None


def _row(
    path: str,
    track: Track,
    ladder: Mapping[float, Mapping[str, Track]],
    tolerance: float,
    changes: FrameChanges,
) -> dict[str, Any]:
    cheaper = next((found for found in _others(path, track, ladder, tolerance, 1)), None)
    finer = next((found for found in _others(path, track, ladder, tolerance, -1)), None)
    return {
        "path": path,
        "source": track.source,
        "track": track.words,
        "error_px": track.error_px,
        "outside": track.outside,
        "bytes": track.bytes,
        "keys": track.keys,
        "count": track.count,
        "cheaper": _plain(path, cheaper, track, changes),
        "finer": _plain(path, finer, track, changes),
    }


def _others(
    path: str, track: Track, ladder: Mapping[float, Mapping[str, Track]], tolerance: float, way: int
) -> list[tuple[float, Track]]:
    """Other tracks, by the tolerances that ask for them; way 1: cheaper ones, -1: finer ones; the next first."""
    asked = sorted((value for value in ladder if (value - tolerance) * way > 0.0), key=lambda value: way * value)
    found = [(value, ladder[value][path]) for value in asked if path in ladder[value]]
    return [(value, other) for value, other in found if other.form != track.form]


def _plain(path: str, found: tuple[float, Track] | None, track: Track, changes: FrameChanges) -> dict[str, Any] | None:
    if found is None:
        return None
    tolerance, other = found
    return {
        "track": other.words,
        "error_px": other.error_px,
        "bytes": other.bytes,
        "bytes_change": other.bytes - track.bytes,
        "tolerance": tolerance,
        "frame_share": changes.share(path, tolerance),
    }
