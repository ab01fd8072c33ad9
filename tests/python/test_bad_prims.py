"""One bad prim does not cost the frame: what is wrong is named, and its neighbour is drawn."""

from __future__ import annotations

import numpy as np
import pytest
from msbvh.base.errors import SceneError
from msbvh.cli.main import main
from sound_neighbour import CAMERA, GOOD, messages, render, shows_good, stage_of

FAULTS = {
    "points_type": (
        'def Mesh "Bad" { int[] faceVertexCounts = [3]\n int[] faceVertexIndices = [0, 1, 2]\n'
        " int[] points = [0, 1, 2, 3]\n}",
        "/Bad.points: found int[], expected point3f[]",
    ),
    "counts_scalar": (
        'def Mesh "Bad" { int faceVertexCounts = 3\n int[] faceVertexIndices = [0, 1, 2]\n'
        " point3f[] points = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]\n}",
        "/Bad.faceVertexCounts: found int, expected int[]",
    ),
    "indices_huge": (
        'def Mesh "Bad" { int[] faceVertexCounts = [3]\n int64[] faceVertexIndices = [0, 1, 4294967298]\n'
        " point3f[] points = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]\n}",
        "/Bad.faceVertexIndices: found int64[]",
    ),
    "prototypes_as_attribute": (
        'def PointInstancer "Bad" { int[] prototypes = [0]\n int[] protoIndices = [0]\n'
        " point3f[] positions = [(0, 0, 0)]\n}",
        "/Bad.prototypes: found an attribute, expected a relationship",
    ),
    "light_focus_type": (
        'def SphereLight "Bad" (prepend apiSchemas = ["ShapingAPI"]) { bool inputs:shaping:focus = 0\n}',
        "/Bad.inputs:shaping:focus: found bool, expected float; the light is left out",
    ),
    "light_ies_type": (
        'def SphereLight "Bad" (prepend apiSchemas = ["ShapingAPI"]) { string inputs:shaping:ies:file = ""\n}',
        "/Bad.inputs:shaping:ies:file: found string, expected asset",
    ),
    "visibility_type": ('def Cube "Bad" { int visibility = 3\n}', "/Bad.visibility: found int, expected token"),
    "purpose_type": ('def Cube "Bad" { int[] purpose = [3]\n}', "/Bad.purpose: found int[], expected token"),
    "axis_token": ('def Cone "Bad" { uniform token axis = "W"\n}', "/Bad.axis: found 'W', expected X, Y or Z"),
    "radius_type": ('def Sphere "Bad" { string radius = "1"\n}', "/Bad.radius: found string, expected double"),
    "op_name": (
        'def Cube "Bad" { uniform token[] xformOpOrder = ["turned"]\n}',
        "/Bad.xformOpOrder: found 'turned'",
    ),
    "op_absent": (
        'def Cube "Bad" { uniform token[] xformOpOrder = ["xformOp:rotateX"]\n}',
        "/Bad.xformOpOrder: found 'xformOp:rotateX'",
    ),
    "op_value": (
        'def Cube "Bad" { int xformOp:scale = 3\n uniform token[] xformOpOrder = ["xformOp:scale"]\n}',
        "/Bad.xformOp:scale: found int, expected double3, float3 or half3",
    ),
    "op_of_a_parent": (
        'def Xform "Bad" { string xformOp:scale = "3"\n uniform token[] xformOpOrder = ["xformOp:scale"]\n'
        ' def Cube "Below" {}\n}',
        "/Bad.xformOp:scale: found string",
    ),
    "op_order_type": (
        'def Cube "Bad" { double3 xformOp:translate = (1, 2, 3)\n string[] xformOpOrder = ["xformOp:translate"]\n}',
        "/Bad.xformOpOrder: found string[], expected token[]",
    ),
    "inverse_of_singular": (
        'def Cube "Bad" { double3 xformOp:scale = (1, 0, 1)\n'
        ' uniform token[] xformOpOrder = ["!invert!xformOp:scale"]\n}',
        "/Bad.xformOp:scale",
    ),
    "inverse_of_a_singular_matrix": (
        'def Cube "Bad" { matrix4d xformOp:transform = ((1,0,0,0),(1,0,0,0),(0,0,1,0),(0,0,0,1))\n'
        ' uniform token[] xformOpOrder = ["!invert!xformOp:transform"]\n}',
        "/Bad.xformOp:transform",
    ),
    "temperature": (
        'def RectLight "Bad" { bool inputs:enableColorTemperature = 1\n float inputs:colorTemperature = nan\n}',
        "/Bad.inputs:colorTemperature: found nan",
    ),
    "instancer_positions": (
        'def PointInstancer "Bad" { rel prototypes = </Bad/P>\n int[] protoIndices = [0]\n'
        ' float[] positions = [1, 2, 3]\n def Cube "P" {}\n}',
        "/Bad.positions: found float[], expected point3f[]",
    ),
    "instancer_indices": (
        'def PointInstancer "Bad" { rel prototypes = </Bad/P>\n string protoIndices = "a"\n'
        ' point3f[] positions = [(1, 2, 3)]\n def Cube "P" {}\n}',
        "/Bad.protoIndices: found string, expected int[]",
    ),
}


