"""The picture that is asked for of a camera: its size, how the camera fits it, and which of its pixels are rendered."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .._core import image_height, pixels_of, window_part
from ..base.errors import Diagnostics
from .aspect import FITS_PIXELS, Window, conformed

WHOLE: Window = (0.0, 0.0, 1.0, 1.0)


@dataclass(frozen=True)
class Picture:
    """As usdrecord, and UsdRenderSettings, have it."""

    width: int
    """Pixels of the display window."""
    height: int | None = None
    """None: from the camera's aspect ratio."""
    conform: str = "expandAperture"
    """UsdRenderSettings' aspectRatioConformPolicy."""
    pixel_aspect: float = 1.0
    """Width of a pixel over its height."""
    data_window: Window = WHOLE
    """UsdRenderSettings' dataWindowNDC: xmin, ymin, xmax, ymax with (0, 0) at the bottom left; more than 0 to 1 is
    overscan."""
    asked_by: str = ""
    """The prim whose data window that is, for messages."""
    exposed: bool = True
    """Whether the camera's exposure attributes brighten it."""

    def sized(self, camera_aspect: float) -> tuple[int, int]:
        """Width and height for a camera of that aspect ratio."""
        pixels = 1.0 if self.conform == FITS_PIXELS else self.pixel_aspect
        return self.width, self.height or image_height(self.width, camera_aspect / pixels)

    def fitted(self, window: Window, size: tuple[int, int]) -> tuple[Window, float]:
        """The camera's window as the picture shows it, and its pixels' aspect ratio. Raises SceneError for an unknown
        policy."""
        return conformed(window, size, self.conform, self.pixel_aspect)

    def pixels(self, size: tuple[int, int], diagnostics: Diagnostics) -> PixelWindow:
        """Those that are rendered."""
        (x, y, width, height), said = pixels_of(self.data_window, self.asked_by, *size)
        diagnostics.take(said)
        return PixelWindow(x, y, width, height, size)


@dataclass(frozen=True)
class PixelWindow:
    """Pixels from the picture's upper left corner, y downwards; what lies outside of the picture is overscan."""

    x: int
    y: int
    width: int
    height: int
    display: tuple[int, int]
    """Width and height of the picture."""

    @property
    def whole(self) -> bool:
        """Whether they are the picture's."""
        return (self.x, self.y, self.width, self.height) == (0, 0, *self.display)

    def part_of(self, windows: np.ndarray) -> np.ndarray:
        """What they show of the picture's windows, float64[T, 4]: left, right, bottom, top."""
        if self.whole:
            return windows
        left, right, bottom, top = window_part((self.x, self.y, self.width, self.height), *self.display)
        across, up = windows[:, 1] - windows[:, 0], windows[:, 3] - windows[:, 2]
        x, y = windows[:, 0], windows[:, 2]
        return np.stack([x + left * across, x + right * across, y + bottom * up, y + top * up], axis=1)
