"""Instances are counted before anything else is read of them, and refused where they are too many."""

from __future__ import annotations

import time

import numpy as np
import pytest
from msbvh.base.errors import SceneError
from msbvh.scene.reader import ReadSettings
from pxr import Sdf, UsdGeom, UsdLux, Vt
from recording import Shot, messages

LIMIT = ReadSettings().max_instances


def instancer(shot: Shot, path: str, prototypes: list[str], count: int) -> UsdGeom.PointInstancer:
    points = UsdGeom.PointInstancer.Define(shot.stage, path)
    points.GetPrototypesRel().SetTargets(prototypes)
    indices = np.arange(count, dtype=np.int32) % len(prototypes)
    points.CreateProtoIndicesAttr(Vt.IntArray.FromNumpy(indices))
    points.CreatePositionsAttr(Vt.Vec3fArray(count))
    return points


def nested(shot: Shot, levels: int, width: int) -> None:
    """/P1 of a square, /P2 of /P1 and so on; none but the last stands in the world by itself."""
    shot.mesh("/Hidden/P0")
    for level in range(1, levels + 1):
        path = f"/P{level}" if level == levels else f"/Hidden/P{level}"
        instancer(shot, path, [f"/Hidden/P{level - 1}"], width)
    shot.stage.GetPrimAtPath("/Hidden").SetSpecifier(Sdf.SpecifierOver)


def native(shot: Shot, path: str, of: str) -> None:
    prim = UsdGeom.Xform.Define(shot.stage, path).GetPrim()
    prim.GetReferences().AddInternalReference(of)
    prim.SetInstanceable(True)


def refused(shot: Shot, **settings: int) -> str:
    """The error, which must come at once."""
    begin = time.process_time()
    with pytest.raises(SceneError) as error:
        shot.read(**settings)
        pytest.fail("read")
    assert time.process_time() - begin < 2.0
    assert "\n" not in str(error.value)
    return str(error.value)


def test_nested_instancers_that_multiply_beyond_all_bounds():
    shot = Shot()
    nested(shot, 8, 16)
    text = refused(shot)
    assert text.startswith("/P8.protoIndices: found 4294967296 instances")
    assert f"expected at most {LIMIT}" in text and "--max-instances" in text


def test_the_limit_can_be_moved():
    shot = Shot()
    nested(shot, 3, 10)
    assert "found 1000 instances" in refused(shot, max_instances=999)
    assert len(shot.read(max_instances=1000).scene.maps(0.5)) == 1000


def test_many_levels_of_native_instances():
    shot = Shot()
    shot.stage.CreateClassPrim("/A0")
    shot.mesh("/A0/Square")
    for level in range(1, 13):
        shot.stage.CreateClassPrim(f"/A{level}")
        for i in range(8):
            native(shot, f"/A{level}/I{i}", f"/A{level - 1}")
    native(shot, "/World/Top", "/A12")
    text = refused(shot)
    assert text.startswith(f"/World/Top: found {8**12} instances")


def test_native_instances_of_instancers_name_the_instancer():
    shot = Shot()
    shot.stage.CreateClassPrim("/Set")
    shot.mesh("/Set/Points/Square")
    instancer(shot, "/Set/Points", ["/Set/Points/Square"], 100_000)
    for i in range(200):
        native(shot, f"/World/I{i}", "/Set")
    text = refused(shot)
    assert text.startswith("/World/I0/Points.protoIndices: found 20000000 instances")


def test_a_wide_instancer_is_refused_before_its_arrays_are_read():
    shot = Shot()
    shot.mesh("/Points/Square")
    points = instancer(shot, "/Points", ["/Points/Square"], 1)
    points.GetProtoIndicesAttr().Set(Vt.IntArray(100_000_000))
    assert refused(shot).startswith("/Points.protoIndices: found 100000000 instances")


def test_several_that_are_too_many_together_name_the_largest():
    shot = Shot()
    shot.mesh("/Small/Square")
    instancer(shot, "/Small", ["/Small/Square"], 400)
    shot.mesh("/Large/Square")
    instancer(shot, "/Large", ["/Large/Square"], 700)
    text = refused(shot, max_instances=1000)
    assert text.startswith("/Large.protoIndices: found 700 instances of 1100 on the stage, expected at most 1000")


def test_what_is_not_drawn_does_not_count():
    shot = Shot()
    UsdGeom.Xform.Define(shot.stage, "/Points/Empty")
    shot.mesh("/Points/Square")
    points = instancer(shot, "/Points", ["/Points/Empty", "/Points/Square", "/Nowhere"], 3000)
    points.GetProtoIndicesAttr().Set([*[0] * 1000, *[1] * 10, *[2] * 1000, *[7] * 990])
    assert len(shot.read(max_instances=10).scene.maps(0.5)) == 10
    assert "found 10 instances" in refused(shot, max_instances=9)


def test_instances_that_show_lights_alone_count():
    shot = Shot()
    UsdLux.SphereLight.Define(shot.stage, "/Points/Light")
    instancer(shot, "/Points", ["/Points/Light"], 100)
    assert "found 100 instances" in refused(shot, max_instances=99)


def test_ways_through_nested_instancers_that_show_nothing_are_bounded_as_well():
    shot = Shot()
    UsdGeom.Xform.Define(shot.stage, "/Hidden/P0")
    for level in range(1, 60):
        for side in "AB":
            top = f"/Hidden/P{level}"
            instancer(shot, f"{top}/{side}", [f"/Hidden/P{level - 1}"], 1)
    shot.stage.GetPrimAtPath("/Hidden").SetSpecifier(Sdf.SpecifierOver)
    instancer(shot, "/Points", ["/Hidden/P59"], 1)
    assert "/Points.protoIndices: found" in refused(shot)


@pytest.mark.parametrize("count", [3, 14])
def test_prototypes_that_instance_each_other_are_errors_and_take_no_time(count):
    shot = Shot()
    names = [f"/P{i}" for i in range(count)]
    for name in names:
        shot.mesh(f"{name}/Square")
        instancer(shot, name, [*names, f"{name}/Square"], count + 1)
    begin = time.perf_counter()
    found = messages(shot.read(), "error")
    assert time.perf_counter() - begin < 5.0
    assert {text.split(".")[0] for text in found if "instances itself" in text} == set(names)


def test_the_command_line_refuses_with_one_line_and_exit_code_1(msbvh, tmp_path):
    shot = Shot()
    nested(shot, 8, 16)
    shot.stage.GetRootLayer().Export(str(tmp_path / "nest.usda"))
    for command in (("record", "nest.usda", "out.exr"), ("motion", "nest.usda")):
        run = msbvh(*command)
        assert run.returncode == 1
        (line,) = [line for line in run.stderr.splitlines() if "error" in line]
        assert "/P8.protoIndices: found 4294967296 instances" in line and "--max-instances" in line
    assert not (tmp_path / "out.exr").exists()
    run = msbvh("record", "nest.usda", "out.exr", "--max-instances", "100")
    assert run.returncode == 1 and "expected at most 100" in run.stderr
