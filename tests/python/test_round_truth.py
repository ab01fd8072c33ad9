"""The polygons that stand for curves and points in the conformance suite's answers, against closed forms."""

from __future__ import annotations

import numpy as np
import pytest
from pxr import Gf, Usd, UsdGeom
from round_truth import SIDES, drawn_curves, drawn_points

EYE = np.array([0.0, 0.0, 20.0])


def test_a_disc_spans_the_cone_that_touches_its_sphere() -> None:
    centres, widths = np.array([(0.0, 0.0, 0.0), (4.0, -2.0, 3.0)]), np.array([3.0, 1.0])
    corners, counts, _ = drawn_points(centres, widths, EYE)
    assert counts.tolist() == [SIDES, SIDES]
    for centre, width, rim in zip(centres, widths, corners.reshape(2, SIDES, 3), strict=True):
        axis, rays = centre - EYE, rim - EYE
        cosine = rays @ axis / (np.linalg.norm(rays, axis=1) * np.linalg.norm(axis))
        assert np.arccos(cosine) == pytest.approx(np.arcsin(0.5 * width / np.linalg.norm(axis)))


def curve(points: list[tuple[float, float, float]], basis: str = "", wrap: str = "nonperiodic") -> UsdGeom.BasisCurves:
    stage = Usd.Stage.CreateInMemory()
    prim = UsdGeom.BasisCurves.Define(stage, "/Curves")
    STAGES.append(stage)
    prim.CreateTypeAttr("cubic" if basis else "linear")
    if basis:
        prim.CreateBasisAttr(basis)
    prim.CreateWrapAttr(wrap)
    prim.CreatePointsAttr([Gf.Vec3f(*point) for point in points])
    prim.CreateCurveVertexCountsAttr([len(points)])
    prim.SetWidthsInterpolation("constant")
    return prim


STAGES: list[Usd.Stage] = []
"""A prim does not hold its stage."""


def ribbon(prim: UsdGeom.BasisCurves, widths: list[float], normals: np.ndarray | None = None) -> np.ndarray:
    """Corners float64[N, 3]."""
    points = np.array(prim.GetPointsAttr().Get(), float)
    return drawn_curves(prim, points, np.array(widths), normals, EYE, 0.0)[0]


LINE = [(-3.0, 0.0, 0.0), (-1.0, 0.0, 0.0), (1.0, 0.0, 0.0), (3.0, 0.0, 0.0)]
ENDS = {"bspline": 1.0, "catmullRom": 1.0, "bezier": 3.0}


@pytest.mark.parametrize("basis", ENDS)
def test_cubic_curves_end_where_their_basis_has_it(basis: str) -> None:
    found = ribbon(curve(LINE, basis), [2.0])
    assert (found[:, 0].min(), found[:, 0].max()) == pytest.approx((-ENDS[basis], ENDS[basis]))
    assert (found[:, 1].min(), found[:, 1].max()) == pytest.approx((-1.0, 1.0))


@pytest.mark.parametrize("basis", ["bspline", "catmullRom"])
def test_pinned_curves_reach_their_ends(basis: str) -> None:
    found = ribbon(curve(LINE, basis, "pinned"), [2.0])
    assert (found[:, 0].min(), found[:, 0].max()) == pytest.approx((-3.0, 3.0))


def test_a_periodic_b_spline_is_closed() -> None:
    square = [(-3.0, -3.0, 0.0), (3.0, -3.0, 0.0), (3.0, 3.0, 0.0), (-3.0, 3.0, 0.0)]
    found = ribbon(curve(square, "bspline", "periodic"), [1e-9])
    # (1, 23, 23, 1) / 48 in the middle of a side, (1, 4, 1) / 6 at a corner.
    assert found[:, :2].max(axis=0) == pytest.approx([2.75, 2.75])
    assert found[:, :2].min(axis=0) == pytest.approx([-2.75, -2.75])
    assert np.abs(found[:, :2]).min(axis=1).max() == pytest.approx(2.0)


def test_widths_vary_and_normals_turn_the_ribbon() -> None:
    prim = curve(LINE)
    prim.SetWidthsInterpolation("varying")
    found = ribbon(prim, [0.0, 1.0, 2.0, 4.0])
    assert found[found[:, 0] > 2.999, 1].max() == pytest.approx(2.0)
    assert found[np.abs(found[:, 0]) < 1e-9, 1].max() == pytest.approx(0.75)
    flat = ribbon(prim, [2.0] * 4, np.array([(0.0, 1.0, 0.0)] * 4))
    assert np.abs(flat[:, 1]).max() == pytest.approx(0.0, abs=1e-12)
    assert np.abs(flat[:, 2]).max() == pytest.approx(1.0)
