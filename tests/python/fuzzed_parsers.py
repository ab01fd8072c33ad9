"""The reader's own parsing, called with bytes as a fuzzer makes them: options, binary layers' tables, a stage's numbers.

Each entry takes bytes and returns, or raises AssertionError, or what must not be. Hypothesis calls them in `make test`
(test_fuzz.py), atheris in `make fuzz`: `python fuzzed_parsers.py ENTRY [atheris's options]`.
"""

from __future__ import annotations

import contextlib
import gc
import math
import os
import random
import struct
import sys
import tempfile
from collections.abc import Callable
from functools import cache
from pathlib import Path
from types import FunctionType
from unittest import mock

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests" / "python"))
import click
from damaged_crates import sound_crates
from msbvh.base.errors import Diagnostics, SceneError
from msbvh.cli.budget_options import Quantity
from msbvh.cli.option_types import SEGMENT_COUNTS, Names, Numbers, PowerOfTwo, ShutterRange
from msbvh.farm import frames
from msbvh.farm.frames import FrameError, frame_jobs, parse_frame_specs
from msbvh.stage.crate_check import crate_fault
from msbvh.stage.stage_metadata import LARGEST_RATE, frames_per_second, start_time
from pxr import Usd

_PIECES = (
    *(
        "0",
        "1",
        "10",
        "-",
        "+",
        ".",
        ":",
        "x",
        ",",
        " ",
        "e",
        "1e300",
        "-1e308",
        "1e-320",
        "nan",
        "inf",
        "#",
        "###",
        "##.##",
    ),
    *("9" * 30, "0" * 5000, "px", "s", "\u0663", "\u00b2", "_", "0x", "a/", ".exr", "\n", "\0", "\ud800"),
)
MOST_FRAMES = 2000
_TYPES = (
    Names(),
    Names(("a", "b")),
    Numbers(),
    PowerOfTwo(),
    ShutterRange(),
    Quantity("px", "0.25px"),
    Quantity("", "0.02", 1e-4, 1.0),
    Quantity("s", "40s"),
)


def _text(data: bytes) -> str:
    """Pieces of what is parsed; from 128 on, characters."""
    return "".join(_PIECES[byte % len(_PIECES)] if byte < 128 else chr(byte) for byte in data)


def _require_line(said: str) -> None:
    """A message that is one line is for the caller to make; it says what was found or expected."""
    assert said.strip(), "a message without words"


def frame_specs(data: bytes) -> None:
    """Time codes that are finite, as many as there may be at most (fewer here), and a file of its own for each."""
    with mock.patch.object(frames, "MAX_FRAMES", MOST_FRAMES):
        _frame_specs(*_text(data).partition("|")[::2])


def _frame_specs(specs: str, output: str) -> None:
    try:
        times, precision = parse_frame_specs(specs)
        assert len(times) <= MOST_FRAMES and precision >= 0
        assert all(map(math.isfinite, times[:100] + times[-100:])), specs
        if len(times) < 1000:
            jobs = frame_jobs([output or "a.###.##.exr"], specs)
            assert len({files for _, files in jobs}) == len(jobs)
    except FrameError as error:
        _require_line(str(error))


def options(data: bytes) -> None:
    """Values that the rest can work with, or click's own error."""
    if not data:
        return
    kind, text = _TYPES[data[0] % len(_TYPES)], _text(data[1:])
    try:
        value = kind.convert(text, None, None)
    except click.UsageError as error:
        _require_line(error.message)
        return
    if isinstance(kind, PowerOfTwo):
        assert value in SEGMENT_COUNTS
    elif isinstance(kind, Quantity):
        assert math.isfinite(value) and value > 0
    elif isinstance(kind, ShutterRange):
        assert len(value) == 2 and not value[1] < value[0], text  # The camera's shutter warns of what is not finite.
    elif isinstance(kind, Numbers):
        assert value and all(0 <= number <= 4096 for number in value)


@cache
def _crates() -> list[bytes]:
    with tempfile.TemporaryDirectory() as folder:
        return sound_crates(Path(folder))


