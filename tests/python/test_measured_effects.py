"""What each effect took of a render: by made-up samples, and by renders."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any, ClassVar

import pytest
from msbvh import _core
from msbvh.cli.main import main
from msbvh.plan_report.measured import measured_effects
from msbvh.plan_report.pilot import PILOT_PATHS, Traced, pilot_size, traced
from test_plan_command import CAMERA, CORNERS, STILL, deforming, row


def sampled(stage: str, samples: int, *, tracing: bool = False, bounced: bool = False) -> _core.StageSamples:
    return {"stage": stage, "tracing": tracing, "bounced": bounced, "samples": samples}


def on(*effects: str, prim: str = "/a") -> Any:
    return {"base_bytes": 0, "effects": [{"effect": e, "asked_by": [(prim, "")], "geometry_bytes": 0} for e in effects]}


def costs(**shares: tuple[float, float]) -> Any:
    """Of prims: their share of the rays' work, and their bytes."""
    prims = [
        {"path": f"/{name}", "share": share, "tree_bytes": held, "instances": 0.0}
        for name, (share, held) in shares.items()
    ]
    return {"prims": prims}


STAGES: list[_core.StageSamples] = [
    sampled("generate", 10),
    sampled("closest", 40, tracing=True),
    sampled("closest", 20, tracing=True, bounced=True),
    sampled("opacity", 5),
    sampled("dome light", 15, tracing=True, bounced=True),
    sampled("accumulate", 10),
]


def test_an_effect_with_a_stage_has_its_samples() -> None:
    found = measured_effects(on("opacity", "dome light", "area lights", "indirect light"), STAGES)
    shares = {effect: measured["time_share"] for effect, measured in found.items()}
    assert shares == {"opacity": 0.05, "dome light": 0.15, "area lights": 0.0, "indirect light": 0.35}
    assert all(measured["by"] == "stage" and measured["tree_share"] is None for measured in found.values())


def test_a_part_of_a_stage_is_an_upper_bound() -> None:
    found = measured_effects(on("lens", "camera motion"), STAGES)
    assert all(measured["time_share"] == 0.1 and measured["by"] == "at most" for measured in found.values())


def test_geometry_has_a_part_of_the_time_in_trees_and_of_their_bytes() -> None:
    found = measured_effects(on("deforming keys"), STAGES, costs(a=(0.4, 300.0), b=(0.6, 100.0)))["deforming keys"]
    assert found == {"time_share": pytest.approx(0.75 * 0.4), "by": "model", "tree_share": pytest.approx(0.75)}


def test_what_cannot_be_told_apart_has_no_share() -> None:
    assert measured_effects(on("moving lights"), STAGES)["moving lights"]["time_share"] is None
    assert measured_effects(on("deforming keys"), STAGES)["deforming keys"]["time_share"] is None


def test_nothing_is_measured_without_samples_or_of_effects_that_are_off() -> None:
    assert measured_effects(on("lens"), []) == {}
    off: Any = {"base_bytes": 0, "effects": [{"effect": "lens", "asked_by": [], "geometry_bytes": 0}]}
    assert measured_effects(off, STAGES) == {}


DOME = 'def DomeLight "dome" {}\n'
BIG = deforming("big").replace(CORNERS, "(-4, -4, 0), (4, -4, 0), (4, 4, 0), (-4, 4, 0)")


