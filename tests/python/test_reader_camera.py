"""Which camera, what it sees, and over which shutter."""

from __future__ import annotations

import math

import numpy as np
import pytest
from msbvh import _core
from msbvh._core import ASPECT_POLICIES
from msbvh.base.errors import SceneError
from msbvh.scene.reader import ReadSettings, read_frame
from pxr import Gf, Usd, UsdGeom
from recording import Shot, messages


def gf_window(camera: Gf.Camera) -> list[float]:
    """left, right, bottom, top by USD's own frustum."""
    window = camera.frustum.GetWindow()
    return [window.min[0], window.max[0], window.min[1], window.max[1]]


@pytest.mark.parametrize("projection", ["perspective", "orthographic"])
def test_apertures_with_offsets_are_usds_own_frustum(projection):
    shot = Shot((0, 0))
    shot.camera.CreateProjectionAttr(projection)
    shot.camera.CreateHorizontalApertureAttr(36.0)
    shot.camera.CreateVerticalApertureAttr(24.0)
    shot.camera.CreateHorizontalApertureOffsetAttr(5.0)
    shot.camera.CreateVerticalApertureOffsetAttr(-3.0)
    shot.camera.CreateFocalLengthAttr(35.0)
    shot.camera.CreateClippingRangeAttr(Gf.Vec2f(0.5, 500))
    camera = shot.read(width=300).camera
    assert camera.projection == projection
    assert camera.windows[0] == pytest.approx(gf_window(shot.camera.GetCamera(10.0)), rel=1e-6)
    assert (camera.width, camera.height) == (300, 200)
    assert (camera.near_clip, camera.far_clip) == (0.5, 500)


@pytest.mark.parametrize("image", [(400, 100), (100, 400)])
@pytest.mark.parametrize("policy", ASPECT_POLICIES)
def test_conform_policies(policy, image):
    shot = Shot((0, 0))
    shot.camera.CreateHorizontalApertureAttr(30.0)
    shot.camera.CreateVerticalApertureAttr(20.0)
    shot.camera.CreateHorizontalApertureOffsetAttr(6.0)
    shot.camera.CreateFocalLengthAttr(10.0)
    camera = shot.read(width=image[0], height=image[1], conform=policy).camera
    left, right, bottom, top = camera.windows[0]
    width, height = right - left, top - bottom
    assert (left + right) / 2 == pytest.approx(0.6) and bottom == -top
    wide = image[0] > image[1]
    expected = {
        "expandAperture": (8.0, 2.0) if wide else (3.0, 12.0),
        "cropAperture": (3.0, 0.75) if wide else (0.5, 2.0),
        "adjustApertureWidth": (8.0, 2.0) if wide else (0.5, 2.0),
        "adjustApertureHeight": (3.0, 0.75) if wide else (3.0, 12.0),
        "adjustPixelAspectRatio": (3.0, 2.0),
    }[policy]
    assert (width, height) == pytest.approx(expected)
    aspect = 1.5 / (image[0] / image[1]) if policy == "adjustPixelAspectRatio" else 1.0
    assert camera.pixel_aspect_ratio == pytest.approx(aspect)


def test_an_unknown_conform_policy_is_an_error():
    with pytest.raises(SceneError, match="found 'squeeze', expected one of expandAperture"):
        Shot().read(height=100, conform="squeeze")


def test_the_camera_and_its_zoom_are_sampled_over_the_shutter():
    shot = Shot((-0.5, 0.5))
    shot.camera.CreateHorizontalApertureAttr(32.0)
    shot.camera.CreateVerticalApertureAttr(24.0)
    shot.camera.GetFocalLengthAttr().Set(50.0, 9.0)
    shot.camera.GetFocalLengthAttr().Set(100.0, 11.0)
    turn = shot.camera.AddRotateYOp()
    turn.Set(0.0, 9.0)
    turn.Set(90.0, 11.0)
    camera = shot.read().camera
    assert len(camera.times01) >= 129
    for time01, matrix, window in zip(camera.times01, camera.world_from_camera, camera.windows, strict=True):
        code = camera.shutter.time_code(time01)
        expected = shot.camera.GetCamera(code)
        assert np.allclose(matrix, np.array(expected.transform), atol=1e-12)
        assert window[1] - window[0] == pytest.approx(expected.horizontalAperture / expected.focalLength, rel=1e-6)


