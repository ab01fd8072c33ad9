"""What came of a frame's budget, for the user and for scripts."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from ..base.reporter import Reporter
from ..output.stats import PHASES, FrameStats
from .budget import SLACK, Goals, Outcome

UNITS = {"error_px": " px", "flip": " FLIP", "seconds": " s"}


def tell_budget(stats: FrameStats, goals: Goals, outcome: Outcome, reporter: Reporter) -> None:
    """Notes what was found, in stats.budget and on stderr; an error line for each goal that was missed."""
    frame = "default time" if stats.frame is None else f"frame {stats.frame:g}"
    found: dict[str, float] = {}
    seconds = sum(stats.seconds[phase] for phase in PHASES)
    misses = outcome.misses(goals, seconds)
    unknown: list[str] = []
    if goals.error_px is not None:
        unknown = unknown_shapes(stats.tracks)
        worst = max(stats.tracks, key=_error)
        found["error_px"] = _error(worst)
        misses += _too_far(worst, goals.error_px)
    if goals.flip is not None and outcome.flip is not None:
        found["flip"] = outcome.flip
    if goals.seconds is not None:
        found["seconds"] = seconds
    stats.budget = {**found, "samples": outcome.samples, "unknown_shapes": unknown, "misses": misses}
    if unknown:
        others = f" (and {len(unknown) - 1} more prims)" if len(unknown) > 1 else ""
        reporter.warning(
            f"{unknown[0]}: --target-error: how far its shape strays is not known{others}; its motion keeps the target"
        )
    kept = ", ".join(f"{value:.3g}{UNITS[name]}" for name, value in found.items())
    reporter.note(f"{frame}: budget: {outcome.samples} samples a pixel, {kept}")
    for miss in misses:
        reporter.error(f"{frame}: {miss}")


def unknown_shapes(tracks: Sequence[dict[str, Any]]) -> list[str]:
    """Paths of what is drawn without a measure of its shape."""
    drawn = [track for track in tracks if track["source"] not in ("camera", "light", "instances")]
    return [track["path"] for track in drawn if track["shape_error_pixels"] is None]


def _moved(track: dict[str, Any]) -> float:
    """The error of motion, pixels. What is outside of the picture is held to a tolerance of its own, so many times the goal."""
    share = track["error_pixels"] / track["tolerance_pixels"]
    return float(track["error_pixels"] if not track["error_outside"] or share > SLACK else 0.0)


def _error(track: dict[str, Any]) -> float:
    """Of motion or of shape, whichever is larger; pixels."""
    return float(max(_moved(track), track["shape_error_pixels"] or 0.0))


def _too_far(worst: dict[str, Any], wanted: float) -> list[str]:
    if _error(worst) <= wanted * SLACK:
        return []
    if _error(worst) > _moved(worst):
        return [f"--target-error {wanted:g}px: the shape of {worst['path']} is off by {_error(worst):.3g} px"]
    return [
        f"--target-error {wanted:g}px: {worst['path']} is off by {worst['error_pixels']:.3g} px, on {worst['segments']} segments"
    ]