@pytest.mark.parametrize("name", FAULTS)
def test_a_bad_prim_is_named_and_its_neighbour_drawn(name: str):
    text, expected = FAULTS[name]
    result, pixels = render(stage_of(CAMERA + GOOD + text))
    assert shows_good(pixels)
    found = [message for message in messages(result) if message.startswith(expected)]
    assert len(found) == 1, messages(result)


def test_a_shutter_of_another_type_is_named():
    camera = CAMERA.replace("double shutter:close = 0.5", "float[] shutter:close = [1]")
    result, pixels = render(stage_of(camera + GOOD))
    assert shows_good(pixels)
    assert "/Cam.shutter:close: found float[], expected double; ignored" in messages(result)


def test_velocities_without_a_rate_are_drawn():
    moving = """def Mesh "Moving" { point3f[] points.timeSamples = { 0: [(0,0,0),(1,0,0),(0,1,0)] }
    vector3f[] velocities.timeSamples = { 0: [(1,0,0),(1,0,0),(1,0,0)] }
    int[] faceVertexCounts = [3]\n int[] faceVertexIndices = [0, 1, 2]\n}"""
    result, pixels = render(stage_of(CAMERA + GOOD + moving, "(timeCodesPerSecond = 0)"))
    assert shows_good(pixels)
    assert any(m.startswith("timeCodesPerSecond: found 0, expected") for m in messages(result))


@pytest.mark.parametrize("kind", ["Xform", "SkelRoot", "Scope"])
def test_a_deep_hierarchy(kind: str):
    deep = f'def {kind} "x" {{\n' * 1500 + 'def Cube "c" {}\n' + "}\n" * 1500
    result, pixels = render(stage_of(CAMERA + GOOD + deep))
    assert shows_good(pixels)
    assert messages(result) == []


def test_absurd_extents_do_not_unframe_the_rest():
    square = "int[] faceVertexCounts = [4]\n int[] faceVertexIndices = [0, 1, 2, 3]\n"
    square += ' uniform token subdivisionScheme = "none"'
    text = "\n".join(
        f'def Mesh "{name}" {{ float3[] extent = [{extent}]\n {square}\n'
        f" point3f[] points = [({x}, -1, 0), ({x + 2}, -1, 0), ({x + 2}, 1, 0), ({x}, 1, 0)]\n}}"
        for name, extent, x in (
            ("A", "(3e38, 3e38, 3e38), (-3e38, -3e38, -3e38)", -3),
            ("B", "(-inf, -inf, -inf), (inf, inf, inf)", 1),
            ("C", "(nan, 0, 0), (1, 1, 1)", 5),
        )
    )
    result, pixels = render(stage_of(text))
    drawn = pixels[:, :, 3].max(axis=0)
    assert drawn[4:7].all() and drawn[14:18].all() and drawn[-7:-4].all()
    assert [m.split(":")[0] for m in messages(result)] == ["/A.extent", "/B.extent", "/C.extent"]


@pytest.mark.parametrize("w", ["1.0000000000000002", "0.9999999403953552"])
def test_rounding_in_the_last_column_is_no_projection(w: str):
    matrix = f"matrix4d xformOp:transform = ((1,0,0,0),(0,1,0,0),(0,0,1,0),(0,0,20,{w}))"
    camera = CAMERA.replace("double3 xformOp:translate = (0, 0, 20)", matrix).replace("translate", "transform")
    result, pixels = render(stage_of(camera + GOOD))
    assert shows_good(pixels) and messages(result) == []