def test_plan_measures_where_it_is_asked_to(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "scene.usda"
    path.write_text(CAMERA + BIG + STILL + DOME)
    arguments = ["plan", str(path), "-w", "128", "--json"]
    assert main([*arguments, "--measure", "--spp", "64"]) == 0
    found = json.loads(capfd.readouterr().out)
    assert found["samples"] > 0
    for effect, by in (("indirect light", "stage"), ("deforming keys", "model")):
        measured = row(found, effect)["measured"]
        assert measured["by"] == by and 0.0 < measured["time_share"] < 1.0
    assert row(found, "dome light")["measured"]["by"] == "stage"
    assert 0.0 < row(found, "deforming keys")["measured"]["tree_share"] < 1.0
    assert row(found, "opacity")["measured"] is None
    assert main([*arguments]) == 0
    found = json.loads(capfd.readouterr().out)
    assert found["samples"] == 0 and all(effect["measured"] is None for effect in found["effects"])


def test_a_small_render_predicts_effects_without_geometry_too(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    """How near it comes is not asked: where the machine is busy, threads stand still at odd places for both."""
    path = tmp_path / "scene.usda"
    path.write_text(CAMERA + BIG + STILL + DOME)
    assert main(["plan", str(path), "-w", "256", "--json", "--measure", "--spp", "32"]) == 0
    found = json.loads(capfd.readouterr().out)
    for effect in ("indirect light", "deforming keys"):
        predicted, measured = row(found, effect)["predicted"], row(found, effect)["measured"]
        assert predicted["by"] == measured["by"] and 0.0 < predicted["time_share"] < 1.0
    assert row(found, "lens")["predicted"] is None


class FakeRenderer:
    """Whose small render found what its frame's did not."""

    made: ClassVar[list[dict[str, Any]]] = []

    def __init__(self, scene: Any, **settings: Any) -> None:
        self.made.append(settings)
        self.pixels = settings["width"] * settings["height"]
        self.statistics: dict[str, Any] = {}

    def ray_costs(self, *, camera_samples: int) -> Any:
        return costs(a=(1.0, camera_samples))

    def render_samples(self, first: int, count: int, progress: Any) -> None:
        if progress:
            progress(0.5)
            progress(1.0)
        self.statistics["stages"] = [sampled("generate", count * self.pixels)]

    def render(self, progress: Any) -> None:
        if progress:
            progress(0.5)
            progress(1.0)
        self.statistics["stages"] = [sampled("accumulate", self.made[-1]["spp"] * self.pixels)]


def test_the_prediction_is_of_the_pilot_and_the_measure_of_the_frame(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(_core, "Renderer", FakeRenderer)
    monkeypatch.setattr(FakeRenderer, "made", [])
    scene: Any = None
    found = traced(scene, (7680, 4320), rays=7, spp=3, max_bounces=1)
    assert found.costs == costs(a=(1.0, 7))
    assert [row["samples"] for row in found.pilot] == [pytest.approx(PILOT_PATHS, rel=0.01)]
    assert found.stages == [sampled("accumulate", 3 * 7680 * 4320)]
    small, frame = FakeRenderer.made
    assert (small["width"], small["height"]) == pilot_size((7680, 4320)) and small["sample_stages"]
    assert (frame["width"], frame["height"]) == (7680, 4320) and frame["sample_stages"]
    found = traced(scene, (128, 64), rays=7, spp=0, max_bounces=1)
    assert (found.pilot, found.stages) == ([sampled("generate", PILOT_PATHS // (128 * 64) * 128 * 64)], [])
    found = traced(scene, (128, 64), rays=0, spp=3, max_bounces=1)
    assert (found.costs, found.pilot, found.stages) == (None, [], [sampled("accumulate", 3 * 128 * 64)])
    count = len(FakeRenderer.made)
    assert traced(scene, (128, 64), rays=0, spp=0, max_bounces=1) == Traced()
    assert len(FakeRenderer.made) == count


@pytest.mark.parametrize(("rays", "spp"), [(7, 0), (0, 3), (7, 32)])
def test_progress_is_of_the_pilot_and_the_frame_together(monkeypatch: pytest.MonkeyPatch, rays: int, spp: int) -> None:
    monkeypatch.setattr(_core, "Renderer", FakeRenderer)
    said: list[float] = []
    scene: Any = None
    traced(scene, (128, 64), rays=rays, spp=spp, max_bounces=1, progress=said.append)
    assert said == sorted(said) and said[0] > 0.0 and said[-1] == 1.0
    if rays and spp:  # Both of as many samples.
        assert said == pytest.approx([0.25, 0.5, 0.75, 1.0], abs=0.01)


def test_without_rays_nothing_is_predicted(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "scene.usda"
    path.write_text(CAMERA + BIG + DOME)
    assert main(["plan", str(path), "-w", "64", "--rays", "0"]) == 0
    assert "predicted" not in capfd.readouterr().out
    assert main(["plan", str(path), "-w", "64"]) == 0
    out = capfd.readouterr().out
    assert "predicted to take about" in out and "took" not in out


def test_a_large_frame_is_predicted_by_a_small_one_of_its_aspect() -> None:
    assert pilot_size((64, 48)) == (64, 48)
    width, height = pilot_size((7680, 4320))
    assert width * height == pytest.approx(PILOT_PATHS, rel=0.01)
    assert width / height == pytest.approx(16 / 9, rel=0.01)
    assert pilot_size((65536, 1)) == (65536, 1)


def test_measured_shares_are_in_the_table(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "scene.usda"
    path.write_text(CAMERA + BIG + DOME)
    assert main(["plan", str(path), "-w", "128", "--measure", "--spp", "64"]) == 0
    lines = {line[:20].strip(): line for line in capfd.readouterr().out.splitlines()}
    assert ", took " in lines["dome light"] and "% of the render]" in lines["dome light"]
    assert "took about " in lines["deforming keys"] and "of the trees]" in lines["deforming keys"]
    assert "looks at what threads did" in lines["measured"]


def test_a_record_with_ray_costs_keeps_them(tmp_path: Path) -> None:
    path, stats = tmp_path / "scene.usda", tmp_path / "stats.json"
    path.write_text(CAMERA + BIG + DOME)
    arguments = ["record", str(path), str(tmp_path / "o.exr"), "-w", "64", "--spp", "64", "--stats", str(stats)]
    assert main([*arguments, "--ray-costs", "--aov", "normal"]) == 0
    render = json.loads(stats.read_text())["frames"][0]["render"]
    assert sum(one["samples"] for one in render["stages"]) > 0
    assert render["effects"]["AOVs"]["by"] == "stage"
    assert main(arguments) == 0
    render = json.loads(stats.read_text())["frames"][0]["render"]
    assert render["stages"] == [] and "effects" not in render
