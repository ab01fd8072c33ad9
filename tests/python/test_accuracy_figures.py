"""Axes and figures of `msbvh accuracy`'s report, as text."""

from __future__ import annotations

import math
from typing import Any

import pytest
from msbvh.accuracy_report import figures
from msbvh.accuracy_report.log_scale import LogScale

# Axes -----------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "values",
    [[1.0, 1.0], [3.1, 3.3], [0.9, 1.1], [2e-7, 8e-7], [1e-6, 1.0], [0.0, 1e-3, 2.0], [120.0, 4000.0], [5e5, 2e6]],
)
def test_an_axis_has_a_few_round_ticks(values: list[float]) -> None:
    scale = LogScale.of(values)
    assert scale is not None
    assert 2 <= len(scale.ticks(5)) <= 5
    assert len(set(scale.labels(5))) == len(scale.ticks(5)) + (0.0 in values)
    assert all(scale.low <= tick <= scale.high for tick in scale.ticks(5))
    places = [scale.place(value) for value in values]
    assert all(place is not None and scale.low < place < scale.high for place in places)
    assert places == sorted(places, key=lambda place: place or 0.0), "0 stands below all others"


def test_what_is_no_figure_has_no_place() -> None:
    scale = LogScale.of([1.0, 2.0])
    assert scale is not None
    assert [scale.place(value) for value in (None, math.nan, math.inf, -1.0, "1")] == [None] * 5
    assert LogScale.of([None, math.nan, -1.0]) is None


# Figures --------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("form", "value", "text"),
    [
        (figures.figure, 0.0012345, "0.00123"),
        (figures.figure, 1234.5, "1,234"),
        (figures.figure, 9.996, "10.0"),
        (figures.figure, 1.234e-7, "1.23×10⁻⁷"),
        (figures.figure, -0.5, "−0.500"),
        (figures.figure, 0, "0"),
        (figures.figure, None, "–"),
        (figures.figure, math.nan, "–"),
        (figures.figure, True, "–"),
        (figures.figure, math.inf, "∞"),
        (figures.plain, 6.0, "6"),
        (figures.seconds, 123.4, "123"),
        (figures.seconds, 0.01234, "0.0123"),
        (figures.megabytes, 123, "<0.001"),
        (figures.megabytes, 1_234_567, "1.23"),
        (figures.megabytes, 12_345_678_901, "12,346"),
        (figures.count, 9_420_113, "9.42 M"),
        (figures.count, 412, "412"),
        (figures.share, 0.314, "31 %"),
        (figures.change, -0.11, "−11 %"),
        (figures.change, 0.003, "+0.3 %"),
        (figures.spread, [1.0, 0.9, 1.25], "0.900–1.25"),
        (figures.spread, [1.0, 1.0, 1.0], ""),
        (figures.spread, None, ""),
        (figures.options_text, {"spp": 16, "robust": False, "x": 0.1}, "spp 16, robust off, x 0.1"),
        (figures.options_text, {}, "base settings"),
    ],
)
def test_figures(form: Any, value: object, text: str) -> None:
    assert form(value) == text
