"""Fitting a camera's window to an image of another shape, by the names of UsdRenderSettings."""

from __future__ import annotations

import numpy as np
from pxr import Gf

from ..base.errors import SceneError

Window = tuple[float, float, float, float]
"""left, right, bottom, top; see core/scene/scene.h."""

POLICIES = (
    "expandAperture",
    "cropAperture",
    "adjustApertureWidth",
    "adjustApertureHeight",
    "adjustPixelAspectRatio",
)


def conformed(window: Window, image_aspect: float, policy: str) -> tuple[Window, float]:
    """The window that fills an image of width / height = `image_aspect`, and the pixel aspect ratio.

    UsdRenderSettings' aspectRatioConformPolicy; the window's centre stays where it is, so aperture offsets
    count once. Raises SceneError for an unknown policy.
    """
    left, right, bottom, top = window
    width, height = right - left, top - bottom
    aspect = width / height
    if policy == "adjustPixelAspectRatio":
        return window, aspect / image_aspect
    if policy not in POLICIES:
        raise SceneError(f"aspectRatioConformPolicy: found '{policy}', expected one of {', '.join(POLICIES)}")
    image_is_wider = image_aspect > aspect
    widen = policy == "adjustApertureWidth" or (policy == "expandAperture" and image_is_wider)
    narrow = policy == "cropAperture" and not image_is_wider
    if widen or narrow:
        width = height * image_aspect
    else:
        height = width / image_aspect
    x, y = (left + right) / 2, (bottom + top) / 2
    return (x - width / 2, x + width / 2, y - height / 2, y + height / 2), 1.0


def image_height(width: int, aspect_ratio: float) -> int:
    """The image's height by usdrecord's rule: rounded down, never below one pixel.

    In single precision as there: in double, the float 16:9 would make 539 lines of 960 columns.
    """
    return max(int(np.float32(width) / np.float32(aspect_ratio if abs(aspect_ratio) > 1e-4 else 1.0)), 1)


def window_of(camera: Gf.Camera) -> Window:
    """The camera's own window. Apertures and focal length share a unit, a tenth of the stage's."""
    if camera.projection == Gf.Camera.Orthographic:
        scale = Gf.Camera.APERTURE_UNIT
    else:
        scale = Gf.Camera.APERTURE_UNIT / (camera.focalLength * Gf.Camera.FOCAL_LENGTH_UNIT)
    x, half_width = camera.horizontalApertureOffset, camera.horizontalAperture / 2
    y, half_height = camera.verticalApertureOffset, camera.verticalAperture / 2
    return (
        (x - half_width) * scale,
        (x + half_width) * scale,
        (y - half_height) * scale,
        (y + half_height) * scale,
    )
