"""Subdivision surfaces whose cages move: what moves is the limit surface of the moved cage."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from authoring import FRAME, Scene, Vector, place, rule, samples, slide, spatial, turn
from pxr import Gf, UsdGeom, UsdSkel
from rules_shapes import seen
from rules_skinning import animate, arm

TOPIC = "subdivision"
FULL = (-0.5, 0.5)
POLYGONS = "the cage's polygons"
CORNERS = [(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
CUBE = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
CUBE_EDGES = [(a, b) for a in range(8) for b in range(a + 1, 8) if (a ^ b) in (1, 2, 4)]
RIM = [(2, 0, 0), (0, 0, 2), (-2, 0, 0), (0, 0, -2)]
ACROSS = {9.0: (-6, 0), 11.0: (6, 0)}


def cage(scene: Scene, path: str, points: Sequence[Vector], faces: Sequence[Sequence[int]]) -> UsdGeom.Mesh:
    """With USD's default scheme, catmullClark, authored."""
    mesh = UsdGeom.Mesh.Define(scene.stage, path)
    mesh.CreateSubdivisionSchemeAttr(UsdGeom.Tokens.catmullClark)
    mesh.CreateFaceVertexCountsAttr([len(face) for face in faces])
    mesh.CreateFaceVertexIndicesAttr([vertex for face in faces for vertex in face])
    mesh.CreatePointsAttr(spatial(points))
    return mesh


def cube(scene: Scene, path: str = "/Cube", size: Vector = (2, 2, 2)) -> UsdGeom.Mesh:
    """Around the origin."""
    return cage(scene, path, [tuple(c * s for c, s in zip(p, size, strict=True)) for p in CORNERS], CUBE)


def sheet(scene: Scene, side: int, unit: float, path: str = "/Sheet") -> UsdGeom.Mesh:
    """Squares around the origin."""
    points = [((x - side / 2) * unit, (y - side / 2) * unit) for y in range(side + 1) for x in range(side + 1)]
    first = [y * (side + 1) + x for y in range(side) for x in range(side)]
    return cage(scene, path, points, [(a, a + 1, a + side + 2, a + side + 1) for a in first])


def polygons(mesh: UsdGeom.Mesh, scene: Scene) -> None:
    """The mistake of drawing the cage."""
    if scene.mistaken:
        mesh.CreateSubdivisionSchemeAttr(UsdGeom.Tokens.none)


def pose(mesh: UsdGeom.Mesh, at: Callable[[float, np.ndarray], np.ndarray], times: Sequence[float]) -> None:
    """Time-sampled points: `at(time, points)` of the mesh's own, float64[N, 3]."""
    attribute = mesh.GetPointsAttr()
    own = np.array(attribute.Get(), float)
    attribute.Clear()
    samples(attribute, {time: spatial(map(tuple, at(time, own))) for time in times})


def about_y(degrees: float, points: np.ndarray) -> np.ndarray:
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return points @ np.array([(c, 0, -s), (0, 1, 0), (s, 0, c)])


@rule(TOPIC, "A cage with time samples moves its limit surface", POLYGONS)
def subdivision_points(scene: Scene) -> None:
    mesh = cube(scene)
    pose(mesh, lambda time, p: about_y(70 * (time - 10), p) + (4 * (time - 10), 0, 0), (9.0, 9.8, 10.2, 11.0))
    polygons(mesh, scene)


@rule(TOPIC, "A mesh without a subdivisionScheme is catmullClark", POLYGONS)
def subdivision_by_default(scene: Scene) -> None:
    mesh = cube(scene)
    mesh.GetPrim().RemoveProperty("subdivisionScheme")
    slide(mesh, {9.0: (-2, 0), 11.0: (2, 0)})
    polygons(mesh, scene)


@rule(TOPIC, "Loop's scheme smooths a cage of triangles", POLYGONS)
def subdivision_loop(scene: Scene) -> None:
    points = [(0, 2.4, 0), *RIM, (0, -2.4, 0)]
    around = [(1, 2), (2, 3), (3, 4), (4, 1)]
    mesh = cage(scene, "/Mesh", points, [(0, a, b) for a, b in around] + [(5, b, a) for a, b in around])
    mesh.CreateSubdivisionSchemeAttr(UsdGeom.Tokens.loop)
    slide(mesh, {9.0: (-2, 0), 11.0: (2, 0)})
    turn(mesh, {9.0: -20.0, 11.0: 40.0})
    polygons(mesh, scene)


