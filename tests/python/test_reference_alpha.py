"""Coverage of blurred frames against pictures of another renderer, whose alpha follows USD's plain semantics.

The bounds are mean absolute errors. A still frame is out by .051, .020 and .206 on the first three scenes;
the fourth reference has about one sample a pixel, so that its own noise sets the bound.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import pytest
from conftest import Run
from shared_scenes import SCENES


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "frame", "bound"),
    [
        ("arnold_1476", 1, 0.004),
        ("arnold_2231", 1002, 0.006),
        ("arnold_0216", 0, 0.014),
        ("arnold_2254", 5, 0.030),
        ("arnold_1443", 3, 0.006),  # skinned
        ("arnold_1352", 1600, 0.010),  # a skinned crowd, without blur
    ],
)
def test_alpha(msbvh: Run, tmp_path: Path, name: str, frame: int, bound: float) -> None:
    folder = next(SCENES.glob(f"*/{name}"), None)
    if folder is None:
        pytest.skip("../shared/scenes is not on this machine")
    reference = oiio.ImageInput.open(str(folder / "ref" / "reference.tif")).read_image(oiio.FLOAT)[..., 3]
    height, width = reference.shape
    done = msbvh(
        *("record", next((folder / "data").glob("test.usd*")), "a.exr", "--frames", frame, "--spp", 256),
        *("--resolution", width, height, "--conform", "adjustApertureHeight", "--max-bounces", 0),
    )
    assert done.returncode == 0, done.stderr
    alpha = oiio.ImageInput.open(str(tmp_path / "a.exr")).read_image(oiio.FLOAT)[..., 3]
    error = float(np.abs(alpha - reference).mean())
    assert error <= bound, f"mean absolute error {error:.5f}"
