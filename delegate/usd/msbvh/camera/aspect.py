"""A camera's window, and how it is fitted to an image of another shape: what the core says, in USD's words."""

from __future__ import annotations

from pxr import Gf

from .. import _core
from ..base.errors import SceneError

Window = tuple[float, float, float, float]
"""left, right, bottom, top; see core/scene/camera.h."""
FITS_PIXELS = "adjustPixelAspectRatio"
"""The one policy that changes pixels, not the camera's window."""


def optics_of(camera: Gf.Camera) -> _core.Optics:
    """What the core needs to know of a camera."""
    optics = _core.Optics()
    optics.projection = camera.projection.displayName.lower()
    optics.horizontal_aperture, optics.vertical_aperture = camera.horizontalAperture, camera.verticalAperture
    optics.horizontal_aperture_offset = camera.horizontalApertureOffset
    optics.vertical_aperture_offset = camera.verticalApertureOffset
    optics.focal_length = camera.focalLength
    optics.f_stop, optics.focus_distance = camera.fStop, camera.focusDistance
    return optics


def window_of(camera: Gf.Camera) -> Window:
    """The camera's own window."""
    return optics_of(camera).window


def conformed(
    window: Window, size: tuple[float, float], policy: str, pixel_aspect: float = 1.0
) -> tuple[Window, float]:
    """The window that a picture of `size` pixels of that aspect ratio shows, and theirs as the policy, UsdRenderSettings'
    aspectRatioConformPolicy, leaves it. Raises SceneError for an unknown one."""
    if policy not in _core.ASPECT_POLICIES:
        names = ", ".join(_core.ASPECT_POLICIES)
        raise SceneError(f"aspectRatioConformPolicy: found '{policy}', expected one of {names}")
    return _core.conformed_picture(window, *size, pixel_aspect, policy)
