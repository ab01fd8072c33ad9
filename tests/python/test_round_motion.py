"""Curves and points move as USD's own evaluation says."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from pxr import Gf, UsdGeom
from recording import Shot, messages, worst_deviation
from round_stages import PIXEL, ZIGZAG, cloud, curves, moved


@pytest.mark.parametrize("make", [curves, cloud])
def test_points_follow_their_samples(make: Any) -> None:
    shot = Shot()
    prim = make(shot)
    for time, by in ((8.0, (0, 0, 0)), (9.8, (1, 2, 0)), (10.1, (-1, 0, 0)), (12.0, (4, 4, 1))):
        prim.GetPointsAttr().Set(moved(ZIGZAG, by), time)
    result = shot.read()
    assert messages(result) == []
    assert worst_deviation(result, prim.GetPrim()) < 0.11 * PIXEL


@pytest.mark.parametrize("make", [curves, cloud])
@pytest.mark.parametrize("accelerate", [False, True])
def test_velocities_and_accelerations_carry_the_sample_at_the_frame(make: Any, accelerate: bool) -> None:
    shot = Shot()
    prim = make(shot)
    prim.GetPointsAttr().Set(moved(ZIGZAG, (0, 0, 0)), 10.0)
    prim.GetPointsAttr().Set(moved(ZIGZAG[:4], (0, 0, 0)), 11.0)  # born and died: rates say how to go on
    prim.CreateVelocitiesAttr().Set([Gf.Vec3f(30, 20 + i, 0) for i in range(len(ZIGZAG))], 10.0)
    prim.GetVelocitiesAttr().Set([Gf.Vec3f(1, 0, 0)] * 4, 11.0)
    if accelerate:
        prim.CreateAccelerationsAttr().Set([Gf.Vec3f(0, -900, 0)] * len(ZIGZAG), 10.0)
        prim.GetAccelerationsAttr().Set([Gf.Vec3f(0, 0, 0)] * 4, 11.0)
    result = shot.read()
    assert messages(result, "warning") == []
    assert worst_deviation(result, prim.GetPrim()) < 0.11 * PIXEL
    track = next(t for t in result.tracks if t.path == prim.GetPath())
    assert track.source == ("accelerations" if accelerate else "velocities")


@pytest.mark.parametrize("make", [curves, cloud])
def test_a_moving_transform_places_them(make: Any) -> None:
    shot = Shot()
    prim = make(shot)
    turn = prim.AddRotateZOp()
    turn.Set(0.0, 9.0)
    turn.Set(60.0, 11.0)
    result = shot.read()
    assert messages(result) == []
    assert worst_deviation(result, prim.GetPrim()) < 0.11 * PIXEL
    assert next(t for t in result.tracks if t.path == prim.GetPath()).moving_transform


@pytest.mark.parametrize("make", [curves, cloud])
def test_in_prototypes_of_point_instancers(make: Any) -> None:
    shot = Shot()
    instancer = UsdGeom.PointInstancer.Define(shot.stage, "/Instancer")
    prim = make(shot, "/Instancer/Thing")
    instancer.CreatePrototypesRel().AddTarget(prim.GetPath())
    instancer.CreateProtoIndicesAttr([0, 0, 0])
    instancer.CreatePositionsAttr([Gf.Vec3f(-3, 0, 0), Gf.Vec3f(0, 1, 0), Gf.Vec3f(3, 2, 0)])
    result = shot.read()
    assert messages(result) == []
    expected = np.array([np.add(p, at) for at in ((-3, 0, 0), (0, 1, 0), (3, 2, 0)) for p in ZIGZAG])
    found = result.scene.instance_points(0.5)
    assert found.shape == expected.shape
    assert np.abs(found - expected).max() < 1e-5
