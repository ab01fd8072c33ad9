"""Displaced surfaces in motion: points that turn, transforms, and distances that change."""

from __future__ import annotations

import numpy as np
from displaced_stages import ROUNDING, SIDE, Displaced, flat, primvar, turning
from pxr import Vt
from recording import DENSE_TIMES01, messages
from subdivision_stages import CORNERS, cube


def test_moving_points_are_displaced_where_the_surface_is_at_each_time() -> None:
    """Points that turn by 40 degrees between samples go straight in between: the surface is squeezed there, and its normals
    are those of the squeezed one."""
    shot = Displaced(0.4, (-1.0, 1.0))
    mesh = shot.bound(cube(shot))
    samples = {9.0: -40.0, 10.0: 0.0, 11.0: 40.0}
    for time, degrees in samples.items():
        mesh.GetPointsAttr().Set(Vt.Vec3fArray.FromNumpy((CORNERS @ turning(degrees)).astype(np.float32)), time)
    tolerance = 0.02
    scene = shot.read(width=400, edge_length=4.0, motion_tolerance=tolerance, displacement="tessellate").scene
    rest = shot.undisplaced("/Cube", 0.5, width=400, edge_length=4.0, motion_tolerance=tolerance)
    normals = (scene.points("/Cube", 0.5) - rest) / 0.4
    assert np.abs(np.linalg.norm(normals, axis=1) - 1.0).max() < 1e-4
    pixels_per_unit = 400 * 50.0 / 20.955 / (20.0 - 1.4)
    worst = 0.0
    for time01 in DENSE_TIMES01:
        time = 9.0 + 2.0 * time01
        before = min(float(np.floor(time)), 10.0)
        w = time - before
        map_ = (1 - w) * turning(samples[before]) + w * turning(samples[before + 1])
        moved = normals @ np.linalg.inv(map_).T
        moved /= np.linalg.norm(moved, axis=1, keepdims=True)
        expected = rest @ map_ + 0.4 * moved
        worst = max(worst, np.linalg.norm(scene.points("/Cube", time01) - expected, axis=1).max())
    assert worst * pixels_per_unit < tolerance
    # The cage alone needs no more than its samples.
    assert shot.undisplaced("/Cube", 0.25, width=400, edge_length=4.0) is not None


def test_turning_surfaces_get_the_keys_they_need() -> None:
    segments = {}
    for amount in (0.0, 0.05, 1.0):
        shot = Displaced(amount, (-1.0, 1.0))
        mesh = shot.bound(cube(shot))
        for time in (9.0, 11.0):
            turned = CORNERS @ turning(60.0 * (time - 10.0))
            mesh.GetPointsAttr().Set(Vt.Vec3fArray.FromNumpy(turned.astype(np.float32)), time)
        result = shot.read(edge_length=8.0, interpolation="linear")
        track = next(track for track in result.tracks if track.path == "/Cube")
        segments[amount] = track.segments
        assert track.error_pixels <= 0.1
    assert segments[0.0] == 1
    assert segments[0.0] < segments[0.05] < segments[1.0]


def test_under_a_moving_transform_the_displaced_mesh_is_still() -> None:
    shot = Displaced(0.5, (-0.5, 0.5))
    mesh = flat(shot)
    turn = mesh.AddRotateYOp()
    turn.Set(0.0, 9.5)
    turn.Set(90.0, 10.5)
    result = shot.read(displacement="tessellate")
    track = next(track for track in result.tracks if track.path == "/Sheet")
    assert track.moving_transform
    for time01 in (0.0, 0.31, 1.0):
        (found,) = [points[0] for _, place, points in result.scene.poses(time01) if place == "/Sheet"]
        a = np.radians(90.0 * time01)
        distance = found @ np.array([np.sin(a), 0, np.cos(a)])  # Along the turned normal.
        assert np.abs(distance - 0.5).max() < 2e-3


def test_a_primvar_that_changes_within_the_shutter_moves_the_surface() -> None:
    shot = Displaced(shutter=(-1.0, 1.0))
    shot.read_primvar("height")
    mesh = flat(shot)
    for time, height in ((9.0, 0.0), (9.5, 1.0), (11.0, 0.25)):
        primvar(mesh, "height", np.full((SIDE + 1) ** 2, height), "vertex", time)
    result = shot.read(displacement="tessellate")
    assert messages(result, "warning") == []
    for time01 in DENSE_TIMES01:
        expected = np.interp(9.0 + 2.0 * time01, [9.0, 9.5, 11.0], [0.0, 1.0, 0.25])
        poses = [points[0] for _, _, points in result.scene.poses(time01)]
        assert np.abs(poses[0][:, 2] - expected).max() < 2e-3


def test_velocities_carry_a_displaced_surface() -> None:
    shot = Displaced(0.5, (-0.5, 0.5))
    mesh = flat(shot)
    points = np.array(mesh.GetPointsAttr().Get())
    mesh.GetPointsAttr().Clear()
    mesh.GetPointsAttr().Set(Vt.Vec3fArray.FromNumpy(points), 10.0)
    velocities = np.full_like(points, (24.0, 0.0, 12.0))  # One unit a frame, and a half.
    mesh.CreateVelocitiesAttr().Set(Vt.Vec3fArray.FromNumpy(velocities), 10.0)
    result = shot.read(displacement="tessellate")
    assert messages(result, "warning") == []
    track = next(track for track in result.tracks if track.path == "/Sheet")
    assert (track.segments, track.degree) == (1, 1)  # It does not turn.
    first = result.scene.points("/Sheet", 0.0)
    for time01 in DENSE_TIMES01:
        found = result.scene.points("/Sheet", time01)
        assert np.abs(found - first - time01 * np.array([1.0, 0.0, 0.5])).max() < 2 * ROUNDING
        assert np.abs(found[:, 2] - 0.5 - 0.5 * (time01 - 0.5)).max() < 2 * ROUNDING
