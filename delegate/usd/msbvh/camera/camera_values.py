"""What UsdGeom.Camera.GetCamera() gives, from values that come through the gate: it passes over other types."""

from __future__ import annotations

from pxr import Gf, Usd, UsdGeom

from ..motion.xform_ops import world_transform
from ..stage.value_types import FLOAT, FLOAT2, FLOAT4S, TOKEN, Kind
from ..stage.values import diagnostics, might_vary, value

_PROPERTIES = {
    "horizontalAperture": FLOAT,
    "verticalAperture": FLOAT,
    "horizontalApertureOffset": FLOAT,
    "verticalApertureOffset": FLOAT,
    "focalLength": FLOAT,
    "fStop": FLOAT,
    "focusDistance": FLOAT,
    "clippingRange": FLOAT2,
    "clippingPlanes": FLOAT4S,
}
"""Attributes that are called as Gf.Camera calls them."""
_PROJECTIONS = {"perspective": Gf.Camera.Perspective, "orthographic": Gf.Camera.Orthographic}


class CameraValues:
    """A camera prim at any time."""

    def __init__(self, camera: UsdGeom.Camera) -> None:
        self._prim = camera.GetPrim()
        names = {"projection": TOKEN, **_PROPERTIES}
        attributes = [(name, self._prim.GetAttribute(name), kind) for name, kind in names.items()]
        self._still = [each for each in attributes if not might_vary(each[1])]
        self._varying = [each for each in attributes if might_vary(each[1])]
        self._known: dict[str, object] | None = None

    def at(self, code: Usd.TimeCode) -> Gf.Camera:
        """A value of another type counts as none: the schema's own shows then."""
        if self._known is None:
            self._known = _values(self._still, code)
        camera = Gf.Camera()
        camera.transform = world_transform(UsdGeom.XformCache(code), self._prim)
        for name, found in {**self._known, **_values(self._varying, code)}.items():
            setattr(camera, name, found)
        return camera


def _values(attributes: list[tuple[str, Usd.Attribute, Kind]], code: Usd.TimeCode) -> dict[str, object]:
    """By the names of Gf.Camera's properties."""
    found = {name: value(attribute, code, kind) for name, attribute, kind in attributes}
    known = {name: each for name, each in found.items() if each is not None}
    if "clippingRange" in known:
        known["clippingRange"] = Gf.Range1f(*known["clippingRange"])
    if "clippingPlanes" in known:
        known["clippingPlanes"] = list(known["clippingPlanes"])
    if "projection" in known:
        known["projection"] = _projection(known["projection"], attributes)
    return known


def _projection(token: str, attributes: list[tuple[str, Usd.Attribute, Kind]]) -> Gf.Camera.Projection:
    if token not in _PROJECTIONS:
        path = next(str(attribute.GetPrimPath()) for name, attribute, _ in attributes if name == "projection")
        message = f"found '{token}', expected perspective or orthographic; took perspective"
        diagnostics().warning(path, "projection", message)
    return _PROJECTIONS.get(token, Gf.Camera.Perspective)
