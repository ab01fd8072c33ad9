"""--shutter OPEN:CLOSE: a shutter asked for on the command line, and the camera that is made up where a stage
has none."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import pytest
from conftest import MOVING_SQUARE
from msbvh.cli.main import main
from pxr import Gf, UsdGeom
from recording import Shot, messages
from skinning_oracle import ARM_POINTS, Arm


def moving(shot: Shot) -> UsdGeom.Mesh:
    mesh = shot.mesh("/Mesh")
    move = mesh.AddTranslateOp()
    move.Set(Gf.Vec3d(0), 9.0)
    move.Set(Gf.Vec3d(2, 0, 0), 11.0)
    return mesh


def without_camera() -> Shot:
    shot = Shot()
    shot.stage.RemovePrim("/Camera")
    return shot


@pytest.mark.parametrize("authored", [(0.0, 0.0), (0.0, 0.5), (0.5, -0.5), (math.nan, 1.0), (0.0, 450.0)])
def test_it_overrides_the_cameras_own(authored: tuple[float, float]) -> None:
    shot = Shot(authored)
    moving(shot)
    result = shot.read(shutter=(-0.25, 0.75))
    assert (result.camera.shutter.open, result.camera.shutter.close) == (-0.25, 0.75)
    assert not [m for m in messages(result) if "shutter" in m]
    start, end = (result.scene.points("/Mesh", time01)[0, 0] for time01 in (0.0, 1.0))
    assert (start, end) == pytest.approx((0.75, 1.75))


def test_it_closes_a_shutter_too() -> None:
    shot = Shot((-0.5, 0.5))
    moving(shot)
    result = shot.read(shutter=(0.0, 0.0))
    assert not result.camera.shutter.moving
    assert messages(result, "note") == ["--shutter: closes where it opens, at 0: no motion blur"]


@pytest.mark.parametrize(
    ("shutter", "text"),
    [
        ((math.nan, 0.5), "--shutter: found nan to 0.5, expected finite numbers; no motion blur"),
        ((0.0, math.inf), "--shutter: found 0 to inf, expected finite numbers; no motion blur"),
        ((-1e308, 1e308), "--shutter: found -1e+308 to 1e+308, expected finite numbers; no motion blur"),
        (
            (0.0, 450.0),
            "--shutter: the shutter is open for 450 frames, expected about one; rendered as asked",
        ),
    ],
)
def test_what_makes_no_sense_is_said_as_of_a_camera(shutter: tuple[float, float], text: str) -> None:
    shot = Shot()
    moving(shot)
    result = shot.read(shutter=shutter)
    assert text in messages(result, "warning")
    assert result.camera.shutter.moving == (shutter[1] == 450.0)


def test_the_cameras_blur_scale_still_scales_its_own_motion() -> None:
    shot = Shot((0.0, 0.0))
    dolly = shot.camera.GetPrim().GetAttribute("xformOp:translate")
    dolly.Set(Gf.Vec3d(0, 0, 20), 9.0)
    dolly.Set(Gf.Vec3d(8, 0, 20), 11.0)
    UsdGeom.MotionAPI.Apply(shot.camera.GetPrim()).CreateMotionBlurScaleAttr(0.5)
    camera = shot.read(shutter=(-0.5, 0.5)).camera
    assert camera.world_from_camera[[0, -1], 3, 0] == pytest.approx([3.0, 5.0])


def test_a_made_up_camera_says_how_to_open_its_shutter_once() -> None:
    shot = without_camera()
    moving(shot)
    (note,) = messages(shot.read(), "note")
    assert note == (
        "no camera on the stage; made one in front of everything. Its shutter is closed, so nothing is blurred;"
        " --shutter -0.25:0.25 opens it"
    )
    opened = shot.read(shutter=(-0.25, 0.25))
    assert messages(opened, "note") == ["no camera on the stage; made one in front of everything"]
    assert opened.camera.shutter.moving
    assert np.ptp([opened.scene.points("/Mesh", t)[0, 0] for t in (0.0, 1.0)]) == pytest.approx(0.5)
    assert not any("--shutter" in note for note in messages(shot.read(None), "note"))


def test_a_closed_shutter_that_is_authored_says_so_too() -> None:
    shot = Shot((0.0, 0.0))
    assert "/Camera.shutter:close: equals shutter:open, 0: no motion blur; --shutter -0.25:0.25 opens it" in messages(
        shot.read(), "note"
    )


SHAPES = {
    "tall": (0.5, 10.0, 0.5),
    "wide": (10.0, 0.5, 0.5),
    "deep": (0.5, 0.5, 50.0),
    "cube": (1.0, 1.0, 1.0),
    "line": (0.0, 7.0, 0.0),
    "plane edge-on": (3.0, 0.0, 3.0),
    "point": (0.0, 0.0, 0.0),
    "huge": (1e12, 3e12, 1e12),
    "tiny": (1e-9, 3e-9, 1e-9),
}


def seen(camera, corners: np.ndarray) -> np.ndarray:
    """float64[N, 2]: where points fall in the image, 0 to 1 on either axis; none may lie outside the clipping
    range."""
    projected = np.c_[corners, np.ones(len(corners))] @ camera.world_to_ndc
    distance = (np.c_[corners, np.ones(len(corners))] @ camera.world_to_camera)[:, 2]
    assert (distance >= camera.near_clip).all() and (distance <= camera.far_clip).all()
    return projected[:, :2] / projected[:, 3:]


@pytest.mark.parametrize(
    "conform", ["expandAperture", "cropAperture", "adjustApertureHeight", "adjustPixelAspectRatio"]
)
@pytest.mark.parametrize("size", [(400, None), (400, 100), (100, 400), (64, 64)])
def test_the_made_up_camera_sees_all_corners(size: tuple[int, int | None], conform: str) -> None:
    for up in ("Y", "Z"):
        for name, extent in SHAPES.items():
            shot = without_camera()
            UsdGeom.SetStageUpAxis(shot.stage, up)
            half = np.array(extent if up == "Y" else (extent[0], extent[2], extent[1])) / 2
            corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * half + (
                3,
                -2,
                1,
            )
            shot.mesh("/Box", corners.tolist())
            result = shot.read(width=size[0], height=size[1], conform=conform)
            box = np.asarray(shot.stage.GetPrimAtPath("/Box").GetAttribute("points").Get(), np.float64)
            found = seen(result.camera, box)
            assert (found > 0.0).all() and (found < 1.0).all(), (name, up)


def test_the_made_up_camera_sees_the_whole_shutters_motion() -> None:
    shot = without_camera()
    mesh = shot.mesh("/Mesh")
    move = mesh.AddTranslateOp()
    for time, x in ((9.0, -40.0), (9.75, 0.0), (10.25, 0.0), (11.0, 60.0)):
        move.Set(Gf.Vec3d(x, 0, 0), time)
    camera = shot.read(shutter=(-1.0, 1.0)).camera
    found = seen(camera, np.array([[-40.0, 0, 0], [61.0, 1, 0]]))
    assert (found > 0.0).all() and (found < 1.0).all()


@pytest.fixture
def scene(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    Path("scene.usda").write_text(MOVING_SQUARE.replace("shutter:close = 0.25", "shutter:close = -0.25"))
    return Path("scene.usda")


SMALL = ("-w", "48", "--spp", "4")


@pytest.mark.parametrize(
    "given", [("--shutter", "-0.25:0.25"), ("--shutter=-0.25:0.25",), ("--shutter", "-.25 : +2.5e-1")]
)
def test_record_writes_it_into_metadata_and_stats(scene: Path, given: tuple[str, ...]) -> None:
    assert main(["record", "scene.usda", "a.exr", *SMALL, "--stats", "a.json", *given]) == 0
    image = oiio.ImageInput.open("a.exr")
    assert image.read_image(oiio.FLOAT)[..., 3].max() > 0.99
    attributes = {a.name: a.value for a in image.spec().extra_attribs}
    assert tuple(attributes["msbvh:shutter"]) == (-0.25, 0.25)
    stats = json.loads(Path("a.json").read_text())
    assert stats["settings"]["read"]["shutter"] == stats["frames"][0]["shutter"] == [-0.25, 0.25]
    assert any(track["segments"] for track in stats["frames"][0]["tracks"])


def test_stats_hold_a_shutter_that_is_no_number(scene: Path) -> None:
    assert main(["record", "scene.usda", "a.exr", *SMALL, "--stats", "a.json", "--shutter", "nan:0.5"]) == 0
    stats = json.loads(Path("a.json").read_text())
    assert stats["settings"]["read"]["shutter"] == ["nan", 0.5] and stats["frames"][0]["shutter"] == [
        0.0,
        0.0,
    ]


def test_motion_and_plan_take_it(scene: Path, capfd: pytest.CaptureFixture[str]) -> None:
    assert main(["motion", "scene.usda", "--json", "--shutter", "-0.25:0.25"]) == 0
    report = json.loads(capfd.readouterr().out)
    assert report["shutter"] == [-0.25, 0.25] and any(prim["segments"] for prim in report["prims"])
    assert main(["plan", "scene.usda", "--json", "--shutter", "-0.25:0.25"]) == 0
    assert any(e["effect"] == "moving instances" for e in json.loads(capfd.readouterr().out)["plan"])


@pytest.mark.parametrize(
    ("given", "message"),
    [
        (
            "0.25:-0.25",
            "found '0.25:-0.25', expected OPEN:CLOSE with CLOSE at or after OPEN, such as -0.25:0.25",
        ),
        ("0.5", "found '0.5', expected OPEN:CLOSE in frames relative to the frame, such as -0.25:0.25"),
        ("", "found '', expected OPEN:CLOSE"),
        ("a:b", "found 'a:b', expected OPEN:CLOSE"),
        ("0:1:2", "found '0:1:2', expected OPEN:CLOSE"),
        (":", "found ':', expected OPEN:CLOSE"),
    ],
)
def test_what_is_no_shutter_is_a_usage_error(
    scene: Path, capfd: pytest.CaptureFixture[str], given: str, message: str
) -> None:
    assert main(["record", "scene.usda", "a.exr", *SMALL, "--shutter", given]) == 2
    assert message in capfd.readouterr().err and not Path("a.exr").exists()


@pytest.mark.parametrize(
    "command", [["record", "scene.usda", "a.exr"], ["motion", "scene.usda"], ["plan", "scene.usda"]]
)
def test_nothing_moves_at_the_default_time(scene: Path, capfd: pytest.CaptureFixture[str], command: list[str]) -> None:
    assert main([*command, "--defaultTime", "--shutter", "-0.25:0.25"]) == 2
    assert "--shutter and --defaultTime exclude each other" in capfd.readouterr().err


def test_the_made_up_camera_sees_what_a_skeleton_poses() -> None:
    shot = without_camera()
    arm = Arm(shot)
    arm.mesh.GetPointsAttr().Set([(x * 2, y * 8, z) for x, y, z in ARM_POINTS])
    arm.rotate({9.0: (0, 0), 10.0: (60, 60), 11.0: (120, 0)})
    result = shot.read(shutter=(-1.0, 1.0))
    for time01 in (0.0, 0.3, 0.5, 1.0):
        found = seen(result.camera, result.scene.points("/Root/Mesh", time01))
        assert (found > 0.0).all() and (found < 1.0).all()


def test_one_absurd_extent_does_not_spoil_the_framing() -> None:
    shot = without_camera()
    shot.mesh("/Sound")
    for index, extent in enumerate([((3e38,) * 3, (-3e38,) * 3), ((-math.inf,) * 3, (math.inf,) * 3)]):
        shot.mesh(f"/Absurd_{index}", [(x + 10, y, 0) for x, y in ((0, 0), (1, 0), (1, 1))]).CreateExtentAttr(extent)
    result = shot.read()
    found = seen(result.camera, np.array([[0.0, 0, 0], [11, 1, 0]]))
    assert (found > 0.0).all() and (found < 1.0).all()
    assert [m.split(":")[0] for m in messages(result, "warning")] == ["/Absurd_0.extent", "/Absurd_1.extent"]
