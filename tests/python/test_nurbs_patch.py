"""NURBS patches from a stage to polygons of their surface: where it is, how fine, closed, coloured, and moved."""

from __future__ import annotations

from collections import Counter
from itertools import pairwise

import numpy as np
import pytest
from drawn import apart
from msbvh import _core
from msbvh.scene.reader import ReadSettings, read_frame
from nurbs_truth import Patch, bumpy, clamped, cylinder, periodic, sphere, torus, vectors
from pxr import Gf, Sdf, UsdGeom
from recording import DENSE_TIMES01, Shot, messages, points_at
from skinning_oracle import bind, spinning_arm, usd_skinned_points


def drawn(shot: Shot, **settings: object) -> np.ndarray:
    """Its points before they are placed before the camera, which rounds them."""
    return polygons(shot, **{"edge_length": 0.0, **settings})["points"][0][1].astype(float)


def polygons(shot: Shot, **settings: object) -> dict:
    return shot.read(**settings).scene.meshes["/Patch"]


def faces_of(mesh: dict) -> list[np.ndarray]:
    ends = np.cumsum(mesh["face_vertex_counts"])
    return [mesh["face_vertex_indices"][a:b] for a, b in pairwise([0, *ends.tolist()])]


@pytest.mark.parametrize("rational", [False, True])
@pytest.mark.parametrize("orders", [(2, 2), (3, 2), (4, 3), (5, 4), (6, 5)])
def test_points_lie_where_the_definition_has_them(orders: tuple[int, int], rational: bool) -> None:
    patch, shot = bumpy(columns=8, rows=6, orders=orders, rational=rational), Shot((0.0, 0.0))
    patch.define(shot)
    assert apart(drawn(shot), patch.surface()) < 1e-6
    assert messages(shot.read(), "warning") == []


def test_uneven_and_repeated_knots() -> None:
    patch, shot = bumpy(columns=8, rows=5, orders=(4, 3)), Shot((0.0, 0.0))
    patch.u_knots = [-1.0, 0, 0.5, 2, 2.1, 2.1, 2.1, 5, 6, 6, 8, 8.5]
    patch.define(shot)
    assert apart(drawn(shot), patch.surface()) < 1e-6


def test_a_range_is_a_part_of_the_surface() -> None:
    patch, shot = bumpy(), Shot((0.0, 0.0))
    patch.ranges = {"u": (0.5, 2.25), "v": (1.0, 2.5)}
    patch.define(shot)
    assert apart(drawn(shot), patch.surface()) < 1e-6


@pytest.mark.parametrize("orientation", ["rightHanded", "leftHanded"])
def test_faces_turn_outward_as_the_orientation_says(orientation: str) -> None:
    shot = Shot((0.0, 0.0))
    sphere().define(shot).CreateOrientationAttr(orientation)
    mesh = polygons(shot)
    points = mesh["points"][0][1].astype(float)
    volume = (
        sum(np.linalg.det(points[[f[0], f[i], f[i + 1]]]) for f in faces_of(mesh) for i in range(1, len(f) - 1)) / 6
    )
    assert volume == pytest.approx(4 / 3 * np.pi, rel=0.01)
    assert bool(mesh["left_handed"]) is (orientation == "leftHanded")


def test_rational_surfaces_are_round() -> None:
    for patch, distance in (
        (sphere(), lambda p: np.linalg.norm(p, axis=1)),
        (cylinder(), lambda p: np.hypot(p[:, 0], p[:, 2])),
        (torus(0.5), lambda p: 2 * np.hypot(np.hypot(p[:, 0], p[:, 2]) - 1, p[:, 1])),
    ):
        shot = Shot((0.0, 0.0))
        patch.define(shot)
        assert np.abs(distance(drawn(shot, edge_length=1.0, width=200)) - 1).max() < 1e-6


