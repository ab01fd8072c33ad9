"""MaterialX documents behind references, payloads and sublayers, which usd-core cannot open itself."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest
from material_stage import write_image
from msbvh.base.errors import Diagnostics
from msbvh.scene.reader import read_frame
from msbvh.stage.opening import open_stage
from pxr import Sdf, Usd

pytest.importorskip("MaterialX")

DOCUMENT = """<?xml version="1.0"?>
<materialx version="1.38" colorspace="lin_rec709" fileprefix="maps/">
  <nodegraph name="Graph">
    <input name="picture" type="filename" value="grey.png" colorspace="srgb_texture" />
    <image name="image" type="color3">
      <input name="file" type="filename" value="grey.png" colorspace="srgb_texture" />
      <input name="uaddressmode" type="string" value="clamp" />
    </image>
    <image name="rough_image" type="float"><input name="file" type="filename" value="grey.png" /></image>
    <constant name="held" type="float"><input name="value" type="float" interfacename="metal" /></constant>
    <input name="metal" type="float" value="0.75" />
    <output name="base" type="color3" nodename="image" />
    <output name="rough" type="float" nodename="rough_image" />
    <output name="metallic" type="float" nodename="held" />
  </nodegraph>
  <standard_surface name="Shader" type="surfaceshader">
    <input name="base_color" type="color3" nodegraph="Graph" output="base" />
    <input name="specular_roughness" type="float" nodegraph="Graph" output="rough" />
    <input name="metalness" type="float" nodegraph="Graph" output="metallic" />
    <input name="emission" type="float" value="1" />
    <input name="emission_color" type="color3" value="0.5, 0.25, 0" colorspace="acescg" />
  </standard_surface>
  <surfacematerial name="Plastic" type="material">
    <input name="surfaceshader" type="surfaceshader" nodename="Shader" />
  </surfacematerial>
</materialx>
"""

CIRCLE = """
  <nodedef name="ND_a" node="a" inherit="ND_b"><output name="out" type="surfaceshader" /></nodedef>
  <nodedef name="ND_b" node="a" inherit="ND_a"><output name="out" type="surfaceshader" /></nodedef>
  <a name="Circle" type="surfaceshader" />
  <surfacematerial name="Round" type="material">
    <input name="surfaceshader" type="surfaceshader" nodename="Circle" />
  </surfacematerial>
</materialx>"""
"""Definitions that inherit each other."""
BALL = """
        def Sphere "Ball" (apiSchemas = ["MaterialBindingAPI"]) {
            rel material:binding = <%s>
        }
