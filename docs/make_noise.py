"""Writes the table of docs/design/noise.md, and pictures to look at into out/noise.

    python docs/make_noise.py [--only GLOB]    # ten minutes on two cores

Each scene is rendered with many samples, which stands for the truth, with `--noise`, and with ever more samples of every
pixel until as many pixels are as close to the truth.
"""

from __future__ import annotations

import argparse
import fnmatch
import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import OpenImageIO as oiio

ROOT = Path(__file__).resolve().parents[1]
PAGE = ROOT / "docs" / "design" / "noise.md"
OUT = ROOT / "out" / "noise"
BEGIN, END = "<!-- python docs/make_noise.py -->\n", "<!-- end -->\n"
SHARED = ROOT.parent / "shared" / "scenes" / "lights_materials"
SCENES = {
    "showcase": ROOT / "testenv/showcase/showcase.usda",
    "multiDomeLights": SHARED / "usdgl_DomeLight/multiDomeLights.usda",
    "arnold_0139": SHARED / "arnold_0139/data/test.usda",
}
SIZE = ("--resolution", "160", "90")
TARGET = 0.05
TRUTH = 2048
DARKEST = 0.05
"""core/film/noise_estimate.h."""


def record(scene: Path, name: str, *options: object) -> tuple[dict[str, np.ndarray], float]:
    """Channels by name, and the seconds that tracing took."""
    picture, stats = OUT / f"{name}.exr", OUT / f"{name}.json"
    command = [
        sys.executable,
        "-m",
        "msbvh",
        "record",
        scene,
        picture,
        *SIZE,
        "--exr-float",
        "--stats",
        stats,
        *options,
    ]
    subprocess.run([str(each) for each in command], check=True, capture_output=True)
    image = oiio.ImageInput.open(str(picture))
    pixels = np.asarray(image.read_image(oiio.FLOAT), np.float64)
    channels = {channel: pixels[..., i] for i, channel in enumerate(image.spec().channelnames)}
    return channels, json.loads(stats.read_text())["frames"][0]["seconds"]["trace"]


def errors(found: dict[str, np.ndarray], truth: dict[str, np.ndarray]) -> np.ndarray:
    """Of each pixel, in the units of --noise."""
    squares = np.mean([(found[c] - truth[c]) ** 2 for c in "RGB"], axis=0)
    level = np.maximum(np.mean([truth[c] for c in "RGB"], axis=0), DARKEST)
    return np.maximum(np.sqrt(squares) / level, np.abs(found["A"] - truth["A"]))


def write_heat(samples: np.ndarray, path: Path) -> None:
    """From black over red to yellow by the logarithm."""
    share = np.log(samples / samples.min()) / np.log(max(samples.max() / samples.min(), 2.0))
    rgb = np.stack([np.clip(2 * share, 0, 1), np.clip(2 * share - 1, 0, 1), 0 * share], axis=-1).astype(np.float32)
    image = oiio.ImageOutput.create(str(path))
    image.open(str(path), oiio.ImageSpec(rgb.shape[1], rgb.shape[0], 3, oiio.UINT8))
    image.write_image(rgb)
    image.close()


def row(name: str, scene: Path) -> str:
    truth, _ = record(scene, f"{name}_truth", "--spp", TRUTH, "--seed", 1)
    found, seconds = record(scene, f"{name}_noise", "--noise", TARGET, "--aov", "sampleCount")
    error, samples = errors(found, truth), found["sampleCount"]
    write_heat(samples, OUT / f"{name}_samples.png")
    within = f"{100 * np.mean(error <= TARGET):.1f} %"
    shares = {share: np.percentile(error, share) for share in (95, 99)}
    even = {share: _even(name, scene, truth, share, level) for share, level in shares.items()}
    cells = [name, f"{samples.min():.0f} / {samples.mean():.0f} / {samples.max():.0f}", within]
    cells += [f"{np.sqrt(np.mean(error**2)):.3f}", *(f"{level:.3f}" for level in shares.values())]
    cells += [f"{count} ({count / samples.mean():.1f})" for count, _ in even.values()]
    return "| " + " | ".join([*cells, f"{even[99][1] / seconds:.1f}"]) + " |"


def _even(name: str, scene: Path, truth: dict[str, np.ndarray], share: int, level: float) -> tuple[int, float]:
    """Samples of every pixel with which a share of the pixels, per cent, is as close to the truth, and the seconds of tracing."""
    for count in (32, 48, 64, 96, 128, 192, 256, 384, 512, 768, 1024):
        flat, seconds = record(scene, f"{name}_even", "--spp", count)
        if np.percentile(errors(flat, truth), share) <= level:
            return count, seconds
    raise SystemExit(f"make_noise: {name}: 1024 samples of every pixel are not enough for {share} %")


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--only", default="*")
    globs = parser.parse_args().only
    OUT.mkdir(parents=True, exist_ok=True)
    lines = [
        f"| scene | samples, least / mean / most | pixels within {TARGET:g} | root mean square error | 95 % within | 99 % within"
        " | samples of every pixel for the same 95 %, over the mean | for the same 99 % | time of that over ours |",
        "|---|---|---|---|---|---|---|---|---|",
        *(row(name, scene) for name, scene in SCENES.items() if fnmatch.fnmatch(name, globs)),
    ]
    print("\n".join(lines))
    if globs == "*":
        head, _, rest = PAGE.read_text(encoding="utf-8").partition(BEGIN)
        _, _, tail = rest.partition(END)
        PAGE.write_text(f"{head}{BEGIN}{chr(10).join(lines)}\n{END}{tail}", encoding="utf-8")


if __name__ == "__main__":
    main()
