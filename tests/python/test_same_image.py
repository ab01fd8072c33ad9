"""Scenes that say the same in two ways make the same picture.

Bit for bit where the renderer does the same: a frame alone and in a sequence, another builder. Where the tracks are
the same motion in other forms (an instance's matrix or a baked mesh, a line or a parabola, a time remap or even keys),
vertices differ by the tolerance of the tracks and by rounding. A sample then hits or misses another thing only if its
ray passes an edge within that distance, and changes its pixel by 1 / SPP: two tracks that stray by TIGHT pixels each,
along some 1000 pixels of edges with 16 samples in each, make 2 * 0.001 * 1000 * 16 = 32 such samples at the very most,
where all of every edge strays that far; most do not stray a tenth of it. Measured with these scenes: no pixel for
instances and time remaps (the largest difference 6e-8, by rounding alone), 3 pixels for lines, 2 for quadratics. FEW leaves
room for other instruction sets, whose rounding is not the same.
"""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from bad_scenes import vec3s
from bad_skins import bad_arm
from exr import read_exr
from msbvh import _core
from msbvh.base.errors import Diagnostics
from msbvh.cli.main import main
from msbvh.scene.reader import ReadResult, ReadSettings, read_frame
from pxr import Gf, Sdf, Usd, UsdGeom, Vt
from recording import Shot

SPP = 16
TIGHT = 0.001
"""Pixels of tolerance: tracks that are this close to the stage are the same for a picture."""
FEW = 8
"""Pixels in which samples may fall on the other side of an edge."""
ROUNDING = 1e-5
"""Of a colour, where the same thing is hit: normals and directions come from other products."""

FRAMES = (9.0, 10.0, 11.0)


def read(stage: Usd.Stage, **settings: Any) -> ReadResult:
    diagnostics = Diagnostics()
    result = read_frame(stage, 10.0, ReadSettings(width=96, **settings), diagnostics)
    assert [str(d) for d in diagnostics if d.severity != "note"] == []
    return result


def drawn(result: ReadResult, builder: str = "msbvh") -> np.ndarray:
    camera = result.camera
    renderer = _core.Renderer(
        result.scene, width=camera.width, height=camera.height, spp=SPP, seed=3, max_bounces=1, threads=1,
        show_domes=False, builder=builder,
    )  # fmt: skip
    pixels = np.array(renderer.render(lambda *_: None))
    assert np.isfinite(pixels).all() and (pixels[..., 3] > 0).sum() > 500
    return pixels


def picture(stage: Usd.Stage, builder: str = "msbvh", **settings: Any) -> np.ndarray:
    return drawn(read(stage, **{"motion_tolerance": TIGHT, **settings}), builder)


def assert_same(a: np.ndarray, b: np.ndarray, few: int = FEW) -> None:
    """But for a few pixels in which some samples hit another thing."""
    away = np.abs(a - b).max(axis=2)
    others = away > ROUNDING
    assert others.sum() <= few, f"{others.sum()} pixels differ, by up to {away.max()}"
    assert away.max() <= 2.0 / SPP


def cube(stage: Usd.Stage, path: str, color: tuple[float, float, float] = (0.8, 0.3, 0.1)) -> UsdGeom.Mesh:
    mesh = UsdGeom.Mesh.Define(stage, path)
    mesh.CreateSubdivisionSchemeAttr("none")
    mesh.CreatePointsAttr(vec3s(*((x, y, z) for z in (-0.5, 0.5) for y in (-0.5, 0.5) for x in (-0.5, 0.5))))
    mesh.CreateFaceVertexCountsAttr([4] * 6)
    faces = (0, 2, 3, 1, 4, 5, 7, 6, 0, 1, 5, 4, 2, 6, 7, 3, 0, 4, 6, 2, 1, 3, 7, 5)
    mesh.CreateFaceVertexIndicesAttr(faces)
    mesh.CreateDisplayColorAttr([Gf.Vec3f(*color)])
    return mesh


# instanceable.