def test_a_still_camera_has_one_sample():
    camera = Shot().read().camera
    assert camera.times01.tolist() == [0.0]
    assert camera.world_from_camera.shape == (1, 4, 4) and camera.windows.shape == (1, 4)


def test_matrices_for_images_are_those_of_the_frame():
    shot = Shot((0.0, 0.5))
    shot.camera.GetPrim().GetAttribute("xformOp:translate").Set(Gf.Vec3d(0, 0, 20), 10.0)
    shot.camera.GetPrim().GetAttribute("xformOp:translate").Set(Gf.Vec3d(8, 0, 20), 11.0)
    camera = shot.read(10.0).camera
    assert np.array([0, 0, 0, 1]) @ camera.world_to_camera == pytest.approx([0, 0, 20, 1])
    x, y, _, w = np.array([0, 0, 0, 1]) @ camera.world_to_ndc
    assert (x / w, y / w) == pytest.approx((0.5, 0.5))


@pytest.mark.parametrize("name", ["/World/Second", "World/Second", "Second"])
def test_a_camera_by_path_or_name(name):
    shot = Shot()
    UsdGeom.Camera.Define(shot.stage, "/World/Second")
    assert shot.read(camera=name).camera.path == "/World/Second"


def test_the_primary_camera_before_the_first_which_is_said():
    shot = Shot()
    UsdGeom.Camera.Define(shot.stage, "/World/Second")
    result = shot.read()
    assert result.camera.path == "/Camera"
    assert "/Camera: the first of 2 cameras; --camera chooses another" in messages(result, "note")
    UsdGeom.Camera.Define(shot.stage, "/World/main_cam")
    assert shot.read().camera.path == "/World/main_cam"


def test_an_unknown_camera_is_an_error_that_names_the_known_ones():
    with pytest.raises(SceneError, match="found no camera 'Nobody', expected one of the stage's cameras: /Camera"):
        Shot().read(camera="Nobody")


@pytest.mark.parametrize("up", ["Y", "Z"])
def test_without_a_camera_one_is_made_that_frames_everything(up):
    shot = Shot()
    shot.stage.RemovePrim("/Camera")
    UsdGeom.SetStageUpAxis(shot.stage, up)
    UsdGeom.Sphere.Define(shot.stage, "/Ball").CreateRadiusAttr(0.01)
    result = shot.read()
    assert messages(result, "note") == [
        "no camera on the stage; made one in front of everything. Its shutter is closed, so nothing is blurred;"
        " --shutter -0.25:0.25 opens it"
    ]
    camera = result.camera
    # usdrecord's distance: half the face's diagonal over the tangent of half the view, and half the depth.
    distance = math.hypot(0.02, 0.02) / 2 / (20.955 / 2 / 50) + 0.01
    eye = [0, 0, distance] if up == "Y" else [0, -distance, 0]
    assert camera.world_from_camera[0, 3, :3] == pytest.approx(eye, rel=1e-5)
    looks = -camera.world_from_camera[0, 2, :3]
    assert looks == pytest.approx([0, 0, -1] if up == "Y" else [0, 1, 0], abs=1e-6)
    assert camera.near_clip < distance - 0.01
    assert not camera.shutter.moving


def test_bounds_that_cannot_be_framed_are_said():
    shot = Shot()
    shot.stage.RemovePrim("/Camera")
    UsdGeom.Xform.Define(shot.stage, "/Nothing")
    result = shot.read()
    assert any("no camera and no finite bounds" in message for message in messages(result, "warning"))