def test_a_fault_of_an_outer_instancer_names_it():
    nested = """def PointInstancer "top" {
        quath[] orientations = [(0, 0, 0, 0)]\n point3f[] positions = [(-4, 0, 0)]\n int[] protoIndices = [0]
        rel prototypes = </top/nest>
        def PointInstancer "nest" {
            point3f[] positions = [(0, 0, 0)]\n int[] protoIndices = [0]\n rel prototypes = </top/nest/c>
            def Cube "c" {}\n }\n}"""
    result, pixels = render(stage_of(CAMERA + GOOD + nested))
    assert shows_good(pixels)
    (message,) = messages(result)
    assert message.startswith("/top.orientations: value 0")


def test_a_value_of_an_outer_instancer_that_is_no_number_names_it():
    nested = """def PointInstancer "top" {
        point3f[] positions = [(-4, 0, nan)]\n int[] protoIndices = [0]\n rel prototypes = </top/nest>
        def PointInstancer "nest" {
            point3f[] positions = [(0, 0, 0)]\n int[] protoIndices = [0]\n rel prototypes = </top/nest/c>
            def Cube "c" {}\n }\n}"""
    result, pixels = render(stage_of(CAMERA + GOOD + nested))
    assert shows_good(pixels)
    (message,) = messages(result)
    assert message.startswith("/top.positions: value 0")


def test_what_is_only_an_over_is_named():
    result, _ = render(stage_of(CAMERA + 'over "x" {\n def Cube "c" {}\n}'))
    found = messages(result)
    assert any(m.startswith("/x: found an over, expected a def") for m in found)
    assert not any("(/)" in m for m in found)


@pytest.mark.parametrize(
    "odd", ['string {} = "a"', 'token {} = "a"', "asset {} = @a@", 'string[] {} = ["a", "b"]', "bool {} = 1"]
)
def test_an_op_of_another_type_does_not_hide_the_one_that_is_nan(odd: str):
    ops = odd.format("xformOp:translate") + "\n    float xformOp:rotateX = nan"
    camera = CAMERA.replace("double3 xformOp:translate = (0, 0, 20)", ops)
    camera = camera.replace('["xformOp:translate"]', '["xformOp:translate", "xformOp:rotateX"]')
    with pytest.raises(SceneError, match=r"^/Cam\.xformOp:rotateX: found nan, expected finite numbers"):
        render(stage_of(camera + GOOD))


@pytest.mark.parametrize("name", ["horizontalApertureOffset", "verticalApertureOffset"])
@pytest.mark.parametrize("found", ["1e30", "-1e30", "inf", "nan"])
def test_an_aperture_offset_beyond_all_pixels_ends_the_run_with_its_name(name: str, found: str):
    camera = CAMERA.replace("}\n", f" float {name} = {found}\n}}\n")
    with pytest.raises(SceneError, match=rf"^/Cam\.{name}: found .*, expected a finite number"):
        render(stage_of(camera + GOOD))


def test_double_precision_and_integers_stand_for_single_precision():
    converted = GOOD.replace("point3f[]", "double3[]").replace("int[] face", "int64[] face")
    camera = CAMERA.replace("}\n", " int focalLength = 50\n double2 clippingRange = (1, 100)\n}\n")
    result, pixels = render(stage_of(camera + converted))
    assert shows_good(pixels) and messages(result) == []


CARRIED = """def Mesh "Carried" {
    int[] faceVertexCounts = [4]\n int[] faceVertexIndices = [0, 1, 2, 3]
    point3f[] points.timeSamples = { 0: [(-7, -3, 0), (-5, -3, 0), (-5, 3, 0), (-7, 3, 0)] }
    vector3f[] velocities.timeSamples = { 0: [(24, 0, 0), (24, 0, 0), (24, 0, 0), (24, 0, 0)] }
    uniform token subdivisionScheme = "none"\n}
def PointInstancer "Many" {
    point3f[] positions.timeSamples = { 0: [(-4, 2, 0)] }
    quath[] orientations.timeSamples = { 0: [(0, 0, 0, 1)] }
    vector3f[] velocities.timeSamples = { 0: [(24, 0, 0)] }
    int[] protoIndices = [0]\n rel prototypes = </Many/P>
    def Xform "P" {\n def Cube "c" {}\n def SphereLight "l" {\n float inputs:intensity = 30\n }\n }\n}
"""


