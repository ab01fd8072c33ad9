"""OpenUSD's testUsdImagingGLVelocityMotion: prims that velocities carry, beside prims that are sampled where the
velocities should take them.

Each group holds a /Reference and a /Pointer at the same place; the pointer's points are some of the reference's.
Their tracks coincide up to what the reference's samples leave out: it has chords for the parabola (a sample every
tenth of a frame), and quaternions in three digits and half floats for the turn.
"""

from __future__ import annotations

import numpy as np
import pytest
from msbvh.base.errors import Diagnostics
from msbvh.scene.reader import ReadResult, ReadSettings, read_frame
from pxr import Usd, UsdGeom
from recording import DENSE_TIMES01
from shared_scenes import SCENES, require

PATH = SCENES / "velocity_accel" / "usdgl_VelocityMotion" / "scene.usda"
pytestmark = pytest.mark.shared


@pytest.fixture(autouse=True)
def _scene() -> None:
    require(PATH)


TOLERANCE_PIXELS = 0.01
DISTANCE = 20.0
"""Of the prims from the camera, at most."""

ACCELERATION = 230.4 / 24**2
"""Units a frame squared, against the x axis."""
CHORD = ACCELERATION * 0.1**2 / 8
"""How far a parabola swells beyond its chords over a tenth of a frame: 0.0005."""

QUATERNION = 0.0005 / 2 + 2.0**-12
"""By which a component strays: three digits, then half the step of half floats below 1."""
TURN = 0.75 * 8 * QUATERNION
"""A point within 0.75 of the axis: an element of the matrix is a sum of two products 2ab, each of which strays by
2 * 2 * QUATERNION at most. Interpolation along the arc does not add to it."""

MESH = ([0, 1, 2, 3], [0, 1, 4, 5])
INSTANCE = ([0, 1, 2, 3], [0, 1, 2, 5])
"""Points of the pointer, and the same ones of the reference."""

PAIRS = {
    "PointsVelocity": (MESH, 0.0),
    "PointsAcceleration": (MESH, CHORD),
    "PositionsVelocity": (INSTANCE, 0.0),
    "PositionsAcceleration": (INSTANCE, CHORD),
    "OrientationsVelocity": (INSTANCE, TURN),
}
"""The group, and by how much its reference strays from the motion that is meant."""

SHUTTERS = ((0.0, 0.0, 1.0), (2.5, -0.5, 0.5), (1.0, -1.0, 0.25), (4.0, -0.1, 0.9))
"""Frame, opening, closing; within the samples at 0 and 5."""


def read(frame: float, opening: float, closing: float) -> ReadResult:
    stage = Usd.Stage.Open(str(PATH))
    stage.SetEditTarget(stage.GetSessionLayer())
    camera = UsdGeom.Camera.Get(stage, "/World/main_cam")
    camera.CreateShutterOpenAttr(opening)
    camera.CreateShutterCloseAttr(closing)
    diagnostics = Diagnostics()
    result = read_frame(
        stage, frame, ReadSettings(motion_tolerance=TOLERANCE_PIXELS, outside_tolerance=1.0), diagnostics
    )
    assert [str(d) for d in diagnostics if d.severity != "note"] == []
    return result


def posed(result: ReadResult, prim: str, time01: float) -> np.ndarray:
    """The points of the one mesh or instance that stands for a prim: float64[N, 3]."""
    (points,) = [points for _, place, points in result.scene.poses(time01) if place == prim]
    return points[0]


@pytest.mark.parametrize("shutter", SHUTTERS, ids=str)
@pytest.mark.parametrize("group", PAIRS)
def test_the_pointer_goes_with_its_reference(group: str, shutter: tuple[float, float, float]):
    (of_pointer, of_reference), bound = PAIRS[group]
    result = read(*shutter)
    # Both tracks may stray by the tolerance.
    tracks = 2 * TOLERANCE_PIXELS * result.camera.pixel_size().per_unit * DISTANCE + 1e-5
    travelled = 0.0
    start = posed(result, f"/World/{group}/Pointer", 0.0)
    for time01 in DENSE_TIMES01:
        pointer = posed(result, f"/World/{group}/Pointer", time01)
        reference = posed(result, f"/World/{group}/Reference", time01)
        away = pointer[of_pointer] - reference[of_reference]
        assert np.abs(away).max() <= bound + tracks
        if bound == CHORD:  # The parabola is concave: chords fall behind it, never ahead.
            assert away[:, 0].min() >= -tracks
        travelled = max(travelled, np.abs(pointer - start).max())
    assert travelled > 100 * (bound + tracks) / 2


def test_the_tracks_are_what_the_velocities_say():
    """One segment each: a line, a parabola; and the reference's chords take many."""
    tracks = {track.path: track for track in read(2.5, -0.5, 0.5).tracks}
    forms = {
        name: (tracks[f"/World/{name}/Pointer"].segments, tracks[f"/World/{name}/Pointer"].degree) for name in PAIRS
    }
    assert forms["PointsVelocity"] == forms["PositionsVelocity"] == (1, 1)
    assert forms["PointsAcceleration"] == forms["PositionsAcceleration"] == (1, 2)


@pytest.mark.parametrize("frame", [0.0, 1.0, 2.5, 4.0])
@pytest.mark.parametrize("group", PAIRS)
def test_without_blur_the_pointer_stands_beside_its_reference(group: str, frame: float):
    """As upstream's baselines of frames 1, 2.5 and 4 have it: velocities carry the pose of a still frame, too."""
    (of_pointer, of_reference), bound = PAIRS[group]
    result = read(frame, 0.0, 0.0)
    pointer = posed(result, f"/World/{group}/Pointer", 0.5)
    reference = posed(result, f"/World/{group}/Reference", 0.5)
    assert np.abs(pointer[of_pointer] - reference[of_reference]).max() <= bound + 1e-5
