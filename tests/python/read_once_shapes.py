"""The cases of docs/design/read-once.md about prims that become meshes."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from drawn import apart
from nurbs_truth import bumpy
from pxr import Gf, Sdf, Vt
from read_once import SHUTTER, Case, case, named, set_in_turn
from recording import Shot, messages
from test_draw_mode import model
from test_tet_mesh import TETS, tets

_CHANGES = (9.0, 10.1)


@case("TetMesh.surfaceFaceVertexIndices")
def _surface() -> None:
    shot = Shot(SHUTTER)
    attribute = tets(shot).GetSurfaceFaceVertexIndicesAttr()
    set_in_turn(attribute, ([Gf.Vec3i(0, 1, 3)], [Gf.Vec3i(0, 1, 2)]), _CHANGES)
    named(shot, "/Tets.points", "topology")


@case("TetMesh.tetVertexIndices")
def _tetrahedra() -> None:
    shot = Shot(SHUTTER)
    attribute = tets(shot, surface=False).GetTetVertexIndicesAttr()
    set_in_turn(attribute, [[Gf.Vec4i(*each) for each in TETS[:count]] for count in (1, 2)], _CHANGES)
    named(shot, "/Tets.points", "topology")


_PATCH: dict[str, tuple[Any, Any]] = {
    "uVertexCount": (6, 5),
    "vOrder": (3, 2),
    "uKnots": (bumpy().u_knots, [0.0, 0, 0, 0, 1.5, 2, 3, 3, 3, 3]),
    "vRange": (Gf.Vec2d(0, 3), Gf.Vec2d(0, 2)),
}
"""Values before and after the change."""


def _patch(name: str) -> Case:
    def check() -> None:
        shot = Shot(SHUTTER)
        patch = bumpy().define(shot)
        set_in_turn(patch.GetPrim().GetAttribute(name), _PATCH[name], _CHANGES)
        named(shot, f"/Patch.{name}", "as the topology")

    return check


for _name in _PATCH:
    case(f"NurbsPatch.{_name}")(_patch(_name))


@case("NurbsPatch.trimCurve:counts")
def _trim_curves() -> None:
    shot = Shot(SHUTTER)
    set_in_turn(bumpy().define(shot).CreateTrimCurveCountsAttr(), ([1], [2]), _CHANGES)
    named(shot, "/Patch.trimCurve:counts", "not supported")


@case("NurbsPatch.pointWeights")
def _weights() -> None:
    shot, patch = Shot(SHUTTER), bumpy(rational=True)
    weights = patch.weights.ravel(), np.ones(patch.weights.size)
    set_in_turn(patch.define(shot).GetPointWeightsAttr(), [each.tolist() for each in weights], (9.0, 11.0))
    scene = shot.read(edge_length=0.0).scene
    for time01 in (0.0, 0.3, 1.0):
        share = (1.0 - 0.25 + 0.75 * time01) / 2.0
        patch.weights = (weights[0] * (1 - share) + weights[1] * share).reshape(patch.weights.shape)
        assert apart(scene.points("/Patch", time01), patch.surface()) < 2e-3


@case("extentsHint")
def _hint() -> None:
    shot = Shot(SHUTTER)
    found = model(shot, mode="cards")
    hint = found.GetPrim().CreateAttribute("extentsHint", Sdf.ValueTypeNames.Float3Array)
    set_in_turn(hint, [Vt.Vec3fArray([Gf.Vec3f(-size), Gf.Vec3f(size)]) for size in (1.0, 2.0)], (9.75, 10.5))
    scene = shot.read().scene
    for time01 in (0.0, 0.3, 1.0):
        assert np.abs(scene.points("/Model", time01)).max() == pytest.approx(1.0 + time01, abs=1e-4)


@case("model:cardTextureXPos")
def _card() -> None:
    shot = Shot(SHUTTER)
    attribute = model(shot, mode="cards").CreateModelCardTextureXPosAttr()
    set_in_turn(attribute, (Sdf.AssetPath("none.exr"), Sdf.AssetPath("other.exr")), _CHANGES)
    held = [text for text in messages(shot.read(), "warning") if "changes within the shutter" in text]
    assert held == ["/Model.model:cardTextureXPos: changes within the shutter; held the frame's value"]
