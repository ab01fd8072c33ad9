"""Bad input: one clear message each, no crash, and the rest of the stage is read."""

from __future__ import annotations

import numpy as np
import pytest
from msbvh.base.errors import Diagnostics, SceneError
from msbvh.stage.opening import open_stage
from pxr import Sdf, Usd, UsdGeom
from recording import Recording, Shot, messages


def opened(path, mask=()) -> tuple[Usd.Stage, list[str]]:
    diagnostics = Diagnostics()
    return open_stage(str(path), diagnostics, mask), [str(d) for d in diagnostics]


def test_a_missing_file(tmp_path):
    with pytest.raises(SceneError, match=r"gone\.usda: no such file; expected a USD scene"):
        opened(tmp_path / "gone.usda")


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("syntax.usda", b'#usda 1.0\ndef "A" { this is not usd }\n'),
        ("header.usda", b"#usda1.0\n"),
        ("cut.usdc", b"PXR-USDC\x00\x08"),
        ("picture.png", b"\x89PNG"),
        ("empty.usda", b""),
    ],
)
def test_an_invalid_layer_is_one_line_without_usds_source_locations(tmp_path, name, content):
    (tmp_path / name).write_bytes(content)
    with pytest.raises(SceneError) as error:
        opened(tmp_path / name)
    text = str(error.value)
    assert text.startswith(str(tmp_path / name)) and "cannot be read as USD" in text
    assert "\n" not in text and ".cpp" not in text and "pxrInternal" not in text


def test_a_syntax_error_says_the_line(tmp_path, monkeypatch):
    (tmp_path / "syntax.usda").write_text('#usda 1.0\ndef "A" {\n')
    monkeypatch.chdir(tmp_path)
    for name in ("syntax.usda", tmp_path / "syntax.usda"):
        with pytest.raises(SceneError, match=f"^{name}: cannot be read as USD: line 3:"):
            opened(name)


def test_a_directory_is_no_scene(tmp_path):
    with pytest.raises(SceneError):
        opened(tmp_path)


def test_an_empty_stage(tmp_path):
    (tmp_path / "empty.usda").write_text("#usda 1.0\n")
    with pytest.raises(SceneError, match="the stage is empty: found no prims; expected at least one prim"):
        opened(tmp_path / "empty.usda")


def test_assets_that_do_not_resolve_are_warnings_that_name_asset_and_prim(tmp_path):
    stage = Usd.Stage.CreateNew(str(tmp_path / "root.usda"))
    stage.DefinePrim("/Referenced").GetReferences().AddReference("absent.usda")
    stage.DefinePrim("/Loaded").GetPayloads().AddPayload("unread.abc")
    stage.GetRootLayer().subLayerPaths.append("below.usda")
    stage.GetRootLayer().Save()
    _, warnings = opened(tmp_path / "root.usda")
    assert any(warning.startswith("/Referenced: ") and "absent.usda" in warning for warning in warnings)
    assert any(warning.startswith("/Loaded: ") and "unread.abc" in warning for warning in warnings)
    assert any("below.usda" in warning for warning in warnings)
    assert all("0x" not in warning and "\n" not in warning for warning in warnings)


def test_a_population_mask_limits_the_stage_and_bad_ones_are_errors(tmp_path):
    path = tmp_path / "root.usda"
    stage = Usd.Stage.CreateNew(str(path))
    for name in ("/A/X", "/A/Y", "/B"):
        stage.DefinePrim(name)
    stage.GetRootLayer().Save()
    masked, _ = opened(path, ["/A/X"])
    assert [str(p.GetPath()) for p in masked.Traverse()] == ["/A", "/A/X"]
    with pytest.raises(SceneError, match=r"mask: found '/A\.x', expected the absolute path of a prim"):
        opened(path, ["/A.x"])
    with pytest.raises(SceneError, match="mask: found the relative path 'A', expected an absolute one such as /A"):
        opened(path, ["A"])
    with pytest.raises(SceneError, match="found no prims under the mask /C"):
        opened(path, ["/C"])


