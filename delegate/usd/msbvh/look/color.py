"""From the rendering space to a display, by a built-in OpenColorIO config."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import PyOpenColorIO as ocio

from ..stage.rendering_space import LINEAR_REC709

CONFIG = "ocio://cg-config-v4.0.0_aces-v2.0_ocio-v2.5"
"""Named in full, so that the same picture comes out of any later OpenColorIO."""
WORKING_SPACES = {LINEAR_REC709: "Linear Rec.709 (sRGB)", "acescg": "ACEScg"}
"""By their names as rendering spaces."""
SRGB_DISPLAY = "sRGB - Display"
UNTONEMAPPED_VIEW = "Un-tone-mapped"

MODES = ("disabled", "sRGB", "openColorIO")
"""usdrecord's names of its colour correction modes."""


class ColorError(ValueError):
    """A display or a view that the config does not have; str() is one line with the choices."""


@dataclass(frozen=True)
class ColorCorrection:
    """How linear pixels become display pixels in the formats that store the latter (PNG, JPEG, TIFF)."""

    mode: str = "sRGB"
    display: str | None = None
    """For mode openColorIO; None: the config's default."""
    view: str | None = None
    """For mode openColorIO; None: the display's default."""
    rendering_space: str = LINEAR_REC709
    """That the linear pixels are in."""

    def resolve(self) -> tuple[str, str] | None:
        """The display and the view that the mode stands for; None where pixels stay linear. Raises
        ColorError."""
        if self.mode == "disabled":
            return None
        if self.mode == "sRGB":
            return SRGB_DISPLAY, UNTONEMAPPED_VIEW
        config = ocio.Config.CreateFromFile(CONFIG)
        display = _choose("display", self.display, config.getDisplays(), config.getDefaultDisplay())
        view = _choose("view", self.view, config.getViews(display), config.getDefaultView(display))
        return display, view

    def apply(self, rgb: np.ndarray) -> np.ndarray:
        """Display values of linear ones; float32[h, w, 3] in and out, `rgb` is left alone. Raises
        ColorError."""
        pixels = np.array(rgb, dtype=np.float32, order="C")
        resolved = self.resolve()
        if resolved is not None:
            config = ocio.Config.CreateFromFile(CONFIG)
            processor = config.getProcessor(WORKING_SPACES[self.rendering_space], *resolved, ocio.TRANSFORM_DIR_FORWARD)
            processor.getDefaultCPUProcessor().apply(ocio.PackedImageDesc(pixels, pixels.shape[1], pixels.shape[0], 3))
        return pixels


def _choose(kind: str, wanted: str | None, names: object, default: str) -> str:
    choices = list(names)  # type: ignore[call-overload]  # OpenColorIO's iterators are not annotated
    if wanted is None:
        return default
    if wanted not in choices:
        raise ColorError(f"unknown OpenColorIO {kind} '{wanted}'; expected one of: {', '.join(choices)}")
    return wanted