@pytest.mark.parametrize("close", ["-0.5", "0.5"])
def test_what_usd_computes_is_the_same_from_values_that_convert(close: str):
    """Still frames of what velocities carry, and lights of instancers, are USD's own computation."""
    camera = CAMERA.replace("shutter:close = 0.5", f"shutter:close = {close}")
    converted = CARRIED.replace("point3f[]", "double3[]").replace("vector3f[]", "half3[]").replace("quath", "quatd")
    pictures = [render(stage_of(camera + GOOD + text)) for text in (CARRIED, converted)]
    for result, pixels in pictures:
        assert messages(result) == [] and shows_good(pixels)
    drawn = pictures[0][1][:, :, 3].sum()
    assert drawn > render(stage_of(camera + GOOD))[1][:, :, 3].sum() + 20
    assert np.abs(pictures[0][1] - pictures[1][1]).max() < 0.02


@pytest.mark.parametrize("rate", ["inf", "1e300", "1e-300"])
def test_a_frame_rate_that_no_image_can_hold_is_named_before_the_picture_is_written(rate: str, tmp_path, capfd):
    scene = tmp_path / "scene.usda"
    scene.write_text(f"#usda 1.0\n(framesPerSecond = {rate})\n{CAMERA}{GOOD}")
    pictures = [str(tmp_path / f"picture.{suffix}") for suffix in ("exr", "png")]
    assert main(["record", str(scene), *pictures, "-w", "32", "--spp", "1"]) == 0
    said = capfd.readouterr().err
    assert f"warning: framesPerSecond: found {float(rate):g}, expected a number from" in said


def test_a_start_time_that_is_no_number_is_an_error(tmp_path, capfd):
    scene = tmp_path / "scene.usda"
    scene.write_text(f"#usda 1.0\n(startTimeCode = nan)\n{CAMERA}{GOOD}")
    assert main(["record", str(scene), str(tmp_path / "o.png"), "-w", "32", "--spp", "1"]) == 1
    assert "error: startTimeCode: found nan, expected a finite number" in capfd.readouterr().err
    assert main(["record", str(scene), str(tmp_path / "o.png"), "--frames", "1", "-w", "32", "--spp", "1"]) == 0


def test_text_that_is_no_utf8(tmp_path, capfd):
    (tmp_path / "syntax.usda").write_bytes(b'#usda 1.0\ndef Xform "A" { # caf\xe9\n  oops caf\xe9\n}\n')
    assert main(["record", str(tmp_path / "syntax.usda"), str(tmp_path / "o.png")]) == 1
    said = capfd.readouterr().err
    assert "syntax.usda: cannot be read as USD: line 2" in said and "internal" not in said and said.count("\n") == 1
    text = (
        'def Cube "Bad" { token visibility = "caf\\xe9"\n uniform token[] xformOpOrder = ["\\xe9"]\n}\n'
        'def Mesh "Worse" { int[] faceVertexCounts = [3]\n int[] faceVertexIndices = [0, 1, 2]\n'
        " point3f[] points = [(-7, 0, 0), (-6, 0, 0), (-7, 1, 0)]\n"
        ' uniform token subdivisionScheme = "\\xe9"\n}'
    )
    result, pixels = render(stage_of(CAMERA + GOOD + text))
    assert shows_good(pixels)
    named = {message.split(":")[0] for message in messages(result)}
    assert {"/Bad.visibility", "/Worse.subdivisionScheme"} <= named
    assert capfd.readouterr().err == ""


@pytest.mark.parametrize("siblings", [0, 300])
def test_instances_nested_beyond_all_measure_are_named(siblings: int):
    """However many prototypes have been looked at before."""
    count = 400
    beside = "".join(
        f'def PointInstancer "s{i}" {{ point3f[] positions = [(0, 0, 900)]\n int[] protoIndices = [0]\n'
        f' rel prototypes = </s{i}/p>\n def Cube "p" {{}}\n}}\n'
        for i in range(siblings)
    )
    deep = "".join(
        f'def PointInstancer "i{i}" {{ point3f[] positions = [(0, 0, 0)]\n int[] protoIndices = [0]\n'
        f" rel prototypes = <{''.join(f'/i{j}' for j in range(i + 2))}>\n"
        for i in range(count)
    )
    result, pixels = render(stage_of(CAMERA + GOOD + beside + deep + f'def Cube "i{count}" {{}}\n' + "}\n" * count))
    assert shows_good(pixels)
    (message,) = messages(result)
    assert "found instances nested more than 100 deep" in message


