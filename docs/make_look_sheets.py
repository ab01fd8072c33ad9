"""Renders scenes of one look each beside Cycles: out/looks/looks.png, differences.csv and a sheet a scene.

    python docs/make_look_sheets.py [--out FOLDER] [--only GLOB]... [--spp N] [--width PIXELS] [--peer-env FOLDER]

Each row of the sheet: ours, Cycles', and the difference (grey: none; red: ours is brighter; blue: darker; full colour at 10 %
of the pair's mean). The scenes are those of msbvh.bench.look_scenes. Cycles reads geometry, camera and motion of the same
USD file by Blender's importer, and gets surfaces and lights that are equal by definition (msbvh/bench/cycles_looks.py). It is
Blender's module bpy, in an environment that is made where it is missing (a GB), as of `msbvh bench --frames --peer cycles`.

differences.csv: of the subject alone (what the camera sees of it, less a rim of 3 %) and of the whole picture, our mean over
Cycles' less 1, and the mean absolute difference over the mean, by channels of the largest.
"""

from __future__ import annotations

import argparse
import csv
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from fnmatch import fnmatch
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
from msbvh.base.errors import SceneError
from msbvh.bench.cycles_peer import find_cycles
from msbvh.bench.frame_scenes import FrameScene
from msbvh.bench.frame_sides import Job, rendered, this_build
from msbvh.bench.look_scenes import LOOK_SCENES, RADIUS, write_images

ROOT = Path(__file__).resolve().parents[1]
EYE_DISTANCE = float(np.hypot(16.0, 6.0))
FOCAL_OVER_WIDTH = 45.0 / 36.0
"""Of scene_parts' camera, which looks at the origin."""
RIM = 0.03
FULL_COLOUR = 0.1
LABEL = 20
BOUNCES = 4


@dataclass(frozen=True)
class Difference:
    """Ours over Cycles'."""

    mean: float
    """Relative difference of the means, of the channel where it is largest; signed."""
    absolute: float
    """Mean absolute difference over the mean."""

    @staticmethod
    def of(ours: np.ndarray, theirs: np.ndarray, where: np.ndarray) -> Difference:
        first, second = ours[where], theirs[where]
        ratios = first.mean(axis=0) / second.mean(axis=0) - 1.0
        return Difference(float(ratios[np.abs(ratios).argmax()]), float(np.abs(first - second).mean() / second.mean()))


def main() -> int:
    options = _parser().parse_args()
    chosen = [
        scene for scene in LOOK_SCENES.values() if any(fnmatch(scene.name, glob) for glob in options.only or ["*"])
    ]
    if not chosen:
        print(
            f"make_look_sheets: error: --only: found no scene; expected one of {', '.join(LOOK_SCENES)}",
            file=sys.stderr,
        )
        return 1
    options.out.mkdir(parents=True, exist_ok=True)
    try:
        sides = [this_build(), find_cycles(options.peer_env, print)]
        rows, sheets = [], []
        write_images(options.out)
        for scene in chosen:
            file = options.out / f"{scene.name.replace(' ', '_')}.usda"
            file.unlink(missing_ok=True)
            scene.write(file)
            ours, theirs = (_picture(side, scene, file, options) for side in sides)
            rows.append(_row(scene, ours, theirs))
            print("make_look_sheets: " + ", ".join(f"{key}: {value}" for key, value in rows[-1].items()), flush=True)
            sheets.append(_sheet(f"{scene.name}: {scene.says}", ours, theirs))
            _write(sheets[-1], file.with_suffix(".png"))
    except SceneError as error:
        print(f"make_look_sheets: error: {error}", file=sys.stderr)
        return 1
    with (options.out / "differences.csv").open("w", encoding="utf-8", newline="") as out:
        table = csv.DictWriter(out, list(rows[0]))
        table.writeheader()
        table.writerows(rows)
    _write(np.concatenate(sheets), options.out / "looks.png")
    print(f"make_look_sheets: wrote {options.out / 'looks.png'} and differences.csv: {len(rows)} scenes")
    return 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(description="Renders looks beside Cycles.")
    parser.add_argument("--out", type=Path, default=ROOT / "out" / "looks", metavar="FOLDER")
    parser.add_argument("--only", action="append", metavar="GLOB", help="only scenes of such names")
    parser.add_argument("--spp", type=int, default=512, metavar="N", help="samples a pixel; default: 512")
    parser.add_argument("--width", type=int, default=300, metavar="PIXELS", help="of a picture; default: 300")
    parser.add_argument("--peer-env", type=Path, metavar="FOLDER", help="that has bpy; default: in the user's cache")
    parser.add_argument("--threads", type=int, default=2, metavar="N", help="of each renderer; default: 2")
    return parser


