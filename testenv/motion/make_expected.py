"""Makes the expected answers of the suite: coverage by usd-core's own evaluation, never by our renderer.

    python testenv/motion/make_expected.py [RULE...]    # with msbvh installed or on PYTHONPATH

Every answer is a 16-bit, single-channel PNG: the share of time and of the pixel that is covered, without any
transfer curve. tests/python/projection_oracle.py projects the polygons of tests/python/stage_truth.py at 512
times of the shutter and 4 x 4 places of each pixel.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import OpenImageIO as oiio
from pxr import Usd

SUITE = Path(__file__).resolve().parent
sys.path.insert(0, str(SUITE.parents[1] / "tests" / "python"))

from projection_oracle import Sampling, coverage  # noqa: E402

SAMPLING = Sampling(times=512, subpixels=4)


def rules() -> list[dict[str, Any]]:
    return json.loads((SUITE / "rules.json").read_text(encoding="utf-8"))["rules"]


def expected(entry: dict[str, Any], scene: Path, sampling: Sampling = SAMPLING) -> np.ndarray:
    """uint16[height, width] of a rule's scene."""
    stage = Usd.Stage.Open(str(scene))
    size = (entry["width"], entry["height"])
    found = coverage(stage, entry["frames"][-1], entry["camera"], size, sampling)
    return np.rint(found * 65535).astype(np.uint16)


def write(path: Path, pixels: np.ndarray) -> None:
    """A 16-bit grey PNG."""
    output = oiio.ImageOutput.create(str(path))
    spec = oiio.ImageSpec(pixels.shape[1], pixels.shape[0], 1, oiio.UINT16)
    if not (
        output and output.open(str(path), spec) and output.write_image(pixels[..., None]) and output.close()
    ):
        raise OSError(f"{path}: {output.geterror() if output else oiio.geterror()}")


def main(names: Sequence[str]) -> None:
    for entry in rules():
        if not names or entry["rule"] in names:
            write(SUITE / entry["expected"], expected(entry, SUITE / entry["scene"]))


if __name__ == "__main__":
    main(sys.argv[1:])
