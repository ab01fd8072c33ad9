"""Curves and points: widths in motion, velocities, bases, numbers that change."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np
from authoring import FRAME, Scene, Vector, place, rule, samples, slide, spatial, turn
from pxr import Gf, UsdGeom

CURVES, POINTS = "curves", "points"
FULL = (-0.5, 0.5)
BOW = [(-4, -1.8), (-2, 2.4), (2, -2.4), (4, 1.8)]


def curves(
    scene: Scene, points: Sequence[Vector], counts: Sequence[int] = (), basis: str = "", path: str = "/Curves"
) -> UsdGeom.BasisCurves:
    """A unit wide; linear without a basis."""
    prim = UsdGeom.BasisCurves.Define(scene.stage, path)
    prim.CreateTypeAttr(UsdGeom.Tokens.cubic if basis else UsdGeom.Tokens.linear)
    if basis:
        prim.CreateBasisAttr(basis)
    prim.CreateCurveVertexCountsAttr(list(counts) or [len(points)])
    prim.CreatePointsAttr(spatial(points))
    width(prim, [1.0])
    return prim


def width(prim: UsdGeom.BasisCurves, values: Sequence[float], interpolation: str = "constant") -> None:
    prim.CreateWidthsAttr(list(values))
    prim.SetWidthsInterpolation(interpolation)


def cloud(scene: Scene, points: Sequence[Vector], widths: Sequence[float] = ()) -> UsdGeom.Points:
    """One and a half units across."""
    prim = UsdGeom.Points.Define(scene.stage, "/Points")
    prim.CreatePointsAttr(spatial(points))
    prim.CreateWidthsAttr(list(widths) or [1.5] * len(points))
    return prim


def pose(prim: UsdGeom.PointBased, at: Callable[[float, np.ndarray], np.ndarray], times: Sequence[float]) -> None:
    attribute = prim.GetPointsAttr()
    own = np.array(attribute.Get(), float)
    attribute.Clear()
    samples(attribute, {time: spatial(map(tuple, at(time, own))) for time in times})


def flying(prim: UsdGeom.PointBased, velocities: Sequence[Vector], accelerations: Sequence[Vector] = ()) -> None:
    """One sample, a vector a point. Units a frame and a frame squared, at 24 frames a second."""
    own = prim.GetPointsAttr().Get()
    prim.GetPointsAttr().Clear()
    prim.GetPointsAttr().Set(own, FRAME)
    prim.CreateVelocitiesAttr().Set([v * 24.0 for v in spatial(velocities)], FRAME)
    if accelerations:
        prim.CreateAccelerationsAttr().Set([a * 24.0**2 for a in spatial(accelerations)], FRAME)


@rule(CURVES, "Points of curves with time samples are interpolated")
def curves_points(scene: Scene) -> None:
    prim = curves(scene, BOW, basis="bezier")
    pose(prim, lambda time, p: p * (1, 1 - 1.5 * (time - 10), 1) + (2 * (time - 10), 0, 0), (9.0, 9.9, 10.3, 11.0))


@rule(CURVES, "Velocities carry curves, each vertex its own way")
def curves_velocities(scene: Scene) -> None:
    flying(curves(scene, [(-4, -1), (4, -1)]), [(0, 6), (0, -2)])


@rule(CURVES, "Accelerations bend the way of curves", "velocities alone", shutter=FULL)
def curves_accelerations(scene: Scene) -> None:
    prim = curves(scene, [(-2, -2), (2, -2)])
    width(prim, [0.7])
    flying(prim, [(2, 0)] * 2, [] if scene.mistaken else [(0, 30)] * 2)


@rule(CURVES, "Widths with time samples grow over the shutter", "the frame's widths")
def curves_widths(scene: Scene) -> None:
    prim = curves(scene, [(-4, 0), (4, 0)])
    values = {FRAME: [1.3]} if scene.mistaken else {9.0: [0.1], 10.0: [1.3], 11.0: [6.1]}
    samples(prim.GetWidthsAttr(), values)


@rule(CURVES, "Widths of curves that velocities carry have time samples of their own", "the frame's widths")
def curves_widths_and_velocities(scene: Scene) -> None:
    prim = curves(scene, [(0, -2), (0, 2)])
    flying(prim, [(6, 0)] * 2)
    samples(prim.GetWidthsAttr(), {FRAME: [1.6]} if scene.mistaken else {9.5: [0.1], 10.0: [1.6], 10.5: [3.1]})


@rule(CURVES, "Widths may differ along a curve, and move with it", "the first one for all")
def curves_varying_widths(scene: Scene) -> None:
    prim = curves(scene, [(-4, 0), (0, 0), (4, 0)])
    if not scene.mistaken:
        width(prim, [0.2, 3.4, 1.2], "varying")
    else:
        width(prim, [0.2])
    slide(prim, {9.0: (0, -2), 11.0: (0, 2)})


@rule(CURVES, "Linear curves are straight, and end where the next one begins", "one B-spline")
def curves_linear(scene: Scene) -> None:
    prim = curves(
        scene, [(-3.5, -1), (-3.5, 1), (3.5, 1), (3.5, -1)], basis="bspline" if scene.mistaken else "", counts=[4]
    )
    width(prim, [0.3])
    if not scene.mistaken:
        prim.CreateCurveVertexCountsAttr([2, 2])
    slide(prim, {9.0: (0, -1), 11.0: (0, 1)})


def of_basis(scene: Scene, basis: str) -> None:
    """The mistake: the control polygon."""
    own = [(-6, -2), (-2.5, 2.5), (2.5, -2.5), (6, 2)] if basis != "bezier" else BOW
    prim = curves(scene, own, basis="" if scene.mistaken else basis)
    turn(prim, {9.0: -20.0, 11.0: 20.0})


@rule(CURVES, "Cubic curves follow their basis, bezier", "their control polygon")
def curves_bezier(scene: Scene) -> None:
    of_basis(scene, "bezier")


@rule(CURVES, "Cubic curves follow their basis, bspline", "their control polygon")
def curves_bspline(scene: Scene) -> None:
    of_basis(scene, "bspline")


@rule(CURVES, "Cubic curves follow their basis, catmullRom", "their control polygon")
def curves_catmull_rom(scene: Scene) -> None:
    of_basis(scene, "catmullRom")


@rule(CURVES, "Periodic curves are closed", "they end")
def curves_periodic(scene: Scene) -> None:
    prim = curves(scene, [(-3, -2), (3, -2), (3, 2), (-3, 2)], basis="bspline")
    if not scene.mistaken:
        prim.CreateWrapAttr(UsdGeom.Tokens.periodic)
    slide(prim, {9.0: (-1.5, 0), 11.0: (1.5, 0)})


@rule(CURVES, "Pinned curves reach their ends", "they stop a span before")
def curves_pinned(scene: Scene) -> None:
    prim = curves(scene, [(-4.5, 0), (-1.5, 0), (1.5, 0), (4.5, 0)], basis="bspline")
    if not scene.mistaken:
        prim.CreateWrapAttr(UsdGeom.Tokens.pinned)
    slide(prim, {9.0: (0, -2), 11.0: (0, 2)})


@rule(CURVES, "With normals a ribbon lies across them, and turns with its curve", "it is turned to the ray")
def curves_oriented(scene: Scene) -> None:
    prim = curves(scene, [(-4, 0), (4, 0)])
    width(prim, [2.5])
    if not scene.mistaken:
        prim.CreateNormalsAttr(spatial([(0, 0, 1), (0, 0, 1)]))
        prim.SetNormalsInterpolation("vertex")
    samples(UsdGeom.Xformable(prim).AddRotateXOp(), {9.0: 0.0, 11.0: 160.0})


@rule(CURVES, "Where the number of vertices changes the frame's curves are held", "both are seen")
def curves_varying(scene: Scene) -> None:
    one, two = [(-5, 0), (-1, 0)], [(1, 1.5), (5, 1.5), (1, -1.5), (5, -1.5)]
    if scene.mistaken:
        for name, points, here in (("One", one, (9.0, 10.2)), ("Two", two, (10.2, 9.0))):
            prim = curves(scene, points, [2] * (len(points) // 2), path=f"/{name}")
            tokens = {here[0]: UsdGeom.Tokens.inherited, here[1]: UsdGeom.Tokens.invisible}
            samples(prim.CreateVisibilityAttr(), tokens)
        return
    prim = curves(scene, one)
    for attribute in (prim.GetPointsAttr(), prim.GetCurveVertexCountsAttr()):
        attribute.Clear()
    samples(prim.GetPointsAttr(), {9.9: spatial(one), 10.2: spatial(two)})
    samples(prim.GetCurveVertexCountsAttr(), {9.9: [2], 10.2: [2, 2]})


@rule(CURVES, "A PointInstancer's prototype may be curves that move", "they stand still in it")
def curves_instanced(scene: Scene) -> None:
    instancer = UsdGeom.PointInstancer.Define(scene.stage, "/Instancer")
    prim = curves(scene, [(-1.5, 0), (1.5, 0)], path="/Instancer/Curves")
    if not scene.mistaken:
        pose(prim, lambda time, p: p + (0, 5 * (time - 10), 0), (9.0, 11.0))
    instancer.CreatePrototypesRel().SetTargets(["/Instancer/Curves"])
    instancer.CreateProtoIndicesAttr([0, 0])
    instancer.CreatePositionsAttr(spatial([(-3, 0), (3, -1)]))


@rule(POINTS, "Points are spheres, and velocities carry them")
def points_velocities(scene: Scene) -> None:
    flying(cloud(scene, [(-3, 0), (2, 1)]), [(4, 4), (0, -5)])


@rule(POINTS, "Accelerations bend the way of points", "velocities alone", shutter=FULL)
def points_accelerations(scene: Scene) -> None:
    flying(cloud(scene, [(0, -2)]), [(8, 0)], [] if scene.mistaken else [(0, 32)])


@rule(POINTS, "Points with time samples are interpolated")
def points_samples(scene: Scene) -> None:
    pose(cloud(scene, [(-2, 0), (2, 0)]), lambda time, p: p * (1, 1, 1) + (0, 5 * (time - 10), 0), (9.0, 10.0, 11.0))


@rule(POINTS, "Widths of points grow over the shutter, each its own way", "the frame's widths")
def points_widths(scene: Scene) -> None:
    prim = cloud(scene, [(-3, 0), (3, 0)])
    values = {FRAME: [1.5, 1.5]} if scene.mistaken else {9.5: [0.1, 2.9], 10.0: [1.5, 1.5], 10.5: [4.5, 0.1]}
    samples(prim.GetWidthsAttr(), values)


def numbers(prim: UsdGeom.Points, clouds: Mapping[float, Sequence[Vector]]) -> None:
    """Points that come and go, with ids."""
    for attribute in (prim.GetPointsAttr(), prim.GetWidthsAttr()):
        attribute.Clear()
    samples(prim.GetPointsAttr(), {time: spatial(points) for time, points in clouds.items()})
    samples(prim.GetWidthsAttr(), {time: [1.5] * len(points) for time, points in clouds.items()})
    samples(prim.CreateIdsAttr(), {time: range(len(points)) for time, points in clouds.items()})


@rule(POINTS, "Velocities carry the frame's points where their number changes", "the frame's pose alone")
def points_number_with_velocities(scene: Scene) -> None:
    prim = cloud(scene, [(-2, 1)])
    if scene.mistaken:
        return
    numbers(prim, {FRAME: [(-2, 1)], 10.2: [(-2, 1), (2, 0), (4, 0)]})
    velocity = Gf.Vec3f(24 * 6, 24 * -2, 0)
    samples(prim.CreateVelocitiesAttr(), {FRAME: [velocity], 10.2: [-velocity] * 3})


@rule(POINTS, "Without velocities the frame's points are held where their number changes", "both numbers are seen")
def points_number_without_velocities(scene: Scene) -> None:
    one, two = [(-2, 0)], [(2, 1.5), (2, -1.5), (4, 0)]
    if not scene.mistaken:
        numbers(cloud(scene, one), {9.9: one, 10.2: two})
        return
    for name, points, here in (("One", one, (9.0, 10.2)), ("Two", two, (10.2, 9.0))):
        prim = UsdGeom.Points.Define(scene.stage, f"/{name}")
        prim.CreatePointsAttr(spatial(points))
        prim.CreateWidthsAttr([1.5] * len(points))
        samples(prim.CreateVisibilityAttr(), {here[0]: UsdGeom.Tokens.inherited, here[1]: UsdGeom.Tokens.invisible})


@rule(POINTS, "A transform scales the widths of points", "widths are in the world")
def points_under_transform(scene: Scene) -> None:
    prim = cloud(scene, [(-1, 0), (1, 0)])
    slide(prim, {9.0: (0, -3), 11.0: (0, 3)})
    UsdGeom.Xformable(prim).AddScaleOp().Set(Gf.Vec3f(2.0))
    if scene.mistaken:
        prim.GetWidthsAttr().Set([0.75, 0.75])


@rule(POINTS, "A PointInstancer's prototype may be points", "they are left out")
def points_instanced(scene: Scene) -> None:
    instancer = UsdGeom.PointInstancer.Define(scene.stage, "/Instancer")
    UsdGeom.Xform.Define(scene.stage, "/Instancer/Root")
    place(scene.square("/Instancer/Root/Square", side=0.6), 0, 1.5)
    if not scene.mistaken:
        prim = UsdGeom.Points.Define(scene.stage, "/Instancer/Root/Points")
        prim.CreatePointsAttr(spatial([(0, 0)]))
        prim.CreateWidthsAttr([1.8])
    instancer.CreatePrototypesRel().SetTargets(["/Instancer/Root"])
    instancer.CreateProtoIndicesAttr([0, 0])
    instancer.CreatePositionsAttr().Set(spatial([(-3, -0.5), (3, -0.5)]), FRAME)
    instancer.CreateVelocitiesAttr().Set(spatial([(24 * 2, 0), (0, 24 * 3)]), FRAME)
