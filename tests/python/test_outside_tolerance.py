"""What moves outside of the picture throughout the shutter, where shadows and bounces alone show it, takes fewer keys: counted,
not timed. Camera rays see the same to the bit, and shadows agree within the noise."""

from __future__ import annotations

import json
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from msbvh import _core
from msbvh.accuracy.kinds import motion_pixels, rid_of
from msbvh.accuracy.options import Options
from msbvh.accuracy.prims import tracks_by_path
from msbvh.accuracy.scenes import SCENES
from msbvh.base.errors import Diagnostics
from msbvh.cli.main import main
from msbvh.motion_report.one_path import worst_track
from msbvh.scene.coarser_tracks import CoarserTracks
from msbvh.scene.reader import ReadResult, ReadSettings, read_frame
from msbvh.stage.opening import open_stage
from pxr import Usd, UsdGeom

# A wall behind what moves, the sun from the left, so that what moves to the left of the picture casts its shadow into it.
HEAD = """#usda 1.0
( startTimeCode = 1 )
def Camera "cam"
{{
    float2 clippingRange = (0.1, 100)
    double shutter:open = 0
    double shutter:close = 1
    double3 xformOp:translate.timeSamples = {{ 1: (0, 0, 10), 2: ({x}, 0, 10) }}
    uniform token[] xformOpOrder = ["xformOp:translate"]
}}
def Mesh "wall" {{ int[] faceVertexCounts = [4]; int[] faceVertexIndices = [0, 1, 2, 3]
    point3f[] points = [(-20, -20, -5), (20, -20, -5), (20, 20, -5), (-20, 20, -5)]; uniform token subdivisionScheme = "none"
}}
"""
SUN = """def DistantLight "sun" { float inputs:intensity = 60000; float xformOp:rotateY = -45
    uniform token[] xformOpOrder = ["xformOp:rotateY"]
}
"""
BLADE = 'int[] faceVertexCounts = [4]; int[] faceVertexIndices = [0, 1, 2, 3]; uniform token subdivisionScheme = "none"'
POINTS = [(-0.8, -0.1, 0.0), (0.8, -0.1, 0.0), (0.8, 0.1, 0.0), (-0.8, 0.1, 0.0)]
SHOWCASE = Path(__file__).resolve().parents[2] / "testenv" / "showcase" / "showcase.usda"
AWAY, SEEN = -5.0, 1.2
TURN = 100.0
"""Degrees within the shutter."""
STEPS = 32


def turned(degrees: float) -> str:
    """The blade's points."""
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return "[" + ", ".join(f"({x * c - y * s:.6f}, {x * s + y * c:.6f}, {z})" for x, y, z in POINTS) + "]"


def at(x: float, spins: bool = True) -> str:
    spin = f"double xformOp:rotateZ.timeSamples = {{ 1: 0, 2: {TURN} }};" if spins else ""
    order = '"xformOp:translate", "xformOp:rotateZ"' if spins else '"xformOp:translate"'
    return f"double3 xformOp:translate = ({x}, 0, 0); {spin} uniform token[] xformOpOrder = [{order}]"


def rigid(name: str, x: float) -> str:
    return f'def Mesh "{name}" {{ {BLADE}\n point3f[] points = {turned(0)}; {at(x)}\n }}\n'


def deforming(name: str, x: float) -> str:
    samples = ", ".join(f"{1 + i / STEPS}: {turned(TURN * i / STEPS)}" for i in range(STEPS + 1))
    return f'def Mesh "{name}" {{ {BLADE}\n point3f[] points.timeSamples = {{ {samples} }}; {at(x, False)}\n }}\n'


def curves(name: str, x: float) -> str:
    return (
        f'def HermiteCurves "{name}" {{ int[] curveVertexCounts = [2]; float[] widths = [0.1] ( interpolation = "constant" )\n'
        f" point3f[] points = [(-0.4, 0, 0), (0.4, 0, 0)]; vector3f[] tangents = [(0.5, 0.4, 0), (0.5, 0.4, 0)]; {at(x)}\n }}\n"
    )


