"""Textures of materials: which file, where its bytes are, in which colour space, and how it is read."""

from __future__ import annotations

import zipfile
from pathlib import Path

import numpy as np
import pytest
from material_stage import TYPES, LookShot, write_image
from msbvh.look.texture_files import locate
from pxr import Gf, Sdf, Usd, UsdShade, UsdUtils
from recording import messages

GREY = np.linspace(0.4, 0.6, 48).reshape(4, 4, 3)


def png(path: Path) -> str:
    return write_image(path, GREY)


def test_a_texture_is_data_and_nothing_is_said(tmp_path: Path) -> None:
    shot = LookShot()
    file = png(tmp_path / "wood.png")
    texture = shot.texture(file)
    for name, kind, value in (
        ("wrapS", TYPES.Token, "repeat"),
        ("wrapT", TYPES.Token, "mirror"),
        ("scale", TYPES.Float4, Gf.Vec4f(2, 2, 2, 1)),
        ("bias", TYPES.Float4, Gf.Vec4f(-1, -1, -1, 0)),
        ("fallback", TYPES.Float4, Gf.Vec4f(0, 0, 1, 1)),
        ("sourceColorSpace", TYPES.Token, "raw"),
    ):
        texture.CreateInput(name, kind).Set(value)
    shot.connect(texture, "st", shot.reader("uv1"))
    shot.bind(shot.mesh("/Mesh"))
    result = shot.read()
    (image,) = result.scene.textures
    assert image == {
        "name": file,
        "tiles": [(0, 0, file, 0, 0)],
        "udim": False,
        "wrap": ("repeat", "mirror"),
        "color_space": "",
        "fallback": [0.5, 0.5, 1.0, 1.0],
    }
    (material,) = result.scene.materials
    assert material["driven"] == {"diffuse_color": {"texture_read": 0, "channel": 0, "grey": False}}
    (read,) = material["texture_reads"]
    assert (read["texture"], read["coordinates"]) == (0, "uv1")
    assert read["scale"] == [2, 2, 2, 1] and read["bias"] == [-1, -1, -1, 0]
    assert messages(result, "warning") == []
    assert messages(result, "note") == [
        "/Mesh.primvars:uv1: is not there; drawn as what its reader falls back to, unless instances have their own"
    ]


def test_materials_share_textures(tmp_path: Path) -> None:
    shot = LookShot()
    shot.texture(png(tmp_path / "wood.png"))
    layer = shot.stage.GetRootLayer()
    for index in range(3):
        Sdf.CopySpec(layer, "/Look", layer, f"/Look_{index}")
        surface = UsdShade.Shader(shot.stage.GetPrimAtPath(f"/Look_{index}/Surface"))
        surface.GetInput("diffuseColor").SetConnectedSources(
            [
                UsdShade.ConnectionSourceInfo(
                    UsdShade.Output(shot.stage.GetAttributeAtPath(f"/Look_{index}/Texture.outputs:rgb"))
                )
            ]
        )
        material = UsdShade.Material(shot.stage.GetPrimAtPath(f"/Look_{index}"))
        material.GetSurfaceOutput().ConnectToSource(surface.ConnectableAPI(), "surface")
        UsdShade.MaterialBindingAPI.Apply(shot.mesh(f"/Mesh_{index}").GetPrim()).Bind(material)
    shot.bind(shot.mesh("/Mesh"))
    scene = shot.read().scene
    assert len(scene.materials) == 4 and len(scene.textures) == 1
    assert all(material["texture_reads"][0]["texture"] == 0 for material in scene.materials)


@pytest.mark.parametrize("fallback", [None, Gf.Vec4f(0, 0, 1, 0.5)])
@pytest.mark.parametrize(
    ("file", "found"), [("missing.jpg", "@missing.jpg@ cannot be found"), ("", "it names no file")]
)
def test_a_missing_file_leaves_the_fallback(file: str, found: str, fallback: Gf.Vec4f | None) -> None:
    shot = LookShot()
    texture = shot.texture(file)
    if fallback is not None:
        texture.CreateInput("fallback", TYPES.Float4).Set(fallback)
    shot.connect(shot.surface, "opacity", texture, "a")
    shot.bind(shot.mesh("/Mesh"))
    result = shot.read()
    (material,) = result.scene.materials
    assert material["driven"] == {} and result.scene.textures == []
    color, opacity = (pytest.approx((0.18, 0.18, 0.18)), 1.0) if fallback is None else ((0, 0, 1), 0.5)
    assert material["diffuse_color"] == color and material["opacity"] == opacity
    warnings = messages(result, "warning")
    assert len(warnings) == 2 and all(found in warning for warning in warnings)


def test_tiles_of_a_udim_texture(tmp_path: Path) -> None:
    files = {tile: png(tmp_path / f"t.{tile}.png") for tile in (1001, 1002, 1011)}
    shot = LookShot()
    shot.texture(str(tmp_path / "t.<UDIM>.png"))
    shot.bind(shot.mesh("/Mesh"))
    (image,) = shot.read().scene.textures
    assert image["udim"] and image["name"].endswith("t.<UDIM>.png")
    assert image["tiles"] == [(0, 0, files[1001], 0, 0), (1, 0, files[1002], 0, 0), (0, 1, files[1011], 0, 0)]


