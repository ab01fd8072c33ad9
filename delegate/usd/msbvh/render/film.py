"""What a film is asked for, from options to the renderer."""

from __future__ import annotations

from dataclasses import dataclass

from .._core import FilmSettings
from ..camera.render_camera import RenderCamera
from .shutter_curve import Curve


@dataclass(frozen=True)
class Film:
    """How samples are spread, and what is kept of them; core/film/film_settings.h."""

    pixel_filter: str = "box"
    filter_width: float | None = None
    """Pixels across; None: what is usual for the filter."""
    shutter_curve: Curve = ()
    rolling_shutter: float = 0.0
    """By which share of the shutter the lowest row of the picture is exposed later than the uppermost."""
    shutter_slices: int = 0
    """Equal parts of the shutter that are kept as layers; the curve then weights these, and samples stay where they are."""


def film_settings(film: Film, camera: RenderCamera) -> FilmSettings:
    """Of a frame. Raises _core.Error for what makes no sense."""
    window = camera.pixels
    rows = window.display[1]
    opening, closing = camera.shutter.open, camera.shutter.close
    frames = closing - opening
    return FilmSettings(
        pixel_filter=film.pixel_filter,
        filter_width=film.filter_width,
        shutter_curve=() if film.shutter_slices else film.shutter_curve,
        shutter_slices=film.shutter_slices,
        rolling=(film.rolling_shutter, window.y / rows, window.height / rows),
        exposure=camera.exposure,
        frame_time=(-opening / frames if frames > 0.0 else 0.0, frames),
    )
