"""msbvh record --target-error, --target-flip, --time-budget: what they pick, and that it holds."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import OpenImageIO as oiio
import pytest
from conftest import Run
from msbvh import _core
from msbvh.output.flip import flip_map
from msbvh.output.images import read_colour
from msbvh.render.budget import COUNTED, Goals, render_within
from msbvh.render.fine_enough import FineEnough
from msbvh.render.sample_sum import SampleSum
from msbvh.scene.reader import ReadResult, ReadSettings, read_frame
from pxr import Usd, UsdGeom
from test_accuracy import arc

SIZE = ("--resolution", 32, 32, "--exr-float")


def recorded(msbvh: Run, folder: Path, *arguments: object, code: int = 0) -> dict[str, Any]:
    """A frame's statistics."""
    scene = folder / "arc.usda"
    if not scene.exists():
        arc(scene)
    done = msbvh("record", scene, "o.exr", "--stats", "s.json", *SIZE, *arguments)
    assert done.returncode == code, done.stderr
    frame: dict[str, Any] = json.loads((folder / "s.json").read_text())["frames"][0]
    return {**frame, "said": done.stderr}


@pytest.mark.parametrize("wanted", [0.1, 0.03])
def test_flip_beside_a_converged_picture_is_no_more_than_promised(wanted: float, msbvh: Run, tmp_path: Path) -> None:
    found = recorded(msbvh, tmp_path, "--target-flip", wanted)["budget"]
    picture = read_colour(tmp_path / "o.exr")
    recorded(msbvh, tmp_path, "--spp", 1024, "--seed", 9)
    true = float(flip_map(read_colour(tmp_path / "o.exr"), picture).mean())
    assert true <= 1.1 * wanted and found["misses"] == []
    # Rather too much than too little, but not by more than halves of one sequence bring.
    assert 0.5 * found["flip"] <= true <= 1.1 * found["flip"]


def test_less_error_takes_more_samples(msbvh: Run, tmp_path: Path) -> None:
    samples = [recorded(msbvh, tmp_path, "--target-flip", wanted)["budget"]["samples"] for wanted in (0.1, 0.03, 0.01)]
    assert samples[0] < samples[1] < samples[2]


def test_the_error_of_motion_is_kept_or_the_command_fails(msbvh: Run, tmp_path: Path) -> None:
    tight = recorded(msbvh, tmp_path, "--target-error", "0.5px", "--spp", 1)
    assert 0.0 < tight["budget"]["error_px"] <= 0.5
    loose = recorded(msbvh, tmp_path, "--target-error", "3px", "--spp", 1)
    assert tight["budget"]["error_px"] < loose["budget"]["error_px"] <= 3.0
    missed = recorded(msbvh, tmp_path, "--target-error", "1e-12px", "--spp", 1, code=1)
    assert "--target-error 1e-12px: /square is off by" in missed["said"]
    assert (tmp_path / "o.exr").exists()