@rule(TOPIC, "The bilinear scheme keeps the cage's shape", "it is smoothed")
def subdivision_bilinear(scene: Scene) -> None:
    mesh = cube(scene)
    if not scene.mistaken:
        mesh.CreateSubdivisionSchemeAttr(UsdGeom.Tokens.bilinear)
    pose(mesh, lambda time, p: about_y(60 * (time - 10), p), (9.0, 9.6, 10.4, 11.0))


@rule(TOPIC, "Faces of any number of corners are smoothed", POLYGONS)
def subdivision_polygons(scene: Scene) -> None:
    angles = np.radians(90 + 72 * np.arange(5))
    rim = [(2.4 * np.cos(a), 2.4 * np.sin(a)) for a in angles]
    points = [(x, y, z) for z in (1.0, -1.0) for x, y in rim]
    walls = [(i, 5 + i, 5 + (i + 1) % 5, (i + 1) % 5) for i in range(5)]
    mesh = cage(scene, "/Mesh", points, [(0, 1, 2, 3, 4), (9, 8, 7, 6, 5), *walls])
    slide(mesh, {9.0: (-1, 2), 11.0: (2, -2)})
    polygons(mesh, scene)


@rule(TOPIC, "A cage's own points and its transform move together", "the transform alone")
def subdivision_points_and_transform(scene: Scene) -> None:
    mesh = cube(scene, size=(1.5, 2.5, 1.5))
    slide(mesh, {9.0: (-1, 1), 11.0: (1, -1)})
    turn(mesh, {9.0: -40.0, 11.0: 60.0})
    if not scene.mistaken:
        pose(mesh, lambda time, p: p * (1.0, 1.0 - 0.8 * (time - 10), 1.0) + (5 * (time - 10), 0, 0), (9.0, 10.1, 11.0))


@rule(TOPIC, "A cage that is turned runs along an arc", "its surface runs along the chord", shutter=FULL)
def subdivision_turns(scene: Scene) -> None:
    mesh = cage(scene, "/Mesh", [(0.5, -0.7), (5.5, -0.7), (5.5, 0.7), (0.5, 0.7)], [(0, 1, 2, 3)])
    mesh.CreateInterpolateBoundaryAttr("edgeOnly")
    ends = {9.5: -80.0, 10.5: 80.0}
    if not scene.mistaken:
        turn(mesh, ends)
        return

    def turned(time: float, points: np.ndarray) -> np.ndarray:
        c, s = np.cos(np.radians(ends[time])), np.sin(np.radians(ends[time]))
        return points @ np.array([(c, s, 0), (-s, c, 0), (0, 0, 1)])

    pose(mesh, turned, tuple(ends))