def test_non_finite_points_reach_the_translators_gate_unchanged():
    shot = Shot()
    shot.mesh("/Bad", [(0, 0, 0), (float("nan"), 0, 0), (0, float("inf"), 0)])
    move = shot.mesh("/Good").AddTranslateOp()
    move.Set((0, 0, 0), 9.0)
    move.Set((1, 0, 0), 11.0)
    meshes = shot.read().scene.meshes
    assert np.isnan(meshes["/Bad"]["points"][0][1]).any()
    assert "/Good" in meshes


@pytest.mark.parametrize(
    ("attribute", "value"),
    [
        ("faceVertexIndices", [0, 1, 99]),
        ("faceVertexCounts", [3, 5]),
        ("faceVertexCounts", [-1]),
        ("holeIndices", [7]),
    ],
)
def test_bad_topology_reaches_the_translators_gate_unchanged(attribute, value):
    shot = Shot()
    mesh = shot.mesh("/Bad")
    mesh.GetPrim().GetAttribute(attribute).Set(value)
    recorded = shot.read().scene.meshes["/Bad"]
    key = {"faceVertexIndices": "face_vertex_indices", "faceVertexCounts": "face_vertex_counts"}
    assert recorded[key.get(attribute, "hole_indices")].tolist() == value


def test_matrices_that_are_not_finite_are_named_by_the_op_that_makes_them():
    shot = Shot()
    move = shot.mesh("/Mesh").AddTranslateOp()
    move.Set((0, 0, 0), 9.0)
    move.Set((float("nan"), 0, 0), 11.0)
    result = shot.read()
    assert "/Mesh" not in result.scene.meshes
    (error,) = messages(result, "error")
    assert error.startswith("/Mesh.xformOp:translate: found (nan, 0, 0) at shutter time 1.5 ")


def test_empty_meshes_are_notes_and_meshes_without_values_too():
    shot = Shot()
    UsdGeom.Mesh.Define(shot.stage, "/Bare")
    shot.mesh("/Empty", [])
    shot.stage.GetPrimAtPath("/Empty").GetAttribute("faceVertexCounts").Set([])
    result = shot.read()
    assert result.scene.meshes == {}
    (note,) = [n for n in messages(result, "note") if "empty" in n]
    assert note == "/Bare: empty: it has neither faces nor points at this frame (and 1 more prims)"


def test_blocked_samples_are_named():
    shot = Shot()
    points = shot.mesh("/Mesh").GetPointsAttr()
    points.Set([(0, 0, 0)] * 4, 9.8)
    points.Set(Sdf.ValueBlock(), 10.2)
    result = shot.read()
    (warning,) = messages(result, "warning")
    assert warning.startswith("/Mesh.points: found 0 values at shutter time") and "is held there" in warning


def test_a_primvar_of_the_wrong_type_is_left_out():
    shot = Shot()
    shot.mesh("/Mesh")
    layer = shot.stage.GetRootLayer()
    Sdf.AttributeSpec(layer.GetPrimAtPath("/Mesh"), "primvars:displayColor", Sdf.ValueTypeNames.StringArray)
    layer.GetAttributeAtPath("/Mesh.primvars:displayColor").default = ["red"]
    result = shot.read()
    assert result.scene.meshes["/Mesh"]["display_color"] is None
    (warning,) = messages(result, "warning")
    assert warning.startswith("/Mesh.primvars:displayColor: found string[], expected color3f[]; ignored")


def test_nothing_to_draw_is_said(monkeypatch):
    monkeypatch.setattr(Recording, "empty", True)
    assert any("nothing to draw" in message for message in messages(Shot().read(), "warning"))


def test_point_instancers_without_anything():
    shot = Shot()
    UsdGeom.PointInstancer.Define(shot.stage, "/Instancer")
    result = shot.read()
    assert "/Instancer: empty: it has no instances at this frame" in messages(result, "note")
