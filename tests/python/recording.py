"""A stand-in for msbvh._core.Translator that keeps what the reader hands down on its way to the core."""

from __future__ import annotations

from typing import Any

import numpy as np
from msbvh import _core
from msbvh.base.errors import Diagnostics
from msbvh.scene.reader import ReadSettings, read_frame
from pxr import Gf, Usd, UsdGeom


class Recording:
    """Keeps copies of what is handed down, and hands it on to the core; every call takes what the contract names
    and nothing else."""

    def __init__(self, **camera: Any) -> None:
        self.camera = camera
        self.meshes: dict[str, dict] = {}
        self.prototypes: list[tuple[str, dict[str, dict]]] = []
        self.instances: list[dict] = []
        self.looks: list[_core.SurfaceLook] = []
        self.lights: list[dict] = []
        self.light_groups: dict[str, list[int]] = {}
        self._core = _core.Translator(**camera)
        self._scene: Any = None

    empty = False
    """Cameras and lights are read on stages without geometry as well."""

    def add_mesh(self, mesh: _core.MeshInput) -> None:
        attributes = checked_mesh(mesh)
        self.meshes[self._key(attributes, self.meshes)] = attributes
        self._core.add_mesh(mesh)

    def begin_prototype(self, path: str, pixels_per_unit: float) -> int:
        self.prototypes.append((path, {}))
        return self._core.begin_prototype(path, pixels_per_unit)

    def pixels_per_unit(self, *, levels: list[_core.InstanceLevel], box: np.ndarray) -> float:
        return self._core.pixels_per_unit(levels=levels, box=box)

    def add_prototype_mesh(self, prototype: int, mesh: _core.MeshInput) -> None:
        meshes, attributes = self.prototypes[prototype][1], checked_mesh(mesh)
        meshes[self._key(attributes, meshes)] = attributes
        self._core.add_prototype_mesh(prototype, mesh)

    def add_instances(self, **instances: Any) -> None:
        self.instances.append(instances)
        self._core.add_instances(**instances)

    def add_material(self, look: _core.SurfaceLook, displacement: _core.Displacement | None = None) -> int:
        self.looks.append(look)
        return self._core.add_material(look, displacement)

    def add_light(self, **light: Any) -> None:
        self.lights.append(light)
        self._core.add_light(**light)

    def set_light_groups(self, groups: dict[str, list[int]]) -> None:
        self.light_groups = groups
        self._core.set_light_groups(groups)

    def diagnostics(self) -> list:
        return self._core.diagnostics()

    def tracks(self) -> list:
        return self._core.tracks()

    def left_out(self) -> list:
        return self._core.left_out()

    def finish(self) -> Recording:
        self._scene = self._core.finish()
        return self

    @property
    def materials(self) -> list[dict]:
        """The finished scene's, and so are those that follow."""
        return self._scene.materials

    @property
    def textures(self) -> list[dict]:
        return self._scene.textures

    def primvars(self, path: str) -> dict:
        """Those of a prim that its materials read: interpolation, segments and values by name."""
        found = [primvars for prim, primvars in self._scene.primvars if prim == path]
        assert len(found) == 1, f"{path} is drawn {len(found)} times"
        return found[0]

    def instance_primvars(self, path: str) -> dict:
        """One value an instance, by name."""
        found = [primvars for prim, primvars in self._scene.instance_primvars if prim == path]
        assert len(found) == 1, f"{path} has {len(found)} sets of instances"
        return found[0]

    @staticmethod
    def _key(mesh: dict, meshes: dict) -> str:
        """The prim's path; with a number behind it for the further parts of a mesh with several materials."""
        return mesh["path"] if mesh["path"] not in meshes else f"{mesh['path']}#{len(meshes)}"

    def poses(self, time01: float) -> list[tuple[str, str, np.ndarray]]:
        """The finished scene's."""
        return self._scene.poses(time01)

    def points(self, path: str, time01: float) -> np.ndarray:
        """The points of a mesh that stands in the world once, from its track: float64[N, 3]."""
        found = [points for mesh, place, points in self.poses(time01) if mesh == place == path]
        assert found, f"{path} is not drawn at {time01}"
        return found[0][0]

    def instance_points(self, time01: float) -> np.ndarray:
        """Every point of every instance at a time, float64[N, 3], in no particular order."""
        parts = [points.reshape(-1, 3) for mesh, place, points in self.poses(time01) if mesh != place]
        return np.concatenate([np.zeros((0, 3)), *parts])

    def maps(self, time01: float, path: str | None = None) -> np.ndarray:
        """Where instances put their prototypes' first vertex: float64[N, 3]."""
        first = [points[:, 0] for mesh, place, points in self.poses(time01) if mesh != place and path in (None, place)]
        return np.concatenate([np.zeros((0, 3)), *first])


MESH_ATTRIBUTES = [name for name in vars(_core.MeshInput) if not name.startswith("_") and name != "copy"]


