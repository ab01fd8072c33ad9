"""`msbvh motion`: what it says of each prim, as JSON and as a table, and its exit codes."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import pytest
from conftest import MOVING_SQUARE
from msbvh.cli.main import main
from msbvh.motion.samples import SampleLog
from msbvh.motion_report.report import MOST_TIMES, motion_report
from msbvh.scene.reader import ReadSettings, read_frame
from pxr import Gf, Usd
from recording import Shot
from shared_scenes import SCENES, require

KEYS = {"path", "source", "rule", "samples", "track", "segments", "degree", "error_px", "bytes", "warnings"}
SCENE = """#usda 1.0
(
    startTimeCode = 10
    timeCodesPerSecond = 24
)
def Camera "cam"
{
    float2 clippingRange = (0.1, 100)
    float focalLength = 35
    float horizontalAperture = 24
    float verticalAperture = 16
    double shutter:open = -0.25
    double shutter:close = 0.25
    double3 xformOp:translate = (0, 0, 10)
    uniform token[] xformOpOrder = ["xformOp:translate"]
}
"""
SQUARE = """
    int[] faceVertexCounts = [4]
    int[] faceVertexIndices = [0, 1, 2, 3]
    uniform token subdivisionScheme = "none"
"""
CORNERS = "(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)"
STILL = f'def Mesh "still" {{ {SQUARE} point3f[] points = [{CORNERS}]\n }}\n'
SPIN = f"""
def Xform "spin"
{{
    float xformOp:rotateZ.timeSamples = {{ 8: 0, 12: 720 }}
    uniform token[] xformOpOrder = ["xformOp:rotateZ"]
    def Mesh "square" {{ {SQUARE} point3f[] points = [{CORNERS}]
    }}
}}
"""
CARRIED = f"""
def Mesh "carried" (prepend apiSchemas = ["MotionAPI"])
{{ {SQUARE}
    point3f[] points.timeSamples = {{ 10: [{CORNERS}], 11: [{CORNERS}] }}
    vector3f[] velocities.timeSamples = {{
        10: [{", ".join(["(24, 0, 0)"] * 4)}], 11: [{", ".join(["(0, 0, 0)"] * 4)}]
    }}
    vector3f[] accelerations.timeSamples = {{
        10: [{", ".join(["(0, 999, 0)"] * 4)}], 11: [{", ".join(["(0, 0, 0)"] * 4)}]
    }}
    int motion:nonlinearSampleCount = 9
}}
"""
INSTANCER = f"""
def PointInstancer "dots"
{{
    rel prototypes = </dots/dot>
    int[] protoIndices = [0, 0, 0]
    point3f[] positions.timeSamples = {{
        9: [(-3, 0, 0), (0, 0, 0), (3, 0, 0)], 11: [(-3, 1, 0), (0, 1, 0), (3, 1, 0)]
    }}
    def Mesh "dot" {{ {SQUARE} point3f[] points = [{CORNERS}]
    }}
}}
"""

Motion = Callable[..., tuple[int, Any, str]]


@pytest.fixture
def motion(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> Motion:
    """The exit code, what stdout has (parsed, with --json) and stderr, of the command on a scene of these parts."""

    def run(parts: str | Path, *arguments: object) -> tuple[int, Any, str]:
        path = parts
        if isinstance(parts, str):
            path = tmp_path / "scene.usda"
            path.write_text(SCENE + parts)
        code = main(["motion", str(path), *map(str, arguments)])
        out, err = capfd.readouterr()
        return code, json.loads(out) if "--json" in arguments and out else out, err

    return run


def prim_of(report: Any, path: str) -> dict:
    (found,) = [prim for prim in report["prims"] if prim["path"] == path]
    return found


def samples_of(prim: dict, attribute: str) -> dict:
    (found,) = [samples for samples in prim["samples"] if samples["attribute"] == attribute]
    return found


def test_json_has_the_camera_the_shutter_and_every_prim(motion: Motion) -> None:
    code, report, err = motion(STILL + SPIN + INSTANCER, "--json")
    assert (code, err) == (0, "")
    assert (report["camera"], report["shutter"], report["frame"]) == ("/cam", [-0.25, 0.25], 10)
    assert [prim["path"] for prim in report["prims"]] == [
        "/cam",
        "/still",
        "/spin/square",
        "/dots/dot",
        "/dots",
    ]
    for prim in report["prims"]:
        assert prim.keys() >= KEYS
        assert (prim["track"] == "still") == (prim["segments"] == 0)
        assert prim["error_px"] <= report["tolerance_px"] == 0.1
        assert prim["bytes"] > 0 and prim["warnings"] == []
        for samples in prim["samples"]:
            assert samples.keys() >= {"attribute", "times", "authored"}
            assert samples["times"] == sorted(samples["times"]) and len(samples["times"]) <= MOST_TIMES


def test_a_transform_names_the_op_of_the_ancestor_and_what_was_computed(motion: Motion) -> None:
    _, report, _ = motion(SPIN, "--json")
    square = prim_of(report, "/spin/square")
    assert (square["source"], square["track"]) == ("transform", "moving transform")
    op = samples_of(square, "/spin.xformOp:rotateZ")
    assert (op["times"], op["authored"]) == ([8, 12], True)
    dense = samples_of(square, "/spin/square.xformOpOrder")
    assert not dense["authored"] and dense["count"] > MOST_TIMES == len(dense["times"])
    assert (dense["times"][0], dense["times"][-1]) == (9.75, 10.25)


def test_velocities_and_accelerations_win_and_are_exact(motion: Motion) -> None:
    code, report, _ = motion(CARRIED, "--json")
    carried = prim_of(report, "/carried")
    assert code == 0
    assert (carried["source"], carried["track"], carried["segments"]) == ("accelerations", "quadratic", 1)
    assert "velocities and accelerations win" in carried["rule"]
    assert "motion:nonlinearSampleCount 9 is not needed" in carried["rule"]
    for name in ("points", "velocities", "accelerations"):
        samples = samples_of(carried, f"/carried.{name}")
        assert samples["authored"] and samples["times"][0] == 10


def test_unused_velocities_are_a_warning_of_their_prim(motion: Motion) -> None:
    shifted = CARRIED.replace("velocities.timeSamples = {\n        10:", "velocities.timeSamples = {\n        9.5:")
    code, report, err = motion(shifted, "--json")
    assert code == 0
    assert any("velocities: not used" in warning for warning in prim_of(report, "/carried")["warnings"])
    assert "/carried.velocities: not used" in err


def test_motion_with_breakpoints_between_keys_is_kept_under_a_time_remap(motion: Motion) -> None:
    ops = "double3 xformOp:translate.timeSamples = { 9: (0, 0, 0), 10.1: (1, 0, 0), 11: (0, 3, 0) }"
    bent = SPIN.replace("float xformOp:rotateZ.timeSamples = { 8: 0, 12: 720 }", ops).replace("rotateZ", "translate")
    code, report, _ = motion(bent, "--json")
    square = prim_of(report, "/spin/square")
    assert samples_of(square, "/spin.xformOp:translate")["times"] == [9, 10.1, 11]
    assert (code, square["track"]) == (0, "moving transform under a time remap")


def test_a_held_stage_says_so() -> None:
    """No scene file can ask for it, but whoever opens the stage."""
    shot = Shot()
    mesh = shot.mesh("/square")
    for time, x in ((9.0, 0.0), (10.1, 1.0)):
        mesh.GetPointsAttr().Set([Gf.Vec3f(x + i % 2, i // 2, 0) for i in (0, 1, 3, 2)], time)
    shot.stage.SetInterpolationType(Usd.InterpolationTypeHeld)
    log = SampleLog()
    result = read_frame(shot.stage, 10.0, ReadSettings(), found=log)
    (square,) = motion_report(shot.stage, 10.0, result, log, 0.1, "/square").prims
    assert square.rule == "samples held until the next"
    assert square.samples[0].times == (9.0, 10.1)
    assert "under a time remap" in square.track


def test_splines_name_their_knots(motion: Motion) -> None:
    knots = "float xformOp:rotateZ.spline = { bezier, 8: 0; post curve (1, 0), 12: 90; pre (1, 0), }"
    spline = SPIN.replace("float xformOp:rotateZ.timeSamples = { 8: 0, 12: 720 }", knots)
    code, report, _ = motion(spline, "--json")
    samples = samples_of(prim_of(report, "/spin/square"), "/spin.xformOp:rotateZ")
    assert (code, samples["times"], samples["authored"]) == (0, [8, 12], False)
    _, text, _ = motion(spline, "/spin")
    assert "a spline with knots at 2 times: 8, 12" in text


def test_visibility_is_a_part_of_the_track(motion: Motion) -> None:
    blink = STILL.replace("{", '{ token visibility.timeSamples = { 9: "inherited", 10.1: "invisible" }', 1)
    code, report, _ = motion(blink, "--json")
    still = prim_of(report, "/still")
    assert (code, still["track"]) == (0, "still, visible for a part of the shutter")
    assert samples_of(still, "/still.visibility")["times"] == [9, 10.1]
    assert "/still" in motion(blink)[1]


def test_instancers_name_their_arrays_and_count(motion: Motion) -> None:
    _, report, _ = motion(INSTANCER, "--json")
    dots = prim_of(report, "/dots")
    assert (dots["source"], dots["track"], dots["count"]) == ("instances", "moving transform", 3)
    assert samples_of(dots, "/dots.positions") == {
        "attribute": "/dots.positions",
        "times": [9, 11],
        "authored": True,
        "count": 2,
    }
    assert "/dots (x 3)" in motion(INSTANCER)[1]


NATIVE = f"""
class Xform "shared" {{ {STILL} }}
def Xform "row"
{{
    double3 xformOp:translate.timeSamples = {{ 9: (0, 0, 0), 11: (1, 0, 0) }}
    uniform token[] xformOpOrder = ["xformOp:translate"]
    def Xform "a" (instanceable = true
        references = </shared>) {{ }}
    def Xform "b" (instanceable = true
        references = </shared>) {{ }}
}}
"""


def test_an_instance_that_moves_like_others_can_be_asked_for(motion: Motion) -> None:
    _, report, _ = motion(NATIVE, "/row/b", "--json")
    assert {prim["path"] for prim in report["prims"]} == {"/row/a/still", "/row/b"}, "itself and what it shows"
    instance = prim_of(report, "/row/b")
    assert instance["count"] == 2
    assert samples_of(instance, "/row.xformOp:translate")["times"] == [9, 11]


def test_an_instance_that_goes_within_the_shutter_says_so(motion: Motion) -> None:
    visibility = 'token visibility.timeSamples = { 9: "inherited", 10.1: "invisible" }'
    blink = NATIVE.replace('"row"\n{', '"row"\n{ ' + visibility)
    _, report, _ = motion(blink, "/row", "--json")
    instance = prim_of(report, "/row/a")
    assert instance["track"] == "moving transform, visible for a part of the shutter"
    assert samples_of(instance, "/row.visibility")["times"] == [9, 10.1]


def test_the_parts_of_a_mesh_are_one_prim(motion: Motion) -> None:
    subsets = "".join(
        f"""    def GeomSubset "part{i}" (prepend apiSchemas = ["MaterialBindingAPI"])
    {{
        uniform token elementType = "face"
        uniform token familyName = "materialBind"
        int[] indices = [{i}]
    }}\n"""
        for i in range(2)
    )
    two = SQUARE.replace("[4]", "[3, 3]").replace("[0, 1, 2, 3]", "[0, 1, 2, 0, 2, 3]")
    parts = f'def Mesh "parts" {{ {two} point3f[] points = [{CORNERS}]\n{subsets} }}\n'
    _, report, _ = motion(parts, "--json")
    assert prim_of(report, "/parts")["bytes"] == 4 * 12


@pytest.mark.parametrize(
    ("prim", "paths"),
    [
        ("/spin/square", ["/spin/square"]),
        ("spin", ["/spin/square"]),
        ("/cam", ["/cam"]),
        ("/dots", ["/dots/dot", "/dots"]),
    ],
)
def test_a_prim_limits_the_report(motion: Motion, prim: str, paths: Sequence[str]) -> None:
    code, report, _ = motion(STILL + SPIN + INSTANCER, prim, "--json")
    assert (code, [found["path"] for found in report["prims"]]) == (0, paths)


@pytest.mark.parametrize(
    ("prim", "message"),
    [
        ("/spin/sqare", "/spin/sqare: found no such prim; /spin has square"),
        ("/nowhere", "/nowhere: found no such prim; / has cam, still"),
        ("a b", "PRIM: found 'a b', expected the path of a prim"),
        ("/empty", "/empty: found nothing drawn there (a Scope)"),
    ],
)
def test_an_unknown_prim_is_one_clear_error(motion: Motion, prim: str, message: str) -> None:
    code, out, err = motion(STILL + SPIN + 'def Scope "empty" { }\n', prim)
    assert (code, out) == (1, "")
    assert err.startswith("msbvh: error: ") and message in err and err.count("\n") == 1


def test_the_table_shows_what_moves_and_counts_what_is_still(motion: Motion) -> None:
    code, text, err = motion(STILL + SPIN)
    lines = text.splitlines()
    assert (code, err) == (0, "")
    assert "frame 10, /cam, shutter -0.25 to +0.25 frames" in lines[0]
    assert lines[1].split()[0] == "prim"
    assert lines[2].split()[:4] == ["/spin/square", "transform", "moving", "transform,"]
    assert lines[3:] == ["1 prim moves, 2 are still; --verbose lists them"]


def test_a_named_or_verbose_prim_shows_rule_and_samples(motion: Motion) -> None:
    named, verbose = motion(STILL, "/still")[1], motion(STILL, "--verbose")[1]
    for text in (named, verbose):
        assert "rule     still" in text
        assert "points  authored for all times" in text
    assert "/cam" not in named.splitlines()[1] and any(line.startswith("/cam") for line in verbose.splitlines())


def test_a_missed_tolerance_is_exit_code_1_after_the_report(motion: Motion) -> None:
    few = ("--segments", 1, "--interpolation", "linear")
    code, report, err = motion(STILL + SPIN, "--json", *few)
    square = prim_of(report, "/spin/square")
    assert (code, square["segments"], square["degree"]) == (1, 1, 1)
    assert square["error_px"] > 10 and any("deviates" in warning for warning in square["warnings"])
    said = "msbvh: error: 1 track misses the tolerance of 0.1 px: /spin/square by "
    assert err.splitlines()[-1].startswith(said)
    code, text, err = motion(STILL + SPIN, "/spin", *few)
    assert code == 1 and " ! " in text and err.count("\n") == 1
    assert motion(STILL + SPIN, "/still", *few)[0] == 0


@pytest.mark.parametrize(
    "arguments",
    [("--segments", 3), ("--interpolation", "nurbs"), ("-f", "1:2"), ("-f", "x"), ("-f", 1, "-d")],
)
def test_usage(motion: Motion, arguments: Sequence[object]) -> None:
    code, out, err = motion(STILL, *arguments)
    assert (code, out) == (2, "")
    assert err.count("\n") == 1


def test_a_closed_shutter_is_said(motion: Motion) -> None:
    code, text, _ = motion(SPIN, "-d")
    assert code == 0
    assert "default time" in text and "nothing moves" in text


def test_a_stage_without_a_camera_has_a_report(motion: Motion, tmp_path: Path) -> None:
    path = tmp_path / "bare.usda"
    path.write_text("#usda 1.0\n" + STILL)
    code, report, err = motion(path, "--json")
    assert (code, report["camera"]) == (0, "framing camera")
    assert "Ill-formed" not in err


def test_moving_square_of_the_suite(motion: Motion, tmp_path: Path) -> None:
    path = tmp_path / "square.usda"
    path.write_text(MOVING_SQUARE)
    square = prim_of(motion(path, "--json")[1], "/world/square")
    assert samples_of(square, "/world/square.xformOp:translate")["times"] == [0, 4]


@pytest.mark.shared
def test_skinned_points_are_computed(motion: Motion, tmp_path: Path) -> None:
    """CesiumMan has one animation and one mesh, and no camera."""
    require(SCENES / "skinned/CesiumMan")
    (scene,) = (SCENES / "skinned/CesiumMan").rglob("*.usd[acz]")
    path = tmp_path / "skinned.usda"
    camera = SCENE.replace("startTimeCode = 10", f"subLayers = [@{scene}@]\n    startTimeCode = 10")
    path.write_text(camera)
    _, report, _ = motion(path, "--json", "-f", 10)
    (mesh,) = [prim for prim in report["prims"] if prim["source"] == "points"]
    assert "computed points" in mesh["rule"]
    points = samples_of(mesh, f"{mesh['path']}.points")
    assert not points["authored"] and points["count"] > 1
    assert any(s["attribute"].endswith(".rotations") and s["authored"] for s in mesh["samples"])