"""
REFERENCE = 'def Scope "Materials" (prepend references = @./look.mtlx@</MaterialX/Materials>) {\n}'
MODEL = (
    '#usda 1.0\n(defaultPrim = "Model")\ndef Xform "Model" {' + BALL % "/Model/Materials/Plastic" + REFERENCE + "\n}\n"
)


def write(folder: Path, **texts: str) -> Path:
    """scene.usda beside look.mtlx and maps/grey.png."""
    (folder / "maps").mkdir(parents=True)
    pixels = np.indices((4, 4)).sum(axis=0) % 2 * 0.5
    write_image(folder / "maps" / "grey.png", np.repeat(pixels[..., None], 3, axis=2))
    (folder / "look.mtlx").write_text(DOCUMENT)
    for name, text in texts.items():
        (folder / f"{name}.usda").write_text(text)
    return folder / "scene.usda"


def scene_of(way: str, folder: Path) -> Path:
    if way == "reference":
        return write(folder, scene=MODEL)
    if way == "payload":
        return write(folder, scene=MODEL.replace("references", "payload"))
    if way == "nested":
        root = '#usda 1.0\ndef "A" (prepend references = @./model.usda@) {\n}'
        return write(folder, model=MODEL, scene=root)
    if way == "instances":
        root = "#usda 1.0\n" + "".join(
            f'def "{name}" (instanceable = true; prepend references = @./model.usda@) {{\n}}\n' for name in "AB"
        )
        return write(folder, model=MODEL, scene=root)
    if way == "variant":
        model = MODEL.replace(REFERENCE, "").replace(
            'def Xform "Model" {', 'def Xform "Model" (variants = {string v = "a"}; prepend variantSets = "v") {'
        )
        inside = f'variantSet "v" = {{ "a" {{ {REFERENCE}\n}} }}\n'
        return write(folder, scene=model.rstrip().removesuffix("}") + inside + "}\n")
    assert way == "sublayer"
    root = "#usda 1.0\n(subLayers = [@./look.mtlx@])\n" + BALL % "/MaterialX/Materials/Plastic"
    return write(folder, scene=root)


WAYS = ["reference", "payload", "nested", "instances", "variant", "sublayer"]


@pytest.mark.parametrize("way", WAYS)
def test_a_document_is_followed(way: str, tmp_path: Path) -> None:
    scene = scene_of(way, tmp_path / "shot")
    before = {path: path.read_bytes() for path in scene.parent.rglob("*") if path.is_file()}
    for _ in range(2):  # once the layers are known, too
        diagnostics = Diagnostics()
        stage = open_stage(str(scene), diagnostics)
        assert not list(map(str, diagnostics))
        read = read_frame(stage, None, diagnostics=diagnostics).scene
        (material,) = read.materials
        assert material["metallic"] == 0.75
        assert material["emissive_color"] == pytest.approx((0.6971, 0.2201, 0), abs=1e-3)  # OpenColorIO, from ACEScg
        assert {"diffuse_color", "roughness"} <= material["driven"].keys()
        spaces = {texture["color_space"] for texture in read.textures}
        assert spaces == {"srgb_texture", ""} and all(Path(t["tiles"][0][2]).is_file() for t in read.textures)
        assert not [str(each) for each in diagnostics if "found" in str(each)]
        del stage
    assert before == {path: path.read_bytes() for path in scene.parent.rglob("*") if path.is_file()}


def test_a_document_in_a_package_is_followed(tmp_path: Path) -> None:
    folder = write(tmp_path / "shot", scene=MODEL).parent
    package = tmp_path / "shot.usdz"
    writer = Sdf.ZipFileWriter.CreateNew(str(package))
    for name in ("scene.usda", "look.mtlx", "maps/grey.png"):
        writer.AddFile(str(folder / name), name)
    writer.Save()
    diagnostics = Diagnostics()
    read = read_frame(open_stage(str(package), diagnostics), None, diagnostics=diagnostics).scene
    assert not [str(each) for each in diagnostics if "mtlx" in str(each) or "grey" in str(each)]
    (tile,) = read.textures[0]["tiles"]
    assert tile[2] == str(package) and tile[4] == (folder / "maps/grey.png").stat().st_size


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("<materialx", "cannot be read as MaterialX"),
        ("", "cannot be read as MaterialX"),
        (None, "no such file"),
        (DOCUMENT.replace("</materialx>", CIRCLE), "cannot be read as MaterialX"),
    ],
)
def test_a_document_that_cannot_be_read_is_named_once(text: str | None, reason: str, tmp_path: Path) -> None:
    scene = scene_of("instances", tmp_path / "shot")
    document = scene.parent / "look.mtlx"
    document.unlink() if text is None else document.write_text(text)
    diagnostics = Diagnostics()
    stage = open_stage(str(scene), diagnostics)
    assert stage.GetPrimAtPath("/A")
    said = [str(each) for each in diagnostics if "look.mtlx" in str(each)]
    assert len(said) == 1 and reason in said[0]


def test_without_the_package_one_line_says_what_to_install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    scene = scene_of("instances", tmp_path / "shot")
    monkeypatch.setitem(sys.modules, "MaterialX", None)
    diagnostics = Diagnostics()
    open_stage(str(scene), diagnostics)
    said = [str(each) for each in diagnostics]
    assert len(said) == 1 and "pip install 'msbvh[materialx]'" in said[0] and said[0].startswith("/")
    scene.write_text(scene.read_text() + REFERENCE.replace("look.mtlx", "other.mtlx").replace("Materials", "More", 1))
    (scene.parent / "other.mtlx").write_text(DOCUMENT)
    diagnostics = Diagnostics()
    open_stage(str(scene), diagnostics)
    assert len([each for each in diagnostics if "materialx" in str(each)]) == 1, "once for all documents"


def test_what_else_is_missing_is_still_said(tmp_path: Path) -> None:
    scene = write(tmp_path / "shot", scene=MODEL + 'def "B" (prepend references = @./none.usda@) {\n}')
    diagnostics = Diagnostics()
    stage = open_stage(str(scene), diagnostics)
    assert isinstance(stage, Usd.Stage)
    assert len([each for each in diagnostics if "none.usda" in str(each)]) == 1
