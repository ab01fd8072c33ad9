"""A stage that is edited at random between frames, as in a session with a viewer: everything that a frame could wrongly
take over from the one before."""

from __future__ import annotations

import random
from collections.abc import Callable

import numpy as np
from pxr import Gf, Sdf, Usd, UsdGeom, UsdLux, Vt

MOST_THINGS = 8


class EditedStage:
    """One sequence of edits a seed. All of it is in the stage's root layer."""

    def __init__(self, seed: int) -> None:
        self._random = random.Random(seed)
        self._made = 0
        self.frame = 1.0
        self.stage = Usd.Stage.CreateInMemory()
        UsdGeom.SetStageUpAxis(self.stage, UsdGeom.Tokens.y)
        self._camera = UsdGeom.Camera.Define(self.stage, "/Camera")
        self._camera.AddTranslateOp().Set(Gf.Vec3d(0, 0, 12))
        self._shutter()
        self._light = UsdLux.DistantLight.Define(self.stage, "/Light")
        UsdGeom.Xform.Define(self.stage, "/World")
        for _ in range(3):
            self._add_mesh()

    def copy(self) -> Usd.Stage:
        """The stage as it is now, composed anew."""
        layer = Sdf.Layer.CreateAnonymous(".usda")
        layer.TransferContent(self.stage.GetRootLayer())
        return Usd.Stage.Open(layer)

    def edit(self) -> str:
        """One to three edits; their names."""
        edits: list[Callable[[], None]] = [
            self._next_frame, self._points, self._faces, self._move, self._hide, self._deactivate, self._remove,
            self._add_mesh, self._add_instancer, self._add_instance, self._instances, self._colour, self._sidedness,
            self._scheme, self._rewire, self._turn_camera, self._shutter, self._brightness, self._displace_parent,
        ]  # fmt: skip
        chosen = [self._random.choice(edits) for _ in range(self._random.choice((1, 1, 2, 3)))]
        for edit in chosen:
            edit()
        return ", ".join(edit.__name__.strip("_") for edit in chosen)

    def _things(self, schema: type | None = None) -> list[Usd.Prim]:
        things = self.stage.GetPrimAtPath("/World").GetAllChildren()
        return [prim for prim in things if schema is None or (prim.IsActive() and prim.IsA(schema))]

    def _some(self, schema: type | None = None) -> Usd.Prim | None:
        things = self._things(schema)
        return self._random.choice(things) if things else None

    def _name(self, kind: str) -> str:
        self._made += 1
        return f"/World/{kind}{self._made}"

    def _vector(self, size: float) -> Gf.Vec3d:
        return Gf.Vec3d(*(self._random.uniform(-size, size) for _ in range(3)))

    def _vectors(self, number: int, size: float) -> Vt.Vec3fArray:
        values = [[self._random.uniform(-size, size) for _ in range(3)] for _ in range(number)]
        return Vt.Vec3fArray.FromNumpy(np.array(values, np.float32).reshape(-1, 3))

    def _times(self) -> list[float]:
        """Around the frame; none: a default value."""
        offsets = self._random.choice(((), (-0.5, 0.5), (-1, 0, 1), (-0.25, 0.1, 0.25)))
        return [self.frame + offset for offset in offsets]

    def _set(self, attribute: Usd.Attribute, make: Callable[[], object]) -> None:
        attribute.Clear()
        attribute.Set(make())
        for time in self._times():
            attribute.Set(make(), time)

    def _next_frame(self) -> None:
        self.frame += self._random.choice((1.0, 1.0, 0.5, -1.0))

    def _set_faces(self, mesh: UsdGeom.Mesh, faces: int) -> None:
        corners = [self._random.choice((3, 3, 4)) for _ in range(faces)]
        mesh.GetFaceVertexCountsAttr().Set(corners)
        mesh.GetFaceVertexIndicesAttr().Set(list(range(sum(corners))))
        self._set(mesh.GetPointsAttr(), lambda: self._vectors(sum(corners), 2.0))

    def _add_mesh(self) -> None:
        if len(self._things()) >= MOST_THINGS:
            return
        mesh = UsdGeom.Mesh.Define(self.stage, self._name("Mesh"))
        mesh.CreateSubdivisionSchemeAttr("none")
        self._set_faces(mesh, self._random.randint(1, 12))
        mesh.AddTranslateOp().Set(self._vector(2.0))

    def _faces(self) -> None:
        if prim := self._some(UsdGeom.Mesh):
            self._set_faces(UsdGeom.Mesh(prim), self._random.randint(1, 12))

    def _rewire(self) -> None:
        """Other faces of the same points."""
        if prim := self._some(UsdGeom.Mesh):
            attribute = UsdGeom.Mesh(prim).GetFaceVertexIndicesAttr()
            attribute.Set(self._random.sample(list(attribute.Get()), len(attribute.Get())))

    def _points(self) -> None:
        if prim := self._some(UsdGeom.Mesh):
            attribute = UsdGeom.Mesh(prim).GetPointsAttr()
            number = sum(UsdGeom.Mesh(prim).GetFaceVertexCountsAttr().Get())
            self._set(attribute, lambda: self._vectors(number, 2.0))

    def _move(self) -> None:
        if prim := self._some(UsdGeom.Xformable):
            operations = UsdGeom.Xformable(prim).GetOrderedXformOps()
            if operations:
                self._set(operations[0].GetAttr(), lambda: self._vector(3.0))

    def _hide(self) -> None:
        if prim := self._some(UsdGeom.Imageable):
            visibility = UsdGeom.Imageable(prim).GetVisibilityAttr()
            visibility.Set("inherited" if visibility.Get() == "invisible" else "invisible")

    def _deactivate(self) -> None:
        if prim := self._some():
            prim.SetActive(not prim.IsActive())

    def _remove(self) -> None:
        if len(self._things()) > 2 and (prim := self._some()):
            self.stage.RemovePrim(prim.GetPath())

    def _add_instancer(self) -> None:
        if len(self._things()) >= MOST_THINGS:
            return
        path = self._name("Instancer")
        instancer = UsdGeom.PointInstancer.Define(self.stage, path)
        prototype = UsdGeom.Mesh.Define(self.stage, f"{path}/Prototype")
        prototype.CreateSubdivisionSchemeAttr("none")
        self._set_faces(prototype, 4)
        instancer.CreatePrototypesRel().SetTargets([prototype.GetPath()])
        instancer.AddTranslateOp()
        self._set_instances(instancer)

    def _set_instances(self, instancer: UsdGeom.PointInstancer) -> None:
        number = self._random.randint(1, 6)
        instancer.GetProtoIndicesAttr().Set([0] * number)
        self._set(instancer.GetPositionsAttr(), lambda: self._vectors(number, 4.0))

    def _instances(self) -> None:
        if prim := self._some(UsdGeom.PointInstancer):
            self._set_instances(UsdGeom.PointInstancer(prim))

    def _add_instance(self) -> None:
        """A native instance of one of the meshes, which may move or go later."""
        mesh = self._some(UsdGeom.Mesh)
        if mesh is None or len(self._things()) >= MOST_THINGS:
            return
        prim = UsdGeom.Xform.Define(self.stage, self._name("Instance")).GetPrim()
        child = self.stage.DefinePrim(prim.GetPath().AppendChild("Held"))
        child.GetReferences().AddInternalReference(mesh.GetPath())
        prim.SetInstanceable(self._random.random() < 0.5)
        child.SetInstanceable(self._random.random() < 0.5)
        UsdGeom.Xformable(prim).AddTranslateOp().Set(self._vector(3.0))

    def _colour(self) -> None:
        if prim := self._some(UsdGeom.Mesh):
            colour = UsdGeom.Gprim(prim).CreateDisplayColorAttr()
            self._set(colour, lambda: [Gf.Vec3f(*(self._random.random() for _ in range(3)))])

    def _sidedness(self) -> None:
        if prim := self._some(UsdGeom.Mesh):
            attribute = UsdGeom.Gprim(prim).CreateDoubleSidedAttr()
            attribute.Set(not attribute.Get())

    def _scheme(self) -> None:
        if prim := self._some(UsdGeom.Mesh):
            UsdGeom.Mesh(prim).GetSubdivisionSchemeAttr().Set(self._random.choice(("none", "none", "catmullClark")))

    def _turn_camera(self) -> None:
        operation = self._camera.GetOrderedXformOps()[0]
        self._set(operation.GetAttr(), lambda: Gf.Vec3d(0, 0, 12) + self._vector(1.0))

    def _shutter(self) -> None:
        first, last = self._random.choice(((-0.25, 0.25), (-0.5, 0.5), (0.0, 0.5), (0.0, 0.0)))
        self._camera.GetShutterOpenAttr().Set(first)
        self._camera.GetShutterCloseAttr().Set(last)

    def _brightness(self) -> None:
        self._set(self._light.GetIntensityAttr(), lambda: self._random.uniform(0.2, 3.0))

    def _displace_parent(self) -> None:
        world = UsdGeom.Xformable(self.stage.GetPrimAtPath("/World"))
        operation = (world.GetOrderedXformOps() or [world.AddTranslateOp()])[0]
        self._set(operation.GetAttr(), lambda: self._vector(1.0))