@cache
def _scratch() -> str:
    return tempfile.mkstemp(suffix=".usdc", dir="/dev/shm" if os.path.isdir("/dev/shm") else None)[1]


def _damage(content: bytearray, data: bytes) -> None:
    """Numbers at places, eight bytes each, which the bytes say; most of them in the table of sections and in what begins a
    section, where counts are."""
    (contents,) = struct.unpack_from("<q", content, 16)
    starts = [struct.unpack_from("<q", content, contents + 8 + 32 * i + 16)[0] for i in range(6)]
    places = [
        *range(8, 32, 8),
        *range(contents, contents + 200, 8),
        *(start + 8 * i for start in starts for i in range(8)),
    ]
    sizes = (
        0,
        1,
        8,
        127,
        255,
        2**31 - 1,
        2**31,
        2**32,
        2**40,
        2**61,
        2**63 - 1,
        2**63,
        2**64 - 1,
        len(content),
        contents,
    )
    for at in range(0, len(data) - 1, 2):
        place = places[data[at] % len(places)] if data[at] < 224 else (data[at] * 256 + data[at + 1]) % len(content)
        number = sizes[data[at + 1] % len(sizes)] if data[at + 1] < 192 else data[at + 1] - 192
        if place + 8 <= len(content):
            struct.pack_into("<Q", content, place, number)


def crate_tables(data: bytes) -> None:
    """Words, or none, whatever the tables of a binary layer say; and no more memory than a file of that size is worth."""
    crates = _crates()
    content = bytearray(crates[data[0] % len(crates)] if data else b"")
    if data and data[0] >= 240:
        content = bytearray(b"PXR-USDC" + data[1:])
    elif data:
        _damage(content, data[2:])
        del content[len(content) - (data[1] * len(content) // 1024 if len(data) > 1 and data[1] > 200 else 0) :]
    Path(_scratch()).write_bytes(content)
    fault = crate_fault(_scratch())
    assert fault == "" or (fault.startswith("found ") and "\n" not in fault), fault


def stage_numbers(data: bytes) -> None:
    """Rates in their range, and a start that is finite or refused."""
    numbers = struct.unpack("<3d", data[:24].ljust(24, b"\0"))
    stage = Usd.Stage.CreateInMemory()
    for name, number in zip(("timeCodesPerSecond", "framesPerSecond", "startTimeCode"), numbers, strict=True):
        with contextlib.suppress(Exception):  # USD refuses some.
            stage.SetMetadata(name, number)
    report = Diagnostics()
    assert 1.0 / LARGEST_RATE <= frames_per_second(stage, report) <= LARGEST_RATE
    try:
        assert math.isfinite(start_time(stage))
    except SceneError as error:
        _require_line(str(error))


def stage_texts(data: bytes) -> None:
    """A sound layer's text with faults, by the number that the bytes are: read and rendered."""
    from mutations import mutated, outcome

    found = outcome(mutated(int.from_bytes(data[:8], "little"))[1])
    assert not found.startswith("WRONG"), found


def stages(data: bytes) -> None:
    """A stage that hypothesis makes of the bytes: read and rendered."""
    from fuzzed_stages import one_input

    one_input(data)


ENTRIES: dict[str, Callable[[bytes], None]] = {
    entry.__name__: entry for entry in (frame_specs, options, crate_tables, stage_numbers, stage_texts, stages)
}


def seeded(count: int, seed: int = 0) -> list[bytes]:
    """Inputs for an entry where there is no fuzzer."""
    dice = random.Random(seed)
    return [dice.randbytes(dice.choice((1, 4, 12, 40, 200))) for _ in range(count)]


def _instrument() -> None:
    """Every function of the package, so that what an input reaches is seen. atheris's own hook on imports does not see an
    editable installation's modules."""
    import msbvh.scene.reader  # noqa: F401  What the stages' entries import when they are called.

    for each in gc.get_objects():
        if isinstance(each, FunctionType) and str(each.__module__).startswith("msbvh"):
            atheris.instrument_func(each)


if __name__ == "__main__":
    import atheris

    _instrument()
    atheris.Setup([sys.argv[0], *sys.argv[2:]], ENTRIES[sys.argv[1]])
    atheris.Fuzz()
