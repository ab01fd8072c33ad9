"""What pixels tell beside their colour: `record --aov`."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import pytest
from conftest import Run

STAGE = """#usda 1.0
(
    startTimeCode = 1
    upAxis = "Y"
)
def Camera "Cam" {
    token projection = "orthographic"
    float horizontalAperture = 40
    float verticalAperture = 10
    float2 clippingRange = (1, 101)
    double3 xformOp:translate = (2, 0.5, 51)
    uniform token[] xformOpOrder = ["xformOp:translate"]
}
def Mesh "Wall" {
    int[] faceVertexCounts = [5, 4]
    int[] faceVertexIndices = [0, 1, 2, 3, 4, 1, 5, 6, 2]
    point3f[] points = [(-0.5, -1, 0), (1, -1, 0), (1, 2, 0), (0.5, 2, 0), (-0.5, 2, 0), (2, -1, 0), (2, 2, 0)]
    color3f[] primvars:displayColor = [(0.25, 0.5, 0.75)]
    uniform token subdivisionScheme = "none"
}
def PointInstancer "Crowd" {
    int[] protoIndices = [0, 0]
    point3f[] positions = [(90, 0, 0), (2.5, 0, 30)]
    rel prototypes = </Crowd/Card>
    def Mesh "Card" {
        int[] faceVertexCounts = [4]
        int[] faceVertexIndices = [0, 1, 2, 3]
        point3f[] points = [(-0.5, -1, 0), (0.5, -1, 0), (0.5, 2, 0), (-0.5, 2, 0)]
        uniform token subdivisionScheme = "none"
    }
}
"""


@pytest.fixture
def stage(tmp_path: Path) -> Path:
    path = tmp_path / "stage.usda"
    path.write_text(STAGE)
    return path


def channels(path: Path) -> dict[str, np.ndarray]:
    """float32[h, w] of each channel."""
    image = oiio.ImageBuf(str(path))
    pixels = image.get_pixels(oiio.FLOAT)
    return {name: pixels[..., i] for i, name in enumerate(image.spec().channelnames)}


def test_each_output_is_in_the_file_of_colour(msbvh: Run, stage: Path, tmp_path: Path) -> None:
    out = tmp_path / "a.exr"
    done = msbvh("record", stage, out, "--resolution", 4, 1, "--spp", 16, "--aov", "all")
    assert done.returncode == 0, done.stderr
    spec = oiio.ImageInput.open(str(out)).spec()
    assert spec.channelnames[:4] == ("R", "G", "B", "A")
    assert [str(form) for form in spec.channelformats] == ["half"] * 4 + ["float"] * (spec.nchannels - 4)
    found = channels(out)
    np.testing.assert_allclose(found["cameraDepth"][0], [51, 51, 21, 0], rtol=1e-6)
    np.testing.assert_allclose(found["depth"][0], [0.5, 0.5, 0.2, 1.0], atol=1e-6)
    np.testing.assert_array_equal(found["elementId"][0], [0, 1, 0, -1])
    np.testing.assert_array_equal(found["instanceId"][0], [-1, -1, 1, -1])
    prims = json.loads(spec.getattribute("msbvh:prims"))
    named = ["" if i < 0 else prims[int(i)] for i in found["primId"][0]]
    assert named == ["/Wall", "/Wall", "/Crowd/Card", ""]
    np.testing.assert_array_equal([found[f"normal.{c}"][0, 0] for c in "XYZ"], [0, 0, 1])
    np.testing.assert_array_equal([found[f"Neye.{c}"][0, 3] for c in "XYZ"], [0, 0, 0])
    np.testing.assert_array_equal([found[f"albedo.{c}"][0, 0] for c in "RGB"], [0.25, 0.5, 0.75])


INSTANCE = """def Xform "%s" (
    instanceable = true
    references = </Cards>
)
{
    double3 xformOp:translate = (%g, 0, 30)
    float xformOp:rotateY.timeSamples = { 1: 0, 2: %g }
    uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:rotateY"]
}
"""


def test_an_instance_keeps_its_number_beside_one_that_spins(msbvh: Run, tmp_path: Path) -> None:
    """That one is sampled more often, so that each comes to the scene by itself."""
    before, crowd = STAGE.split('def PointInstancer "Crowd" {')
    card = crowd[crowd.index('    def Mesh "Card"') : crowd.rindex("}")]
    open_camera = before.replace("    token projection", "    double shutter:close = 0.5\n    token projection")
    stage, out = tmp_path / "native.usda", tmp_path / "a.exr"
    instances = INSTANCE % ("Spins", 90, 90000) + INSTANCE % ("Leans", 2.5, 1)
    stage.write_text(f'{open_camera}class Xform "Cards" {{\n{card}}}\n{instances}')
    done = msbvh("record", stage, out, "--resolution", 4, 1, "--spp", 16, "--aov", "instanceId")
    assert done.returncode == 0, done.stderr
    np.testing.assert_array_equal(channels(out)["instanceId"][0], [-1, -1, 1, -1])


def test_outputs_do_not_change_colour(msbvh: Run, stage: Path, tmp_path: Path) -> None:
    for name, more in (("plain.exr", ()), ("more.exr", ("--aov", "normal depth"))):
        msbvh("record", stage, tmp_path / name, "-w", 16, "--spp", 4, "--exr-float", *more)
    plain, more = channels(tmp_path / "plain.exr"), channels(tmp_path / "more.exr")
    assert set(more) - set(plain) == {"normal.X", "normal.Y", "normal.Z", "depth"}
    for name, values in plain.items():
        np.testing.assert_array_equal(values, more[name])


def test_formats_without_channels_get_colour_and_nothing_is_lost_in_silence(
    msbvh: Run, stage: Path, tmp_path: Path
) -> None:
    done = msbvh("record", stage, tmp_path / "a.png", "--aov", "depth")
    assert done.returncode == 2 and "only .exr files hold AOVs" in done.stderr
    done = msbvh("record", stage, tmp_path / "a.exr", "--aov", "depht")
    assert done.returncode == 2 and "found 'depht'" in done.stderr and "cameraDepth" in done.stderr
    done = msbvh("record", stage, tmp_path / "a.png", tmp_path / "a.exr", "-w", 8, "--spp", 1, "--aov", "depth")
    assert done.returncode == 0 and "depth" in channels(tmp_path / "a.exr")


def test_what_is_asked_for_is_in_the_plan(msbvh: Run, stage: Path, tmp_path: Path) -> None:
    stats = tmp_path / "s.json"
    msbvh("record", stage, tmp_path / "a.exr", "-w", 8, "--spp", 1, "--aov", "normal", "--stats", stats)
    plan = json.loads(stats.read_text())["frames"][0]["plan"]
    assert {"effect": "AOVs", "prim": "", "why": "normal"} in plan


MOVING = """#usda 1.0
(
    timeCodesPerSecond = 24
)
def Camera "Cam" {
    token projection = "orthographic"
    float horizontalAperture = 80
    float verticalAperture = 80
    float2 clippingRange = (1, 101)
    double shutter:open = -0.25
    double shutter:close = 0.25
    double3 xformOp:translate.timeSamples = { 0: (99990, 4, 51), 10: (100000, 14, 51) }
    uniform token[] xformOpOrder = ["xformOp:translate"]
}
def Mesh "Wall" {
    int[] faceVertexCounts = [4]
    int[] faceVertexIndices = [0, 1, 2, 3]
    point3f[] points = [(-99, -99, 0), (99, -99, 0), (99, 99, 0), (-99, 99, 0)]
    uniform token subdivisionScheme = "none"
    double3 xformOp:translate.timeSamples = { 0: (100000, 0, 0), 4: (99992, 0, 0), 8: (100008, 0, 0) }
    uniform token[] xformOpOrder = ["xformOp:translate"]
}
"""


def test_motion_is_that_of_the_frame_whatever_moves(msbvh: Run, tmp_path: Path) -> None:
    """The camera moves by 1 to the right and up a frame; the wall by 2 to the left until frame 4, then by 4 to the right. Eight
    units are 16 pixels."""
    (tmp_path / "moving.usda").write_text(MOVING)
    for frame, forward, backward in ((2, -3, 3), (4, 3, 3), (6, 3, -3)):
        options = ("--frames", frame, "--resolution", 16, 16, "--spp", 4, "--aov", "forward backward Pworld Peye")
        done = msbvh("record", "moving.usda", f"{frame}.exr", *options)
        assert done.returncode == 0, done.stderr
        found = channels(tmp_path / f"{frame}.exr")
        np.testing.assert_allclose(found["forward.u"], 2 * forward, rtol=1e-4)
        np.testing.assert_allclose(found["backward.u"], 2 * backward, rtol=1e-4)
        np.testing.assert_allclose(found["forward.v"], -2, rtol=1e-4)
        np.testing.assert_allclose(found["backward.v"], 2, rtol=1e-4)
        # In the stage's world, far from its origin; the camera sees 8 units of it.
        np.testing.assert_allclose(found["Pworld.X"][:, 0], 99990 + frame - 4, atol=0.8)
        np.testing.assert_allclose(found["Pworld.Z"], 0, atol=1e-3)
        np.testing.assert_allclose(found["Peye.Z"], -51, rtol=1e-5)
        np.testing.assert_allclose(found["Peye.X"][:, 15], 3.75, atol=0.26)
    done = msbvh("record", "moving.usda", "closed.exr", "-w", 4, "--spp", 1, "--shutter", "0:0", "--aov", "forward")
    assert done.returncode == 0 and "AOVs of motion are 0: the shutter is closed" in done.stderr


def test_st_is_told_of_what_no_material_reads(stage: Path, tmp_path: Path, msbvh: Run) -> None:
    text = stage.read_text().replace(
        "    color3f[] primvars:displayColor",
        '    float2[] primvars:st = [(0.25, 0.75)] (interpolation = "constant")\n    color3f[] primvars:displayColor',
    )
    stage.write_text(text)
    out = tmp_path / "out.exr"
    assert msbvh("record", stage, out, "-w", "40", "--spp", "4", "--aov", "st,primId").returncode == 0
    image = oiio.ImageInput.open(str(out))
    pixels = image.read_image(oiio.FLOAT)
    channels = {name: pixels[..., i] for i, name in enumerate(image.spec().channelnames)}
    image.close()
    prims = json.loads(oiio.ImageInput.open(str(out)).spec().getattribute("msbvh:prims"))
    wall = channels["primId"] == prims.index("/Wall")
    assert wall.any() and np.allclose(channels["st.s"][wall], 0.25) and np.allclose(channels["st.t"][wall], 0.75)
    assert not channels["st.s"][~wall].any()
