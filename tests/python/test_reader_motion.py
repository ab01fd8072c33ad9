"""Positions that the reader hands down against usd-core's own evaluation at 33 times of the shutter."""

from __future__ import annotations

from time import process_time

import numpy as np
import pytest
from pxr import Gf, Usd, UsdGeom
from recording import Shot, messages, worst_deviation

FRAME = 10.0
# The camera is 20 units from the origin: a tenth of a pixel there is 0.1 * 20 * (20.955 / 50) / 960 units.
TENTH_PIXEL = 0.1 * 20 * (20.955 / 50) / 960
ROUNDING = 4e-6


def deviation(shot: Shot, mesh: UsdGeom.Mesh, **settings) -> float:
    return worst_deviation(shot.read(FRAME, **settings), mesh.GetPrim())


@pytest.mark.parametrize("shutter", [(-0.5, 0.5), (0.0, 0.5), (-0.1, 0.7)])
def test_a_rotation_stays_within_the_tolerance(shutter):
    shot = Shot(shutter)
    mesh = shot.mesh("/Mesh")
    spin = mesh.AddRotateZOp()
    spin.Set(0.0, 9.0)
    spin.Set(220.0, 11.0)
    assert 0 < deviation(shot, mesh) < TENTH_PIXEL
    assert deviation(shot, mesh, motion_tolerance=0.01) < TENTH_PIXEL / 10


def test_a_full_turn_within_the_shutter_is_not_missed():
    shot = Shot()
    mesh = shot.mesh("/Mesh")
    spin = mesh.AddRotateZOp()
    spin.Set(0.0, 9.5)
    spin.Set(360.0, 10.5)
    assert deviation(shot, mesh) < TENTH_PIXEL


def test_parameters_are_interpolated_then_composed_and_matrices_by_component():
    shot = Shot()
    parent = UsdGeom.Xform.Define(shot.stage, "/Parent")
    matrix = parent.AddTransformOp()
    matrix.Set(Gf.Matrix4d(1), 9.7)
    matrix.Set(Gf.Matrix4d().SetRotate(Gf.Rotation(Gf.Vec3d(0, 0, 1), 90)), 10.4)
    mesh = shot.mesh("/Parent/Mesh")
    pivot = mesh.AddTranslateOp(opSuffix="pivot")
    pivot.Set(Gf.Vec3d(0.5, 0.5, 0))
    scale = mesh.AddScaleOp()
    scale.Set(Gf.Vec3f(1, 1, 1), 9.0)
    scale.Set(Gf.Vec3f(-2, 1, 1), 10.9)
    mesh.AddRotateXYZOp().Set(Gf.Vec3f(10, 20, 30))
    mesh.AddTranslateOp(opSuffix="pivot", isInverseOp=True)
    assert deviation(shot, mesh) < TENTH_PIXEL


def test_keys_outside_and_inside_the_shutter_at_odd_times():
    shot = Shot((-0.25, 0.25))
    mesh = shot.mesh("/Mesh")
    move = mesh.AddTranslateOp()
    for code, x in [
        (3.0, 0.0),
        (9.8, 1.0),
        (9.9000001, 4.0),
        (10.0 - 8e-9, -3.0),
        (10.123, 2.0),
        (17.0, 9.0),
    ]:
        move.Set(Gf.Vec3d(x, 0, 0), code)
    assert deviation(shot, mesh) < ROUNDING


def test_wide_keys_with_none_inside_the_shutter_still_blur():
    shot = Shot((-0.1, 0.1))
    mesh = shot.mesh("/Mesh")
    mesh.GetPointsAttr().Set([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], 0.0)
    mesh.GetPointsAttr().Set([(0, 0, 5), (9, 0, 0), (1, 1, 0), (0, 1, 0)], 24.0)
    result = shot.read(FRAME)
    assert [time for time, _ in result.scene.meshes["/Mesh"]["points"]] == pytest.approx([-49.5, 70.5])
    assert worst_deviation(result, mesh.GetPrim()) < ROUNDING