def checked_mesh(given: _core.MeshInput) -> dict[str, Any]:
    """A mesh's attributes, held against the contract's shapes and types."""
    mesh = {name: getattr(given, name) for name in MESH_ATTRIBUTES}
    if mesh["round"] is None:
        assert mesh["face_vertex_counts"].dtype == mesh["face_vertex_indices"].dtype == np.int32
    times = [time for time, _ in mesh["points"]]
    assert times == [None] or (times == sorted(set(times)) and len(times) >= 1)
    assert all(points.dtype == np.float32 and points.shape[1:] == (3,) for _, points in mesh["points"])
    assert mesh["transform"].matrices.dtype == np.float64
    assert mesh["transform"].matrices.shape == (len(mesh["transform"].times01), 4, 4)
    assert (np.diff(mesh["transform"].times01) > 0).all()
    return mesh


def interpolated(times01: Any, values: Any, time01: float, held: bool = False) -> np.ndarray:
    """Linear between samples (`held`: each until the next), held outside: what the translator does."""
    after = int(np.searchsorted(times01, time01, side="right"))
    if after == 0 or after == len(times01) or held:
        return np.asarray(values[max(after - 1, 0)], np.float64)
    weight = (time01 - times01[after - 1]) / (times01[after] - times01[after - 1])
    return (1 - weight) * np.asarray(values[after - 1], np.float64) + weight * np.asarray(values[after], np.float64)


def transformed(points: np.ndarray, matrix: np.ndarray) -> np.ndarray:
    """Row vectors times a matrix."""
    return points @ matrix[:3, :3] + matrix[3, :3]


def points_at(mesh: dict, time01: float) -> np.ndarray:
    """The points, as far as no velocities carry them, of a recorded mesh under its own transform: float64[N, 3]."""
    times, values = zip(*mesh["points"], strict=True)
    times = [0.0] if times == (None,) else times
    points = interpolated(times, values, time01, mesh["points_held"])
    return transformed(points, interpolated(mesh["transform"].times01, mesh["transform"].matrices, time01))


def usd_points_at(prim: Usd.Prim, code: Usd.TimeCode, base: Usd.TimeCode) -> np.ndarray:
    """The world-space points of a mesh by USD's own evaluation: float64[N, 3]."""
    points = np.array(UsdGeom.PointBased(prim).ComputePointsAtTime(code, base), np.float64).reshape(-1, 3)
    return transformed(points, np.array(UsdGeom.XformCache(code).GetLocalToWorldTransform(prim)))


class Shot:
    """A stage with a camera at (0, 0, 20), made in memory."""

    def __init__(self, shutter: tuple[float, float] = (-0.5, 0.5), time_codes_per_second: float = 24.0) -> None:
        self.stage = Usd.Stage.CreateInMemory()
        self.stage.SetTimeCodesPerSecond(time_codes_per_second)
        self.camera = UsdGeom.Camera.Define(self.stage, "/Camera")
        self.camera.AddTranslateOp().Set(Gf.Vec3d(0, 0, 20))
        self.camera.CreateShutterOpenAttr(shutter[0])
        self.camera.CreateShutterCloseAttr(shutter[1])

    def mesh(self, path: str, points: Any = ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0))) -> UsdGeom.Mesh:
        """A square, or whatever `points` are, as one face; without subdivision."""
        mesh = UsdGeom.Mesh.Define(self.stage, path)
        mesh.CreateSubdivisionSchemeAttr("none")
        mesh.CreateFaceVertexCountsAttr([len(points)])
        mesh.CreateFaceVertexIndicesAttr(range(len(points)))
        mesh.CreatePointsAttr([Gf.Vec3f(*point) for point in points])
        return mesh

    def read(self, frame: float | None = 10.0, **settings: Any) -> Any:
        """What the reader makes of a frame; its scene is a Recording. What is outside of the picture has no other tolerance."""
        chosen = ReadSettings(**{"outside_tolerance": 1.0, **settings})
        return read_frame(self.stage, frame, chosen, Diagnostics(), Recording)


def messages(result: Any, severity: str | None = None) -> list[str]:
    """The diagnostics as the user sees them."""
    return [str(d) for d in result.diagnostics if severity in (None, d.severity)]


DENSE_TIMES01 = [0.0, *np.sort(np.arange(1, 32) * 0.6180339887498949 % 1.0).tolist(), 1.0]
"""33 times of the shutter that fall on no key but the ends."""


def worst_deviation(result: Any, prim: Usd.Prim) -> float:
    """How far the track of a mesh in the world strays from USD's points at 33 times, in stage units."""
    shutter = result.camera.shutter
    path = str(prim.GetPath())
    return max(
        np.abs(
            result.scene.points(path, time01) - usd_points_at(prim, shutter.time_code(time01), shutter.frame_code)
        ).max(initial=0.0)
        for time01 in DENSE_TIMES01
    )