def instances(name: str, x: float) -> str:
    return (
        f'def PointInstancer "{name}" {{ int[] protoIndices = [0, 0]; rel prototypes = <blade>\n'
        f" point3f[] positions = [(0, 0.6, 0), (0, -0.6, 0)]; {at(x)}\n"
        f' def Mesh "blade" {{ {BLADE}\n point3f[] points = {turned(0)}\n }}\n }}\n'
    )


KINDS = {"rigid": rigid, "deforming": deforming, "curves": curves, "instances": instances}


def written(folder: Path, text: str, *, x: float = 0.01, name: str = "scene") -> str:
    """`x`: as far as the camera moves."""
    path = folder / f"{name}.usda"
    path.write_text(HEAD.format(x=x) + text)
    return str(path)


OF_LIGHT = {"noise", "directDiffuse", "directSpecular", "indirectDiffuse", "indirectSpecular"}
OF_TREES = {"nodeVisits", "primitiveTests", "seconds"}
OF_CAMERA_RAYS = tuple(name for name in _core.aov_names() if name not in OF_LIGHT | OF_TREES)
"""AOVs of what camera rays find alone."""


def read(scene: str, factor: float, frame: float | None = 1.0, **settings: Any) -> ReadResult:
    stage = open_stage(scene, Diagnostics(), ())
    return read_frame(stage, frame, ReadSettings(**{"width": 480, "outside_tolerance": factor, **settings}))


def keys(result: ReadResult, path: str) -> int:
    """Of all tracks of a prim."""
    return max(track.segments * track.degree + 1 for track in result.tracks if track.path == path)


def rendered(result: ReadResult, seed: int = 0, spp: int = 16) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    camera = result.camera
    settings = {"width": camera.width, "height": camera.height, "spp": spp, "seed": seed, "max_bounces": 0}
    return _core.Renderer(result.scene, **settings, aovs=OF_CAMERA_RAYS).render_with_aovs()


def same_to_the_camera(one: dict[str, np.ndarray], other: dict[str, np.ndarray]) -> None:
    """All that camera rays find."""
    for name, values in one.items():
        np.testing.assert_array_equal(values, other[name], err_msg=name)


@pytest.mark.parametrize("kind", KINDS)
def test_fewer_keys_outside_and_the_same_inside(kind: str, tmp_path: Path) -> None:
    scene = written(tmp_path, KINDS[kind]("away", AWAY) + KINDS[kind]("seen", SEEN) + SUN)
    fine, coarse = read(scene, 1.0), read(scene, 8.0)
    assert keys(coarse, "/seen") == keys(fine, "/seen") > 2
    saved = keys(fine, "/away") - keys(coarse, "/away")
    assert saved > 0
    found = coarse.coarser_tracks
    count = 2 if kind == "instances" else 1
    assert (found.prims, found.tracks, found.keys_saved) == (["/away"], count, count * saved)
    assert read(scene, 1.0).coarser_tracks.prims == []
    held, less = (sum(track.bytes for track in result.tracks if track.path == "/away") for result in (fine, coarse))
    assert less < held
    for track in coarse.tracks:
        assert track.error_pixels <= track.tolerance_pixels == pytest.approx(0.8 if track.path == "/away" else 0.1)


@pytest.mark.parametrize("kind", ["rigid", "deforming"])
def test_the_coarser_track_keeps_its_tolerance(kind: str, tmp_path: Path) -> None:
    """Against where the blade is, at times that are no keys; a pixel at the distance of its far end."""
    result = read(written(tmp_path, KINDS[kind]("away", AWAY) + SUN), 8.0)
    assert result.coarser_tracks.prims == ["/away"]
    pixel = np.hypot(10.0, AWAY - 0.8) * 20.955 / 50.0 / 480.0
    worst = 0.0
    for time01 in np.arange(1, 32) * 0.6180339887498949 % 1.0:
        angle = np.radians(TURN * time01) * 1j
        true = np.array([complex(x, y) for x, y, _ in POINTS]) * np.exp(angle) + AWAY
        (found,) = [points[0] for path, _, points in result.scene.poses(float(time01)) if path == "/away"]
        worst = max(worst, float(np.abs(found[:, 0] + 1j * found[:, 1] - true).max()))
    assert 0.1 * pixel < worst <= 0.8 * pixel


