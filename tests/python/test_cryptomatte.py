"""Cryptomattes, decoded by somebody else's library."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import pytest
from conftest import Run
from msbvh import _core

STAGE = """#usda 1.0
def Camera "Cam" {
    token projection = "orthographic"
    float horizontalAperture = 80
    float verticalAperture = 40
    float2 clippingRange = (1, 101)
    double shutter:open = -0.25
    double shutter:close = 0.25
    double3 xformOp:translate = (4, 2, 51)
    uniform token[] xformOpOrder = ["xformOp:translate"]
}
def Material "Red" {
    token outputs:surface.connect = </Red/S.outputs:surface>
    def Shader "S" {
        uniform token info:id = "UsdPreviewSurface"
        color3f inputs:diffuseColor = (1, 0, 0)
        token outputs:surface
    }
}
def Mesh "Wall" (prepend apiSchemas = ["MaterialBindingAPI"]) {
    int[] faceVertexCounts = [4]
    int[] faceVertexIndices = [0, 1, 2, 3]
    point3f[] points = [(0, 0, 0), (3.3, 0, 0), (3.3, 4, 0), (0, 4, 0)]
    uniform token subdivisionScheme = "none"
    rel material:binding = </Red>
}
def Mesh "Mover" {
    int[] faceVertexCounts = [4]
    int[] faceVertexIndices = [0, 1, 2, 3]
    point3f[] points = [(1, 1, 5), (2, 1, 5), (2, 2, 5), (1, 2, 5)]
    float[] primvars:displayOpacity = [0.5]
    uniform token subdivisionScheme = "none"
    double3 xformOp:translate.timeSamples = { 0: (0, 0, 0), 2: (4, 0, 0) }
    uniform token[] xformOpOrder = ["xformOp:translate"]
}
def PointInstancer "Crowd" {
    int[] protoIndices = [0, 0]
    point3f[] positions = [(5, 0, 0), (6.5, 2, 0)]
    rel prototypes = </Crowd/Card>
    def Mesh "Card" {
        int[] faceVertexCounts = [4]
        int[] faceVertexIndices = [0, 1, 2, 3]
        point3f[] points = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]
        uniform token subdivisionScheme = "none"
    }
}
"""

DECODE = """
import json, sys
import numpy as np
from cryptomatte_api import Cryptomatte
found = {}
for matte in Cryptomatte.load(sys.argv[1]):
    name = matte.metadata().name()
    masks = matte.masks()
    found[name] = {key: np.asarray(mask).tolist() for key, mask in masks.items()}
json.dump(found, open(sys.argv[2], "w"))
"""
"""In a process of its own: the library brings another OpenImageIO."""


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("crypto")
    (folder / "stage.usda").write_text(STAGE)
    options = ("--frames", "1", "--resolution", "8", "4", "--spp", "64", "--max-bounces", "0", "--exr-float")
    aovs = "cryptoObject,cryptoMaterial,cryptoInstance"
    command = [sys.executable, "-m", "msbvh", "record", "stage.usda", "a.exr", *options, "--aov", aovs]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return folder / "a.exr"


def decoded(picture: Path) -> dict[str, dict[str, np.ndarray]]:
    pytest.importorskip("cryptomatte_api", reason="the extra `test` has it where there is a wheel")
    out = picture.with_suffix(".json")
    done = subprocess.run(
        [sys.executable, "-c", DECODE, str(picture), str(out)], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    found = json.loads(out.read_text())
    return {layer: {name: np.array(mask, np.float32) for name, mask in masks.items()} for layer, masks in found.items()}


def test_another_library_finds_each_name_and_its_coverage(recorded: Path) -> None:
    found = decoded(recorded)
    assert set(found) == {"cryptoObject", "cryptoMaterial", "cryptoInstance"}
    alpha = oiio.ImageBuf(str(recorded)).get_pixels(oiio.FLOAT)[..., 3]
    assert set(found["cryptoObject"]) == {"/Wall", "/Mover", "/Crowd/Card"}
    assert set(found["cryptoMaterial"]) == {"/Red", "none"}
    assert set(found["cryptoInstance"]) == {"/Wall", "/Mover", "/Crowd[0]", "/Crowd[1]"}
    for layer, masks in found.items():
        np.testing.assert_allclose(sum(masks.values()), alpha, atol=1e-6, err_msg=layer)
    wall, mover = found["cryptoObject"]["/Wall"], found["cryptoObject"]["/Mover"]
    np.testing.assert_allclose(wall[0], [1, 1, 1, 0.3, 0, 0, 0, 0], atol=0.02)
    # Half seen through, and seen on its way: from x = 2.5 to 4.5 in the shutter, with all of its light.
    assert mover.sum() == pytest.approx(0.5, abs=0.05) and not mover[0].any() and not mover[3].any()
    np.testing.assert_array_equal(found["cryptoMaterial"]["/Red"], wall)
    first = found["cryptoInstance"]["/Crowd[0]"]
    assert first[3, 5] == 1.0 and first.sum() == pytest.approx(1.0)


def test_the_header_is_as_the_specification_has_it(recorded: Path) -> None:
    spec = oiio.ImageInput.open(str(recorded)).spec()
    layers = [f"cryptoObject0{i}.{c}" for i in range(3) for c in "RGBA"]
    assert [name for name in spec.channelnames if name.startswith("cryptoObject")] == layers
    assert all(str(form) == "float" for form in spec.channelformats[4:])
    key = f"cryptomatte/{_core.name_hash('cryptoObject'):08x}"[:19]
    assert spec.getattribute(f"{key}/name") == "cryptoObject"
    assert spec.getattribute(f"{key}/hash") == "MurmurHash3_32"
    assert spec.getattribute(f"{key}/conversion") == "uint32_to_float32"
    manifest = json.loads(spec.getattribute(f"{key}/manifest"))
    assert manifest == {name: f"{_core.name_hash(name):08x}" for name in ("/Wall", "/Mover", "/Crowd/Card")}


def test_hashes_are_the_specifications() -> None:
    # MurmurHash3's own values with seed 0, for each rest of four bytes; that of the empty string would be 0, no normal float.
    known = {"hello": 0x248BFA47, "hello, world": 0x149BBB7F, "": 0x00800000}
    known["The quick brown fox jumps over the lazy dog"] = 0x2E4FF723
    for name, expected in known.items():
        assert _core.name_hash(name) == expected
    for i in range(20000):
        assert np.isfinite(np.uint32(_core.name_hash(f"/World/prim_{i}")).view(np.float32))


def test_a_budget_has_none(msbvh: Run, scene: Path) -> None:
    done = msbvh("record", scene, "a.exr", "--aov", "cryptoObject", "--target-flip", 0.1)
    assert done.returncode == 2 and "cryptoObject excludes" in done.stderr
