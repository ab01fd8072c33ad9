"""The rules of subdivision that the conformance suite's answers come from, against closed forms."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from limit_surface import INFINITE, Cage
from subdivision_stages import CORNERS, FACES, VERTEX_LIMIT

STEPS = 4


def grid(side: int) -> list[tuple[int, ...]]:
    stride = side + 1
    first = [y * stride + x for y in range(side) for x in range(side)]
    return [(a, a + 1, a + 1 + stride, a + stride) for a in first]


def triangle_grid(side: int) -> list[tuple[int, ...]]:
    return [triangle for a, b, c, d in grid(side) for triangle in ((a, b, c), (a, c, d))]


def places(side: int) -> np.ndarray:
    """float64[N, 2] of a grid's vertices."""
    return np.array([(x, y) for y in range(side + 1) for x in range(side + 1)], float)


def edges_of(faces: list[tuple[int, ...]]) -> list[tuple[int, int]]:
    return [(min(a, b), max(a, b)) for f in faces for a, b in zip(f, (*f[1:], f[0]), strict=True)]


@pytest.mark.parametrize("scheme", ["catmullClark", "loop", "bilinear"])
@pytest.mark.parametrize("boundary", ["edgeAndCorner", "edgeOnly", "none"])
def test_points_are_weighted_means(scheme: str, boundary: str) -> None:
    faces = triangle_grid(3) if scheme == "loop" else grid(3)
    cage = Cage.of(faces, 16, scheme, boundary, {(5, 6): 1.5, (6, 10): INFINITE}, {9: 0.5}).refined(STEPS)
    assert cage.weights.sum(axis=1) == pytest.approx(1.0)
    assert cage.weights.min() >= 0.0


def test_a_regular_grid_is_a_bicubic_b_spline() -> None:
    """Control points of x^2 on a uniform grid of width h are x^2 - h^2 / 3, of x^3 they are x^3 - h^2 x, of y likewise."""
    side = 8
    at = places(side)

    def controls(xy: np.ndarray, h: float) -> np.ndarray:
        x, y = xy.T
        square, cube = lambda t: t**2 - h**2 / 3.0, lambda t: t**3 - h**2 * t
        return square(x) * cube(y) - 2.0 * cube(x) + y

    cage = Cage.of(grid(side), len(at)).refined(STEPS)
    here, found = cage.weights @ at, cage.weights @ controls(at, 1.0)
    inside = ((here > 2.0) & (here < side - 2.0)).all(axis=1)
    assert inside.sum() > 1000
    assert found[inside] == pytest.approx(controls(here, 2.0**-STEPS)[inside], rel=1e-12, abs=1e-9)


def test_a_regular_triangle_grid_is_a_box_spline() -> None:
    """Loop's controls of x^2 on a uniform grid of three directions are x^2 - h^2 / 3: a limit point is half of the vertex and
    a twelfth of each neighbour, four of which lie a column away."""
    side = 8
    at = places(side)
    cage = Cage.of(triangle_grid(side), len(at), "loop").refined(STEPS)
    here, found = cage.weights @ at, cage.weights @ (at[:, 0] ** 2 - 1.0 / 3.0)
    inside = ((here > 2.0) & (here < side - 2.0)).all(axis=1)
    h = 2.0**-STEPS
    assert inside.sum() > 1000
    assert found[inside] == pytest.approx(here[inside, 0] ** 2 - h**2 / 3.0, abs=1e-9)


def test_a_cube_goes_where_halstead_says() -> None:
    cage = Cage.of(FACES, 8)
    distances = [np.abs(cage.refined(n).weights[:8] @ CORNERS - VERTEX_LIMIT * CORNERS).max() for n in range(2, 6)]
    assert distances[-1] < 1e-3
    # A vertex, its neighbours and the corners across its faces, as far along the axis: the step's matrix of them has the
    # eigenvalues 1, 1/6 and 0.
    assert [b / a for a, b in itertools.pairwise(distances)] == pytest.approx([1 / 6] * 3, rel=1e-6)


def test_bilinear_is_its_polygons() -> None:
    cage = Cage.of(FACES, 8, "bilinear").refined(3)
    points = cage.weights @ CORNERS
    assert np.abs(points).max(axis=1) == pytest.approx(1.0, abs=1e-12)
    assert (cage.weights[:8] == np.eye(8)).all()


def test_boundaries_are_cubic_b_splines_and_corners_by_their_rule() -> None:
    at = places(1)
    kept = Cage.of(grid(1), 4).refined(STEPS)
    assert (kept.weights[:4] @ at == at).all()
    # Corners of a closed cubic B-spline go to (1, 4, 1) / 6: a third of the way to the middle.
    smooth = Cage.of(grid(1), 4, boundary="edgeOnly").refined(6)
    assert smooth.weights[:4] @ at == pytest.approx(0.5 + (at - 0.5) * 2.0 / 3.0, abs=1e-3)
    cornered = Cage.of(grid(1), 4, boundary="edgeOnly", corners={0: INFINITE}).refined(STEPS)
    assert (cornered.weights[0] @ at == at[0]).all()


def test_without_boundary_interpolation_faces_at_the_rim_are_hidden_and_count() -> None:
    cage = Cage.of(grid(4), 25, boundary="none").refined(2)
    counts, indices = cage.drawn()
    assert len(counts) == 4 * 16
    points = (cage.weights @ places(4))[indices]
    # The corners of the inner faces are smooth vertices: the limit ends where the B-spline does.
    assert points.min() > 0.99 and points.max() < 3.01


def test_holes_are_hidden_and_count() -> None:
    whole, holed = Cage.of(grid(3), 16).refined(3), Cage.of(grid(3), 16, holes=[4]).refined(3)
    assert (whole.weights == holed.weights).all()
    assert len(whole.drawn()[0]) == 9 * 64 and len(holed.drawn()[0]) == 8 * 64


@pytest.mark.parametrize(("sharpness", "stays_for"), [(1.0, 1), (2.0, 2), (INFINITE, 9)])
def test_creases_run_down(sharpness: float, stays_for: int) -> None:
    """A cube with all edges creased is a cube for as many steps, and smooth from then on."""
    creases = dict.fromkeys(edges_of(FACES), sharpness)
    for steps in range(1, 5):
        points = Cage.of(FACES, 8, creases=creases).refined(steps).weights @ CORNERS
        sharp = np.abs(points).max(axis=1) == pytest.approx(1.0, abs=1e-12)
        assert sharp == (steps <= stays_for)


def test_half_a_sharpness_is_half_way() -> None:
    points = [
        Cage.of(FACES, 8, creases=dict.fromkeys(edges_of(FACES), s)).refined(1).weights @ CORNERS
        for s in (0.0, 0.5, 1.0)
    ]
    assert points[1] == pytest.approx((points[0] + points[2]) / 2.0)
