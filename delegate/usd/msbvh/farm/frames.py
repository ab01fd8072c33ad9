"""Which frames to render, and the file that each one goes to: usdrecord's FrameSpecs and `###` placeholders.

A FrameSpec is `START`, `START:END` or `START:ENDxSTRIDE` in time codes; specs are joined by commas. The rules
are those of UsdUtils.TimeCodeRange and UsdAppUtils.framesArgs. usd-core has the former, but its wheel crashes
on some malformed specs ("1:" after an exception), so that command line input must not reach it.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

MAX_FRAMES = 1_000_000
"""More frames than this in one command are a slip of the finger."""

_NUMBER = re.compile(r"\s*[+-]?(\d+(\.\d*)?|\.\d+)([eE][+-]?\d+)?")
_PLACEHOLDER = re.compile(r"[^#]*(#+(?:\.#+)?)[^#]*")


class FrameError(ValueError):
    """A FrameSpec or an output name is malformed; str() is one line that says what was found and expected."""


@dataclass(frozen=True)
class FrameRange:
    """Time codes `start + i * stride`, up to and including `end` where the stride meets it."""

    start: float
    end: float
    stride: float

    def steps(self) -> float:
        """How many there are, not rounded down; infinite or NaN where they cannot be counted."""
        # The expression of UsdUtilsTimeCodeRange::const_iterator, so that rounding falls the same way.
        return (self.end - self.start + self.stride) / self.stride

    def __len__(self) -> int:
        return math.floor(self.steps())

    def __iter__(self) -> Iterator[float]:
        return (self.start + self.stride * step for step in range(len(self)))


def parse_frame_specs(text: str) -> tuple[list[float], int]:
    """Parses comma-separated FrameSpecs.

    Returns the time codes in the order given, and the digits behind the point that a file name needs to tell
    neighbours apart (those of the longest stride, usdrecord's rule). Raises FrameError.
    """
    frames: list[float] = []
    precision = 0
    for spec in text.split(","):
        frame_range = _parse_frame_spec(spec)
        if not frame_range.steps() < MAX_FRAMES - len(frames) + 1:
            raise FrameError(f"FrameSpec '{spec}' makes more than {MAX_FRAMES} frames; expected fewer")
        frames.extend(frame_range)
        precision = max(precision, _digits_behind_point(spec.partition(":")[2].partition("x")[2]))
    return frames, precision


def _parse_frame_spec(spec: str) -> FrameRange:
    start_text, colon, rest = spec.partition(":")
    start = _parse_time_code(start_text, spec)
    if not colon:
        return FrameRange(start, start, 1.0)
    end_text, separator, stride_text = rest.partition("x")
    end = _parse_time_code(end_text, spec)
    if not separator:
        return FrameRange(start, end, 1.0 if end >= start else -1.0)
    stride = _parse_time_code(stride_text, spec)
    if stride == 0.0:
        raise FrameError(f"invalid FrameSpec '{spec}': the stride is zero")
    if end != start and (end > start) != (stride > 0.0):
        side = "below" if stride > 0.0 else "above"
        raise FrameError(f"invalid FrameSpec '{spec}': the end is {side} the start, against the stride's sign")
    return FrameRange(start, end, stride)


def _parse_time_code(text: str, spec: str) -> float:
    value = float(text) if _NUMBER.fullmatch(text) else math.nan
    if not math.isfinite(value):
        raise FrameError(
            f"invalid FrameSpec '{spec}': found '{text}' where a time code is expected"
            " (START, START:END or START:ENDxSTRIDE, joined by commas)"
        )
    return value


def _digits_behind_point(number: str) -> int:
    return len(number.partition(".")[2])


def find_placeholder(output: str) -> str | None:
    """The one group of hashes in a file name (`###` or `###.##`), or None where there is none or more than
    one."""
    match = _PLACEHOLDER.fullmatch(output)
    return match.group(1) if match else None


def format_frame(output: str, placeholder: str, frame: float) -> str:
    """Puts a time code where the placeholder stands: padded with zeros to its width, as precise as its second
    group."""
    precision = _digits_behind_point(placeholder)
    return output.replace(placeholder, f"{frame:0{len(placeholder)}.{precision}f}")


def output_files(output: str, frames: list[float], precision: int) -> list[tuple[float, str]]:
    """Pairs every frame with its file; a frame named twice is rendered once.

    `precision` comes from parse_frame_specs(). A single frame needs no placeholder (usdrecord wants one).
    Raises FrameError where the name has none, where it is too coarse, and where two frames would go to the
    same file.
    """
    placeholder = find_placeholder(output)
    if len(frames) == 1 and "#" not in output:
        return [(frames[0], output)]
    if placeholder is None:
        raise FrameError(
            f"output '{output}' must contain exactly one frame placeholder, ### or ###.###, for many frames"
        )
    if _digits_behind_point(placeholder) < precision:
        raise FrameError(
            f"output '{output}': the frames need {precision} digits behind the point,"
            f" but the placeholder {placeholder} has {_digits_behind_point(placeholder)}"
        )
    frame_of_file: dict[str, float] = {}
    for frame in frames:
        file = format_frame(output, placeholder, frame)
        if frame_of_file.setdefault(file, frame) != frame:
            raise FrameError(f"frames {frame_of_file[file]:g} and {frame:g} would both be written to '{file}'")
    return [(frame, file) for file, frame in frame_of_file.items()]


def frame_jobs(outputs: Sequence[str], specs: str) -> list[tuple[float, tuple[str, ...]]]:
    """Every frame of the FrameSpecs with the files that it goes to, one for each of `outputs`. Raises
    FrameError."""
    frames, precision = parse_frame_specs(specs)
    columns = [output_files(output, frames, precision) for output in outputs]
    return [(row[0][0], tuple(file for _, file in row)) for row in zip(*columns, strict=True)]


def check_single_outputs(outputs: Sequence[str]) -> None:
    """Raises FrameError for a placeholder where no range of frames is rendered: the file would be named
    `###`."""
    for output in outputs:
        if "#" in output:
            raise FrameError(f"output '{output}' has a frame placeholder, but there is no --frames to fill it")
