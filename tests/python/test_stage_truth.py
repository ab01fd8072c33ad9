"""The truth about skinning, against UsdSkel's other way to compute it: baked points."""

from __future__ import annotations

import numpy as np
import pytest
from conftest import ROOT
from pxr import Gf, Usd, UsdGeom, UsdSkel
from recording import transformed
from stage_truth import StageTruth

SCENES = ROOT / "testenv" / "motion" / "scenes"


@pytest.mark.parametrize(
    "name",
    [
        "skin_linear",
        "skin_dual_quaternion",
        "skin_geom_bind_transform",
        "skin_moving_skeleton",
        "skin_rigid",
        "skin_under_moving_parent",
        "blend_shapes",
        "blend_shape_in_betweens",
    ],
)
def test_skinned_points_are_the_baked_ones(name: str) -> None:
    path = str(SCENES / f"{name}.usda")
    truth, baked = StageTruth(Usd.Stage.Open(path), 10.0), Usd.Stage.Open(path)
    baked.SetEditTarget(baked.GetSessionLayer())
    assert UsdSkel.BakeSkinning(baked.Traverse(), Gf.Interval(9.0, 11.0))
    prim = next(prim for prim in baked.Traverse() if prim.IsA(UsdGeom.Mesh))
    times = set(prim.GetAttribute("points").GetTimeSamples()) or set(
        UsdGeom.Xformable(prim).GetTimeSamplesInInterval(Gf.Interval(9.0, 11.0))
    )
    assert len(times) >= 2
    for time in times:
        points = np.array(prim.GetAttribute("points").Get(time), float)
        matrix = np.array(UsdGeom.XformCache(time).GetLocalToWorldTransform(prim))
        found = truth.world_points(str(prim.GetPath()), time)
        assert np.abs(found - transformed(points, matrix)).max() < 2e-5


def test_instances_are_skinned_where_they_stand() -> None:
    truth = StageTruth(Usd.Stage.Open(str(SCENES / "skin_instances.usda")), 10.0)
    one, two = (truth.world_points(f"/{name}/Root/Mesh", 10.5) for name in ("One", "Two"))
    # Mirrored arms, six units apart: the joints turn by 120 degrees up and down.
    assert one[0] == pytest.approx((-5.0, -0.4, 0.0), abs=1e-5)
    assert two[0] == pytest.approx((1.0, -0.4, 0.0), abs=1e-5)
    assert one[:, 1].max() == pytest.approx(-two[:, 1].min(), abs=1e-5)
    assert one[:, 1].max() > 1.5
