"""`msbvh motion` for people: which prims move, how and why, at a glance."""

from __future__ import annotations

from collections.abc import Sequence

from ..motion.samples import COMPOSED_TRANSFORM, FoundSamples
from .report import DEGREES, MotionReport, PrimMotion

MOST_TIMES_IN_A_LINE = 6
WIDEST_PATH = 64
"""Characters; a longer path has a line of its own, so that the columns stay on the screen."""
HEADER = ("prim", "moved by", "track", "segments", "error px", "within px", "bytes")


def motion_text(report: MotionReport, prim: str | None, verbose: bool) -> str:
    """A line on the shutter and an aligned table of what moves, with rules and samples where a prim was asked
    for or `verbose`; how many are still."""
    named = None if prim is None else "/" + prim.lstrip("/")
    shown = [found for found in report.prims if verbose or not found.still or found.path == named]
    lines = [_headline(report)]
    if shown:
        rows = [_cells(found) for found in shown]
        columns = zip(HEADER, *rows, strict=True)
        widths = [max(len(cell) for cell in column if len(cell) <= WIDEST_PATH) for column in columns]
        lines.append(_line(HEADER, widths))
        for found, row in zip(shown, rows, strict=True):
            lines.append(_line(row, widths))
            if verbose or prim is not None:
                lines.extend(f"    {line}" for line in _details(found))
    return "\n".join([*lines, _sum(report, len(shown))])


def beyond_text(report: MotionReport, segments: int | None, interpolation: str) -> str:
    """One line on the tracks that miss the tolerance, and what helps given the settings that were asked for."""
    count, worst = len(report.beyond), report.beyond[0]
    what = "1 track misses" if count == 1 else f"{count} tracks miss"
    at = f"{worst.path} by {worst.error_pixels:.4g} px on {_plural(worst.segments, 'segment')}"
    which = at if count == 1 else f"the worst is {at}"
    return f"{what} the tolerance of {worst.tolerance_pixels:g} px: {which}; {_advice(segments, interpolation)}"


def _advice(segments: int | None, interpolation: str) -> str:
    """What helps where no allowed track follows a motion (advice() in delegate/translate/fit.h)."""
    if segments is not None:
        return "more --segments help, or none given"
    if interpolation != "auto":
        return "--interpolation auto may help"
    return "no track has more segments; a shorter shutter or a larger --motion-tolerance helps"


def _plural(count: int, noun: str) -> str:
    return f"{count:,} {noun}" + ("" if count == 1 else "s")


def _headline(report: MotionReport) -> str:
    frame = "default time" if report.frame is None else f"frame {report.frame:g}"
    opening, closing = report.shutter
    if not closing > opening or report.frame is None:
        shutter = "shutter closed: nothing moves"
    else:
        shutter = f"shutter {opening:+g} to {closing:+g} frames"
    return f"{frame}, {report.camera}, {shutter}, tolerance {report.tolerance_pixels:g} px"


def _cells(found: PrimMotion) -> tuple[str, ...]:
    many = f" (x {found.count:,})" if found.count > 1 else ""
    track = found.track
    if found.moving_transform and found.segments:
        track = track.replace("moving transform", f"moving transform, {DEGREES[found.degree]}")
    missed = " !" if found.beyond else ""
    error = "-" if found.segments == 0 and not missed else f"{found.error_pixels:.3g}{missed}"
    if 0.0 < found.error_pixels < 5e-4:
        error = "< 0.001"
    return (
        found.path + many,
        found.source,
        track,
        str(found.segments or "-"),
        error,
        f"{found.tolerance_pixels:g}",
        f"{found.bytes:,}",
    )


def _line(cells: Sequence[str], widths: Sequence[int]) -> str:
    """Words to the left, numbers to the right."""
    own_line = f"{cells[0]}\n" if len(cells[0]) > WIDEST_PATH else ""
    pairs = list(zip(("" if own_line else cells[0], *cells[1:]), widths, strict=True))
    words, numbers = pairs[:3], pairs[3:]
    return own_line + "  ".join([c.ljust(w) for c, w in words] + [c.rjust(w) for c, w in numbers])


def _details(found: PrimMotion) -> list[str]:
    lines = [f"rule     {found.rule}"]
    names = [_name(samples, found.path) for samples in found.samples]
    width = max(map(len, names), default=0)
    for name, samples in zip(names, found.samples, strict=True):
        lines.append(f"samples  {name:{width}}  {_times(samples)}")
    lines.extend(f"warning  {warning}" for warning in found.warnings)
    return lines


def _name(samples: FoundSamples, path: str) -> str:
    """Of a prim's own attributes the name alone."""
    prefix = f"{path}."
    name = samples.attribute.removeprefix(prefix)
    return "transform" if name == COMPOSED_TRANSFORM and not samples.authored else name


def _times(samples: FoundSamples) -> str:
    times = samples.times
    listed = [f"{time:.7g}" for time in times]
    if len(times) > MOST_TIMES_IN_A_LINE:
        listed = [*listed[:2], "...", *listed[-2:]]
    at = f"{_plural(len(times), 'time')}: {', '.join(listed)}"
    if samples.authored:
        return f"authored at {at}" if times else "authored for all times"
    if samples.attribute.endswith((f".{COMPOSED_TRANSFORM}", ".points")):
        return f"computed by the stage at {at}"
    return f"a spline with knots at {at}" if times else "a spline"


def _sum(report: MotionReport, shown: int) -> str:
    still = sum(found.still for found in report.prims)
    moving = len(report.prims) - still
    what = f"{_plural(moving, 'prim')} {'moves' if moving == 1 else 'move'}" if moving else "nothing moves"
    hint = "; --verbose lists them" if shown < len(report.prims) else ""
    return what + (f", {still:,} {'is' if still == 1 else 'are'} still{hint}" if still else "")
