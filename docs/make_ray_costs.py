"""Writes the table of docs/design/ray_costs.md: shares of the rays' time that Renderer.ray_costs() predicts beside those
that are saved where a prim is taken away.

    python docs/make_ray_costs.py [--shared SHARED_SCENES] [--repetitions N]

Needs the installed package. Each scene is rendered whole and without one prim (or group of prims) after another, all in
turn, N times over; a time is the least of its N. Processor seconds, not seconds by the clock: the machine may have others
on it. The model's cost is RayCosts.cost with and without the part. Only parts below a path that can be switched off on the
stage are taken away; prims that instance prototypes are whole.
"""

from __future__ import annotations

import argparse
import re
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from msbvh import _core
from msbvh.base.errors import Diagnostics
from msbvh.bench.frame_scenes import FRAME, SCENES
from msbvh.scene.reader import ReadSettings, read_frame
from msbvh.stage.opening import open_stage
from msbvh.stage.stage_metadata import start_time
from provenance import processor
from pxr import Gf, Usd, UsdGeom

ROOT = Path(__file__).resolve().parents[1]
PAGE = ROOT / "docs" / "design" / "ray_costs.md"
WIDTH, SPP = 480, 16
SAMPLES = 40000


@dataclass(frozen=True)
class Case:
    """A scene, and the parts that are taken away, one at a time: paths of prims whose descendants go with them."""

    name: str
    file: Path
    frame: float | None
    parts: Sequence[str]


@dataclass(frozen=True)
class Way:
    """What is rendered: all light, or what the camera sees alone, where nothing is lit and paths end at once."""

    name: str
    max_bounces: int
    lit: bool


WAYS = (Way("all rays", 2, True), Way("camera rays alone", 0, False))


def cases(shared: Path | None, folder: Path) -> Iterator[Case]:
    showcase = ROOT / "testenv/showcase/showcase.usda"
    yield Case("showcase", showcase, 6.0, ("/showcase/wheel", "/showcase/flag", "/showcase/throws", "/showcase/studio"))
    still = folder / "still.usdc"
    SCENES["still"].write(still)
    yield Case("still (bench)", still, FRAME, ("/set/ring_1", "/set/ring_5", "/set/ring_10", "/ground"))
    if shared is not None:
        chess = shared / "heavy/OpenChessSet/chess_set.usda"
        parts = ("/ChessSet/Chessboard", "/ChessSet/Black", "/ChessSet/White/Pawns", "/ChessSet/White/Queen")
        yield Case("OpenChessSet", chess, None, parts)


def renderer_of(case: Case, way: Way, without: str | None) -> _core.Renderer:
    stage = open_stage(str(case.file), Diagnostics())
    stage.SetEditTarget(stage.GetSessionLayer())
    camera = None if any(prim.IsA(UsdGeom.Camera) for prim in stage.Traverse()) else add_camera(stage)
    for path in [without] if without else []:
        stage.GetPrimAtPath(path).SetActive(False)
    if not way.lit:
        switch_lights_off(stage)
    frame = start_time(stage) if case.frame is None else case.frame
    result = read_frame(stage, frame, ReadSettings(camera=camera, width=WIDTH, disable_camera_light=not way.lit))
    width, height = result.camera.width, result.camera.height
    return _core.Renderer(result.scene, width=width, height=height, spp=SPP, max_bounces=way.max_bounces)


def add_camera(stage: Usd.Stage) -> str:
    """One that looks down at all of the stage, from the front: a camera that is made for what is there would move as parts
    are taken away."""
    box = UsdGeom.BBoxCache(Usd.TimeCode.EarliestTime(), ["default", "render", "proxy"]).ComputeWorldBound(
        stage.GetPseudoRoot()
    )
    bounds = box.ComputeAlignedRange()
    up = UsdGeom.GetStageUpAxis(stage) == UsdGeom.Tokens.y
    middle, size = bounds.GetMidpoint(), bounds.GetSize().GetLength()
    away = Gf.Vec3d(0, 0.6, 1) if up else Gf.Vec3d(0, -1, 0.6)
    view = Gf.Matrix4d().SetLookAt(middle + away * size, middle, Gf.Vec3d(0, 1, 0) if up else Gf.Vec3d(0, 0, 1))
    camera = UsdGeom.Camera.Define(stage, "/cameraOfRayCosts")
    camera.AddTransformOp().Set(view.GetInverse())
    camera.CreateClippingRangeAttr(Gf.Vec2f(0.001 * size, 10 * size))
    return str(camera.GetPath())


def switch_lights_off(stage: Usd.Stage) -> None:
    lights = [prim for prim in stage.Traverse() if prim.HasAPI("LightAPI")]
    for prim in lights:
        prim.SetActive(False)


def seconds(renderer: _core.Renderer) -> float:
    """Of all threads together."""
    start = time.process_time()
    renderer.render()
    return time.process_time() - start


def below(path: str, part: str) -> bool:
    return path == part or path.startswith(f"{part}/")


def rows(case: Case, way: Way, repetitions: int) -> Iterator[str]:
    whole = renderer_of(case, way, None)
    costs = whole.ray_costs(camera_samples=SAMPLES)
    renderers = {None: whole} | {part: renderer_of(case, way, part) for part in case.parts}
    times: dict[str | None, list[float]] = {part: [] for part in renderers}
    for _ in range(repetitions):
        for part, renderer in renderers.items():
            times[part].append(seconds(renderer))
    all_of_it = min(times[None])
    spread = (sorted(times[None])[repetitions // 2] - all_of_it) / all_of_it
    for part in case.parts:
        predicted = sum(prim["share"] for prim in costs["prims"] if below(prim["path"], part))
        saved = 1.0 - min(times[part]) / all_of_it
        without = renderers[part].ray_costs(camera_samples=SAMPLES)
        cheaper, fewer = 1.0 - without["cost"] / costs["cost"], 1.0 - without["rays"] / costs["rays"]
        yield (
            f"| {case.name} | {way.name} | `{part}` | {100 * predicted:.1f} % | {100 * cheaper:.1f} % |"
            f" {100 * saved:.1f} % | {100 * fewer:.1f} % | {100 * spread:.1f} % |"
        )


def table(shared: Path | None, repetitions: int) -> str:
    lines = [
        "| scene | rays | taken away | share | model's cost saved | time saved | fewer rays | noise |",
        "|---|---|---|---|---|---|---|---|",
    ]
    with tempfile.TemporaryDirectory() as folder:
        for case in cases(shared, Path(folder)):
            for way in WAYS:
                for row in rows(case, way, repetitions):
                    print(row, file=sys.stderr, flush=True)
                    lines.append(row)
    return "\n".join(lines)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--shared", type=Path)
    parser.add_argument("--repetitions", type=int, default=5)
    chosen = parser.parse_args()
    made = f"{processor()}, {chosen.repetitions} repetitions, {WIDTH} pixels across, {SPP} samples a pixel."
    marked = f"<!-- table -->\n{made}\n\n{table(chosen.shared, chosen.repetitions)}\n<!-- /table -->"
    text = PAGE.read_text(encoding="utf-8")
    PAGE.write_text(re.sub(r"<!-- table -->.*<!-- /table -->", marked, text, flags=re.DOTALL), encoding="utf-8")


if __name__ == "__main__":
    main()
