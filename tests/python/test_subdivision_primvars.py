"""Colours and materials on subdivision surfaces."""

from __future__ import annotations

import numpy as np
import pytest
from pxr import Gf, UsdGeom, UsdLux, UsdShade, Vt
from recording import Shot
from subdivision_stages import BLUE, GREEN, RED, WHITE, colour, picture, sheet
from test_subsets import material


@pytest.mark.parametrize(
    ("interpolation", "values", "indices"),
    [
        ("constant", [RED], None),
        ("uniform", [RED, GREEN, BLUE, WHITE], None),
        ("uniform", [WHITE, BLUE, GREEN, RED], [3, 2, 1, 0]),
        ("varying", [RED] * 9, None),
        ("vertex", [RED] * 9, None),
        ("vertex", [RED, GREEN], [0] * 9),
        ("faceVarying", [RED] * 4 + [GREEN] * 4 + [BLUE] * 4 + [WHITE] * 4, None),
        ("faceVarying", [WHITE, RED, GREEN, BLUE], [1] * 4 + [2] * 4 + [3] * 4 + [0] * 4),
    ],
)
def test_colours_of_every_interpolation(interpolation: str, values: list, indices: list[int] | None) -> None:
    shot = Shot((0.0, 0.0))
    colour(sheet(shot, 2), values, interpolation, indices)
    shot.camera.CreateFocalLengthAttr(150.0)
    UsdLux.DomeLight.Define(shot.stage, "/Dome")
    image = picture(shot)
    height, width = image.shape[:2]
    quarters = [image[height * 5 // 8, width * 7 // 16], image[height * 5 // 8, width * 9 // 16]]
    quarters += [image[height * 3 // 8, width * 7 // 16], image[height * 3 // 8, width * 9 // 16]]
    by_face = interpolation in ("uniform", "faceVarying")
    for found, expected in zip(quarters, (RED, GREEN, BLUE, WHITE) if by_face else (RED,) * 4, strict=True):
        assert found[:3] == pytest.approx(expected, abs=0.02)


def test_vertex_colours_are_smooth_and_varying_ones_linear() -> None:
    """Along a row whose values are 0, 0, 1, 0, 0: a B-spline's top is 2 / 3, a line's 1."""
    tops = {}
    for interpolation in ("vertex", "varying"):
        shot = Shot((0.0, 0.0))
        values = [WHITE if i % 5 == 2 else (0, 0, 0) for i in range(25)]
        colour(sheet(shot, 4), values, interpolation)
        shot.camera.CreateFocalLengthAttr(100.0)
        UsdLux.DomeLight.Define(shot.stage, "/Dome")
        image = picture(shot, width=192)
        tops[interpolation] = image[image.shape[0] // 2, 48:144, 0].max()
    assert tops["vertex"] == pytest.approx(2 / 3, abs=0.02)
    assert tops["varying"] == pytest.approx(1.0, abs=0.05)


def test_animated_colours_are_refined_at_every_key() -> None:
    shot = Shot((-0.5, 0.5))
    mesh = sheet(shot, 2)
    colour(mesh, [RED] * 9, "vertex")
    primvar = UsdGeom.PrimvarsAPI(mesh).GetPrimvar("displayColor")
    primvar.Set([Gf.Vec3f(0, 0, 0)] * 9, 9.5)
    primvar.Set([Gf.Vec3f(1, 0, 0)] * 9, 10.5)
    shot.camera.CreateFocalLengthAttr(150.0)
    UsdLux.DomeLight.Define(shot.stage, "/Dome")
    image = picture(shot)
    assert image[image.shape[0] // 2, image.shape[1] // 2, 0] == pytest.approx(0.5, abs=0.05)


def test_parts_keep_their_materials() -> None:
    shot = Shot((0.0, 0.0))
    mesh = sheet(shot, 2)
    subset = UsdGeom.Subset.CreateGeomSubset(mesh, "Part", "face", Vt.IntArray([1]), "materialBind")
    UsdShade.MaterialBindingAPI.Apply(subset.GetPrim()).Bind(material(shot.stage, "/Looks/Green", GREEN))
    shot.camera.CreateFocalLengthAttr(150.0)
    UsdLux.DomeLight.Define(shot.stage, "/Dome")
    image = picture(shot)
    height, width = image.shape[:2]
    green = image[height * 5 // 8, width * 9 // 16, :3]
    gloss = green[0]  # a UsdPreviewSurface of ior 1.5 reflects some of all colours, and lets the rest through
    assert 0.03 < gloss < 0.06
    assert green == pytest.approx(np.array(GREEN) * (1.0 - gloss) + gloss, abs=0.02)
    assert image[height * 5 // 8, width * 7 // 16, :3] == pytest.approx((0.18,) * 3, abs=0.02)
