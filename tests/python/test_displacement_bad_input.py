"""What is wrong with a displacement, or not supported: one message, and the surface without it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from displaced_stages import ROUNDING, Displaced, flat, primvar, ramp, square, write
from pxr import Gf, UsdGeom
from recording import messages


def test_a_missing_primvar_is_its_fallback_and_said() -> None:
    shot = Displaced()
    shot.read_primvar("height", 0.5)
    flat(shot)
    result = shot.read(displacement="tessellate")
    assert np.abs(result.scene.points("/Sheet", 0.5)[:, 2] - 0.5).max() < ROUNDING
    assert messages(result, "warning") == [
        "/Sheet.primvars:height: is not there, or empty; displaced by what its reader falls back to"
    ]


def test_only_where_the_materials_output_is_connected() -> None:
    shot = Displaced(0.5)
    flat(shot)
    shot.material.GetDisplacementOutput().ClearSources()
    result = shot.read(displacement="tessellate")
    assert (result.scene.points("/Sheet", 0.5)[:, 2] == 0.0).all()
    said = "/Look/Surface.inputs:displacement: the material's outputs:displacement is not connected"
    assert [text for text in messages(result, "note") if text.startswith(said)] != []
    assert messages(result, "warning") == []


@pytest.mark.parametrize(
    ("amount", "found"), [(1e30, "1e+30"), (float("nan"), "nan"), (float("inf"), "inf"), (-1e13, "-1e+13")]
)
def test_a_constant_that_is_no_distance(amount: float, found: str) -> None:
    shot = Displaced(amount)
    flat(shot)
    result = shot.read(displacement="tessellate")
    assert (result.scene.points("/Sheet", 0.5)[:, 2] == 0.0).all()
    assert messages(result, "warning") == [
        f"/Look/Surface.inputs:displacement: found {found}, expected a finite number of at most 2^40 in size; drawn"
        " without displacement"
    ]


def test_coordinates_that_come_out_too_large() -> None:
    shot = Displaced(1e12)
    flat(shot).AddScaleOp().Set(Gf.Vec3f(1, 1, 1e7))
    result = shot.read()
    assert (result.scene.points("/Sheet", 0.5)[:, 2] == 0.0).all()
    (said,) = messages(result, "warning")
    assert said.startswith("/Sheet.material:binding: displaced to (") and said.endswith("drawn without displacement")


@pytest.mark.parametrize("bad", [1e30, float("nan"), float("-inf")])
def test_a_primvar_with_what_is_no_distance(bad: float) -> None:
    shot = Displaced()
    shot.read_primvar("height")
    mesh = flat(shot)
    primvar(mesh, "height", [0.5] * 7 + [bad] + [0.5] * 17, "vertex")
    result = shot.read(displacement="tessellate")
    assert (result.scene.points("/Sheet", 0.5)[:, 2] == 0.0).all()
    (said,) = messages(result, "warning")
    assert said.startswith("/Sheet.primvars:height: value 7 is ") and "drawn without displacement" in said


@pytest.mark.parametrize("bad", [float("nan"), float("inf"), 3e38])
def test_a_texture_with_what_is_no_distance(tmp_path: Path, bad: float) -> None:
    shot = Displaced()
    texels = ramp()
    texels[3, 5] = bad
    shot.read_texture(write(tmp_path / "bad.exr", texels))
    mesh = flat(shot)
    primvar(mesh, "st", square(np.array(mesh.GetPointsAttr().Get())), "vertex")
    result = shot.read(displacement="tessellate")
    assert (result.scene.points("/Sheet", 0.5)[:, 2] == 0.0).all()
    (said,) = messages(result, "warning")
    assert said.startswith("/Look/") and "drawn without displacement" in said


def test_an_implicit_shape_stays_as_it_is() -> None:
    shot = Displaced(0.5)
    shot.bound(UsdGeom.Sphere.Define(shot.stage, "/Ball"))
    result = shot.read(displacement="tessellate")
    assert np.linalg.norm(result.scene.points("/Ball", 0.5), axis=1).max() < 1.0001
    assert messages(result, "warning") == [
        "/Ball.material:binding: displacement of an implicit shape is not supported; drawn without it"
    ]