def test_reset_xform_stack_and_moving_ancestors():
    shot = Shot()
    outer = UsdGeom.Xform.Define(shot.stage, "/Outer").AddTranslateOp()
    outer.Set(Gf.Vec3d(0), 9.0)
    outer.Set(Gf.Vec3d(0, 3, 0), 11.0)
    inner = UsdGeom.Xform.Define(shot.stage, "/Outer/Inner")
    below, reset = shot.mesh("/Outer/Inner/Below"), shot.mesh("/Outer/Inner/Reset")
    inner.AddRotateYOp().Set(30.0)
    reset.AddTranslateOp().Set(Gf.Vec3d(1, 2, 3))
    reset.SetResetXformStack(True)
    result = shot.read(FRAME)
    assert worst_deviation(result, below.GetPrim()) < ROUNDING
    assert worst_deviation(result, reset.GetPrim()) < ROUNDING
    assert len(result.scene.meshes["/Outer/Inner/Reset"]["transform"].matrices) == 1


def test_points_and_transform_with_different_samples():
    shot = Shot()
    mesh = shot.mesh("/Mesh")
    for index, time in enumerate((8.7, 9.6, 9.93, 10.2, 10.45, 13.0)):
        mesh.GetPointsAttr().Set([(0, 0, index % 2), (1, 0, 0), (1, 1 + index, 0), (0, 1, 0)], time)
    spin = mesh.AddRotateZOp()
    spin.Set(0.0, 9.0)
    spin.Set(45.0, 11.0)
    assert deviation(shot, mesh) < TENTH_PIXEL


def test_held_interpolation_jumps():
    shot = Shot()
    shot.stage.SetInterpolationType(Usd.InterpolationTypeHeld)
    mesh = shot.mesh("/Mesh")
    move = mesh.AddTranslateOp()
    for code, x in [(9.0, 0.0), (9.9, 1.0), (10.3, 5.0)]:
        move.Set(Gf.Vec3d(x, 0, 0), code)
        mesh.GetPointsAttr().Set([(0, 0, x), (1, 0, 0), (1, 1, 0), (0, 1, 0)], code)
    assert deviation(shot, mesh) < ROUNDING


def test_splines_have_no_samples_but_move():
    from pxr import Ts

    shot = Shot()
    mesh = shot.mesh("/Mesh")
    attribute = mesh.AddTranslateXOp().GetAttr()
    spline = Ts.Spline("double")
    for time, value in [(9.0, 0.0), (10.0, 3.0), (11.0, -1.0)]:
        knot = Ts.Knot(typeName="double", time=time, value=value, nextInterp=Ts.InterpCurve)
        knot.SetPreTanWidth(0.3)
        knot.SetPostTanWidth(0.3)
        spline.SetKnot(knot)
    attribute.SetSpline(spline)
    assert not attribute.GetTimeSamples()
    result = shot.read(FRAME)
    assert len(result.scene.meshes["/Mesh"]["transform"].matrices) > 8
    assert worst_deviation(result, mesh.GetPrim()) < TENTH_PIXEL


def test_constant_values_under_many_samples_are_still():
    shot = Shot()
    mesh = shot.mesh("/Mesh")
    move = mesh.AddTranslateOp()
    for time in np.arange(9.0, 11.0, 0.1):
        move.Set(Gf.Vec3d(1, 2, 3), float(time))
        mesh.GetPointsAttr().Set([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], float(time))
    result = shot.read(FRAME)
    track = next(track for track in result.tracks if track.path == "/Mesh")
    assert (track.segments, track.moving_transform, track.error_pixels) == (0, False, 0.0)


