"""FrameSpecs and placeholders against UsdUtils.TimeCodeRange and the rules of UsdAppUtils.framesArgs."""

from __future__ import annotations

import pytest
from msbvh.farm.frames import FrameError, find_placeholder, format_frame, output_files, parse_frame_specs
from pxr import UsdUtils


@pytest.mark.parametrize(
    "spec",
    [
        "123",
        "101:105",
        "105:101",
        "101:109x2",
        "101:110x2",
        "101:104x0.5",
        "10:1x-3",
        "-3:-1",
        "1.5",
        "1e2",
        " 3",
        "+4",
        ".5",
        "1:1",
        "0:0.3x0.1",
        "1:2x0.1",
        "0:1x0.3",
        "101:104x.5",
        "-1:1x0.25",
    ],
)
def test_time_codes_are_those_of_usd(spec: str) -> None:
    expected = [time_code.GetValue() for time_code in UsdUtils.TimeCodeRange.CreateFromFrameSpec(spec)]
    assert expected, "the oracle must know the spec"
    assert parse_frame_specs(spec)[0] == expected


def test_specs_are_joined_in_order() -> None:
    assert parse_frame_specs("1:10x2,15,3:2") == ([1, 3, 5, 7, 9, 15, 3, 2], 0)


def test_precision_is_that_of_the_longest_stride() -> None:
    assert parse_frame_specs("1:2x0.5,1:2x0.125,7")[1] == 3


@pytest.mark.parametrize(
    "spec",
    [
        "",
        "abc",
        "1:",
        ":5",
        "1:2:3",
        "1:10x0",
        "1:10x",
        "1:10x2x3",
        "5x2",
        "10:1x2",
        "1:10x-2",
        "nan",
        "inf",
        "1:inf",
        "1:2xinf",
        "0x10",
        "1_000",
        "1,",
        "1:2,,3",
        "3 ",
        "1e999",
    ],
)
def test_a_malformed_spec_is_named(spec: str) -> None:
    with pytest.raises(FrameError, match="FrameSpec"):
        parse_frame_specs(spec)


def test_an_absurd_count_is_refused_at_once() -> None:
    with pytest.raises(FrameError, match="more than 1000000 frames"):
        parse_frame_specs("1:1e15")


@pytest.mark.parametrize(
    ("name", "placeholder"),
    [
        ("a.###.exr", "###"),
        ("a.##.##.exr", "##.##"),
        ("#", "#"),
        ("a.exr", None),
        ("a.#.b.#.exr", None),
        ("###.###.###", None),
        ("f#.exr", "#"),
    ],
)
def test_placeholder(name: str, placeholder: str | None) -> None:
    assert find_placeholder(name) == placeholder


@pytest.mark.parametrize(
    ("placeholder", "frame", "text"),
    [
        ("###", 7.0, "007"),
        ("###", 1234.0, "1234"),
        ("###", -5.0, "-05"),
        ("###.##", 7.5, "007.50"),
        ("#", 2.5, "2"),
        ("#.#", 0.25, "0.2"),
    ],
)
def test_frame_text_is_that_of_a_float_format(placeholder: str, frame: float, text: str) -> None:
    assert format_frame(f"a.{placeholder}.exr", placeholder, frame) == f"a.{text}.exr"


def test_files_of_a_range() -> None:
    frames, precision = parse_frame_specs("1:2x0.5")
    assert output_files("o/a.##.#.exr", frames, precision) == [
        (1.0, "o/a.01.0.exr"),
        (1.5, "o/a.01.5.exr"),
        (2.0, "o/a.02.0.exr"),
    ]


def test_a_frame_named_twice_is_rendered_once() -> None:
    assert output_files("a.#.exr", [1.0, 2.0, 1.0], 0) == [(1.0, "a.1.exr"), (2.0, "a.2.exr")]


def test_one_frame_needs_no_placeholder() -> None:
    assert output_files("a.exr", [5.0], 0) == [(5.0, "a.exr")]


@pytest.mark.parametrize(
    ("output", "spec", "message"),
    [
        ("a.exr", "1:2", "exactly one frame placeholder"),
        ("a.#.#.#.exr", "1:2", "exactly one frame placeholder"),
        ("a.###.exr", "1:2x0.5", "need 1 digits"),
        ("a.##.#.exr", "1:2x0.25", "need 2 digits"),
        ("a.#.exr", "1.5,2.5", "frames 1.5 and 2.5 would both be written"),
    ],
)
def test_an_output_name_that_cannot_tell_frames_apart(output: str, spec: str, message: str) -> None:
    with pytest.raises(FrameError, match=message):
        output_files(output, *parse_frame_specs(spec))