@pytest.mark.parametrize("kind", KINDS)
def test_camera_rays_see_the_same_and_the_shadow_agrees_within_the_noise(kind: str, tmp_path: Path) -> None:
    scene = written(tmp_path, KINDS[kind]("away", AWAY) + KINDS[kind]("seen", SEEN) + SUN)
    fine, coarse = read(scene, 1.0, width=160), read(scene, 8.0, width=160)
    assert coarse.coarser_tracks.keys_saved > 0
    (pixels, aovs), (others, other_aovs) = rendered(fine), rendered(coarse)
    same_to_the_camera(aovs, other_aovs)
    again, _ = rendered(fine, seed=1)
    noise = float(np.sqrt(((again - pixels) ** 2).mean()))
    assert float(np.sqrt(((others - pixels) ** 2).mean())) < 0.5 * noise
    alone = written(tmp_path, KINDS[kind]("seen", SEEN) + SUN, name="alone")
    lit, _ = rendered(read(alone, 1.0, width=160))
    assert (lit - pixels)[..., 0].max() > 0.1 * lit[..., 0].max()  # there is a shadow


def test_what_the_moving_camera_comes_to_see_keeps_its_keys(tmp_path: Path) -> None:
    scene = written(tmp_path, rigid("away", AWAY) + SUN, x=AWAY)
    assert keys(read(scene, 8.0), "/away") == keys(read(scene, 1.0), "/away")
    assert read(scene, 8.0).coarser_tracks.prims == []


def test_where_only_the_camera_looks_it_is_left_out_as_before(tmp_path: Path) -> None:
    scene = written(tmp_path, rigid("away", AWAY) + rigid("seen", SEEN))
    found = read(scene, 8.0, max_bounces=0)
    assert [row["path"] for row in found.left_out] == ["/away"]
    assert found.coarser_tracks.prims == []


def test_an_instancer_of_which_a_part_is_seen_reports_that_part(tmp_path: Path) -> None:
    part = instances("dots", 0.0).replace("(0, 0.6, 0), (0, -0.6, 0)", f"({AWAY}, 0.6, 0), (0, -0.6, 0)")
    scene = written(
        tmp_path, part.replace("rotateZ.timeSamples", "rotateX.timeSamples").replace(':rotateZ"', ':rotateX"') + SUN
    )
    fine, coarse = read(scene, 1.0), read(scene, 8.0)
    (one,), (other,) = ([track for track in result.tracks if track.path == "/dots"] for result in (fine, coarse))
    assert (other.count, other.outside, other.coarser) == (2, 1, 1)
    assert (other.error_pixels, other.tolerance_pixels, other.error_outside) == (one.error_pixels, 0.1, False)


def cubes(count: int, x: float, step: float = 0.3) -> str:
    """Alike, so that they become instances of one."""
    return "".join(
        f'def Cube "s{i}" {{ double size = 0.5\n double3 xformOp:translate = ({x - step / 3.0 * i}, {step * i}, 0)\n'
        f" double xformOp:rotateZ.timeSamples = {{ 1: 0, 2: {TURN} }}\n"
        ' uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:rotateZ"]\n}\n'
        for i in range(count)
    )


def motion_of(scene: str, capfd: pytest.CaptureFixture[str], *options: str) -> dict[str, dict[str, Any]]:
    main(["motion", scene, "-w", "480", "--json", *options])
    return {prim["path"]: prim for prim in json.loads(capfd.readouterr().out)["prims"]}