@pytest.mark.parametrize("rate", [23.976, 24.0, 48.0, 128.0])
@pytest.mark.parametrize("accelerated", [False, True])
def test_velocities_are_per_second_from_one_base_sample(rate, accelerated):
    shot = Shot((-0.25, 0.5), rate)
    mesh = shot.mesh("/Mesh")
    for time in (9.0, 9.9, 11.0):
        mesh.GetPointsAttr().Set([(0, 0, time), (1, 0, 0), (1, 1, 0), (0, 1, 0)], time)
        mesh.CreateVelocitiesAttr().Set([(time * 20, 0, 0), (0, 30, 0), (0, 0, 0), (1, 1, 1)], time)
        if accelerated:
            mesh.CreateAccelerationsAttr().Set([(0, 900, 0), (0, 0, 0), (500, 0, 0), (0, 0, -800)], time)
    result = shot.read(FRAME)
    assert worst_deviation(result, mesh.GetPrim()) < 2e-5
    track = next(track for track in result.tracks if track.path == "/Mesh")
    assert (track.segments, track.degree) == (1, 2 if accelerated else 1)
    assert track.source == ("accelerations" if accelerated else "velocities")


def test_velocities_that_do_not_align_are_not_used_and_that_is_said():
    shot = Shot()
    mesh = shot.mesh("/Mesh")
    for time in (9.0, 11.0):
        mesh.GetPointsAttr().Set([(0, 0, time), (1, 0, 0), (1, 1, 0), (0, 1, 0)], time)
        mesh.CreateVelocitiesAttr().Set([(50, 0, 0)] * 4, time + 0.25)
    result = shot.read(FRAME)
    assert worst_deviation(result, mesh.GetPrim()) < ROUNDING
    assert any("/Mesh.velocities: not used" in message for message in messages(result, "warning"))


def test_velocities_rescue_a_topology_that_changes():
    shot = Shot()
    mesh = shot.mesh("/Mesh")
    for time, count in [(9.0, 3), (9.8, 4), (10.2, 5)]:
        mesh.GetPointsAttr().Set([(i, i * i, time) for i in range(count)], time)
        mesh.CreateVelocitiesAttr().Set([(24, i, 0) for i in range(count)], time)
        mesh.GetFaceVertexCountsAttr().Set([count], time)
        mesh.GetFaceVertexIndicesAttr().Set(range(count), time)
    result = shot.read(FRAME)
    assert worst_deviation(result, mesh.GetPrim()) < ROUNDING
    assert not messages(result, "warning")


def test_a_topology_that_changes_without_velocities_is_held_with_a_warning():
    shot = Shot()
    mesh = shot.mesh("/Mesh")
    for time, count in [(9.8, 4), (10.2, 5)]:
        mesh.GetPointsAttr().Set([(i, i * i, time) for i in range(count)], time)
        mesh.GetFaceVertexCountsAttr().Set([count], time)
        mesh.GetFaceVertexIndicesAttr().Set(range(count), time)
    result = shot.read(FRAME)
    recorded = result.scene.meshes["/Mesh"]
    assert recorded["face_vertex_counts"].tolist() == [4]
    for time01 in (0.0, 0.9):
        assert np.abs(result.scene.points("/Mesh", time01) - [(i, i * i, 9.8) for i in range(4)]).max() < ROUNDING
    assert any("/Mesh.points: the topology changes" in message for message in messages(result, "warning"))


def test_topology_that_is_time_sampled_but_constant_does_not_hold_the_points():
    shot = Shot()
    mesh = shot.mesh("/Mesh")
    for time in (9.0, 9.9, 11.0):
        mesh.GetPointsAttr().Set([(0, 0, time), (1, 0, 0), (1, 1, 0), (0, 1, 0)], time)
        mesh.GetFaceVertexCountsAttr().Set([4], time)
        mesh.GetFaceVertexIndicesAttr().Set([0, 1, 2, 3], time)
    result = shot.read(FRAME)
    assert worst_deviation(result, mesh.GetPrim()) < ROUNDING
    assert not messages(result, "warning")


def test_the_pose_of_a_closed_shutter_is_the_frames():
    shot = Shot((0.0, 0.0))
    mesh = shot.mesh("/Mesh")
    move = mesh.AddTranslateOp()
    move.Set(Gf.Vec3d(0), 9.0)
    move.Set(Gf.Vec3d(2, 0, 0), 11.0)
    recorded = shot.read(FRAME).scene.meshes["/Mesh"]
    assert recorded["transform"].matrices.shape == (1, 4, 4)
    assert recorded["transform"].matrices[0, 3, 0] == pytest.approx(1.0)