def cube(path: Path) -> str:
    """A cage of catmullClark that fills the picture."""
    stage = Usd.Stage.CreateNew(str(path))
    mesh = UsdGeom.Mesh.Define(stage, "/cube")
    mesh.CreatePointsAttr([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    mesh.CreateFaceVertexCountsAttr([4] * 6)
    mesh.CreateFaceVertexIndicesAttr([0, 1, 3, 2, 4, 6, 7, 5, 0, 4, 5, 1, 2, 3, 7, 6, 0, 2, 6, 4, 1, 5, 7, 3])
    mesh.CreateExtentAttr([(-1, -1, -1), (1, 1, 1)])
    ball = UsdGeom.Sphere.Define(stage, "/ball")
    ball.CreateRadiusAttr(0.2)
    ball.AddTranslateOp().Set((1, 1, 1))
    stage.GetRootLayer().Save()
    return str(path)


def test_the_error_of_shape_is_kept_by_edges_that_are_no_finer_than_that(msbvh: Run, tmp_path: Path) -> None:
    scene = cube(tmp_path / "cube.usda")
    triangles = []
    for wanted in (0.05, 0.2, 0.8):
        done = msbvh("record", scene, "o.exr", "-w", 200, "--spp", 1, "--target-error", wanted, "--stats", "s.json")
        assert done.returncode == 0, done.stderr
        frame = json.loads((tmp_path / "s.json").read_text())["frames"][0]
        errors = {
            track["path"]: track["shape_error_pixels"] for track in frame["tracks"] if track["source"] != "camera"
        }
        assert 0.0 < errors["/cube"] <= 1.1 * wanted
        assert frame["budget"]["error_px"] == pytest.approx(max(errors.values())) and not frame["budget"]["misses"]
        triangles.append(frame["scene"]["triangles"])
    assert triangles[0] > 2 * triangles[1] > 4 * triangles[2]


def test_shape_that_cannot_be_kept_is_an_error(msbvh: Run, tmp_path: Path) -> None:
    done = msbvh("record", cube(tmp_path / "cube.usda"), "o.exr", "-w", 64, "--spp", 1, "--target-error", "1e-5px")
    assert done.returncode == 1
    assert "--target-error 1e-05px: the shape of /" in done.stderr and (tmp_path / "o.exr").exists()


class Clocked:
    """A renderer of grey that takes a second for ten samples, by a clock of its own; the first sample takes three times as
    long."""

    statistics = dict.fromkeys(COUNTED, 1)

    def __init__(self) -> None:
        self.now = 100.0
        self.samples = 0

    def render_samples(self, first: int, count: int, progress: Any) -> tuple[np.ndarray, dict[str, np.ndarray]]:
        assert first == self.samples
        self.now += 0.1 * count + (0.2 if first == 0 else 0.0)
        self.samples += count
        return np.full((4, 4, 4), 0.5, np.float32), {}


@pytest.mark.parametrize("seconds", [1.0, 5.0, 40.0])
def test_a_time_budget_is_filled_and_kept(seconds: float, monkeypatch: pytest.MonkeyPatch) -> None:
    renderer = Clocked()
    monkeypatch.setattr("msbvh.render.budget.time.perf_counter", lambda: renderer.now)
    outcome = render_within(renderer, Goals(seconds=seconds), renderer.now + seconds, lambda share: None)
    took = renderer.now - 100.0
    assert 0.79 * seconds <= took <= seconds and outcome.samples == renderer.samples
    assert outcome.statistics["rays"] % 2 == 0 and not outcome.misses(Goals(seconds=seconds), took)


def test_samples_end_where_the_error_is_reached_or_time_is_over(monkeypatch: pytest.MonkeyPatch) -> None:
    renderer = Clocked()
    monkeypatch.setattr("msbvh.render.budget.time.perf_counter", lambda: renderer.now)
    outcome = render_within(renderer, Goals(flip=0.01, seconds=40.0), renderer.now + 40.0, lambda share: None)
    assert outcome.samples == 2 and outcome.flip == 0.0  # Grey has no noise.


def test_a_budget_that_no_frame_keeps_is_an_error_with_a_picture(msbvh: Run, tmp_path: Path) -> None:
    found = recorded(msbvh, tmp_path, "--time-budget", "0.0001s", code=1)
    assert "--time-budget 0.0001s: the frame took" in found["said"]
    assert found["budget"]["samples"] == 2 and (tmp_path / "o.exr").exists()


def test_statistics_are_those_of_all_samples_together(msbvh: Run, tmp_path: Path) -> None:
    """However many ranges a budget has taken."""
    frame = recorded(msbvh, tmp_path, "--target-flip", 0.02)
    render, samples = frame["render"], frame["budget"]["samples"]
    assert samples > 8
    assert render["camera_rays"] == 32 * 32 * samples
    assert render["rays"] == sum(render[f"rays_{way}"] for way in ("in_packets", "interleaved", "single"))
    alone = recorded(msbvh, tmp_path, "--spp", samples)["render"]
    assert render["rays"] == alone["rays"]


def test_two_goals_hold_together(msbvh: Run, tmp_path: Path) -> None:
    found = recorded(msbvh, tmp_path, "--target-flip", 0.05, "--time-budget", "60s", "--target-error", "1px")["budget"]
    assert found["flip"] <= 0.055 and found["seconds"] < 60 and found["error_px"] <= 1.1 and not found["misses"]


def test_every_frame_of_a_run_keeps_its_own(msbvh: Run, tmp_path: Path) -> None:
    done = msbvh(
        "record", arc(tmp_path / "arc.usda"), "o.##.exr", "-f", "1:2", "--target-flip", 0.05, "--stats", "s.json", *SIZE
    )
    assert done.returncode == 0, done.stderr
    frames = json.loads((tmp_path / "s.json").read_text())["frames"]
    assert [frame["budget"]["misses"] for frame in frames] == [[], []]


def test_aovs_come_with_a_budget(msbvh: Run, tmp_path: Path) -> None:
    """Depths and ids are those of the nearest sample of all ranges, and nothing is written that was not asked for."""
    frame = recorded(msbvh, tmp_path, "--target-flip", 0.03, "--aov", "primId,normal")
    image = oiio.ImageBuf(str(tmp_path / "o.exr"))
    found, names = np.asarray(image.get_pixels(oiio.FLOAT)), image.spec().channelnames
    assert names == ("R", "G", "B", "A", "primId", "normal.X", "normal.Y", "normal.Z")
    recorded(msbvh, tmp_path, "--spp", frame["budget"]["samples"], "--aov", "primId,normal")
    alone = np.asarray(oiio.ImageBuf(str(tmp_path / "o.exr")).get_pixels(oiio.FLOAT))
    assert np.array_equal(found[..., 4], alone[..., 4]) and np.allclose(found, alone, atol=1e-5)


def test_shapes_that_cannot_be_measured_are_named(msbvh: Run, tmp_path: Path) -> None:
    stage = Usd.Stage.CreateNew(str(tmp_path / "patch.usda"))
    patch = UsdGeom.NurbsPatch.Define(stage, "/patch")
    patch.CreatePointsAttr([(x, y, 0.3 * x * y) for y in range(4) for x in range(4)])
    for make in (
        patch.CreateUVertexCountAttr,
        patch.CreateVVertexCountAttr,
        patch.CreateUOrderAttr,
        patch.CreateVOrderAttr,
    ):
        make(4)
    for make in (patch.CreateUKnotsAttr, patch.CreateVKnotsAttr):
        make([0, 0, 0, 0, 1, 1, 1, 1])
    patch.CreateExtentAttr([(0, 0, 0), (3, 3, 3)])
    stage.GetRootLayer().Save()
    done = msbvh("record", "patch.usda", "o.exr", "-w", 64, "--spp", 1, "--target-error", "1px", "--stats", "s.json")
    assert done.returncode == 0, done.stderr
    assert "/patch: --target-error: how far its shape strays is not known; its motion keeps the target" in done.stderr
    assert json.loads((tmp_path / "s.json").read_text())["frames"][0]["budget"]["unknown_shapes"] == ["/patch"]


def test_later_frames_keep_the_edges_of_the_first(tmp_path: Path) -> None:
    stage = Usd.Stage.Open(cube(tmp_path / "cube.usda"))
    keeper, edges = FineEnough(), []

    def read(settings: ReadSettings) -> ReadResult:
        edges.append(settings.edge_length)
        return read_frame(stage, 0.0, settings)

    for _ in range(2):
        keeper.read(stage, read, ReadSettings(width=200), 0.5)
    assert len(set(edges)) > 1 and edges[-1] == edges[-2]


@pytest.mark.parametrize(
    ("one", "other"),
    [
        (("--target-error", "1px"), ("--motion-tolerance", "0.2")),
        (("--target-error", "1px"), ("--segments", "2")),
        (("--target-flip", "0.1"), ("--spp", "4")),
        (("--time-budget", "1s"), ("--spp", "4")),
    ],
)
def test_options_that_decide_the_same_exclude_each_other(
    one: tuple[str, str], other: tuple[str, str], msbvh: Run, tmp_path: Path
) -> None:
    done = msbvh("record", arc(tmp_path / "arc.usda"), "o.exr", *one, *other)
    assert done.returncode == 2 and not (tmp_path / "o.exr").exists()
    assert f"{one[0]} and {other[0]} exclude each other" in done.stderr


def renderer(tmp_path: Path, **settings: Any) -> _core.Renderer:
    scene = tmp_path / "arc.usda"
    if not scene.exists():
        arc(scene)
    result = read_frame(Usd.Stage.Open(str(scene)), 1.0, ReadSettings(width=24, height=24))
    return _core.Renderer(result.scene, width=24, height=24, **settings)


AOVS = ("cameraDepth", "primId", "depth", "normal", "albedo")


def test_ranges_of_samples_add_up_to_the_whole(tmp_path: Path) -> None:
    made = renderer(tmp_path, spp=48, aovs=AOVS)
    whole, aovs = made.render_with_aovs()
    parts = SampleSum(AOVS)
    for first, count in ((0, 8), (8, 24), (32, 16)):
        parts.add(count, *made.render_samples(first, count))
    assert np.abs(parts.pixels - whole).max() <= 4e-7
    for name in AOVS:
        assert np.allclose(parts.aovs[name], aovs[name], atol=2e-6, equal_nan=False), name


def test_independent_samples_are_noisier_and_have_the_same_mean(tmp_path: Path) -> None:
    def noise(sampler: str) -> tuple[float, np.ndarray]:
        pictures = [renderer(tmp_path, spp=16, seed=seed, sampler=sampler).render() for seed in range(12)]
        return float(np.var(pictures, axis=0, ddof=1).mean()), np.mean(pictures, axis=0)

    sobol, spread = noise("sobol"), noise("independent")
    assert spread[0] > 1.5 * sobol[0]
    limit = 5.0 * np.sqrt((spread[0] + sobol[0]) / 12 / spread[1].size)
    assert abs(spread[1].mean() - sobol[1].mean()) < limit


def test_independent_samples_do_not_depend_on_threads(tmp_path: Path) -> None:
    pictures = [renderer(tmp_path, spp=4, sampler="independent", threads=threads).render() for threads in (1, 3)]
    assert np.array_equal(*pictures)


def test_a_split_budget_changes_the_tree_and_not_the_picture(tmp_path: Path) -> None:
    from msbvh.accuracy.scenes import SCENES

    SCENES["debris"].write(tmp_path / "debris.usdc", 0.1)
    stage = Usd.Stage.Open(str(tmp_path / "debris.usdc"))
    for k in range(40):  # Long thin triangles that cross each other.
        mesh = UsdGeom.Mesh.Define(stage, f"/needle_{k}")
        ends = np.random.default_rng(k).uniform(-4, 4, (2, 3))
        mesh.CreatePointsAttr([tuple(ends[0]), tuple(ends[1]), tuple(ends[0] + 0.05)])
        mesh.CreateFaceVertexCountsAttr([3])
        mesh.CreateFaceVertexIndicesAttr([0, 1, 2])
    result = read_frame(stage, 1.0, ReadSettings(width=32, height=24))
    made = [_core.Renderer(result.scene, width=32, height=24, spp=2, split_budget=budget) for budget in (0.0, 4.0)]
    references = [one.statistics["accel"]["references"] for one in made]
    assert references[0] < references[1]
    assert np.array_equal(made[0].render(), made[1].render())