def test_a_sphere_covers_its_disc() -> None:
    shot = Shot((0.0, 0.0))
    sphere(2.0).define(shot)
    result = read_frame(shot.stage, 10.0, ReadSettings(width=96))
    size = {"width": result.camera.width, "height": result.camera.height}
    alpha = _core.Renderer(result.scene, spp=256, max_bounces=0, **size).render()[..., 3]
    # The outline is where the view's tangents touch the sphere.
    radius = 96 * 50.0 / 20.955 * 2.0 / np.sqrt(20.0**2 - 2.0**2)
    assert alpha.sum() == pytest.approx(np.pi * radius**2, rel=2e-3)


@pytest.mark.parametrize("patch", [torus(), sphere(), periodic()], ids=["torus", "sphere", "periodic"])
@pytest.mark.parametrize("coloured", [False, True])
def test_what_closes_has_no_gap(patch: Patch, coloured: bool) -> None:
    shot = Shot((0.0, 0.0))
    prim = patch.define(shot)
    if coloured:
        count = patch.points.shape[0] * patch.points.shape[1]
        prim.CreateDisplayColorPrimvar("vertex").Set([Gf.Vec3f(i / count, 0, 0) for i in range(count)])
    mesh = polygons(shot)
    corners = [[point.tobytes() for point in mesh["points"][0][1][face]] for face in faces_of(mesh)]
    edges = Counter(edge for face in corners for edge in pairwise([*face, face[0]]) if edge[0] != edge[1])
    open_edges = [edge for edge in edges if (edge[1], edge[0]) not in edges]
    assert max(edges.values()) == 1
    if patch.v_knots[0] == patch.v_knots[3] and patch.points.shape[0] == 4:  # the tube's two ends
        heights = {np.frombuffer(a, np.float32)[1].item() for a, _ in open_edges}
        assert heights == {-1.0, 1.0}
    else:
        assert open_edges == []


def test_a_kink_stays_sharp_and_a_seam_smooth() -> None:
    """Where normals differ there are two points in one place; nowhere else."""
    folded = bumpy(columns=5, rows=4, orders=(2, 4))  # a polyline along u
    for patch, shared in ((folded, False), (cylinder(), True), (periodic(), True)):
        shot = Shot((0.0, 0.0))
        patch.define(shot)
        points = polygons(shot, edge_length=0.0)["points"][0][1]
        assert (len(np.unique(points, axis=0)) == len(points)) is shared


def test_edges_are_about_as_long_as_asked_for() -> None:
    longest = []
    for edge in (1.0, 4.0):
        shot = Shot((0.0, 0.0))
        bumpy().define(shot)
        mesh = polygons(shot, width=200, edge_length=edge)
        points = mesh["points"][0][1].astype(float)
        pixels_per_unit = 200 * 50.0 / 20.955 / (20.0 - points[:, 2].max())
        sides = [np.linalg.norm(points[f] - points[np.roll(f, 1)], axis=1) for f in faces_of(mesh)]
        longest.append(np.max(sides) * pixels_per_unit / edge)
        assert np.median(sides) * pixels_per_unit > 0.5 * edge
    assert max(longest) < 1.5


def test_farther_is_coarser_and_complexity_says_how_fine() -> None:
    def triangles(distance: float, **settings: object) -> int:
        shot = Shot((0.0, 0.0))
        bumpy().define(shot).AddTranslateOp().Set(Gf.Vec3d(0, 0, -distance))
        return read_frame(shot.stage, 10.0, ReadSettings(**settings)).scene.statistics()["triangles"]

    near = triangles(0)
    assert triangles(60) == pytest.approx(near / 16, rel=0.1)
    assert triangles(0, complexity="medium") == pytest.approx(near / 16, rel=0.1)
    assert triangles(0, complexity="low") == 2 * (3 * 3) * (3 * 2)  # spans, each cut by its degree


def test_too_many_cells_are_fewer_with_a_warning() -> None:
    shot = Shot((0.0, 0.0))
    bumpy().define(shot)
    result = shot.read(edge_length=0.01)
    (warning,) = messages(result, "warning")
    assert warning.startswith("/Patch.uKnots: edges of 0.01 pixels take more than 4194304 cells; drawn with edges ")
    assert len(result.scene.meshes["/Patch"]["face_vertex_counts"]) <= 2**22