def nine_things(instanceable: bool, moving: bool) -> Usd.Stage:
    """Two meshes under each of nine prims, which go along curves and turn."""
    stage = Shot().stage
    prototype = UsdGeom.Xform.Define(stage, "/Prototype")
    prototype.GetPrim().SetSpecifier(Sdf.SpecifierClass)
    cube(stage, "/Prototype/Cube")
    tip = cube(stage, "/Prototype/Tip", (0.1, 0.5, 0.9))
    tip.AddTranslateOp().Set((0, 1, 0))
    tip.AddScaleOp().Set((0.3, 0.8, 0.3))
    for index in range(9):
        thing = UsdGeom.Xform.Define(stage, f"/World/Thing{index}")
        thing.GetPrim().GetReferences().AddInternalReference("/Prototype")
        thing.GetPrim().SetInstanceable(instanceable)
        move, turn = thing.AddTranslateOp(), thing.AddRotateZOp()
        for frame in FRAMES:
            t = frame - 10 if moving else 0.0
            move.Set((index % 3 * 3 - 3 + 0.4 * t * (index % 2), index // 3 * 3 - 3 + 0.3 * t * t, 0), frame)
            turn.Set(20 * index + 30 * t * (index % 4), frame)
    return stage


@pytest.mark.parametrize("moving", [False, True])
def test_instanceable_on_and_off(moving: bool):
    assert_same(picture(nine_things(False, moving)), picture(nine_things(True, moving)))


def test_at_the_usual_tolerance_instances_and_meshes_differ_by_no_more_than_both_may_stray():
    """Tracks that each follow the stage to a tenth of a pixel are not the same tracks; two tenths of a pixel along an
    edge are a fifth of its coverage."""
    a, b = (picture(nine_things(on, True), motion_tolerance=0.1) for on in (False, True))
    assert np.abs(a - b).max() <= 0.2 + 1.0 / SPP
    assert np.abs(a - b).max(axis=2).mean() <= 0.002


# Point instancers.

COUNT = 6
POSITIONS = [(1.6 * i - 4.0, 1.2 * (i % 3) - 1.0, 0.0) for i in range(COUNT)]
VELOCITIES = [(24.0 * (i % 2), 12.0 * (i - 2), 0.0) for i in range(COUNT)]
SPINS = [270.0 * i for i in range(COUNT)]
"""Units and degrees a second, at 24 frames a second."""


def instancer_of(stage: Usd.Stage) -> UsdGeom.PointInstancer:
    instancer = UsdGeom.PointInstancer.Define(stage, "/Instancer")
    cube(stage, "/Instancer/Cube")
    instancer.CreatePrototypesRel().SetTargets(["/Instancer/Cube"])
    instancer.CreateProtoIndicesAttr([0] * COUNT)
    return instancer


def carried_instances() -> Usd.Stage:
    stage = Shot().stage
    instancer = instancer_of(stage)
    instancer.CreatePositionsAttr().Set(vec3s(*POSITIONS), 10)
    instancer.CreateVelocitiesAttr().Set(vec3s(*VELOCITIES), 10)
    instancer.CreateOrientationsfAttr().Set(Vt.QuatfArray([Gf.Quatf(1)] * COUNT), 10)
    instancer.CreateAngularVelocitiesAttr().Set(vec3s(*((0, 0, spin) for spin in SPINS)), 10)
    return stage


def placed_by_hand() -> Usd.Stage:
    """Translations are linear in time, and so are angles about one axis: two samples say the same."""
    stage = Shot().stage
    for index in range(COUNT):
        mesh = cube(stage, f"/Cube{index}")
        move, turn = mesh.AddTranslateOp(), mesh.AddRotateZOp()
        for frame in (9, 11):
            seconds = (frame - 10) / 24
            move.Set(
                Gf.Vec3d(*(p + v * seconds for p, v in zip(POSITIONS[index], VELOCITIES[index], strict=True))),
                frame,
            )
            turn.Set(SPINS[index] * seconds, frame)
    return stage


def test_a_point_instancer_with_velocities_and_the_same_things_placed_by_hand():
    assert_same(picture(carried_instances()), picture(placed_by_hand()))


def test_sampled_positions_and_the_same_things_placed_by_hand():
    stage = Shot().stage
    instancer = instancer_of(stage)
    for frame in (9, 11):
        ends = np.array(POSITIONS) + np.array(VELOCITIES) * (frame - 10) / 24
        instancer.CreatePositionsAttr().Set(vec3s(*map(tuple, ends.tolist())), frame)
    other = placed_by_hand()
    for index in range(COUNT):
        UsdGeom.Xformable.Get(other, f"/Cube{index}").GetOrderedXformOps()[1].GetAttr().Clear()
    assert_same(picture(stage), picture(other))


# Tracks of other forms.


@pytest.mark.parametrize("interpolation", ["linear", "quadratic", "cubic"])
def test_lines_and_curves(interpolation: str):
    """A turn in up to 64 lines, and as few curves as it takes."""
    assert_same(picture(carried_instances(), interpolation=interpolation), picture(carried_instances()))


def deforming(frames: list[float]) -> Usd.Stage:
    """A cube that deforms one way until 9.8125 and another way after, which is 5/16 of the shutter."""
    stage = Shot().stage
    mesh = cube(stage, "/Mesh")
    rest = 2.0 * np.array(mesh.GetPointsAttr().Get(), np.float64)
    mesh.GetPointsAttr().Clear()
    for frame in frames:
        before, after = min(frame, 9.8125) - 9.5, max(frame - 9.8125, 0.0)
        points = rest + (4 * before, 6 * after, 0) + 0.5 * before * rest[:, [1, 0, 2]]
        mesh.GetPointsAttr().Set(vec3s(*map(tuple, points.tolist())), frame)
    return stage


def test_a_time_remap_and_keys_at_even_times():
    """One more sample, on the straight line at no dyadic time, makes a time remap the cheaper track."""
    even, remapped = (read(deforming([9.5, *more, 9.8125, 10.5]), motion_tolerance=TIGHT) for more in ([], [9.7]))
    forms = [(track.time_remap, track.segments) for result in (even, remapped) for track in result.tracks[1:]]
    assert forms == [(False, 16), (True, 4)]
    assert_same(drawn(even), drawn(remapped))


# The very same.


@pytest.mark.parametrize("make", [carried_instances, placed_by_hand, lambda: deforming([9.5, 9.7, 9.8125, 10.5])])
def test_builders(make):
    """With and without spatial splits the same triangles are hit; ties at shared edges go by their order."""
    assert np.array_equal(picture(make()), picture(make(), builder="mbvh"))


def everything_that_moves() -> Usd.Stage:
    """Frames 1 to 4: instances that velocities carry, each from its own frame's sample; a skinned mesh; a mesh with
    another number of points at every frame; a turning thing that is instanced."""
    shot = Shot()
    _, animation = bad_arm(shot)
    instancer = instancer_of(shot.stage)
    thing = UsdGeom.Xform.Define(shot.stage, "/Thing")
    thing.GetPrim().GetReferences().AddInternalReference("/Instancer/Cube")
    thing.GetPrim().SetInstanceable(True)
    thing.AddTranslateOp().Set((0, -3, 0))
    turn = thing.AddRotateZOp()
    strip = UsdGeom.Mesh.Define(shot.stage, "/Strip")
    strip.CreateSubdivisionSchemeAttr("none")
    for frame in range(6):
        angle = Gf.Rotation((0, 0, 1), 20.0 * frame).GetQuat()
        animation.GetRotationsAttr().Set(Vt.QuatfArray([Gf.Quatf(1), Gf.Quatf(angle)]), frame)
        instancer.CreatePositionsAttr().Set(vec3s(*((x + 0.3 * frame, y, z) for x, y, z in POSITIONS)), frame)
        instancer.CreateVelocitiesAttr().Set(vec3s(*VELOCITIES), frame)
        turn.Set(30.0 * frame, frame)
        corners = [(0.5 * i - 3 + 0.2 * frame, 2.0 + i % 2, 0.0) for i in range(frame + 4)]
        strip.CreatePointsAttr().Set(vec3s(*corners), frame)
        strip.CreateVelocitiesAttr().Set(vec3s(*[(4.8, 0, 0)] * len(corners)), frame)
        strip.CreateFaceVertexCountsAttr().Set([3] * (len(corners) - 2), frame)
        strip.CreateFaceVertexIndicesAttr().Set([i + k for i in range(len(corners) - 2) for k in range(3)], frame)
    return shot.stage


def test_a_frame_alone_and_in_a_sequence(tmp_path: Path):
    """Velocities, skinned poses and caches of one frame leave nothing behind for the next (hdArnold #1919)."""
    path = tmp_path / "scene.usda"
    everything_that_moves().Export(str(path))
    options = ["-w", "96", "--spp", "4", "--exr-float", "--strict"]
    assert main(["record", str(path), str(tmp_path / "all.###.exr"), "-f", "1:4", *options]) == 0
    frames = [read_exr(tmp_path / f"all.{frame:03}.exr") for frame in range(1, 5)]
    for frame, pixels in enumerate(frames, 1):
        alone = tmp_path / f"alone{frame}.exr"
        assert main(["record", str(path), str(alone), "-f", str(frame), *options]) == 0
        assert np.array_equal(read_exr(alone), pixels)
    assert all((a != b).any(axis=2).sum() > 100 for a, b in pairwise(frames))
