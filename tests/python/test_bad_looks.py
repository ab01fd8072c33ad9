"""What is wrong with textures, colour spaces, coordinates, profiles and lights: named, and no pixel that is no number."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import pytest
from material_stage import TYPES, write_image
from msbvh import _core
from msbvh.base.errors import Diagnostics
from msbvh.scene.reader import read_frame
from pxr import Gf, Sdf, UsdGeom, UsdLux, UsdShade
from test_textured_pictures import GlowingShot

RANDOM = np.random.default_rng(3).random((8, 8, 3))


def lit() -> GlowingShot:
    shot = GlowingShot()
    shot.stage.RemovePrim("/Dark")
    shot.surface.GetInput("diffuseColor").Set(Gf.Vec3f(0.5))
    UsdLux.DomeLight.Define(shot.stage, "/Sky")
    return shot


def said_of(shot: GlowingShot) -> list[str]:
    """All that is said; the picture must be of numbers."""
    diagnostics = Diagnostics()
    result = read_frame(shot.stage, 10.0, diagnostics=diagnostics)
    renderer = _core.Renderer(result.scene, width=16, height=12, spp=8, max_bounces=1, show_domes=True)
    assert np.isfinite(renderer.render()).all()
    return [str(each) for each in diagnostics] + [" ".join(fault) for fault in renderer.texture_faults]


def nan_image(folder: Path) -> str:
    pixels = np.full((16, 16, 3), 0.5)
    pixels[3:9, 3:9], pixels[12, 12] = np.nan, np.inf
    return write_image(folder / "nan.exr", pixels, oiio.FLOAT)


INPUTS = ("emissiveColor", "diffuseColor", "roughness", "metallic", "ior", "clearcoat", "opacity", "normal")


@pytest.mark.parametrize("name", INPUTS)
def test_nan_in_a_texture(name: str, tmp_path: Path) -> None:
    shot = lit()
    shot.glowing(nan_image(tmp_path), to=name, output="rgb" if name.endswith("Color") or name == "normal" else "r")
    assert len([text for text in said_of(shot) if "not finite" in text]) == 1


def test_nan_in_a_domes_image(tmp_path: Path) -> None:
    shot = lit()
    UsdLux.DomeLight(shot.stage.GetPrimAtPath("/Sky")).CreateTextureFileAttr(Sdf.AssetPath(nan_image(tmp_path)))
    assert len([text for text in said_of(shot) if "NaN or infinity in 37 texels" in text]) == 1


def coordinates(*values: tuple[float, float]) -> Callable[[GlowingShot, Path], None]:
    def author(shot: GlowingShot, folder: Path) -> None:
        file = write_image(folder / "random.png", RANDOM)
        shot.glowing(file)
        shot.texture(file, "Bumps", to="normal")
        shot.connect(UsdShade.Shader(shot.stage.GetPrimAtPath("/Look/Bumps")), "st", shot.reader("st"))
        UsdGeom.PrimvarsAPI(shot.square).GetPrimvar("st").Set([Gf.Vec2f(*value) for value in values])

    return author


NAN, INF = float("nan"), float("inf")


@pytest.mark.parametrize(
    ("author", "said"),
    [
        (coordinates(*[(0.25, 0.75)] * 4), None),
        (coordinates((0, 0), (1, 0), (0, 0), (1, 0)), None),
        (coordinates(*[(NAN, 0)] * 4), "primvars:st: value 0 is not finite"),
        (coordinates((0, 0), (INF, 0), (1, 1), (0, 1)), "primvars:st: value 1 is not finite"),
        (coordinates((1e30, 0), (0, 1e30), (1, 1), (3e38, 3e38)), "too large"),
    ],
)
def test_coordinates(author: Callable, said: str | None, tmp_path: Path) -> None:
    shot = lit()
    author(shot, tmp_path)
    found = [text for text in said_of(shot) if "primvars:st" in text]
    assert len(found) == (said is not None) and all(said in text for text in found)


def test_circles_of_nodes() -> None:
    shot = lit()
    graph = UsdShade.NodeGraph.Define(shot.stage, "/Look/Graph")
    output, inside = graph.CreateOutput("out", TYPES.Color3f), graph.CreateInput("in", TYPES.Color3f)
    output.ConnectToSource(inside)
    inside.ConnectToSource(graph.ConnectableAPI(), "out", UsdShade.AttributeType.Output)
    shot.surface.CreateInput("emissiveColor", TYPES.Color3f).ConnectToSource(graph.ConnectableAPI(), "out")
    said_of(shot)  # USD names it on its way


@pytest.mark.parametrize("where", ["texture", "dome", "light"])
def test_a_colour_space_that_is_none(where: str, tmp_path: Path) -> None:
    shot = lit()
    file = write_image(tmp_path / "random.png", RANDOM)
    if where == "texture":
        attribute = shot.glowing(file).GetInput("file").GetAttr()
    elif where == "dome":
        attribute = UsdLux.DomeLight(shot.stage.GetPrimAtPath("/Sky")).CreateTextureFileAttr(Sdf.AssetPath(file))
    else:
        attribute = UsdLux.DomeLight(shot.stage.GetPrimAtPath("/Sky")).CreateColorAttr(Gf.Vec3f(1))
    attribute.SetColorSpace("lin_nowhere")
    assert len([text for text in said_of(shot) if "'lin_nowhere'" in text]) == 1


def test_an_empty_ies_file(tmp_path: Path) -> None:
    (tmp_path / "empty.ies").write_bytes(b"")
    shot = lit()
    light = UsdLux.SphereLight.Define(shot.stage, "/Lamp")
    shaping = UsdLux.ShapingAPI.Apply(light.GetPrim())
    shaping.CreateShapingIesFileAttr(Sdf.AssetPath(str(tmp_path / "empty.ies")))
    assert len([text for text in said_of(shot) if "@empty.ies@" in text]) == 1


@pytest.mark.parametrize("normalize", [False, True])
@pytest.mark.parametrize("kind", ["Sphere", "Disk", "Cylinder", "Rect", "Distant"])
def test_lights_without_size(kind: str, normalize: bool) -> None:
    shot = lit()
    light = getattr(UsdLux, f"{kind}Light").Define(shot.stage, "/Lamp")
    light.CreateNormalizeAttr(normalize)
    sizes = [
        light.GetPrim().GetAttribute(f"inputs:{name}") for name in ("radius", "width", "height", "length", "angle")
    ]
    for size in filter(None, sizes):
        size.Set(0.0)
    dark = kind in ("Disk", "Cylinder", "Rect")
    assert bool([text for text in said_of(shot) if "emits nothing" in text]) is dark