def packed(folder: Path) -> str:
    """A package with a mesh and its textures, one of them of tiles."""
    for name in ("wood.png", "t.1001.png", "t.1012.png"):
        png(folder / name)
    shot = LookShot()
    shot.texture("wood.png")
    shot.texture("t.<UDIM>.png", "Tiles", "r", "roughness")
    shot.bind(shot.mesh("/Mesh"))
    shot.stage.Export(str(folder / "s.usda"))
    package = str(folder / "s.usdz")
    assert UsdUtils.CreateNewUsdzPackage(str(folder / "s.usda"), package)
    return package


def bytes_at(place: tuple[str, int, int]) -> bytes:
    path, offset, count = place
    return Path(path).read_bytes()[offset : offset + count]


def test_files_in_a_package_are_places_in_it(tmp_path: Path) -> None:
    package = packed(tmp_path)
    shot = LookShot()
    shot.stage = Usd.Stage.Open(package)
    result = shot.read()
    assert [w for w in messages(result, "warning") if "texture" in w.lower()] == []
    image, tiles = sorted(result.scene.textures, key=lambda each: each["udim"])
    archive = zipfile.ZipFile(package)
    inside = {Path(name).name: archive.read(name) for name in archive.namelist()}
    assert bytes_at(image["tiles"][0][2:]) == inside["wood.png"]
    assert [tile[:2] for tile in tiles["tiles"]] == [(0, 0), (1, 1)]
    assert bytes_at(tiles["tiles"][1][2:]) == inside["t.1012.png"]


def test_a_package_in_a_package_is_looked_through_and_what_is_compressed_is_not(tmp_path: Path) -> None:
    package = packed(tmp_path)
    nested = tmp_path / "outer.usdz"
    with zipfile.ZipFile(nested, "w", zipfile.ZIP_STORED) as archive:
        archive.write(package, "inner.usdz")
        archive.write(tmp_path / "wood.png", "small.png", zipfile.ZIP_DEFLATED)
    name = next(each for each in zipfile.ZipFile(package).namelist() if each.endswith("wood.png"))
    place = locate(f"{nested}[inner.usdz[{name}]]")
    assert place is not None and bytes_at(place) == (tmp_path / "wood.png").read_bytes()
    assert locate(f"{nested}[small.png]") is None
    assert locate(f"{nested}[nothing.png]") is None
    assert locate(f"{nested}[inner.usdz[nothing.png]]") is None
    assert locate(f"{tmp_path}/nowhere.usdz[a.png]") is None
    assert locate("/a/b.png") == ("/a/b.png", 0, 0)


@pytest.mark.parametrize(
    ("source", "expected"),
    [(None, "lin_ap1_scene"), ("auto", "lin_ap1_scene"), ("raw", ""), ("sRGB", "srgb_rec709_scene")],
)
def test_colour_space_metadata_counts_where_the_node_leaves_it_open(
    tmp_path: Path, source: str | None, expected: str
) -> None:
    shot = LookShot()
    texture = shot.texture(png(tmp_path / "a.png"))
    texture.GetInput("file").GetAttr().SetColorSpace("lin_ap1_scene")
    if source is not None:
        texture.CreateInput("sourceColorSpace", TYPES.Token).Set(source)
    shot.bind(shot.mesh("/Mesh"))
    assert shot.read().scene.textures[0]["color_space"] == expected


def test_the_colour_space_of_a_prim_above_counts(tmp_path: Path) -> None:
    shot = LookShot()
    shot.texture(png(tmp_path / "a.png"))
    shot.bind(shot.mesh("/Mesh"))
    assert shot.read().scene.textures[0]["color_space"] == "auto"
    Usd.ColorSpaceAPI.Apply(shot.material.GetPrim()).CreateColorSpaceNameAttr("g22_rec709_scene")
    assert shot.read().scene.textures[0]["color_space"] == "g22_rec709_scene"


def test_a_file_and_a_name_from_the_material_interface_through_a_node_graph(tmp_path: Path) -> None:
    shot = LookShot()
    file = png(tmp_path / "a.png")
    graph = UsdShade.NodeGraph.Define(shot.stage, "/Look/Graph")
    texture = UsdShade.Shader.Define(shot.stage, "/Look/Graph/Texture")
    texture.CreateIdAttr("UsdUVTexture")
    public = shot.material.CreateInput("map", TYPES.Asset)
    public.Set(Sdf.AssetPath(file))
    inner = graph.CreateInput("file", TYPES.Asset)
    inner.ConnectToSource(public)
    texture.CreateInput("file", TYPES.Asset).ConnectToSource(inner)
    reader = shot.node("Graph/St", "UsdPrimvarReader_float2")
    name = shot.material.CreateInput("uvset", TYPES.String)
    name.Set("map1")
    reader.CreateInput("varname", TYPES.String).ConnectToSource(name)
    shot.connect(texture, "st", reader)
    out = graph.CreateOutput("color", TYPES.Color3f)
    out.ConnectToSource(texture.CreateOutput("rgb", TYPES.Float3))
    shot.surface.CreateInput("diffuseColor", TYPES.Color3f).ConnectToSource(out)
    shot.bind(shot.mesh("/Mesh"))
    result = shot.read()
    assert result.scene.textures[0]["tiles"] == [(0, 0, file, 0, 0)]
    assert result.scene.materials[0]["texture_reads"][0]["coordinates"] == "map1"
    assert messages(result, "warning") == []