def flying(
    scene: Scene, mesh: UsdGeom.Mesh, velocities: Sequence[Vector], accelerations: Sequence[Vector] = ()
) -> None:
    """One sample of points and rates, a vector a point or one for all. Units a frame and a frame squared."""
    own, rate = mesh.GetPointsAttr().Get(), scene.stage.GetTimeCodesPerSecond()

    def each(vectors: Sequence[Vector], factor: float) -> list[Gf.Vec3f]:
        return [vector * factor for vector in spatial(vectors)] * (len(own) // len(vectors))

    mesh.GetPointsAttr().Clear()
    mesh.GetPointsAttr().Set(own, FRAME)
    mesh.CreateVelocitiesAttr().Set(each(velocities, rate), FRAME)
    if accelerations:
        mesh.CreateAccelerationsAttr().Set(each(accelerations, rate**2), FRAME)


@rule(TOPIC, "Velocities of a cage carry its limit surface")
def subdivision_velocities(scene: Scene) -> None:
    """Two ends with velocities of their own: the cage is drawn out."""
    flying(scene, cube(scene), [(-3, 2, 0) if x < 0 else (5, 0, 0) for x, _, _ in CORNERS])


@rule(TOPIC, "Accelerations of a cage bend the way of its limit surface", "velocities alone", shutter=FULL)
def subdivision_accelerations(scene: Scene) -> None:
    mesh = cube(scene, size=(1, 1, 1))
    flying(scene, mesh, [(8, 0)], [] if scene.mistaken else [(0, 32)])
    place(mesh, 0, -2)


@rule(TOPIC, "A skinned cage is smoothed where its joints have put it", "the bind pose", shutter=FULL)
def subdivision_skinned(scene: Scene) -> None:
    mesh = arm(scene, columns=5, half_width=0.7)
    mesh.CreateSubdivisionSchemeAttr(UsdGeom.Tokens.catmullClark)
    mesh.CreateInterpolateBoundaryAttr("edgeOnly")
    if scene.mistaken:
        mesh.GetPrim().RemoveAPI(UsdSkel.BindingAPI)
    animate(scene, {9.5: (0.0, 0.0), 10.5: (30.0, 140.0)})


def creased(mesh: UsdGeom.Mesh, edges: Sequence[tuple[int, int]], sharpness: float) -> None:
    mesh.CreateCreaseLengthsAttr([2] * len(edges))
    mesh.CreateCreaseIndicesAttr([vertex for edge in edges for vertex in edge])
    mesh.CreateCreaseSharpnessesAttr([sharpness] * len(edges))


@rule(TOPIC, "Creases stay sharp while their cage moves", "they are left out")
def subdivision_creases(scene: Scene) -> None:
    mesh = cube(scene, size=(2.4, 2.2, 1))
    if not scene.mistaken:
        creased(mesh, CUBE_EDGES, 10.0)
    pose(mesh, lambda time, p: about_y(30 * (time - 10), p) + (0, 1.2 * (time - 10), 0), (9.0, 9.8, 10.3, 11.0))


@rule(TOPIC, "A crease of sharpness 2 is sharp for two steps", "it is left out")
def subdivision_semi_sharp_creases(scene: Scene) -> None:
    mesh = cube(scene, size=(2.4, 2.4, 1))
    if not scene.mistaken:
        creased(mesh, CUBE_EDGES, 2.0)
    slide(mesh, {9.0: (-1, 0), 11.0: (1, 0)})


@rule(TOPIC, "A crease has one sharpness or one an edge", "its first one counts for all")
def subdivision_sharpness_of_edges(scene: Scene) -> None:
    """Around the front and the back, of which the edges at the sides are sharp, and between the two."""
    mesh = cube(scene, size=(2.4, 2.4, 1))
    between = [vertex for edge in CUBE_EDGES if edge[0] ^ edge[1] == 1 for vertex in edge]
    mesh.CreateCreaseLengthsAttr([5, 5, 2, 2, 2, 2])
    mesh.CreateCreaseIndicesAttr([1, 5, 7, 3, 1, 0, 4, 6, 2, 0, *between])
    by_edge = [0.0, 10.0, 0.0, 10.0] * 2 + [10.0] * 4
    mesh.CreateCreaseSharpnessesAttr([0.0, 0.0] + [10.0] * 4 if scene.mistaken else by_edge)
    slide(mesh, {9.0: (-1, 0), 11.0: (1, 0)})


@rule(TOPIC, "Corners stay where the cage has them", "they are left out")
def subdivision_corners(scene: Scene) -> None:
    mesh = sheet(scene, 1, 4.4)
    mesh.CreateInterpolateBoundaryAttr("edgeOnly")
    if not scene.mistaken:
        mesh.CreateCornerIndicesAttr([0, 3])
        mesh.CreateCornerSharpnessesAttr([10.0, 10.0])
    turn(mesh, {9.0: -10.0, 11.0: 30.0})


@rule(TOPIC, "A hole of a cage is open, and shapes its neighbours as if it were not", "it is filled")
def subdivision_holes(scene: Scene) -> None:
    mesh = sheet(scene, 3, 1.8)
    if not scene.mistaken:
        mesh.CreateHoleIndicesAttr([4, 2])
    slide(mesh, {9.0: (-1, 0), 11.0: (1, 0)})
    turn(mesh, {9.0: -20.0, 11.0: 10.0})


@rule(TOPIC, "A hole of a cage has no boundary", "its rim is smoothed as a boundary is")
def subdivision_hole_without_boundary(scene: Scene) -> None:
    """A triangle inside of a triangle: the inner one is a hole, whose rim a boundary would round to half its size."""
    at = [(5 * np.cos(a), 5 * np.sin(a)) for a in np.radians((90, 210, 330))]
    points = [*at, *((0.45 * x, 0.45 * y) for x, y in at)]
    rim = [(i, (i + 1) % 3, 3 + (i + 1) % 3, 3 + i) for i in range(3)]
    hole = [] if scene.mistaken else [(3, 4, 5)]
    mesh = cage(scene, "/Mesh", points, [*rim, *hole])
    if hole:
        mesh.CreateHoleIndicesAttr([3])
    turn(mesh, {9.0: -12.0, 11.0: 12.0})


@rule(TOPIC, "interpolateBoundary edgeOnly rounds the corners of a boundary", "they stay")
def subdivision_edge_only(scene: Scene) -> None:
    mesh = sheet(scene, 1, 4.4)
    mesh.CreateInterpolateBoundaryAttr("edgeAndCorner" if scene.mistaken else "edgeOnly")
    slide(mesh, {9.0: (-2, 0), 11.0: (2, 0)})


@rule(TOPIC, "interpolateBoundary none leaves faces at a boundary without a surface", "they are drawn")
def subdivision_boundary_none(scene: Scene) -> None:
    mesh = sheet(scene, 4, 1.3)
    if not scene.mistaken:
        mesh.CreateInterpolateBoundaryAttr("none")
    slide(mesh, {9.0: (-4, 0), 11.0: (4, 0)})


def two_topologies(mesh: UsdGeom.Mesh, times: tuple[float, float]) -> None:
    """A cube, and from the second time on a flat square elsewhere."""
    attributes = (mesh.GetPointsAttr(), mesh.GetFaceVertexCountsAttr(), mesh.GetFaceVertexIndicesAttr())
    first = [attribute.Get() for attribute in attributes]
    square = (spatial([(3, -1), (5, -1), (5, 1), (3, 1)]), [4], [0, 1, 2, 3])
    for attribute, one, two in zip(attributes, first, square, strict=True):
        attribute.Clear()
        samples(attribute, dict(zip(times, (one, two), strict=True)))


@rule(TOPIC, "Where a cage's topology changes its frame's surface is held", "both surfaces are seen")
def subdivision_varying(scene: Scene) -> None:
    mesh = cube(scene, size=(1.6, 1.6, 1.6))
    place(mesh, -2.5, 0)
    if not scene.mistaken:
        two_topologies(mesh, (9.9, 10.2))
        return
    other = cage(scene, "/Other", [(0.5, -1), (2.5, -1), (2.5, 1), (0.5, 1)], [(0, 1, 2, 3)])
    seen(mesh, {9.0: True, 10.2: False})
    seen(other, {9.0: False, 10.2: True})


@rule(TOPIC, "Velocities carry the frame's surface where a cage's topology changes", "the frame's pose alone")
def subdivision_varying_with_velocities(scene: Scene) -> None:
    mesh = cube(scene, size=(1.2, 1.2, 1.2))
    place(mesh, -1, 0)
    if scene.mistaken:
        return
    two_topologies(mesh, (FRAME, 10.2))
    velocity = Gf.Vec3f(24 * 6, 24 * 2, 0)
    samples(mesh.CreateVelocitiesAttr(), {FRAME: [velocity] * 8, 10.2: [velocity] * 4})


@rule(TOPIC, "A PointInstancer's prototype may be a cage that moves itself", POLYGONS)
def subdivision_instanced(scene: Scene) -> None:
    instancer = UsdGeom.PointInstancer.Define(scene.stage, "/Instancer")
    mesh = cube(scene, "/Instancer/Cube", (1.3, 1.3, 1.3))
    pose(mesh, lambda time, p: about_y(80 * (time - 10), p), (9.0, 9.7, 10.2, 11.0))
    polygons(mesh, scene)
    instancer.CreatePrototypesRel().SetTargets(["/Instancer/Cube"])
    instancer.CreateProtoIndicesAttr([0, 0])
    instancer.CreatePositionsAttr().Set(spatial([(-2.5, 1), (2.5, -1)]), FRAME)
    instancer.CreateVelocitiesAttr().Set(spatial([(24 * 2, 0), (0, 24 * 3)]), FRAME)


@rule(TOPIC, "motion:blurScale counts for a cage", "full blur")
def subdivision_blur_scale(scene: Scene) -> None:
    mesh = cube(scene, size=(1.2, 1.2, 1.2))
    slide(mesh, {9.0: (-10, 0), 11.0: (10, 0)})
    if not scene.mistaken:
        UsdGeom.MotionAPI.Apply(mesh.GetPrim()).CreateMotionBlurScaleAttr(0.25)


@rule(TOPIC, "A cage among many frames is the frame's", "the first frame's surface stays", frames=(8.0, 9.0, FRAME))
def subdivision_after_other_frames(scene: Scene) -> None:
    """Refined topology may be kept over frames; shapes and rates are the frame's."""
    mesh = cube(scene)
    if scene.mistaken:
        pose(mesh, lambda _, p: 0.4 * p, (8.0,))
    else:
        pose(mesh, lambda time, p: (0.4 + 0.3 * (time - 8.0)) * p + (2 * (time - 10), 0, 0), (7.0, 9.0, 9.9, 11.0))
