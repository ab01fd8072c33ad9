"""What came of a frame's budget, for the user and for scripts."""

from __future__ import annotations

from typing import Any

from ..base.reporter import Reporter
from ..output.stats import FrameStats
from .budget import SLACK, Goals, Outcome

UNITS = {"error_px": " px", "flip": " FLIP", "seconds": " s"}


def tell_budget(stats: FrameStats, goals: Goals, outcome: Outcome, reporter: Reporter) -> None:
    """Notes what was found, in stats.budget and on stderr; an error line for each goal that was missed."""
    frame = "default time" if stats.frame is None else f"frame {stats.frame:g}"
    found: dict[str, float] = {}
    misses = outcome.misses(goals, sum(stats.seconds.values()))
    if goals.error_px is not None:
        worst = max(stats.tracks, key=_error)
        found["error_px"] = _error(worst)
        misses += _too_far(worst, goals.error_px)
    if goals.flip is not None and outcome.flip is not None:
        found["flip"] = outcome.flip
    if goals.seconds is not None:
        found["seconds"] = sum(stats.seconds.values())
    stats.budget = {**found, "samples": outcome.samples, "misses": misses}
    kept = ", ".join(f"{value:.3g}{UNITS[name]}" for name, value in found.items())
    reporter.note(f"{frame}: budget: {outcome.samples} samples a pixel, {kept}")
    for miss in misses:
        reporter.error(f"{frame}: {miss}")


def _error(track: dict[str, Any]) -> float:
    """Of motion or of shape, whichever is larger; pixels."""
    return float(max(track["error_pixels"], track["shape_error_pixels"] or 0.0))


def _too_far(worst: dict[str, Any], wanted: float) -> list[str]:
    if _error(worst) <= wanted * SLACK:
        return []
    if _error(worst) > worst["error_pixels"]:
        return [f"--target-error {wanted:g}px: the shape of {worst['path']} is off by {_error(worst):.3g} px"]
    return [
        f"--target-error {wanted:g}px: {worst['path']} is off by {worst['error_pixels']:.3g} px, on {worst['segments']} segments"
    ]