@pytest.mark.parametrize(
    ("shutter", "severity", "text"),
    [
        ((0.0, 0.0), "note", "/Camera.shutter:close: equals shutter:open, 0: no motion blur"),
        ((0.25, 0.25), "note", "equals shutter:open, 0.25: no motion blur"),
        (
            (0.5, -0.5),
            "warning",
            "/Camera.shutter:close: found -0.5, before shutter:open at 0.5, expected a later time",
        ),
        ((math.nan, 0.5), "warning", "found nan to 0.5, expected finite numbers; no motion blur"),
        ((0.0, math.inf), "warning", "found 0 to inf, expected finite numbers; no motion blur"),
        (
            (0.0, 450.0),
            "warning",
            "the shutter is open for 450 frames, expected about one; rendered as authored",
        ),
    ],
)
def test_shutters_that_make_no_sense_are_named(shutter, severity, text):
    shot = Shot(shutter)
    move = shot.mesh("/Mesh").AddTranslateOp()
    move.Set(Gf.Vec3d(0), 9.0)
    move.Set(Gf.Vec3d(2, 0, 0), 11.0)
    result = shot.read()
    assert any(text in message for message in messages(result, severity))
    absurd = shutter[1] == 450.0
    assert result.camera.shutter.moving == absurd
    assert len(result.scene.meshes["/Mesh"]["transform"].matrices) == 1 or absurd


@pytest.mark.parametrize(
    ("attribute", "value"),
    [("horizontalAperture", 0.0), ("focalLength", 0.0), ("verticalAperture", math.nan)],
)
def test_optics_that_make_no_image_are_errors(attribute, value):
    shot = Shot()
    shot.camera.GetPrim().GetAttribute(attribute).Set(value)
    with pytest.raises(SceneError, match=f"/Camera.{attribute}: found {value:g}, expected a finite number above 0"):
        shot.read()


def test_a_frame_in_a_sequence_is_the_frame_alone():
    shot = Shot()
    move = shot.mesh("/Mesh").AddTranslateOp()
    for time in (9.0, 10.0, 11.0, 12.0):
        move.Set(Gf.Vec3d(time**2, 0, 0), time)
    alone = shot.read(11.0).scene.meshes["/Mesh"]["transform"].matrices
    shot.read(10.0)
    assert np.array_equal(shot.read(11.0).scene.meshes["/Mesh"]["transform"].matrices, alone)
    assert not np.array_equal(shot.read(10.0).scene.meshes["/Mesh"]["transform"].matrices, alone)


def test_camera_inside_a_moving_parent():
    shot = Shot()
    shot.stage.RemovePrim("/Camera")
    rig = UsdGeom.Xform.Define(shot.stage, "/Rig").AddTranslateOp()
    camera = UsdGeom.Camera.Define(shot.stage, "/Rig/Camera")
    camera.CreateShutterCloseAttr(0.5)
    rig.Set(Gf.Vec3d(0), 10.0)
    rig.Set(Gf.Vec3d(4, 0, 0), 11.0)
    read = shot.read().camera
    assert read.world_from_camera[-1, 3, 0] == pytest.approx(2.0)
    assert read.shutter.time_code(1.0) == Usd.TimeCode(10.5)


def test_clipping_planes_are_those_of_the_frame_with_unit_normals():
    shot = Shot()
    planes = shot.camera.CreateClippingPlanesAttr()
    planes.Set([Gf.Vec4f(3, 0, 4, 10), Gf.Vec4f(0, 0, 0, 1)])
    result = shot.read()
    assert result.camera.clipping_planes == pytest.approx(np.array([[0.6, 0, 0.8, 2]]))
    assert any("/Camera.clippingPlanes: found (0, 0, 0, 1)" in text for text in messages(result, "warning"))


def test_what_clipping_planes_cut_off_is_not_seen():
    def row(planes: list[Gf.Vec4f]) -> np.ndarray:
        """Alpha along the middle of the image, of a floor across all of it."""
        shot = Shot((0, 0))
        shot.mesh("/Wall", [(-99, -99, 0), (99, -99, 0), (99, 99, 0), (-99, 99, 0)])
        shot.camera.CreateClippingPlanesAttr(planes)
        scene = read_frame(shot.stage, 10.0, ReadSettings(width=32, height=24)).scene
        return _core.Renderer(scene, width=32, height=24, spp=16, max_bounces=0).render()[12, :, 3]

    assert (row([]) == 1.0).all()
    right = row([Gf.Vec4f(1, 0, 0, 0)])
    assert (right[:15] == 0.0).all() and (right[17:] == 1.0).all()
    assert (row([Gf.Vec4f(0, 0, 1, 1)]) == 0.0).all(), "all further than 1 in front of the camera"