@pytest.mark.parametrize("rational", [False, True])
def test_samples_move_it_as_its_control_points_move(rational: bool) -> None:
    shot, patch = Shot((-1.0, 1.0)), bumpy(rational=rational)
    prim = patch.define(shot)
    others = [bumpy(seed).points for seed in (2, 3, 4)]
    for time, points in zip((9.0, 9.7, 11.0), others, strict=True):
        prim.GetPointsAttr().Set(vectors(points), time)
    result = shot.read(edge_length=0.0, motion_tolerance=0.001)
    assert messages(result, "warning") == []
    for time01 in DENSE_TIMES01[::4]:
        time = 9.0 + 2.0 * time01
        mixed = np.array([[np.interp(time, (9.0, 9.7, 11.0), p) for p in np.stack([o.ravel() for o in others], 1)]])
        patch.points = mixed.reshape(others[0].shape)
        assert apart(result.scene.points("/Patch", time01), patch.surface()) < 2e-4


@pytest.mark.parametrize("accelerated", [False, True])
@pytest.mark.parametrize("rational", [False, True])
def test_velocities_and_accelerations_carry_it(accelerated: bool, rational: bool) -> None:
    shot, patch = Shot((-0.5, 0.5)), bumpy(rational=rational)
    prim = patch.define(shot)
    velocities, accelerations = 30 * bumpy(5).points, 900 * bumpy(6).points
    prim.GetPointsAttr().Clear()
    prim.GetPointsAttr().Set(vectors(patch.points), 10.0)
    prim.CreateVelocitiesAttr().Set(vectors(velocities), 10.0)
    if accelerated:
        prim.CreateAccelerationsAttr().Set(vectors(accelerations), 10.0)
    result = shot.read(edge_length=0.0, motion_tolerance=0.001)
    for time01 in DENSE_TIMES01[::4]:
        time = 9.5 + time01
        points = UsdGeom.PointBased(prim).ComputePointsAtTime(time, 10.0)
        moved = Patch(np.array(points, float).reshape(patch.points.shape), patch.u_knots, patch.v_knots, patch.weights)
        assert apart(result.scene.points("/Patch", time01), moved.surface()) < 2e-4


def test_weights_that_move_are_followed() -> None:
    shot, patch = Shot((-1.0, 1.0)), bumpy(rational=True)
    prim = patch.define(shot)
    other = bumpy(7, rational=True)
    for time, each in ((9.0, patch), (11.0, other)):
        prim.GetPointWeightsAttr().Set(each.weights.ravel().tolist(), time)
    result = shot.read(edge_length=0.0, motion_tolerance=0.01)
    assert messages(result, "warning") == []
    first, last = patch.weights, other.weights
    for time01 in DENSE_TIMES01[::4]:
        patch.weights = first * (1 - time01) + last * time01
        assert apart(result.scene.points("/Patch", time01), patch.surface()) < 2e-3


def test_instances_and_transforms_move_it() -> None:
    shot, patch = Shot((-0.5, 0.5)), bumpy()
    shot.stage.DefinePrim("/Proto", "Xform").SetSpecifier(Sdf.SpecifierOver)
    patch.define(shot, "/Proto/Patch")
    instancer = UsdGeom.PointInstancer.Define(shot.stage, "/Many")
    instancer.CreatePrototypesRel().AddTarget("/Proto")
    instancer.CreateProtoIndicesAttr([0, 0])
    instancer.CreatePositionsAttr([Gf.Vec3f(-3, 0, 0), Gf.Vec3f(3, 0, 0)])
    move = UsdGeom.Xformable(instancer).AddTranslateOp()
    move.Set(Gf.Vec3d(0, -1, 0), 9.0)
    move.Set(Gf.Vec3d(0, 1, 0), 11.0)
    scene = shot.read(edge_length=0.0).scene
    for time01 in (0.0, 0.37, 1.0):
        expected = np.concatenate([patch.surface() + (x, time01 - 0.5, 0) for x in (-3, 3)])
        assert apart(scene.instance_points(time01), expected) < 1e-5