def test_the_first_of_a_crowd_has_the_error_of_its_motion(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    """Its path is that of the shape that all of them share, which stands still."""
    scene = written(tmp_path, cubes(20, -8.0) + SUN, x=0.0)
    result = read(scene, 8.0)
    own = [track for track in result.tracks if track.path == "/s0"]
    (moving,) = [track for track in own if track.segments]
    assert len(own) == 2 and moving.error_outside and 0.1 < moving.error_pixels <= 0.8
    told = motion_of(scene, capfd)["/s0"]
    assert (told["error_px"], told["count"]) == (moving.error_pixels, 1)
    assert told["tolerance_px"] == moving.tolerance_pixels == pytest.approx(0.8)
    row = tracks_by_path(result.tracks)["/s0"]
    assert (row.error_px, row.outside, row.count) == (moving.error_pixels, True, 1)


@dataclass
class Kept:
    """What a TrackReport says of errors."""

    error_pixels: float
    tolerance_pixels: float = 0.1
    error_outside: bool = False
    segments: int = 1


def test_a_miss_counts_before_what_is_seen_and_a_motion_before_what_stands_still() -> None:
    seen, still, misses = Kept(0.05), Kept(0.0, segments=0), Kept(3.0, 0.8, True)
    away, barely = Kept(0.7, 0.8, True), Kept(0.08, segments=0)
    for worst, *others in [(misses, seen, still), (seen, away, still), (away, still), (barely, away), (still, still)]:
        assert worst_track([worst, *others]) is worst and worst_track([*others, worst]) == worst


def test_a_prim_that_stands_in_many_places_is_outside_in_some(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    group = (
        'def PointInstancer "inst" { int[] protoIndices = [0, 0, 0]; rel prototypes = </inst/p>\n'
        f' point3f[] positions = [(0, 0, 0), (-20, 0, 0), (-30, 0, 0)]\n def Xform "p" {{\n{cubes(20, 0.0, 0.05)} }}\n}}\n'
    )
    scene = written(tmp_path, group + SUN, x=0.0)
    prims = motion_of(scene, capfd)
    for i in range(20):
        prim = prims[f"/inst/p/s{i}"]
        assert (prim["count"], prim["outside"]) == (3, 2)
        assert prim["track"].endswith(", 2 outside of the picture")
    assert {track.count for path, track in tracks_by_path(read(scene, 8.0).tracks).items() if "/s" in path} == {3}


def test_a_crowd_that_is_left_out_is_not_among_the_coarser_tracks(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    """Its one name is that of its first prim."""
    scene = written(tmp_path, cubes(20, -8.0), x=0.0)
    left = read(scene, 8.0, max_bounces=0)
    assert sum(row["count"] for row in left.left_out) == 20
    assert left.coarser_tracks == CoarserTracks([], 0, 0)
    assert len(read(scene, 8.0).coarser_tracks.prims) > 10
    assert main(["plan", scene, "-w", "480", "--rays", "0", "--max-bounces", "0"]) == 0
    assert "coarser tracks" not in capfd.readouterr().out


def test_the_commands_tell_each_prims_own_tolerance(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    scene = written(tmp_path, rigid("away", AWAY) + rigid("seen", SEEN) + SUN)
    assert main(["motion", scene, "-w", "480", "--json"]) == 0
    report = json.loads(capfd.readouterr().out)
    prims = {prim["path"]: prim for prim in report["prims"]}
    assert report["tolerance_px"] == prims["/seen"]["tolerance_px"] == 0.1
    assert 0.1 < prims["/away"]["error_px"] <= prims["/away"]["tolerance_px"] == pytest.approx(0.8)
    assert prims["/away"]["keys_saved"] > 0 == prims["/seen"]["keys_saved"]
    assert main(["motion", scene, "-w", "480"]) == 0
    (line,) = [line for line in capfd.readouterr().out.splitlines() if line.startswith("/away")]
    assert "outside of the picture" in line and " 0.8 " in line and "!" not in line
    assert main(["motion", scene, "-w", "480", "--outside-tolerance", "1"]) == 0
    assert "outside" not in capfd.readouterr().out

    assert main(["plan", scene, "-w", "480", "--rays", "0"]) == 0
    saved = prims["/away"]["keys_saved"]
    assert (
        f"coarser tracks       1 outside of the picture throughout the shutter, {saved} key" in capfd.readouterr().out
    )
    assert main(["plan", scene, "-w", "480", "--rays", "0", "--json"]) == 0
    found = {"prims": ["/away"], "prim_count": 1, "tracks": 1, "keys_saved": saved}
    assert json.loads(capfd.readouterr().out)["coarser_tracks"] == found

    stats = tmp_path / "stats.json"
    image = str(tmp_path / "out.exr")
    assert main(["record", scene, image, "-w", "480", "--spp", "1", "--stats", str(stats)]) == 0
    frame = json.loads(stats.read_text())["frames"][0]
    assert frame["coarser_tracks"] == {"prims": 1, "tracks": 1, "keys_saved": saved}
    assert motion_pixels(frame["tracks"]) <= 0.1  # of what is in the picture


@pytest.mark.parametrize("value", ["0.5", "0", "nan", "inf"])
def test_a_factor_below_1_is_a_slip(value: str, tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    assert main(["record", written(tmp_path, SUN), str(tmp_path / "a.exr"), "--outside-tolerance", value]) == 2
    assert "--outside-tolerance" in capfd.readouterr().err


def test_a_goal_in_pixels_is_of_what_is_in_the_picture(tmp_path: Path) -> None:
    scene = written(tmp_path, rigid("away", AWAY) + rigid("seen", SEEN) + SUN)
    stats = tmp_path / "stats.json"
    asked = ["-w", "480", "--spp", "1", "--target-error", "0.3px", "--stats", str(stats)]
    assert main(["record", scene, str(tmp_path / "out.exr"), *asked]) == 0
    frame = json.loads(stats.read_text())["frames"][0]
    away = next(track for track in frame["tracks"] if track["path"] == "/away")
    assert away["error_pixels"] > 0.33 and away["tolerance_pixels"] == pytest.approx(2.4)
    assert 0.0 < frame["budget"]["error_px"] <= 0.3 and frame["budget"]["misses"] == []


def test_rid_of_motion_is_rid_of_the_factor() -> None:
    assert rid_of("motion", Options.of({"outside-tolerance": 32.0})).plain()["outside-tolerance"] == 1.0


def through_a_long_lens(scene: Path, frame: float) -> Usd.Stage:
    """With eight times the focal length."""
    stage = open_stage(str(scene), Diagnostics(), ())
    found = read_frame(stage, frame, ReadSettings(width=16), Diagnostics()).camera.path
    stage.SetEditTarget(stage.GetSessionLayer())
    focal = UsdGeom.Camera(stage.GetPrimAtPath(found)).GetFocalLengthAttr()
    focal.Set(8.0 * focal.Get(frame))
    return stage


@pytest.mark.parametrize("name", ["debris", "showcase"])
def test_camera_rays_see_the_same_of_whole_scenes(name: str, tmp_path: Path) -> None:
    scene, frame = SHOWCASE, 6.0
    if name == "debris":
        scene, frame = tmp_path / "scene.usdc", 1.0
        SCENES[name].write(scene, 0.2)
    stage = through_a_long_lens(scene, frame)
    settings = ReadSettings(width=240, shutter=(-0.5, 0.5))
    fine, coarse = (read_frame(stage, frame, replace(settings, outside_tolerance=factor)) for factor in (1.0, 8.0))
    assert coarse.coarser_tracks.keys_saved > 0
    same_to_the_camera(rendered(fine, spp=4)[1], rendered(coarse, spp=4)[1])
