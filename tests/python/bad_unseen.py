"""Values that are no numbers where the shutter does not see them, and in cameras (bad_scenes.py)."""

from __future__ import annotations

from collections.abc import Callable

from bad_instancers import bad_instancer, quaternions, row
from bad_scenes import INF, NAN, bad_mesh, left, vec3s, with_value
from bad_skins import bad_arm
from pxr import Gf, Usd, UsdGeom, UsdLux
from recording import Shot

# What the shutter does not see, which is from 10.1 to 10.5 here: samples at 9, at the frame and far behind.

UNSEEN_SHUTTER = (0.1, 0.5)
UNSEEN_TIMES = (9.0, 10.0, 10.05, 10.3, 10.6, 12.0)
UNSEEN_BAD = (9.0, 10.0, 12.0)

UNSEEN: list[Callable[[Shot], None]] = []


def unseen(function: Callable[[Shot], None]) -> Callable[[Shot], None]:
    """Registers a scene with values that are no numbers where they do not matter."""
    UNSEEN.append(function)
    return function


@unseen
def points_unseen(shot: Shot) -> None:
    points = bad_mesh(shot).GetPointsAttr()
    for time in UNSEEN_TIMES:
        values = left()
        if time in UNSEEN_BAD:
            values[1] = Gf.Vec3f(NAN, 0, 0)
        points.Set(values, time)


@unseen
def normals_unseen(shot: Shot) -> None:
    mesh = bad_mesh(shot)
    mesh.SetNormalsInterpolation("vertex")
    for time in UNSEEN_TIMES:
        mesh.GetNormalsAttr().Set(vec3s(*[(0, 0, NAN if time in UNSEEN_BAD else 1.0)] * 4), time)


@unseen
def color_unseen(shot: Shot) -> None:
    primvar = bad_mesh(shot).CreateDisplayColorPrimvar("constant")
    for time in UNSEEN_TIMES:
        primvar.Set(vec3s((NAN if time in (9.0, 12.0) else time / 20, 0, 0)), time)


@unseen
def rates_unseen(shot: Shot) -> None:
    mesh = bad_mesh(shot)
    for time in (9.0, 10.0, 11.0):
        bad = NAN if time != 10.0 else 1.0
        mesh.GetPointsAttr().Set(left(), time)
        mesh.CreateVelocitiesAttr().Set(vec3s(*with_value(bad)), time)
        mesh.CreateAccelerationsAttr().Set(vec3s(*with_value(bad)), time)


@unseen
def translation_unseen(shot: Shot) -> None:
    move = bad_mesh(shot).AddTranslateOp()
    for time in UNSEEN_TIMES:
        move.Set(Gf.Vec3d(NAN if time in UNSEEN_BAD else 0.0, 0, 0), time)


@unseen
def instances_unseen(shot: Shot) -> None:
    instancer = bad_instancer(shot)
    orientations, scales = instancer.CreateOrientationsfAttr(), instancer.CreateScalesAttr()
    for time in UNSEEN_TIMES:
        bad = NAN if time in UNSEEN_BAD else 1.0
        positions = row()
        positions[1] = Gf.Vec3f(positions[1][0] * bad, 0, 0)
        instancer.GetPositionsAttr().Set(positions, time)
        scales.Set(vec3s(*[(bad, 1, 1)] * 4), time)
        orientations.Set(quaternions(orientations, bad=(bad, 0.0, 0.0, 0.0)), time)


@unseen
def joints_unseen(shot: Shot) -> None:
    _, animation = bad_arm(shot)
    for time in UNSEEN_TIMES:
        bad = NAN if time in UNSEEN_BAD else 0.0
        animation.GetTranslationsAttr().Set(vec3s((0, 0, 0), (bad, 0, 0)), time)


@unseen
def light_unseen(shot: Shot) -> None:
    light = UsdLux.SphereLight.Define(shot.stage, "/World/Light")
    bad_mesh(shot)
    for time in UNSEEN_TIMES:
        light.GetIntensityAttr().Set(NAN if time in UNSEEN_BAD else time, time)


# Cameras: without one there is no picture.

CAMERA_FAULTS: dict[str, tuple[Callable[[UsdGeom.Camera], None], str]] = {}


def _sampled(attribute: Usd.Attribute, good: object, bad: object) -> None:
    for time in (9, 9.75, 10.25, 11):
        attribute.Set(bad if time == 10.25 else good, time)


def camera_translation(camera: UsdGeom.Camera) -> None:
    move = camera.GetOrderedXformOps()[0]
    _sampled(move.GetAttr(), Gf.Vec3d(0, 0, 20), Gf.Vec3d(NAN, 0, 20))


def camera_focal_length(camera: UsdGeom.Camera) -> None:
    _sampled(camera.CreateFocalLengthAttr(), 50.0, NAN)


def camera_aperture(camera: UsdGeom.Camera) -> None:
    _sampled(camera.CreateHorizontalApertureAttr(), 20.0, INF)


def camera_aperture_offset(camera: UsdGeom.Camera) -> None:
    _sampled(camera.CreateHorizontalApertureOffsetAttr(), 0.0, NAN)


def camera_clipping_range(camera: UsdGeom.Camera) -> None:
    _sampled(camera.CreateClippingRangeAttr(), Gf.Vec2f(1, 100), Gf.Vec2f(NAN, 100))


CAMERA_FAULTS.update(
    {
        "translation": (camera_translation, "/Camera.xformOp:translate: found (nan, 0, 20) "),
        "focal-length": (camera_focal_length, "/Camera.focalLength: found nan"),
        "aperture": (camera_aperture, "/Camera.horizontalAperture: found inf"),
        "aperture-offset": (camera_aperture_offset, "/Camera.horizontalApertureOffset: found nan"),
        "clipping-range": (camera_clipping_range, "/Camera.clippingRange: found (nan, 100)"),
    }
)
