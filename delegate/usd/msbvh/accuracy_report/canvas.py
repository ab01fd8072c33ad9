"""An empty plot in the page's type and colours, and its SVG for a page that holds several.

Colours are roles. matplotlib draws each in a stand-in that nothing else has, which becomes a variable of report.css: the
same drawing serves a light and a dark page. Series take the colours of Okabe and Ito (2008), which people with any
colour vision tell apart, and a marker each.
"""

from __future__ import annotations

import html
import io
import re
from collections.abc import Mapping
from contextlib import AbstractContextManager
from dataclasses import dataclass
from typing import Any

import matplotlib
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

COLORS = 6
"""Of series."""
ROLES = ("ink", "muted", "rule", "paper", *(f"{kind}-{i}" for kind in ("series", "text") for i in range(COLORS)))
"""Variables `--plot-ROLE` of report.css."""
STAND_INS = {role: f"#fe{i:02x}01" for i, role in enumerate(ROLES, start=1)}
SERIES = [STAND_INS[f"series-{i}"] for i in range(COLORS)]
SERIES_TEXT = [STAND_INS[f"text-{i}"] for i in range(COLORS)]
"""The same, dark enough to read on the page."""
MARKERS = ("o", "s", "^", "D", "v", "P")
INK, MUTED, RULE, PAPER = (STAND_INS[role] for role in ROLES[:4])

STYLE: dict[str, Any] = {
    "svg.fonttype": "none",
    "svg.hashsalt": "msbvh",
    "text.parse_math": False,
    "axes.unicode_minus": True,
    "font.family": "DejaVu Sans",
    "text.color": INK,
    "axes.labelcolor": INK,
    "axes.edgecolor": MUTED,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.linewidth": 0.8,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": RULE,
    "grid.linewidth": 0.7,
    "xtick.color": MUTED,
    "ytick.color": MUTED,
    "xtick.labelcolor": INK,
    "ytick.labelcolor": INK,
}
"""Of matplotlib. Text stays text, in the page's own font; DejaVu Sans, which comes with matplotlib, is as wide as any,
so that what fits here fits there. `$` in a scene's names is no formula."""

NO_METADATA: Mapping[str, None] = dict.fromkeys(("Creator", "Date", "Format", "Type"))


@dataclass(frozen=True)
class Size:
    """Of a drawing, in CSS pixels at its natural width: text is as large as said only there."""

    name: str
    width: float
    height: float
    text: float


WIDE = Size("wide", 760.0, 440.0, 13.0)
NARROW = Size("narrow", 343.0, 360.0, 11.5)
"""A phone of 375 px less its margins."""
DOTS_PER_INCH = 72.0
"""Of the SVG backend: a point is a pixel."""


class Canvas:
    """One pair of axes in a figure of a fixed size. Use inside `style()`."""

    def __init__(self, size: Size, left: float, bottom: float, top: float = 10.0, right: float = 14.0) -> None:
        """Margins in pixels."""
        self.size = size
        figure = Figure(figsize=(size.width / DOTS_PER_INCH, size.height / DOTS_PER_INCH), dpi=DOTS_PER_INCH)
        figure.patch.set_visible(False)
        self.measure = FigureCanvasAgg(figure).get_renderer()
        width, height = 1.0 - (left + right) / size.width, 1.0 - (bottom + top) / size.height
        self.axes: Axes = figure.add_axes((left / size.width, bottom / size.height, width, height))
        self.axes.patch.set_visible(False)
        self.axes.tick_params(length=3.0, pad=5.0)
        self._figure = figure
        self._titles: dict[str, str] = {}
        self._label_count = 0

    def label(self) -> str:
        """A gid for text that stands on the plot itself: report.css gives it a halo."""
        self._label_count += 1
        return f"label-{self._label_count}"

    def title_of(self, text: str) -> str:
        """A gid for what a pointer over it explains."""
        name = f"titled-{len(self._titles)}"
        self._titles[name] = text
        return name

    def svg(self, prefix: str) -> str:
        """Markup for a page; `prefix` makes its ids unique there."""
        written = io.BytesIO()
        self._figure.savefig(written, format="svg", metadata=NO_METADATA)
        text = written.getvalue().decode("utf-8")
        text = text[text.index("<svg") :]
        text = re.sub(r"\s*<metadata>.*?</metadata>", "", text, flags=re.DOTALL)
        for name, title in self._titles.items():
            text = text.replace(f'<g id="{name}">', f"<g><title>{html.escape(title)}</title>", 1)
        text = re.sub(r'<g id="label-\d+">', '<g class="label">', text)
        text = re.sub(r'(\bid="|href="#|url\(#)', rf"\g<1>{prefix}-", text)
        for role, color in STAND_INS.items():
            text = text.replace(color, f"var(--plot-{role})")
        size = f'width="{self.size.width:g}" height="{self.size.height:g}"'
        text = re.sub(r'width="[\d.]+pt" height="[\d.]+pt"', size, text, count=1)
        return text.replace("<svg ", f'<svg class="plot {self.size.name}" ', 1)


def style(size: Size) -> AbstractContextManager[None]:
    """A context in which everything is drawn and saved."""
    settings: dict[Any, Any] = {**STYLE, "font.size": size.text}
    return matplotlib.rc_context(settings)
