"""Frames after the first rebuild what moved alone: by counts of trees and of refined cages."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import pytest
from msbvh import _core
from msbvh.base.errors import Diagnostics
from msbvh.scene.reader import ReadSettings, read_frame
from pxr import Gf, UsdGeom, Vt
from recording import Shot
from subdivision_stages import cube

FIRST, NEXT = 10.0, 20.0


@dataclass(frozen=True)
class Taken:
    """What a frame made, and what it took over."""

    built: int
    refitted: int
    kept: int
    cages_made: int
    meshes_made: int


def taken(shot: Shot) -> Taken:
    """Of the second frame."""
    refinements = _core.RefinementCache()
    renderer: Any = None
    before: dict[str, int] = {}
    for frame in (FIRST, NEXT):
        before = dict(refinements.counts)
        result = read_frame(
            shot.stage, frame, ReadSettings(camera="/Camera", width=64), Diagnostics(), refinements=refinements
        )
        settings = {"width": result.camera.width, "height": result.camera.height, "keep_topology": True}
        if renderer is None:
            renderer = _core.Renderer(result.scene, **settings)
        else:
            renderer.commit(result.scene, **settings)
    counts, trees = refinements.counts, renderer.statistics["accel"]
    return Taken(
        **{name: trees[name] for name in ("built", "refitted", "kept")},
        **{name: counts[name] - before[name] for name in ("cages_made", "meshes_made")},
    )


def slide(prim: Any, end: tuple[float, float, float]) -> None:
    """To `end` from where it stands at FIRST to where it is at NEXT."""
    op = UsdGeom.Xformable(prim).AddTranslateOp()
    op.Set(Gf.Vec3d(0, 0, 0), FIRST - 1)
    op.Set(Gf.Vec3d(0, 0, 0), FIRST + 1)
    op.Set(Gf.Vec3d(*end), NEXT - 1)
    op.Set(Gf.Vec3d(*end), NEXT + 1)


def instanced(shot: Shot) -> UsdGeom.PointInstancer:
    """Two prototypes, a subdivided cube and a square, twice each."""
    instancer = UsdGeom.PointInstancer.Define(shot.stage, "/Many")
    cube(shot, "/Many/Cube")
    shot.mesh("/Many/Square")
    instancer.CreatePrototypesRel().SetTargets(["/Many/Cube", "/Many/Square"])
    instancer.CreateProtoIndicesAttr([0, 1, 0, 1])
    instancer.CreatePositionsAttr([(-4, 0, 0), (-1, 0, 0), (2, 0, 0), (4, 0, 0)])
    return instancer


def stage() -> Shot:
    """Instances, and a subdivided cube and a square that stand in the world."""
    shot = Shot((-0.25, 0.25))
    instanced(shot)
    cube(shot, "/Still").AddTranslateOp().Set(Gf.Vec3d(0, 3, 0))
    shot.mesh("/Square")
    return shot


TREES = 3
"""Of the two prototypes, and the world's."""


def test_where_nothing_moves_nothing_is_made() -> None:
    assert taken(stage()) == Taken(built=0, refitted=0, kept=TREES, cages_made=0, meshes_made=0)


def test_moved_instances_change_the_top_level_alone() -> None:
    shot = stage()
    slide(shot.stage.GetPrimAtPath("/Many"), (0, 0.5, 0))
    found = taken(shot)
    assert (found.built + found.refitted, found.kept) == (1, TREES - 1)
    assert found.built == 0
    assert (found.cages_made, found.meshes_made) == (0, 0)


def test_what_deforms_leaves_the_trees_of_the_others() -> None:
    shot = stage()
    points = UsdGeom.Mesh.Get(shot.stage, "/Many/Square").GetPointsAttr()
    corners = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]
    for time, z in ((FIRST - 1, 0.0), (FIRST + 1, 0.0), (NEXT - 1, 0.4), (NEXT + 1, 0.4)):
        points.Set(Vt.Vec3fArray([Gf.Vec3f(x, y, z * x * y) for x, y, _ in corners]), time)
    found = taken(shot)
    # The square's own, and the world's, whose boxes of it move.
    assert found.built == 0 and found.refitted == 2 and found.kept == TREES - 2
    assert (found.cages_made, found.meshes_made) == (0, 0)


def test_a_camera_that_turns_rebuilds_nothing() -> None:
    shot = stage()
    turn = shot.camera.AddRotateYOp()
    for time, degrees in ((FIRST - 1, 0.0), (FIRST + 1, 0.0), (NEXT - 1, 3.0), (NEXT + 1, 3.0)):
        turn.Set(degrees, time)
    found = taken(shot)
    assert found == Taken(built=0, refitted=0, kept=TREES, cages_made=0, meshes_made=0)


@pytest.mark.parametrize("distance", [0.01, 0.5])
def test_a_camera_that_travels_moves_the_world_under_it_and_builds_nothing(distance: float) -> None:
    """The world's coordinates count from the camera."""
    shot = stage()
    eye = shot.camera.GetOrderedXformOps()[0]
    for time, z in ((FIRST - 1, 20.0), (FIRST + 1, 20.0), (NEXT - 1, 20.0 - distance), (NEXT + 1, 20.0 - distance)):
        eye.Set(Gf.Vec3d(0, 0, z), time)
    found = taken(shot)
    assert found.cages_made == 0
    assert (found.built, found.refitted, found.kept) == (0, 1, TREES - 1), found
