"""Random stages with every kind of motion that is read: few prims, odd times, arrays that do not agree."""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator
from itertools import chain, count

import numpy as np
from pxr import Gf, Sdf, Usd, UsdGeom, Vt
from recording import Shot

SHUTTERS = (
    (-0.5, 0.5),
    (-0.25, 0.25),
    (0, 0.5),
    (-0.5, 0),
    (0, 1),
    (0.1, 0.6),
    (-1, 0.2),
    (-0.9, -0.3),
    (0, 0),
)
FRAME = 10.0


class StageMaker:
    """One stage a seed. Meshes are told apart by their number of points."""

    def __init__(self, seed: int, held: bool) -> None:
        self._random = random.Random(seed)
        self._sizes: Iterator[int] = count(3)
        self.shutter = self._random.choice(SHUTTERS)
        shot = Shot(self.shutter, self._random.choice((24.0, 30.0, 23.976)))
        self.stage = shot.stage
        shot.camera.GetOrderedXformOps()[0].Set(Gf.Vec3d(0, 0, 60))
        if held:
            self.stage.SetInterpolationType(Usd.InterpolationTypeHeld)
        self._move(UsdGeom.Xform.Define(self.stage, "/World"), 0.3)
        for index in range(self._random.choice((1, 2))):
            self._random.choice((self._mesh, self._instancer, self._instances))(f"/World/Thing{index}")

    def scale_motion(self) -> None:
        """Gives some prims a motion:blurScale or a motion:velocityScale, to be inherited.

        Not together with shutters that a scale of 0 closes: velocityScale does not act on still frames. No
        velocityScale with native instances, inside of which StageTruth cannot edit.
        """
        world = self.stage.GetPrimAtPath("/World")
        instanced = any(prim.IsInstance() for prim in Usd.PrimRange(world))
        may_close = instanced or self._chance(0.5)
        classes = [prim for prim in self.stage.GetPseudoRoot().GetAllChildren() if prim.IsAbstract()]
        ranges = (Usd.PrimRange(top, Usd.PrimAllPrimsPredicate) for top in (world, *classes))
        for prim in chain.from_iterable(ranges):
            if not self._chance(0.3):
                continue
            motion = UsdGeom.MotionAPI.Apply(prim)
            motion.CreateMotionBlurScaleAttr(self._random.choice((0.0, 0.5, 2.0) if may_close else (0.5, 1.0, 2.0)))
            if not may_close and self.shutter != (0, 0):
                motion.CreateVelocityScaleAttr(self._random.choice((0.5, 2.0, -1.0)))

    def _chance(self, share: float) -> bool:
        return self._random.random() < share

    def _times(self) -> list[float]:
        number = self._random.choice((1, 2, 2, 3, 5, 9))
        odd = [round(self._random.uniform(8.5, 11.5), 2), self._random.uniform(8.5, 11.5)]
        return sorted({self._random.choice((9, 10, 11, 9.5, 10.5, 9.75, *odd)) for _ in range(number)})

    def _vectors(self, number: int, size: float) -> Vt.Vec3fArray:
        values = [[self._random.gauss(0, size) for _ in range(3)] for _ in range(number)]
        return Vt.Vec3fArray.FromNumpy(np.array(values, np.float32).reshape(-1, 3))

    def _sample(
        self, attribute: Usd.Attribute, make: Callable[[], object], like: list[float] | None = None
    ) -> list[float]:
        """Values at some times, mostly those of `like`; for all times at once now and then ([])."""
        if like is None and self._chance(0.2):
            attribute.Set(make())
            return []
        times = like if like and self._chance(0.8) else self._times()
        for time in times:
            attribute.Set(make(), time)
        return times

    def _move(self, xformable: UsdGeom.Xformable, share: float = 0.6) -> None:
        number = self._random
        if self._chance(share):
            move = xformable.AddTranslateOp().GetAttr()
            self._sample(move, lambda: Gf.Vec3d(*(number.gauss(0, 0.7) for _ in range(3))))
        if self._chance(share / 2):
            turn = xformable.AddRotateXYZOp().GetAttr()
            self._sample(turn, lambda: Gf.Vec3f(*(number.uniform(-60, 60) for _ in range(3))))
        if self._chance(share / 3):
            size = xformable.AddScaleOp().GetAttr()
            self._sample(size, lambda: Gf.Vec3f(*(number.uniform(0.5, 1.5) for _ in range(3))))

    def _rates(self, prim: UsdGeom.PointBased | UsdGeom.PointInstancer, number: int, like: list[float]) -> None:
        def some(size: float) -> Vt.Vec3fArray:
            return self._vectors(number + (1 if self._chance(0.1) else 0), size)

        if self._chance(0.5):
            self._sample(prim.CreateVelocitiesAttr(), lambda: some(20.0), like or None)
            if self._chance(0.5):
                self._sample(prim.CreateAccelerationsAttr(), lambda: some(300.0), like or None)

    def _mesh(self, path: str) -> None:
        size = next(self._sizes)
        mesh = UsdGeom.Mesh.Define(self.stage, path)
        mesh.CreateSubdivisionSchemeAttr("none")
        mesh.CreateFaceVertexCountsAttr([size])
        mesh.CreateFaceVertexIndicesAttr(range(size))
        self._rates(mesh, size, self._sample(mesh.CreatePointsAttr(), lambda: self._vectors(size, 1.0)))
        self._move(mesh)

    def _instances(self, path: str) -> None:
        prototype = path.replace("/World", "/Prototype_")
        UsdGeom.Xform.Define(self.stage, prototype).GetPrim().SetSpecifier(Sdf.SpecifierClass)
        self._mesh(prototype + "/Mesh")
        for name in ("A", "B"):
            instance = UsdGeom.Xform.Define(self.stage, path + name)
            instance.GetPrim().GetReferences().AddInternalReference(prototype)
            instance.GetPrim().SetInstanceable(True)
            self._move(instance)

    def _instancer(self, path: str) -> None:
        instancer = UsdGeom.PointInstancer.Define(self.stage, path)
        nested = path.count("/") < 3 and self._chance(0.3)
        (self._instancer if nested else self._mesh)(path + "/A")
        UsdGeom.Xform.Define(self.stage, path + "/B")
        self._mesh(path + "/B/Mesh")
        self._move(UsdGeom.Xform.Get(self.stage, path + "/B"))
        instancer.CreatePrototypesRel().SetTargets([path + "/A", path + "/B"])
        number = self._random.choice((1, 2, 4))
        instancer.CreateProtoIndicesAttr([self._random.randrange(2) for _ in range(number)])
        times = self._sample(instancer.CreatePositionsAttr(), lambda: self._vectors(number, 1.0))
        self._rates(instancer, number, times)
        if self._chance(0.5):
            self._sample(instancer.CreateScalesAttr(), lambda: self._vectors(number, 0.7))
        if self._chance(0.6):
            turned = self._sample(instancer.CreateOrientationsfAttr(), lambda: self._quaternions(number), times or None)
            if self._chance(0.5):
                spin = instancer.CreateAngularVelocitiesAttr()
                self._sample(spin, lambda: self._vectors(number, 300.0), turned or None)
        self._move(instancer)

    def _quaternions(self, number: int) -> Vt.QuatfArray:
        def one() -> Gf.Quatf:
            imaginary = (self._random.gauss(0, 0.3) for _ in range(3))
            return Gf.Quatf(1.0, *imaginary).GetNormalized()

        return Vt.QuatfArray([one() for _ in range(number)])
