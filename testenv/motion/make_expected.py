"""Makes the expected answers of the suite: coverage by usd-core's own evaluation, never by our renderer.

    python testenv/motion/make_expected.py [RULE...]    # with msbvh installed or on PYTHONPATH
    python testenv/motion/make_expected.py --shutter=-0.5:0.5 --out FOLDER [RULE...]

Every answer is a 16-bit, single-channel PNG: the share of time and of the pixel that is covered, without any
transfer curve. tests/python/projection_oracle.py projects the polygons of tests/python/stage_truth.py at 512
times of the shutter and 4 x 4 places of each pixel. Subdivided cages are refined 5 times by the rules of their scheme
(tests/python/limit_surface.py), which is a hundredth of a pixel off their limit surface.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import OpenImageIO as oiio
from pxr import Usd, UsdGeom

SUITE = Path(__file__).resolve().parent
sys.path.insert(0, str(SUITE.parents[1] / "tests" / "python"))

from projection_oracle import Sampling, coverage

SAMPLING = Sampling(times=512, subpixels=4, subdivisions=5, round=True)


def rules() -> list[dict[str, Any]]:
    return json.loads((SUITE / "rules.json").read_text(encoding="utf-8"))["rules"]


def expected(
    entry: dict[str, Any],
    scene: Path,
    sampling: Sampling = SAMPLING,
    shutter: tuple[float, float] | None = None,
) -> np.ndarray:
    """uint16[height, width] of a rule's scene; `shutter`: in place of its camera's own."""
    stage = under(scene, entry["camera"], shutter)
    size = (entry["width"], entry["height"])
    found = coverage(stage, entry["frames"][-1], entry["camera"], size, sampling)
    return np.rint(found * 65535).astype(np.uint16)


def write(path: Path, pixels: np.ndarray) -> None:
    """A 16-bit grey PNG."""
    output = oiio.ImageOutput.create(str(path))
    spec = oiio.ImageSpec(pixels.shape[1], pixels.shape[0], 1, oiio.UINT16)
    if not (output and output.open(str(path), spec) and output.write_image(pixels[..., None]) and output.close()):
        raise OSError(f"{path}: {output.geterror() if output else oiio.geterror()}")


def under(scene: Path, camera: str, shutter: tuple[float, float] | None) -> Usd.Stage:
    """The stage of a scene, with another shutter than its camera's in the session layer."""
    stage = Usd.Stage.Open(str(scene))
    if shutter is not None:
        stage.SetEditTarget(stage.GetSessionLayer())
        prim = UsdGeom.Camera.Get(stage, camera)
        prim.CreateShutterOpenAttr(shutter[0])
        prim.CreateShutterCloseAttr(shutter[1])
    return stage


def main(arguments: Sequence[str]) -> None:
    parser = argparse.ArgumentParser(description="Makes the expected answers of the suite.")
    parser.add_argument("rules", nargs="*", metavar="RULE", help="default: all")
    parser.add_argument("--shutter", metavar="OPEN:CLOSE", help="in place of the cameras' own; needs --out")
    parser.add_argument("--out", type=Path, metavar="FOLDER", help="for RULE.png, instead of the suite's own files")
    given = parser.parse_args(arguments)
    if given.shutter and not given.out:
        parser.error("--shutter makes answers that are not the suite's: give --out FOLDER")
    shutter = tuple(map(float, given.shutter.split(":"))) if given.shutter else None
    for entry in rules():
        if not given.rules or entry["rule"] in given.rules:
            path = given.out / f"{entry['rule']}.png" if given.out else SUITE / entry["expected"]
            write(path, expected(entry, SUITE / entry["scene"], shutter=shutter))


if __name__ == "__main__":
    main(sys.argv[1:])
