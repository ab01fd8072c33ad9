"""Stages that hypothesis makes, and the reader's own parsing on bytes: drawn, or refused in one line, never an internal
error. `make fuzz` runs the same under atheris."""

from __future__ import annotations

from collections import Counter

import pytest
from batches import batches
from fuzzed_parsers import ENTRIES, crate_tables, frame_specs, options, seeded, stage_numbers
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from msbvh.cli.option_types import Numbers
from msbvh.farm.frames import FrameError, frame_jobs
from msbvh.stage.crate_check import crate_fault
from soak import is_soak, soak_count, soak_figure

PARSERS = (frame_specs, options, crate_tables, stage_numbers)
EXAMPLES = settings(
    derandomize=not is_soak(),
    max_examples=soak_count(150, 20_000),
    database=None,
    deadline=None,
    suppress_health_check=list(HealthCheck),
)


@pytest.mark.soak
def test_stages_of_every_schema_are_drawn_or_refused():
    """Prims, attributes of right and wrong types, time samples, relationships: no crash, no hang, no internal error, no pixel
    that is no number."""
    count = soak_count(120, 20_000)
    done = [line for line in batches("fuzzed_stages.py", (), count) if "outcome" in line]
    wrong = [line for line in done if line["outcome"].startswith("WRONG")]
    assert not wrong, "\n".join(map(str, wrong[:5]))
    kinds = Counter(line["outcome"].partition(":")[0] for line in done)
    assert len(done) >= count and kinds["drawn"] > count / 3 and kinds["crashed"] <= count / 1000, kinds
    soak_figure("stages by hypothesis", f"{count}: " + ", ".join(f"{n} {kind}" for kind, n in kinds.items()))


@pytest.mark.soak
@pytest.mark.parametrize("entry", PARSERS, ids=lambda entry: entry.__name__)
def test_what_is_parsed_is_a_value_or_an_error_in_words(entry):
    for data in seeded(soak_count(200, 100_000)):
        entry(data)
    EXAMPLES(given(st.binary(max_size=120))(entry))()


def test_every_parser_has_an_entry():
    assert {entry.__name__ for entry in PARSERS} | {"stage_texts", "stages"} == set(ENTRIES)


@pytest.mark.parametrize(
    "specs", ["0:1e300x1e-300", "1e308:-1e308", "-1e308:1e308", "0:1x1e-320", "0:1e18x0.01", "0:1e308x1e308"]
)
def test_frames_that_cannot_be_counted_are_too_many(specs):
    with pytest.raises(FrameError, match="makes more than 1000000 frames; expected fewer"):
        frame_jobs(["a.###.exr"], specs)


def test_a_time_code_of_many_digits_takes_time_in_proportion():
    """Two ways to split a run of digits would be tried for each digit: hours."""
    with pytest.raises(FrameError, match="found '0"):
        frame_jobs(["a.###.exr"], "0" * 300_000 + "#")


def test_a_stride_against_the_range_is_found_however_small():
    """Their product underflows to 0."""
    with pytest.raises(FrameError, match="the end is below the start, against the stride's sign"):
        frame_jobs(["a.###.exr"], "1e-300:0x1e-300")


def test_a_number_of_thousands_of_digits_is_a_slip():
    with pytest.raises(Exception, match="expected numbers of threads such as 1,0"):
        Numbers().convert("9" * 5000, None, None)


def test_a_section_whose_name_is_no_text_is_named_in_one_line(tmp_path):
    crate = tmp_path / "damaged.usdc"
    head = b"PXR-USDC" + bytes([0, 8, 0, 0, 0, 0, 0, 0]) + (88).to_bytes(8, "little") + bytes(64)
    section = b"A\nB\x07".ljust(16, b"\0") + (10**6).to_bytes(8, "little") + (1).to_bytes(8, "little")
    crate.write_bytes(head + (1).to_bytes(8, "little") + section)
    assert crate_fault(str(crate)) == "found a section A?B? of 1 bytes at 1000000, expected it inside 128 bytes"