NAN_TIMES = {
    "translate": 'def Cube "Bad" { double3 xformOp:translate.timeSamples = { nan: (0, 0, 0), 11: (1, 0, 0) }\n'
    ' uniform token[] xformOpOrder = ["xformOp:translate"]\n}',
    "above": 'def Xform "Bad" { float xformOp:rotateZ.timeSamples = { nan: 0, 11: 90 }\n'
    ' uniform token[] xformOpOrder = ["xformOp:rotateZ"]\n def Cube "Below" {}\n}',
    "points": 'def Mesh "Bad" { int[] faceVertexCounts = [3]\n int[] faceVertexIndices = [0, 1, 2]\n'
    " point3f[] points.timeSamples = { nan: [(0, 0, 0), (1, 0, 0), (0, 1, 0)], 11: [(0, 0, 0), (1, 0, 0), (0, 1, 1)] }\n}",
    "velocities": 'def Mesh "Bad" { int[] faceVertexCounts = [3]\n int[] faceVertexIndices = [0, 1, 2]\n'
    " point3f[] points.timeSamples = { 10: [(0, 0, 0), (1, 0, 0), (0, 1, 0)] }\n"
    " vector3f[] velocities.timeSamples = { nan: [(0, 0, 0), (1, 0, 0), (0, 1, 0)] }\n}",
    "visibility": 'def Cube "Bad" { token visibility.timeSamples = { nan: "invisible", 11: "inherited" }\n}',
    "radius": 'def Sphere "Bad" { double radius.timeSamples = { nan: 1, 11: 2 }\n}',
    "color": 'def Cube "Bad" { color3f[] primvars:displayColor.timeSamples = { nan: [(1, 0, 0)], 11: [(0, 1, 0)] }\n}',
    "intensity": 'def SphereLight "Bad" { float inputs:intensity.timeSamples = { nan: 1, 11: 2 }\n}',
    "texture": 'def DomeLight "Bad" { asset inputs:texture:file.timeSamples = { nan: @a.exr@, 11: @b.exr@ }\n}',
    "instancer": 'def PointInstancer "Bad" { rel prototypes = </Bad/Proto>\n int[] protoIndices = [0]\n'
    ' point3f[] positions.timeSamples = { nan: [(0, 0, 0)], 11: [(1, 0, 0)] }\n def Cube "Proto" {}\n}',
    "hidden": 'def PointInstancer "Bad" { rel prototypes = </Bad/Proto>\n'
    " int[] protoIndices.timeSamples = { nan: [0], 11: [0] }\n"
    ' int64[] invisibleIds.timeSamples = { nan: [], 11: [1] }\n point3f[] positions = [(0, 0, 0)]\n def Cube "Proto" {}\n}',
    "subset": 'def Mesh "Bad" { int[] faceVertexCounts = [3]\n int[] faceVertexIndices = [0, 1, 2]\n'
    " int[] holeIndices.timeSamples = { nan: [0], 11: [] }\n point3f[] points = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]\n"
    ' def GeomSubset "S" { int[] indices.timeSamples = { nan: [0], 11: [] }\n }\n}',
    "blur scale": 'def Cube "Bad" { float motion:blurScale.timeSamples = { nan: 1, 11: 2 }\n}',
}


@pytest.mark.parametrize("name", NAN_TIMES)
def test_samples_at_times_that_are_nan(name: str) -> None:
    """USD cannot even count them. The prim is drawn or named, everything else is drawn."""
    result, pixels = render(stage_of(CAMERA + GOOD + NAN_TIMES[name]))
    assert shows_good(pixels)
    assert np.isfinite(pixels).all()
    drawn = {track.path for track in result.tracks}
    assert (
        any(path.startswith("/Bad") for path in drawn)
        or name in ("intensity", "texture")
        or any(str(message).startswith("/Bad") for message in messages(result))
    )
