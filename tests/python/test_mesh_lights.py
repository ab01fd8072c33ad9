"""Meshes that shine, portals, and light links that tell instances apart: from USD to the picture."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from msbvh import _core
from msbvh.base.errors import Diagnostics
from msbvh.scene.reader import ReadSettings, read_frame
from pxr import Gf, Sdf, Usd, UsdGeom, UsdLux, UsdShade
from recording import Shot, messages

SIZE = 24
SQUARE = ((-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0))


class Room(Shot):
    """A floor seen from above; lights stand beside the picture."""

    def __init__(self) -> None:
        super().__init__()
        self.camera.CreateProjectionAttr("orthographic")
        self.camera.CreateHorizontalApertureAttr(40.0)  # tenths of a unit
        self.camera.CreateVerticalApertureAttr(40.0)
        self.mesh("/Floor", [(-20, -20, 0), (20, -20, 0), (20, 20, 0), (-20, 20, 0)])

    def lamp(self, path: str = "/Lamp", **inputs: Any) -> UsdGeom.Mesh:
        """A square of side 2 at (4, 0, 2) that shines."""
        mesh = self.mesh(path, SQUARE)
        mesh.AddTranslateOp().Set(Gf.Vec3d(4, 0, 2))
        UsdLux.MeshLightAPI.Apply(mesh.GetPrim())
        set_inputs(mesh.GetPrim(), **inputs)
        return mesh

    def picture(self, frame: float | None = 10.0, spp: int = 64) -> np.ndarray:
        """float32[H, W, 3]."""
        found = Diagnostics()
        result = read_frame(self.stage, frame, ReadSettings(disable_camera_light=True), found)
        assert [d for d in found if d.severity != "note"] == []
        renderer = _core.Renderer(result.scene, width=SIZE, height=SIZE, spp=spp, max_bounces=0)
        return np.asarray(renderer.render())[..., :3]


def set_inputs(prim: Usd.Prim, **inputs: Any) -> None:
    for name, value in inputs.items():
        prim.GetAttribute(f"inputs:{name}").Set(value)


def rect(room: Room, path: str = "/Rect", **inputs: Any) -> UsdLux.RectLight:
    light = UsdLux.RectLight.Define(room.stage, path)
    light.CreateWidthAttr(2.0)
    light.CreateHeightAttr(2.0)
    light.AddTranslateOp().Set(Gf.Vec3d(4, 0, 2))
    set_inputs(light.GetPrim(), **inputs)
    return light


def mean_of(room: Room, **options: Any) -> float:
    return float(room.picture(**options).mean())


@pytest.mark.parametrize("normalize", [False, True])
def test_a_square_gives_what_a_rect_gives(normalize: bool):
    inputs = {"intensity": 3.0, "exposure": 1.0, "color": Gf.Vec3f(1, 0.5, 0.25), "normalize": normalize}
    square, panel = Room(), Room()
    square.lamp(**inputs).AddScaleOp().Set(Gf.Vec3f(1.5, 1, 1))
    rect(panel, **inputs).AddScaleOp().Set(Gf.Vec3f(1.5, 1, 1))
    found, expected = square.picture(), panel.picture()
    assert found.mean(axis=(0, 1)) == pytest.approx(expected.mean(axis=(0, 1)), rel=0.01)
    assert np.abs(found - expected).max() < 0.1 * expected.max()


def test_a_moving_square_gives_what_a_moving_rect_gives():
    rooms = Room(), Room()
    for prim in (rooms[0].lamp(intensity=5.0), rect(rooms[1], intensity=5.0)):
        op = prim.GetOrderedXformOps()[0]
        op.Set(Gf.Vec3d(4, -3, 2), 9.5)
        op.Set(Gf.Vec3d(4, 3, 3), 10.5)
    assert mean_of(rooms[0]) == pytest.approx(mean_of(rooms[1]), rel=0.015)


def test_a_deforming_mesh_keeps_its_power_where_it_is_normalized():
    room = Room()
    points = room.lamp(intensity=5.0, normalize=True).GetPointsAttr()
    still = mean_of(room)
    points.Set([Gf.Vec3f(*p) * 0.5 for p in SQUARE], 9.5)
    points.Set([Gf.Vec3f(*p) * 1.5 for p in SQUARE], 10.5)
    assert mean_of(room) == pytest.approx(still, rel=0.05)


def test_each_instance_of_a_mesh_shines():
    room, two = Room(), Room()
    room.stage.CreateClassPrim("/Asset")
    room.lamp("/Asset/Lamp", intensity=2.0)
    for index, y in enumerate((0.0, 3.0)):
        prim = UsdGeom.Xform.Define(room.stage, f"/Instance_{index}")
        prim.AddTranslateOp().Set(Gf.Vec3d(0, y, 0))
        prim.GetPrim().GetReferences().AddInternalReference("/Asset")
        prim.GetPrim().SetInstanceable(True)
        two.lamp(f"/Lamp_{index}", intensity=2.0).GetOrderedXformOps()[0].Set(Gf.Vec3d(4, y, 2))
    assert mean_of(room) == pytest.approx(mean_of(two), rel=0.01)


def test_subdivided_meshes_are_their_limit_surface():
    room, fine = Room(), Room()
    for each, scheme in ((room, "bilinear"), (fine, "none")):
        each.lamp(intensity=2.0).CreateSubdivisionSchemeAttr(scheme)
    assert mean_of(room) == pytest.approx(mean_of(fine), rel=0.01)


def test_a_geometry_light_names_its_mesh():
    room, api = Room(), Room()
    api.lamp(intensity=4.0)
    room.mesh("/Shape", SQUARE).AddTranslateOp().Set(Gf.Vec3d(4, 0, 2))
    light = UsdLux.GeometryLight.Define(room.stage, "/Light")
    light.CreateIntensityAttr(4.0)
    light.CreateGeometryRel().SetTargets(["/Shape"])
    assert mean_of(room) == pytest.approx(mean_of(api), rel=1e-6)


def material(room: Room, glow: tuple[float, float, float]) -> UsdShade.Material:
    bound = UsdShade.Material.Define(room.stage, "/Look")
    shader = UsdShade.Shader.Define(room.stage, "/Look/Surface")
    shader.CreateIdAttr("UsdPreviewSurface")
    shader.CreateInput("emissiveColor", Sdf.ValueTypeNames.Color3f).Set(Gf.Vec3f(*glow))
    shader.CreateInput("diffuseColor", Sdf.ValueTypeNames.Color3f).Set(Gf.Vec3f(0.5))
    bound.CreateSurfaceOutput().ConnectToSource(shader.ConnectableAPI(), "surface")
    return bound


def seen(room: Room, mode: str) -> tuple[np.ndarray, np.ndarray]:
    """What the lamp shows of itself, and what it gives the floor."""
    lamp = UsdGeom.Mesh(room.stage.GetPrimAtPath("/Lamp"))
    lamp.GetPrim().GetAttribute("light:materialSyncMode").Set(mode)
    floor = room.picture().mean(axis=(0, 1))
    lamp.GetOrderedXformOps()[0].Set(Gf.Vec3d(0, 0, 2))
    middle = room.picture()[SIZE // 2, SIZE // 2]
    lamp.GetOrderedXformOps()[0].Set(Gf.Vec3d(4, 0, 2))
    return middle, floor


def test_material_sync_modes():
    room = Room()
    lamp = room.lamp(intensity=10.0)
    plain = room.picture().mean(axis=(0, 1))
    UsdShade.MaterialBindingAPI.Apply(lamp.GetPrim()).Bind(material(room, (0.5, 0.25, 0.0)))
    middle, floor = seen(room, "materialGlowTintsLight")
    assert middle == pytest.approx([0.5, 0.25, 0.0], abs=1e-5)
    assert floor == pytest.approx(plain * [0.5, 0.25, 0.0], rel=0.01)
    middle, floor = seen(room, "independent")
    assert middle == pytest.approx([0.5, 0.25, 0.0], abs=1e-5)
    assert floor == pytest.approx(plain, rel=0.01)
    middle, floor = seen(room, "noMaterialResponse")
    assert middle == pytest.approx([10.0, 10.0, 10.0], rel=1e-5)
    assert floor == pytest.approx(plain, rel=0.01)


def test_what_cannot_shine_is_named():
    shot = Shot()
    shot.mesh("/Hidden").CreateVisibilityAttr("invisible")
    UsdLux.MeshLightAPI.Apply(shot.stage.GetPrimAtPath("/Hidden"))
    UsdLux.VolumeLightAPI.Apply(shot.stage.DefinePrim("/Fog", "Volume"))
    UsdLux.GeometryLight.Define(shot.stage, "/Light").CreateGeometryRel().SetTargets(["/Nothing"])
    UsdLux.GeometryLight.Define(shot.stage, "/Empty")
    odd = shot.mesh("/Odd").GetPrim()
    UsdLux.MeshLightAPI.Apply(odd)
    odd.GetAttribute("light:materialSyncMode").Set("always")
    warnings = messages(shot.read(), "warning")
    assert "/Light: found no triangles that are drawn at /Nothing; it gives no light" in warnings
    assert any(w.startswith("/Empty.geometry: found no geometry, expected the path of a mesh") for w in warnings)
    assert any(w.startswith("/Fog: volume lights (VolumeLightAPI) are not supported yet") for w in warnings)
    assert any(w.startswith("/Odd.light:materialSyncMode: found always, expected one of") for w in warnings)


def test_portals_change_no_more_than_the_noise():
    shot = Room()
    dome = UsdLux.DomeLight_1.Define(shot.stage, "/Dome")
    wall = shot.mesh("/Wall", [(-20, -20, 3), (20, -20, 3), (20, 20, 3), (2.5, 20, 3), (2.5, -20, 3), (-20, 20, 3)])
    wall.CreateFaceVertexCountsAttr([4])
    wall.CreateFaceVertexIndicesAttr([0, 4, 3, 5])
    shot.camera.GetOrderedXformOps()[0].Set(Gf.Vec3d(0, 0, 2.5))
    shot.camera.CreateClippingRangeAttr(Gf.Vec2f(0.1, 100))
    expected = shot.picture(spp=512)
    portal = UsdLux.PortalLight.Define(shot.stage, "/Window")
    portal.AddTranslateOp().Set(Gf.Vec3d(11.25, 0, 3))
    portal.GetPrim().GetAttribute("inputs:width").Set(17.5)
    portal.GetPrim().GetAttribute("inputs:height").Set(40.0)
    result = shot.read()
    assert any(w.startswith("/Window: no dome light lists it in its portals") for w in messages(result, "warning"))
    dome.GetPortalsRel().SetTargets(["/Window"])
    (light,) = shot.read().scene.lights
    ((width, height, times01, places),) = light["portals"]
    assert (width, height, places.shape) == (17.5, 40.0, (len(times01), 4, 4))
    assert shot.picture(spp=512).mean() == pytest.approx(expected.mean(), rel=0.02)
    dome.GetPortalsRel().SetTargets(["/Wall"])
    assert any("found /Wall, expected a PortalLight" in w for w in messages(shot.read(), "warning"))


def links_of(path: str, instanced: bool) -> Room:
    """Two cards and a light that leaves one of them out."""
    room = Room()
    room.stage.RemovePrim("/Floor")
    room.stage.CreateClassPrim("/Asset")
    card = room.mesh("/Asset/Card", [(-1, -2, 0), (0, -2, 0), (0, 2, 0), (-1, 2, 0)])
    card.CreateDisplayColorAttr([Gf.Vec3f(1)])
    for index in range(2):
        prim = UsdGeom.Xform.Define(room.stage, f"/Instance_{index}")
        prim.AddTranslateOp().Set(Gf.Vec3d(1.2 * index, 0, 0))
        prim.GetPrim().GetReferences().AddInternalReference("/Asset")
        prim.GetPrim().SetInstanceable(instanced)
    light = UsdLux.DistantLight.Define(room.stage, "/Light")
    light.CreateIntensityAttr(1.0)
    UsdLux.LightAPI(light).GetLightLinkCollectionAPI().CreateExcludesRel().SetTargets([path])
    return room


@pytest.mark.parametrize("path", ["/Instance_0", "/Instance_1", "/Instance_1/Card"])
def test_links_tell_instances_of_one_prototype_apart(path: str):
    found, expected = links_of(path, True).picture(spp=4), links_of(path, False).picture(spp=4)
    assert expected.max() > 0.0 and (expected[SIZE // 2] > 0).any()
    assert np.array_equal(found, expected)
    assert messages(links_of(path, True).read(), "warning") == []


def test_links_that_tell_parts_of_an_instance_apart_are_named():
    room = links_of("/Instance_1/Card", True)
    room.mesh("/Asset/Other")
    (warning,) = messages(room.read(), "warning")
    assert warning.startswith("/Instance_1: light links that tell parts of an instance apart are not supported yet")
