"""Scenes that nobody here wrote render without error, small: what is not supported is named in a warning."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import pytest
from conftest import Run
from shared_scenes import SharedScene, here, scene_parameters


@pytest.mark.slow
@pytest.mark.shared
@pytest.mark.parametrize("shared", scene_parameters())
def test_renders(msbvh: Run, tmp_path: Path, shared: SharedScene | None) -> None:
    shared = here(shared)
    frames = ("--frames", shared.frame) if shared.frame else ()
    done = msbvh("record", shared.path, "a.exr", "-w", 64, "--spp", 2, *frames)
    assert done.returncode == 0, done.stderr
    assert "Traceback" not in done.stderr
    pixels = oiio.ImageInput.open(str(tmp_path / "a.exr")).read_image(oiio.FLOAT)
    assert np.isfinite(pixels).all()
    if pixels[..., 3].max() == 0.0:  # An empty picture has its reason in a warning.
        assert "msbvh: warning: " in done.stderr
