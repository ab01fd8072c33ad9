"""The part of _core that says what a film is asked for (core/film)."""

from collections.abc import Mapping, Sequence

PIXEL_FILTERS: tuple[str, ...]
MOST_FILTER_WIDTH: float
"""Pixels across."""
MOST_SHUTTER_SLICES: int
SHUTTER_CURVES: Mapping[str, tuple[tuple[float, float], ...]]
"""By name: (time01, weight) of each knot; no knots: open throughout."""

def name_hash(name: str) -> int:
    """As Cryptomatte has it: MurmurHash3_32, with the exponent of a finite float."""

class FilmSettings:
    def __init__(
        self,
        *,
        pixel_filter: str = "box",
        filter_width: float | None = None,
        shutter_curve: Sequence[tuple[float, float]] = (),
        rolling: tuple[float, float, float] = (0.0, 0.0, 1.0),
        frame_time: tuple[float, float] = (0.0, 0.0),
        shutter_slices: int = 0,
        exposure: float = 1.0,
    ) -> None:
        """``filter_width``: pixels across; None: what is usual for the filter. ``rolling``: share of the shutter by which the
        lowest row begins later, then the top and the height of the rows rendered as shares of the picture's.
        ``frame_time``: where the frame lies in the shutter, 0 being its opening and 1 its closing, and how many frames it is
        open: for AOVs of motion. ``shutter_slices``: equal parts of the shutter that render_sliced() keeps apart, a power of
        two; with neither a curve nor a rolling shutter, which move samples in time. ``exposure``: what colours,
        and AOVs that are light, are multiplied by.

        Raises Error for settings that make no sense.
        """