@pytest.mark.parametrize("rational", [False, True])
def test_a_skeleton_moves_its_control_points(rational: bool) -> None:
    arm, patch = spinning_arm(), bumpy(rational=rational)
    prim = patch.define(arm.shot, "/Root/Patch")
    bind(arm, prim.GetPrim(), np.clip((patch.points[..., 0].ravel() + 2) / 4, 0, 1))
    result = arm.shot.read(edge_length=0.0)
    assert messages(result, "warning") == []
    for time01 in DENSE_TIMES01[::4]:
        code = result.camera.shutter.time_code(time01)
        points = usd_skinned_points(prim.GetPrim(), code).reshape(patch.points.shape)
        expected = Patch(points, patch.u_knots, patch.v_knots, patch.weights).surface()
        assert apart(points_at(result.scene.meshes["/Root/Patch"], time01), expected) < 5e-3


def test_primvars_of_every_interpolation() -> None:
    """On a square whose parameters are its x and y."""
    flat = Patch(np.array([[(x, y, 0) for x in (0, 1, 2, 3)] for y in (0, 1, 2)], float), clamped(4, 2), clamped(3, 2))
    random = np.random.default_rng(3)
    for interpolation, shape in (("constant", (1,)), ("uniform", (2, 3)), ("varying", (3, 4)), ("vertex", (3, 4))):
        values = random.uniform(0, 1, (*shape, 3)).astype(np.float32)
        for indexed in (False, True):
            shot = Shot((0.0, 0.0))
            primvar = flat.define(shot).CreateDisplayColorPrimvar(interpolation)
            flipped = np.arange(len(values.reshape(-1, 3)))[::-1]
            primvar.Set(vectors(values.reshape(-1, 3)[flipped] if indexed else values))
            if indexed:
                primvar.SetIndices(flipped.tolist())
            result = shot.read(width=100)
            assert messages(result, "warning") == []
            mesh = result.scene.meshes["/Patch"]
            found, colours, indices = mesh["display_color"]
            points = mesh["points"][0][1].astype(float)
            if found == "uniform":
                centres = np.array([points[face].mean(axis=0) for face in faces_of(mesh)])
                expected = values[centres[:, 1].astype(int), centres[:, 0].astype(int)]
                assert np.abs(colours[indices] - expected).max() == 0
            elif found == "vertex":
                expected = np.array([flat.at(x + 0.0, y + 0.0, values) for x, y, _ in points])
                assert np.abs(colours - expected).max() < 1e-5
            else:
                assert interpolation == "constant" and np.abs(colours[0] - values.reshape(-1, 3)[0]).max() == 0


def test_vertex_colours_follow_the_basis_and_move() -> None:
    patch, shot = bumpy(orders=(4, 3), rational=True), Shot((-0.5, 0.5))
    colours = [np.random.default_rng(seed).uniform(0, 1, patch.points.shape) for seed in (1, 2)]
    primvar = patch.define(shot).CreateDisplayColorPrimvar("vertex")
    for time, values in zip((9.5, 10.5), colours, strict=True):
        primvar.GetAttr().Set(vectors(values), time)
    mesh = polygons(shot, edge_length=0.0)
    points, (_, samples, _) = mesh["points"][0][1], mesh["display_color"]
    for (_, found), values in zip(samples, colours, strict=True):
        both = np.array(
            [[*patch.at(u, v), *patch.at(u, v, values)] for v in patch.parameters("v") for u in patch.parameters("u")]
        )
        nearest = np.linalg.norm(points[:, None] - both[None, :, :3], axis=-1).argmin(axis=1)
        assert np.abs(found - both[nearest, 3:]).max() < 1e-6


def test_trim_curves_and_forms() -> None:
    shot, patch = Shot((0.0, 0.0)), bumpy()
    prim = patch.define(shot)
    prim.CreateUFormAttr("closed")
    prim.CreateTrimCurveCountsAttr([1])
    assert messages(shot.read(), "warning") == [
        "/Patch.trimCurve:counts: trim curves are not supported yet; drawn untrimmed"
    ]
    assert apart(drawn(shot), patch.surface()) < 1e-6