def test_default_time_reads_defaults_alone():
    shot = Shot()
    mesh = shot.mesh("/Mesh")
    mesh.GetPointsAttr().Set([(9, 9, 9)] * 4, 10.0)
    recorded = shot.read(None).scene.meshes["/Mesh"]
    assert np.array_equal(recorded["points"][0][1], np.float32([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]))


def test_implicit_shapes_follow_their_animated_parameters():
    shot = Shot()
    sphere = UsdGeom.Sphere.Define(shot.stage, "/Sphere")
    sphere.GetRadiusAttr().Set(1.0, 9.0)
    sphere.GetRadiusAttr().Set(3.0, 11.0)
    recorded = shot.read(FRAME).scene.meshes["/Sphere"]
    radii = [np.linalg.norm(points, axis=1) for _, points in recorded["points"]]
    assert [time for time, _ in recorded["points"]] == [-0.5, 1.5]
    assert radii[0] == pytest.approx(1.0, abs=1e-6) and radii[1] == pytest.approx(3.0, abs=1e-6)


def test_thousands_of_moving_prims_are_read_in_seconds():
    shot = Shot()
    for index in range(2000):
        move = shot.mesh(f"/Group_{index // 100}/Mesh_{index}").AddTranslateOp()
        move.Set(Gf.Vec3d(index, 0, 0), 9.0)
        move.Set(Gf.Vec3d(index, 1, 0), 11.0)
    start = process_time()
    assert len(shot.read(FRAME).scene.meshes) == 2000
    assert process_time() - start < 8.0  # About 1 s on one idle core.


@pytest.mark.parametrize("shutter", [(-0.5, 0.0), (-0.9, -0.3)])
def test_velocities_must_align_behind_the_frame_also_where_the_shutter_closes_before(shutter):
    """USD looks at the samples around the frame; whatever the shutter sees."""
    shot = Shot(shutter)
    mesh = shot.mesh("/Mesh")
    for time, x in ((9, 0), (10, 1), (11, 3)):
        mesh.GetPointsAttr().Set([(x, 0, 0), (x + 1, 0, 0), (x + 1, 1, 0), (x, 1, 0)], time)
    for time in (9, 10, 10.5):
        mesh.CreateVelocitiesAttr().Set([(50, 0, 0)] * 4, time)
    result = shot.read()
    assert messages(result, "warning") == [
        "/Mesh.velocities: not used: the samples do not align with those of points (USD's rule)"
    ]
    assert worst_deviation(result, mesh.GetPrim()) <= 1e-5


def test_a_breakpoint_at_the_shutters_end_but_for_rounding():
    """(9.7 - 9.1) / (9.7 - 9.1) is not always 1: a stretch of 1e-16 cannot be halved."""
    shot = Shot((-0.9, -0.3))
    mesh = shot.mesh("/Mesh")
    turn = mesh.AddRotateZOp()
    for time, angle in ((9.61, 0.0), (9.7, 40.0), (9.7 + 1e-12, 40.0), (11, 0.0)):
        turn.Set(angle, time)
    result = shot.read()
    assert not messages(result, "warning") and not messages(result, "error")
    assert worst_deviation(result, mesh.GetPrim()) <= 0.01


@pytest.mark.parametrize("shutter", [(-0.5, 0.0), (-0.9, -0.3)])
@pytest.mark.parametrize("visible", [True, False])
def test_a_visibility_that_changes_at_the_frame_is_the_shutters(shutter, visible: bool):
    shot = Shot(shutter)
    mesh = shot.mesh("/Mesh")
    for time, is_visible in ((9, visible), (10, not visible)):
        mesh.CreateVisibilityAttr().Set("inherited" if is_visible else "invisible", time)
    assert ("/Mesh" in shot.read().scene.meshes) == visible
