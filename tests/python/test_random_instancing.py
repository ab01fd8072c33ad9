"""Random trees of instancers and native instances in each other, with everything that decides what stands where and
when: visibility, resets, blur scales, prototype indices, ids."""

from __future__ import annotations

import random
from collections.abc import Sequence

import pytest
from drawn import apart, drawn_at, true_at
from pxr import Gf, Usd, UsdGeom
from recording import Shot, messages
from soak import soak_count, soak_figure

TIMES01 = [0.0713, 0.2919, 0.4127, 0.6341, 0.8829]
"""At none of them does a track of whole hundredths, scaled or not, hold or jump: which side a moment of change is on
rounding decides."""
SHUTTERS = ((-0.25, 0.5), (-0.5, 0.5), (0.1, 0.7))
TIMES = (9.3, 9.8, 9.93, 10.11, 10.26, 10.45, 10.9)


class Tree:
    """One stage a seed."""

    def __init__(self, seed: int) -> None:
        self._random = random.Random(seed)
        self._assets = 0
        self.shot = Shot(self._random.choice(SHUTTERS))
        self.shot.camera.GetOrderedXformOps()[0].Set(Gf.Vec3d(0, 0, 60))
        self._group("/World", 3)

    def _chance(self, share: float) -> bool:
        return self._random.random() < share

    def _times(self, most: int = 3) -> list[float]:
        return sorted(self._random.sample(TIMES, self._random.randint(1, most)))

    def _group(self, path: str, depth: int) -> UsdGeom.Xform:
        prim = UsdGeom.Xform.Define(self.shot.stage, path)
        self._dress(prim)
        for index in range(self._random.choice((1, 2))):
            self._thing(f"{path}/T{index}", depth - 1)
        return prim

    def _thing(self, path: str, depth: int) -> None:
        kinds = [self._square] if depth <= 0 else [self._square, self._group, self._native, self._instancer]
        kind = self._random.choice(kinds)
        kind(path) if kind == self._square else kind(path, depth)

    def _square(self, path: str) -> None:
        self._dress(self.shot.mesh(path))

    def _native(self, path: str, depth: int) -> None:
        self._assets += 1
        asset = f"/Asset{self._assets}"
        self.shot.stage.CreateClassPrim(asset)
        self._thing(f"{asset}/Inside", depth - 1)
        for name in ("A", "B"):
            prim = UsdGeom.Xform.Define(self.shot.stage, f"{path}{name}")
            prim.GetPrim().GetReferences().AddInternalReference(asset)
            prim.GetPrim().SetInstanceable(True)
            self._dress(prim)

    def _instancer(self, path: str, depth: int) -> None:
        instancer = UsdGeom.PointInstancer.Define(self.shot.stage, path)
        self._dress(instancer)
        for name in "AB":
            self._thing(f"{path}/{name}", depth - 1)
        stage = self.shot.stage
        roots = [f"{path}/{name}" for name in ("A", "AA", "AB", "B", "BA", "BB")]
        roots = [root for root in roots if stage.GetPrimAtPath(root)][:2]
        instancer.GetPrototypesRel().SetTargets(roots)
        count = self._random.choice((1, 2, 3))
        self._sample(instancer.CreateProtoIndicesAttr(), lambda: self._some(count, len(roots)), 0.4)
        self._sample(instancer.CreatePositionsAttr(), lambda: self._vectors(count), 0.6)
        if self._chance(0.4):
            self._sample(instancer.CreateInvisibleIdsAttr(), lambda: self._some(1, count), 0.7)
        if self._chance(0.2):
            self._sample(instancer.CreateIdsAttr(), lambda: self._some(count, count), 0.7)

    def _some(self, count: int, below: int) -> list[int]:
        return [self._random.randrange(below) for _ in range(count)]

    def _vectors(self, count: int) -> list[Gf.Vec3f]:
        return [Gf.Vec3f(*(self._random.uniform(-4, 4) for _ in range(3))) for _ in range(count)]

    def _sample(self, attribute: Usd.Attribute, make: object, moving: float) -> None:
        times: Sequence[object] = self._times() if self._chance(moving) else [Usd.TimeCode.Default()]
        for time in times:
            attribute.Set(make(), time)

    def _dress(self, schema: UsdGeom.Xformable) -> None:
        """Gives a prim a transform and now and then something that decides about it."""
        if self._chance(0.7):
            move = schema.AddTranslateOp().GetAttr()
            self._sample(move, lambda: Gf.Vec3d(*(self._random.uniform(-2, 2) for _ in range(3))), 0.6)
        if self._chance(0.3):
            self._sample(schema.AddRotateZOp().GetAttr(), lambda: self._random.uniform(-60, 60), 0.6)
        if self._chance(0.2):
            schema.SetResetXformStack(True)
        if self._chance(0.25):
            api = UsdGeom.MotionAPI.Apply(schema.GetPrim())
            api.CreateMotionBlurScaleAttr(self._random.choice((0.0, 0.5, 2.0)))
        if self._chance(0.25):
            visibility = schema.CreateVisibilityAttr()
            self._sample(visibility, lambda: self._random.choice(("inherited", "inherited", "invisible")), 0.8)


@pytest.mark.soak
def test_what_is_drawn_is_what_the_stage_has():
    points, worst = 0, 0.0
    seeds = soak_count(60, 4000)
    for seed in range(seeds):
        tree = Tree(seed)
        result = tree.shot.read(motion_tolerance=0.05)
        assert not messages(result, "error"), f"seed {seed}"
        for time01 in TIMES01:
            time = result.camera.shutter.time_code(time01).GetValue()
            expected, found = true_at(tree.shot, time), drawn_at(result, time01)
            assert found.shape == expected.shape, f"seed {seed} at {time01}"
            worst = max(worst, apart(found, expected))
            assert worst < 0.02, f"seed {seed} at {time01}"
            points += len(expected)
    assert points > 20 * seeds
    soak_figure("random instancing", f"{seeds} stages, {points} points, at most {worst:.2g} units apart")
