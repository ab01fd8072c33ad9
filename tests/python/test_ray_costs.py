"""What rays cost, from a stage: Renderer.ray_costs() and `record --ray-costs`."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from conftest import Run
from msbvh import _core
from msbvh.base.errors import Diagnostics
from msbvh.base.exit_codes import USAGE
from msbvh.bench.frame_scenes import FRAME, SCENES
from msbvh.scene.reader import ReadSettings, read_frame
from msbvh.stage.opening import open_stage
from pxr import Gf, Usd, UsdGeom, Vt

WIDTH = 60


@pytest.fixture
def stage() -> Usd.Stage:
    """A dense sheet on the left half of the picture, a card in the right one, and the sheet again far outside."""
    stage = Usd.Stage.CreateInMemory()
    camera = UsdGeom.Camera.Define(stage, "/camera")
    camera.CreateProjectionAttr("orthographic")
    camera.CreateHorizontalApertureAttr(40.0)
    camera.CreateVerticalApertureAttr(20.0)
    camera.CreateClippingRangeAttr(Gf.Vec2f(0.1, 100.0))
    camera.AddTranslateOp().Set(Gf.Vec3d(0, 0, 10))
    add_sheet(stage, "/sheet", 40, -1.0)
    add_sheet(stage, "/card", 1, 1.0)
    add_sheet(stage, "/outside", 40, 500.0)
    return stage


def add_sheet(stage: Usd.Stage, path: str, faces: int, x: float) -> UsdGeom.Mesh:
    """`faces`^2 squares over [-0.8, 0.8]^2 around (x, 0), uneven so that no leaf has a whole row."""
    across = np.linspace(-0.8, 0.8, faces + 1)
    u, v = np.meshgrid(across, across, indexing="ij")
    points = np.stack([u + x, v, 0.1 * np.sin(9 * u) * np.cos(8 * v)], axis=-1).reshape(-1, 3).astype(np.float32)
    first = (np.arange(faces)[:, None] * (faces + 1) + np.arange(faces)).ravel()
    corners = np.stack([first, first + faces + 1, first + faces + 2, first + 1], axis=1).astype(np.int32)
    mesh = UsdGeom.Mesh.Define(stage, path)
    mesh.CreatePointsAttr(Vt.Vec3fArray.FromNumpy(points))
    mesh.CreateFaceVertexIndicesAttr(Vt.IntArray.FromNumpy(corners.ravel()))
    mesh.CreateFaceVertexCountsAttr(Vt.IntArray.FromNumpy(np.full(len(corners), 4, np.int32)))
    mesh.CreateSubdivisionSchemeAttr("none")
    return mesh


def renderer_of(stage: Usd.Stage, threads: int = 0, spp: int = 2) -> _core.Renderer:
    result = read_frame(stage, None, ReadSettings(width=WIDTH))
    return _core.Renderer(
        result.scene, width=result.camera.width, height=result.camera.height, spp=spp, threads=threads
    )


def costs_of(stage: Usd.Stage, threads: int = 0) -> _core.RayCosts:
    return renderer_of(stage, threads).ray_costs(camera_samples=2000)


def prim(costs: _core.RayCosts, path: str) -> _core.PrimCosts:
    return next(row for row in costs["prims"] if row["path"] == path)


def check_sums(costs: _core.RayCosts) -> None:
    prims = costs["prims"]
    assert sum(row["share"] for row in prims) + costs["empty_share"] == pytest.approx(1.0)
    assert sum(row["build_share"] for row in prims) == pytest.approx(1.0)
    nodes = sum(row["nodes"] for row in prims) + costs["empty_nodes"]
    assert nodes == pytest.approx(costs["nodes_per_ray"] * costs["rays"])
    assert sum(row["blocks"] for row in prims) == pytest.approx(costs["blocks_per_ray"] * costs["rays"])
    assert sum(row["tests"] for row in prims) == pytest.approx(costs["tests_per_ray"] * costs["rays"])


def test_shares_go_to_the_prims_that_rays_test(stage: Usd.Stage) -> None:
    costs = costs_of(stage)
    check_sums(costs)
    assert prim(costs, "/sheet")["share"] > 2 * prim(costs, "/card")["share"] > 0.0
    assert prim(costs, "/outside")["share"] < 0.01
    assert prim(costs, "/outside")["build_share"] == pytest.approx(prim(costs, "/sheet")["build_share"], rel=0.1)
    assert prim(costs, "/card")["build_share"] < 0.01
    assert costs["camera"]["rays"] == costs["paths"] < costs["rays"]


def test_a_prim_that_is_switched_off_is_gone_and_the_rest_goes_up(stage: Usd.Stage) -> None:
    before = costs_of(stage)
    stage.GetPrimAtPath("/sheet").SetActive(False)
    after = costs_of(stage)
    assert [row["path"] for row in after["prims"]] == ["/card", "/outside"]
    assert prim(after, "/card")["share"] > prim(before, "/card")["share"]
    check_sums(after)
    assert after["cost"] < before["cost"]


def test_prims_stand_in_the_order_of_mesh_names(stage: Usd.Stage) -> None:
    result = read_frame(stage, None, ReadSettings(width=WIDTH))
    renderer = _core.Renderer(result.scene, width=WIDTH, height=30)
    assert [row["path"] for row in renderer.ray_costs()["prims"]] == result.scene.mesh_names


def test_all_samples_are_the_rays_of_the_frame(stage: Usd.Stage) -> None:
    renderer = renderer_of(stage)
    renderer.render()
    costs = renderer.ray_costs(camera_samples=10**9)
    assert costs["rays"] == renderer.statistics["rays"]
    assert costs["camera"]["rays"] == renderer.statistics["camera_rays"] == costs["paths"]


def test_the_same_on_any_number_of_threads(stage: Usd.Stage) -> None:
    one, three = costs_of(stage, 1), costs_of(stage, 3)
    for costs in (one, three):
        for row in costs["prims"]:
            row["build_share"] = 0.0  # Which is measured.
    assert one == three


def test_instances_count_for_the_mesh_that_they_show(tmp_path: Path) -> None:
    path = tmp_path / "crowd.usdc"
    SCENES["crowd"].write(path, 0.1)
    stage = open_stage(str(path), Diagnostics())
    result = read_frame(stage, FRAME, ReadSettings(width=WIDTH))
    renderer = _core.Renderer(result.scene, width=result.camera.width, height=result.camera.height)
    costs = renderer.ray_costs(camera_samples=1000)
    check_sums(costs)
    assert costs["instances_per_ray"] > 0.1
    shown = [row for row in costs["prims"] if row["path"] != "/ground"]
    assert len(shown) == 3
    assert all(row["share"] > 0.0 and row["build_share"] > 0.0 for row in shown)
    assert sum(row["instances"] for row in shown) == pytest.approx(costs["instances_per_ray"] * costs["rays"])


def test_progress_is_told_and_stops_it(stage: Usd.Stage) -> None:
    renderer = renderer_of(stage, spp=16)
    told: list[float] = []
    renderer.ray_costs(camera_samples=10**9, progress=told.append)
    assert told == sorted(told) and told[-1] == 1.0 and len(told) > 1

    def stop(done: float) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        renderer.ray_costs(progress=stop)


def test_no_samples_are_an_error(stage: Usd.Stage) -> None:
    with pytest.raises(_core.Error, match=r"camera_samples: found 0; expected at least 1"):
        renderer_of(stage).ray_costs(camera_samples=0)


SMALL = ("-w", 48, "--spp", 4)


def test_record_writes_them_where_asked(msbvh: Run, tmp_path: Path, scene: Path) -> None:
    done = msbvh("record", scene, "a.exr", "--stats", "s.json", "--ray-costs", *SMALL)
    assert done.returncode == 0, done.stderr
    frame = json.loads((tmp_path / "s.json").read_text())["frames"][0]
    costs = frame["render"]["ray_costs"]
    assert [row["path"] for row in costs["prims"]] == ["/world/square"]
    assert costs["prims"][0]["share"] + costs["empty_share"] == pytest.approx(1.0)
    assert costs["camera"]["rays"] == 48 * 32 * 4
    assert frame["seconds"]["ray_costs"] > 0.0
    assert "ray" not in done.stdout + done.stderr


def test_record_leaves_them_out_else(msbvh: Run, tmp_path: Path, scene: Path) -> None:
    done = msbvh("record", scene, "a.exr", "--stats", "s.json", *SMALL)
    assert done.returncode == 0, done.stderr
    frame = json.loads((tmp_path / "s.json").read_text())["frames"][0]
    assert "ray_costs" not in frame["render"] and "ray_costs" not in frame["seconds"]


def test_they_need_a_file_to_go_to(msbvh: Run, scene: Path) -> None:
    done = msbvh("record", scene, "a.exr", "--ray-costs", *SMALL)
    assert done.returncode == USAGE
    assert "--ray-costs: found no --stats FILE.json to write them to" in done.stderr