def _picture(side: object, scene: FrameScene, file: Path, options: argparse.Namespace) -> np.ndarray:
    width, height = options.width, options.width * 2 // 3
    job = Job(scene, file.absolute(), width, height, BOUNCES, options.spp, 1, options.threads)
    return rendered(side, job, (options.out / "runs" / side.name).absolute()).pixels


def _row(scene: FrameScene, ours: np.ndarray, theirs: np.ndarray) -> dict[str, str]:
    subject = Difference.of(ours, theirs, _subject(*ours.shape[:2]))
    whole = Difference.of(ours, theirs, np.ones(ours.shape[:2], bool))
    figures = {
        "subject mean": subject.mean,
        "subject absolute": subject.absolute,
        "picture mean": whole.mean,
        "picture absolute": whole.absolute,
    }
    return {"scene": scene.name, **{name: f"{figure:.4f}" for name, figure in figures.items()}}


def _subject(height: int, width: int) -> np.ndarray:
    """Where the camera sees the ball, or would: bool[height, width]."""
    radius = FOCAL_OVER_WIDTH * width * RADIUS / np.sqrt(EYE_DISTANCE**2 - RADIUS**2)
    x, y = np.meshgrid(np.arange(width) + 0.5 - width / 2, np.arange(height) + 0.5 - height / 2)
    return np.hypot(x, y) < (1 - RIM) * radius


def _sheet(label: str, ours: np.ndarray, theirs: np.ndarray) -> np.ndarray:
    """Ours, theirs, difference, below a label: display values, float64[height, 3 width, 3]."""
    mean = 0.5 * (ours + theirs).mean(axis=-1) + 1e-3
    share = np.clip((ours - theirs).mean(axis=-1) / mean / FULL_COLOUR, -1.0, 1.0)[..., None]
    grey, red, blue = np.array([[0.5] * 3, [0.9, 0.1, 0.05], [0.05, 0.2, 0.9]])
    difference = grey + np.maximum(share, 0.0) * (red - grey) + np.maximum(-share, 0.0) * (blue - grey)
    pictures = [*(np.clip(found, 0.0, 1.0) ** (1 / 2.2) for found in (ours, theirs)), difference]
    row = np.concatenate(pictures, axis=1)
    strip = oiio.ImageBuf(oiio.ImageSpec(row.shape[1], LABEL, 3, "float"))
    oiio.ImageBufAlgo.render_text(
        strip, 4, LABEL - 6, f"{label}   (ours, Cycles, difference)", 13, textcolor=(1.0, 1.0, 1.0)
    )
    return np.concatenate([strip.get_pixels(oiio.FLOAT).reshape(LABEL, row.shape[1], 3), row])


def _write(pixels: Sequence[object] | np.ndarray, path: Path) -> None:
    pixels = np.ascontiguousarray(pixels, np.float32)
    out = oiio.ImageBuf(oiio.ImageSpec(pixels.shape[1], pixels.shape[0], 3, "uint8"))
    out.set_pixels(oiio.ROI.All, pixels)
    if not out.write(str(path)):
        raise SceneError(f"'{path}': {out.geterror()}")


if __name__ == "__main__":
    sys.exit(main())
