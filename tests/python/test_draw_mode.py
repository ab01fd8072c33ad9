"""model:drawMode: which prims it takes the place of, and what is drawn there (UsdGeomModelAPI, UsdImaging's stand-ins)."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import pytest
from drawn import apart
from msbvh import _core
from msbvh.scene.reader import ReadSettings, read_frame
from pxr import Gf, Kind, Sdf, Usd, UsdGeom, UsdLux, UsdShade, Vt
from recording import DENSE_TIMES01, Shot, messages
from sound_neighbour import retype

LO, HI = np.array((-1.0, -2.0, -0.5)), np.array((2.0, 1.0, 1.5))
"""Of the box in every model."""


def model(
    shot: Shot, path: str = "/Model", mode: str | None = "bounds", kind: str | None = "component", geometry: bool = True
) -> UsdGeom.ModelAPI:
    prim = UsdGeom.Xform.Define(shot.stage, path).GetPrim()
    if kind:
        Usd.ModelAPI(prim).SetKind(kind)
    found = UsdGeom.ModelAPI.Apply(prim)
    if mode:
        found.CreateModelDrawModeAttr(mode)
    if geometry:
        shot.mesh(f"{path}/Inside", [LO, (HI[0], LO[1], 0), HI])
    return found


def shown(shot: Shot, **settings: object) -> set[str]:
    return set(shot.read(**settings).scene.meshes)


def points(shot: Shot, path: str = "/Model", **settings: object) -> np.ndarray:
    return shot.read(**settings).scene.meshes[path]["points"][0][1].astype(float)


def alpha(shot: Shot, width: int = 200, spp: int = 64) -> np.ndarray:
    result = read_frame(shot.stage, 10.0, ReadSettings(width=width))
    size = {"width": result.camera.width, "height": result.camera.height}
    return _core.Renderer(result.scene, spp=spp, max_bounces=0, **size).render()[..., 3]


def texture(folder: Path, name: str, rgba: tuple[float, ...], matrix: np.ndarray | None = None) -> str:
    """A file of one colour, linear."""
    spec = oiio.ImageSpec(8, 8, 4, oiio.FLOAT)
    if matrix is not None:
        spec.attribute("worldtoscreen", oiio.TypeMatrix44, tuple(matrix.ravel().tolist()))
    path = str(folder / name)
    out = oiio.ImageOutput.create(path)
    out.open(path, spec)
    out.write_image(np.tile(np.array(rgba, np.float32), (8, 8, 1)))
    out.close()
    return path


# Which prims.


@pytest.mark.parametrize(
    ("kind", "apply", "drawn"),
    [
        ("component", None, "/Model"),
        ("component", False, "/Model"),
        ("group", None, "/Model/Inside"),
        ("group", True, "/Model"),
        ("assembly", True, "/Model"),
        ("subcomponent", True, "/Model/Inside"),
        (None, True, "/Model/Inside"),
    ],
)
def test_it_applies_to_components_and_where_it_is_applied(kind: str | None, apply: bool | None, drawn: str) -> None:
    shot = Shot((0.0, 0.0))
    found = model(shot, kind=kind)
    if apply is not None:
        found.CreateModelApplyDrawModeAttr(apply)
    assert shown(shot) == {drawn}


def test_modes_are_inherited_by_models() -> None:
    shot = Shot((0.0, 0.0))
    model(shot, "/All", "bounds", "group", geometry=False)
    model(shot, "/All/Own", "cards")
    model(shot, "/All/Inherited", "inherited")
    model(shot, "/All/Silent", None)
    model(shot, "/All/Full", "default")
    model(shot, "/All/NoModel", None, None, geometry=False)
    model(shot, "/All/NoModel/Below", None)
    result = shot.read()
    expected = {"/All/Own", "/All/Inherited", "/All/Silent", "/All/Full/Inside", "/All/NoModel/Below/Inside"}
    assert set(result.scene.meshes) == expected
    counts = {path: len(mesh["face_vertex_counts"]) for path, mesh in result.scene.meshes.items()}
    assert counts["/All/Own"] == 3 and counts["/All/Silent"] == counts["/All/Inherited"] == 12 * 6
    for path in ("Own", "Inherited", "Silent", "Full"):
        prim = shot.stage.GetPrimAtPath(f"/All/{path}")
        usd = UsdGeom.ModelAPI(prim).ComputeModelDrawMode()
        assert (usd == "default") is (path == "Full")


def test_without_draw_modes_everything_is_drawn_in_full() -> None:
    shot = Shot((0.0, 0.0))
    model(shot)
    assert shown(shot, disable_draw_modes=True) == {"/Model/Inside"}


def test_everything_below_and_the_prim_itself_give_way() -> None:
    shot = Shot((0.0, 0.0))
    model(shot, geometry=False)
    shot.mesh("/Model/A/Deep")
    UsdLux.SphereLight.Define(shot.stage, "/Model/Light")
    ball = UsdGeom.Sphere.Define(shot.stage, "/Ball")
    Usd.ModelAPI(ball.GetPrim()).SetKind(Kind.Tokens.component)
    UsdGeom.ModelAPI.Apply(ball.GetPrim()).CreateModelDrawModeAttr("bounds")
    result = shot.read()
    assert set(result.scene.meshes) == {"/Model", "/Ball"}
    assert [light["name"] for light in result.scene.lights] == ["camera light"]
    assert len(result.scene.meshes["/Ball"]["face_vertex_counts"]) == 72


def test_purpose_and_visibility_are_the_models() -> None:
    shot = Shot((-0.5, 0.5))
    hidden, guide, blinking = (model(shot, f"/{name}") for name in ("Hidden", "Guide", "Blinking"))
    UsdGeom.Imageable(hidden.GetPrim()).MakeInvisible()
    UsdGeom.Imageable(guide.GetPrim()).CreatePurposeAttr("guide")
    visibility = UsdGeom.Imageable(blinking.GetPrim()).CreateVisibilityAttr()
    visibility.Set("invisible", 9.0)
    visibility.Set("inherited", 10.0)
    assert shown(shot) == {"/Blinking"}
    assert shown(shot, purposes=("guide",)) == {"/Blinking", "/Guide"}
    assert shot.read().scene.meshes["/Blinking"]["visible"][:, 0].tolist() == [0.5]


@pytest.mark.parametrize("native", [True, False])
def test_instances_stand_in_as_the_prims_they_are(native: bool) -> None:
    shot = Shot((0.0, 0.0))
    source = shot.stage.CreateClassPrim("/_class_Source")
    Usd.ModelAPI(source).SetKind(Kind.Tokens.component)
    shot.mesh("/_class_Source/Inside", [LO, (HI[0], LO[1], 0), HI])
    UsdGeom.Xform.Define(shot.stage, "/World")
    Usd.ModelAPI(shot.stage.GetPrimAtPath("/World")).SetKind(Kind.Tokens.group)
    for name, mode in (("A", "bounds"), ("B", "default")):
        model(shot, f"/World/{name}", mode, "group", geometry=False)
        prim = UsdGeom.Xform.Define(shot.stage, f"/World/{name}/Copy").GetPrim()
        prim.GetReferences().AddInternalReference("/_class_Source")
        UsdGeom.Xformable(prim).AddTranslateOp().Set(Gf.Vec3d(5, 0, 0))
        prim.SetInstanceable(native)
    result = shot.read()
    assert messages(result, "warning") == []
    stand_in = result.scene.meshes["/World/A/Copy"]
    assert len(stand_in["face_vertex_counts"]) == 72
    found = result.scene.points("/World/A/Copy", 0.5)
    assert np.abs(found.min(axis=0) - (LO + (5, 0, 0))).max() < 0.05
    assert (len(result.scene.instances) == 1) is native
    assert ("/World/B/Copy/Inside" in result.scene.meshes) is not native


def test_models_inside_instances_inherit_from_what_is_around_them() -> None:
    """One prototype, two looks."""
    shot = Shot((0.0, 0.0))
    source = shot.stage.CreateClassPrim("/_class_Set")
    Usd.ModelAPI(source).SetKind(Kind.Tokens.group)
    model(shot, "/_class_Set/Prop", None)
    UsdGeom.Xform.Define(shot.stage, "/World")
    Usd.ModelAPI(shot.stage.GetPrimAtPath("/World")).SetKind(Kind.Tokens.group)
    for name, mode in (("A", "bounds"), ("B", None)):
        model(shot, f"/World/{name}", mode, "group", geometry=False)
        prim = shot.stage.DefinePrim(f"/World/{name}/Copy", "Xform")
        prim.GetReferences().AddInternalReference("/_class_Set")
        prim.SetInstanceable(True)
    prototypes = [set(meshes) for _, meshes in shot.read().scene.prototypes]
    assert prototypes == [{"/World/A/Copy/Prop"}, {"/World/B/Copy/Prop/Inside"}]


def test_prototypes_of_instancers() -> None:
    shot = Shot((0.0, 0.0))
    model(shot, "/Many/Proto", "cards")
    instancer = UsdGeom.PointInstancer.Define(shot.stage, "/Many")
    Usd.ModelAPI(instancer.GetPrim()).SetKind(Kind.Tokens.group)
    instancer.CreatePrototypesRel().AddTarget("/Many/Proto")
    instancer.CreateProtoIndicesAttr([0, 0])
    instancer.CreatePositionsAttr([Gf.Vec3f(-4, 0, 0), Gf.Vec3f(4, 0, 0)])
    result = shot.read()
    assert [set(meshes) for _, meshes in result.scene.prototypes] == [{"/Many/Proto"}]
    middle = (LO + HI) / 2
    found = result.scene.instance_points(0.5)
    assert np.abs(found[: len(found) // 2].mean(axis=0) - middle - (-4, 0, 0)).max() < 1e-5


# Lines.


def test_bounds_are_the_edges_of_the_box() -> None:
    shot = Shot((0.0, 0.0))
    model(shot)
    found = points(shot).reshape(12, 8, 3)
    size = found.max(axis=1) - found.min(axis=1)
    along = size.argmax(axis=1)
    assert np.bincount(along).tolist() == [4, 4, 4]
    for bar, axis in zip(found, along, strict=True):
        ends = bar.min(axis=0), bar.max(axis=0)
        middle = (ends[0] + ends[1]) / 2
        thickness = np.delete(ends[1] - ends[0], axis)
        across = np.delete(np.stack([np.abs(middle - LO), np.abs(middle - HI)]).min(axis=0), axis)
        assert across.max() < 1e-6
        assert ends[0][axis] == pytest.approx(LO[axis], abs=0.05) and ends[1][axis] == pytest.approx(HI[axis], abs=0.05)
        assert thickness.max() < 0.05


def test_lines_are_a_pixel_wide_where_they_are_nearest() -> None:
    for scale in (1.0, 0.01):
        shot = Shot((0.0, 0.0))
        UsdGeom.Xformable(model(shot, geometry=False)).AddScaleOp().Set(Gf.Vec3f(scale, scale, scale))
        shot.mesh("/Model/Flat", np.array([(-2, -2, 0), (2, -2, 0), (2, 2, 0), (-2, 2, 0)]) / scale)
        seen = alpha(shot)
        middle = seen.shape[0] // 2
        row = seen[middle]
        # Two edges and nothing between; of a bar at 2 of 20 units, a tenth of its depth is seen beside its front.
        assert row.sum() == pytest.approx(2.0 * (1.0 + 2.0 / 20.0), abs=0.03)
        assert row[80:120].max() == 0.0


def test_an_origin_is_three_unit_lines_in_the_models_space() -> None:
    shot = Shot((0.0, 0.0))
    found = model(shot, mode="origin", geometry=False)
    UsdGeom.Xformable(found.GetPrim()).AddTranslateOp().Set(Gf.Vec3d(1, 2, 3))
    bars = shot.read().scene.points("/Model", 0.5).reshape(3, 8, 3)
    for axis, bar in enumerate(bars):
        expected = np.array([(1.0, 2, 3), (1, 2, 3) + np.eye(3)[axis]])
        assert np.abs(bar.min(axis=0) - expected[0]).max() < 0.02
        assert np.abs(bar.max(axis=0) - expected[1]).max() < 0.02


def test_colours_are_the_models_not_those_of_prims() -> None:
    shot = Shot((0.0, 0.0))
    for path, colour in (("/Plain", None), ("/Red", Gf.Vec3f(1, 0, 0))):
        found = model(shot, path)
        UsdGeom.PrimvarsAPI(found).CreatePrimvar("displayColor", Sdf.ValueTypeNames.Color3fArray).Set(
            [Gf.Vec3f(0, 1, 0)]
        )
        material = UsdShade.Material.Define(shot.stage, f"{path}/Look")
        UsdShade.MaterialBindingAPI.Apply(found.GetPrim()).Bind(material)
        if colour:
            found.CreateModelDrawModeColorAttr(colour)
    meshes = shot.read().scene.meshes
    assert meshes["/Red"]["display_color"][1].tolist() == [[1, 0, 0]]
    assert np.abs(meshes["/Plain"]["display_color"][1] - 0.18).max() < 1e-6
    assert meshes["/Red"]["material"] is None


# Cards.


@pytest.mark.parametrize(("geometry", "faces"), [(None, 3), ("cross", 3), ("box", 6)])
def test_cards_lie_in_the_box(geometry: str | None, faces: int) -> None:
    shot = Shot((0.0, 0.0))
    found = model(shot, mode="cards")
    if geometry:
        found.CreateModelCardGeometryAttr(geometry)
    quads = points(shot).reshape(faces, 4, 3)
    middle = (LO + HI) / 2
    for number, quad in enumerate(quads):
        axis = number if faces == 3 else number // 2
        place = middle[axis] if faces == 3 else (HI if number % 2 == 0 else LO)[axis]
        assert np.abs(quad[:, axis] - place).max() < 1e-6
        others = [k for k in range(3) if k != axis]
        assert np.abs(quad.min(axis=0) - LO)[others].max() < 1e-6
        assert np.abs(quad.max(axis=0) - HI)[others].max() < 1e-6
        normal = np.cross(quad[1] - quad[0], quad[2] - quad[1])
        assert np.sign(normal[axis]) == (1 if faces == 3 or number % 2 == 0 else -1)


def test_cards_cover_what_their_quads_do() -> None:
    shot = Shot((0.0, 0.0))
    model(shot, mode="cards")
    size = (HI - LO)[:2] * 200 * 50.0 / 20.955 / (20.0 - 0.5)  # the card across z, in the middle
    assert alpha(shot).sum() == pytest.approx(size[0] * size[1], rel=0.02)


def test_axes_without_textures_have_no_cards_and_sides_share_one(tmp_path: Path) -> None:
    shot = Shot((0.0, 0.0))
    found = model(shot, mode="cards")
    found.CreateModelCardGeometryAttr("box")
    found.CreateModelCardTextureXPosAttr(texture(tmp_path, "x.exr", (1, 0, 0, 1)))
    found.CreateModelCardTextureZPosAttr(texture(tmp_path, "z.exr", (0, 1, 0, 0.25)))
    found.CreateModelCardTextureZNegAttr(texture(tmp_path, "w.exr", (0, 0, 1, 0.5)))
    mesh = shot.read().scene.meshes["/Model"]
    colours, opacities = mesh["display_color"][1], mesh["display_opacity"][1]
    assert np.abs(colours - [(1, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]).max() < 1e-5
    assert np.abs(opacities - [1, 1, 0.25, 0.5]).max() < 1e-5
    found.GetModelCardGeometryAttr().Set("cross")
    mesh = shot.read().scene.meshes["/Model"]
    assert np.abs(mesh["display_color"][1] - [(1, 0, 0), (0, 0.5, 0.5)]).max() < 1e-5
    said = messages(shot.read(), "warning")
    assert len(said) == 3 and all("drawn as the mean of its texture" in text for text in said)


def test_cards_from_textures_stand_where_these_were_rendered_from(tmp_path: Path) -> None:
    shot = Shot((0.0, 0.0))
    found = model(shot, mode="cards", geometry=False)
    found.CreateModelCardGeometryAttr("fromTexture")
    frustum = Gf.Frustum(
        Gf.Matrix4d().SetTranslate(Gf.Vec3d(1, 2, 5)),
        Gf.Range2d((-1, -1), (1, 1)),
        Gf.Range1d(1, 10),
        Gf.Frustum.Perspective,
    )
    matrix = np.array(frustum.ComputeViewMatrix() * frustum.ComputeProjectionMatrix())
    found.CreateModelCardTextureZPosAttr(texture(tmp_path, "z.exr", (1, 0, 0, 1), matrix))
    found.CreateModelCardTextureXPosAttr(texture(tmp_path, "x.exr", (1, 0, 0, 1)))
    result = shot.read()
    expected = [
        Gf.Matrix4d(matrix).GetInverse().Transform(Gf.Vec3d(*c, 0)) for c in ((1, -1), (-1, -1), (-1, 1), (1, 1))
    ]
    assert np.abs(points(shot) - np.array(expected)).max() < 1e-5
    (refused,) = [text for text in messages(result, "warning") if "worldtoscreen" in text]
    assert refused.startswith("/Model.model:cardTextureXPos: found no invertible worldtoscreen")


# Motion.


def test_it_moves_with_the_model_and_its_extents_hint() -> None:
    shot = Shot((-1.0, 1.0))
    found = model(shot, mode="cards")
    found.CreateModelCardGeometryAttr("box")
    UsdGeom.Xformable(found.GetPrim()).AddRotateYOp().Set(0.0, 9.0)
    UsdGeom.Xformable(found.GetPrim()).GetOrderedXformOps()[0].Set(90.0, 11.0)
    hint = found.GetPrim().CreateAttribute("extentsHint", Sdf.ValueTypeNames.Float3Array)
    for time, size in ((9.0, 1.0), (10.5, 2.0), (11.0, 1.0)):
        hint.Set(Vt.Vec3fArray([Gf.Vec3f(-size), Gf.Vec3f(size)]), time)
    result = shot.read(motion_tolerance=0.01)
    corners = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float)
    for time01 in DENSE_TIMES01[::3]:
        time = 9.0 + 2.0 * time01
        angle = np.radians(45.0 * (time - 9.0))
        turn = np.array([(np.cos(angle), 0, -np.sin(angle)), (0, 1, 0), (np.sin(angle), 0, np.cos(angle))])
        size = np.interp(time, (9.0, 10.5, 11.0), (1.0, 2.0, 1.0))
        assert apart(result.scene.points("/Model", time01), corners * size @ turn) < 2e-3


def test_the_hint_comes_before_what_is_inside_and_purposes_count() -> None:
    shot = Shot((0.0, 0.0))
    found = model(shot, mode="cards", geometry=False)
    for name, purpose, size in (("A", "default", 1), ("B", "proxy", 2), ("C", "render", 3)):
        mesh = shot.mesh(f"/Model/{name}", np.array([(-1.0, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)]) * size)
        mesh.CreatePurposeAttr(purpose)
    assert np.abs(points(shot)).max() == pytest.approx(2.0)
    assert np.abs(points(shot, purposes=())).max() == pytest.approx(1.0)
    assert np.abs(points(shot, purposes=("render",))).max() == pytest.approx(3.0)
    found.SetExtentsHint(Vt.Vec3fArray([Gf.Vec3f(-5), Gf.Vec3f(5)]))
    assert np.abs(points(shot)).max() == pytest.approx(5.0)


# Wrong input.


def test_what_is_wrong_is_one_message(tmp_path: Path) -> None:
    shot = Shot((0.0, 0.0))
    model(shot, "/Odd", "sketch")
    model(shot, "/Empty", "bounds", geometry=False)
    card = model(shot, "/Card", "cards")
    card.CreateModelCardGeometryAttr("pyramid")
    card.CreateModelCardTextureXPosAttr(str(tmp_path / "none.exr"))
    wrong = model(shot, "/Wrong", "bounds")
    retype(wrong.GetPrim(), "model:drawModeColor", Sdf.ValueTypeNames.Float, 1.0)
    result = shot.read()
    assert set(result.scene.meshes) == {"/Odd/Inside", "/Card", "/Wrong"}
    assert "/Empty: empty: draw mode 'bounds' finds no extent" in messages(result, "note")
    said = messages(result, "warning")
    for text in (
        "/Odd.model:drawMode: found 'sketch', expected default, inherited, origin, bounds, cards; drawn in full",
        "/Card.model:cardGeometry: found 'pyramid', expected cross, box or fromTexture; took cross",
        f"/Card.model:cardTextureXPos: textures of cards are not evaluated yet; @{tmp_path}/none.exr@ cannot be read, "
        "drawn as model:drawModeColor",
        "/Wrong.model:drawModeColor: found float, expected float3; ignored",
    ):
        assert text in said
    assert len(said) == 4
