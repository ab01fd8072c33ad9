"""The oracle against closed forms, and against pictures of another renderer."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import pytest
from projection_oracle import Sampling, clipped, coverage
from pxr import Gf, Usd, UsdGeom
from recording import Shot
from shared_scenes import SCENES, absent
from stage_truth import StageTruth

SIZE = (96, 48)


def shot(shutter: tuple[float, float] = (0.0, 1.0)) -> Shot:
    """A camera whose image is 12 x 6 units of the plane z = 0: 8 pixels a unit."""
    shot = Shot(shutter)
    shot.camera.CreateHorizontalApertureAttr(24.0)
    shot.camera.CreateVerticalApertureAttr(12.0)
    shot.camera.CreateFocalLengthAttr(40.0)
    shot.camera.CreateClippingRangeAttr(Gf.Vec2f(0.1, 1000))
    return shot


def pixel_x() -> np.ndarray:
    """The left edges of the pixels in units of the plane z = 0, and the right edge of the last."""
    return (np.arange(SIZE[0] + 1) - SIZE[0] / 2) / 8.0


def test_a_moving_square_is_a_ramp() -> None:
    scene = shot()
    square = scene.mesh("/square", [(-3, -1, 0), (-1, -1, 0), (-1, 1, 0), (-3, 1, 0)])
    translate = square.AddTranslateOp()
    translate.Set(Gf.Vec3d(0, 0, 0), 10)
    translate.Set(Gf.Vec3d(4, 0, 0), 11)
    found = coverage(scene.stage, 10.0, "/Camera", SIZE)

    # At x the square is from (x + 1) / 4 to (x + 3) / 4 of the shutter; the pixel averages over its width.
    def integral(x: np.ndarray) -> np.ndarray:
        u = np.linspace(0.0, 1.0, 4097)
        shown = np.clip((x[:, None] - (-3 + 4 * u)), 0, 2)
        return np.trapezoid(shown, u, axis=1)

    expected = np.diff(integral(pixel_x())) * 8.0
    rows = np.arange(16, 32)  # y in (-1, 1)
    assert np.abs(found[rows] - expected).max() < 0.005
    assert found[:16].max() == found[32:].max() == 0.0
    assert expected.max() == pytest.approx(0.5, abs=1e-3)


def test_the_top_row_comes_first_and_edges_split_pixels() -> None:
    scene = shot((0.0, 0.0))
    scene.mesh("/square", [(0, 1, 0), (1.05, 1, 0), (1.05, 2, 0), (0, 2, 0)])
    found = coverage(scene.stage, 10.0, "/Camera", SIZE)
    assert found[8:16, 48:56].min() == 1.0
    assert found[8:16, 56] == pytest.approx(np.full(8, 0.4), abs=0.01)
    assert found.sum() == pytest.approx(8 * 8.4, abs=0.1)


def test_neighbours_leave_no_gap_and_count_once() -> None:
    scene = shot((0.0, 0.0))
    rng = np.random.default_rng(3)
    rim = [(2 * np.cos(a), 2 * np.sin(a), 0) for a in np.sort(rng.uniform(0, 2 * np.pi, 40))]
    scene.mesh("/fan", rim)
    found = coverage(scene.stage, 10.0, "/Camera", SIZE, Sampling(16, 4))
    x, y = np.array(rim).T[:2]
    area = 0.5 * abs(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1)))
    assert found.max() == 1.0
    assert found.sum() == pytest.approx(64 * area, rel=2e-3)


def test_what_passes_the_eye_is_clipped() -> None:
    scene = shot((0.0, 0.0))
    # A floor from behind the eye to the far plane: it covers what is below the horizon, down to its edge.
    scene.mesh("/floor", [(-1e4, -2, 100), (1e4, -2, 100), (1e4, -2, -5000), (-1e4, -2, -5000)])
    found = coverage(scene.stage, 10.0, "/Camera", SIZE, Sampling(16, 4))
    assert found[:24].max() == 0.0
    # It ends at the far plane, 1000 units off: 24 + 2 / 1000 * 160 = 24.3 pixels down.
    assert found[26:].min() == 1.0
    assert found[24].mean() == pytest.approx(0.68, abs=0.05)


def test_clipping_keeps_the_inside() -> None:
    rng = np.random.default_rng(1)
    corners = rng.normal(size=(200, 3, 3))
    kept = clipped(corners, corners[..., 2])
    assert kept[..., 2].min() > -1e-12

    def area(triangles: np.ndarray) -> float:
        edges = triangles[:, 1:] - triangles[:, :1]
        return float(np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1).sum() / 2)

    other = clipped(corners, -corners[..., 2])
    assert area(kept) + area(other) == pytest.approx(area(corners), rel=1e-12)


def test_velocity_scale_is_the_closed_form() -> None:
    scene = shot()
    mesh = scene.mesh("/m", [(0, 0, 0), (1, 0, 0), (1, 1, 0)])
    mesh.GetPointsAttr().Clear()
    mesh.GetPointsAttr().Set([(0, 0, 0), (1, 0, 0), (1, 1, 0)], 10)
    mesh.CreateVelocitiesAttr().Set([(24, 0, 0)] * 3, 10)
    mesh.CreateAccelerationsAttr().Set([(0, 24.0**2, 0)] * 3, 10)
    UsdGeom.MotionAPI.Apply(mesh.GetPrim()).CreateVelocityScaleAttr(3.0)
    found = StageTruth(scene.stage, 10.0).world_points("/m", 10.5)
    assert found[0] == pytest.approx((3 * 0.5, 0.5 * 0.5**2, 0.0))
    assert scene.stage.GetSessionLayer().empty


def test_blur_scale_stretches_the_motion_about_the_frame() -> None:
    scene = shot()
    translate = UsdGeom.Xformable(scene.mesh("/parent/m")).AddTranslateOp()
    for time in (0, 20):
        translate.Set(Gf.Vec3d(time, 0, 0), time)
    parent = scene.stage.GetPrimAtPath("/parent")
    UsdGeom.MotionAPI.Apply(parent).CreateMotionBlurScaleAttr(0.25)
    found = StageTruth(scene.stage, 10.0).world_points("/parent/m", 12.0)
    assert found[0] == pytest.approx((10.5, 0, 0))


@pytest.mark.shared
@pytest.mark.parametrize(("name", "frame", "bound"), [("arnold_1476", 1.0, 0.0035), ("arnold_2231", 1002.0, 0.0035)])
def test_another_renderers_alpha(name: str, frame: float, bound: float) -> None:
    """What the notes beside the scenes call the error of a plain triangle projection: .003. A still frame is
    out by .051 and .020."""
    folder = next(SCENES.glob(f"*/{name}"), None)
    if folder is None:
        absent(SCENES / "*" / name)
    stage = Usd.Stage.Open(str(folder / "data" / "test.usda"))
    camera = next(str(p.GetPath()) for p in stage.Traverse() if p.IsA(UsdGeom.Camera))
    reference = read_reference(folder / "ref" / "reference.tif")
    size = reference.shape[::-1]
    blurred = coverage(stage, frame, camera, size, Sampling(64, 4))
    assert np.abs(blurred - reference).mean() <= bound


def read_reference(path: Path) -> np.ndarray:
    return oiio.ImageInput.open(str(path)).read_image(oiio.FLOAT)[..., 3]
