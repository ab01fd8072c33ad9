"""Fixtures that the Python tests share."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

import pytest
from msbvh.cli.main import main

ROOT = Path(__file__).resolve().parents[2]

# A shell starts background jobs with SIGINT ignored, which the tests' children would inherit.
signal.signal(signal.SIGINT, signal.default_int_handler)

MOVING_SQUARE = """#usda 1.0
(
    defaultPrim = "world"
    endTimeCode = 3
    framesPerSecond = 24
    startTimeCode = 1
    timeCodesPerSecond = 24
    upAxis = "Y"
)
def Xform "world"
{
    def Camera "main_cam"
    {
        float2 clippingRange = (0.1, 100)
        float focalLength = 35
        float horizontalAperture = 24
        float verticalAperture = 16
        double shutter:open = -0.25
        double shutter:close = 0.25
        double3 xformOp:translate = (0, 0, 5)
        uniform token[] xformOpOrder = ["xformOp:translate"]
    }
    def Mesh "square"
    {
        int[] faceVertexCounts = [4]
        int[] faceVertexIndices = [0, 1, 2, 3]
        point3f[] points = [(-0.5, -0.5, 0), (0.5, -0.5, 0), (0.5, 0.5, 0), (-0.5, 0.5, 0)]
        color3f[] primvars:displayColor = [(0.5, 0.3, 0.1)]
        uniform token subdivisionScheme = "none"
        double3 xformOp:translate.timeSamples = { 0: (-2, 0, 0), 4: (2, 0, 0) }
        uniform token[] xformOpOrder = ["xformOp:translate"]
    }
}
"""
"""A square that moves a unit a frame before main_cam; shutter of half a frame; frames 1 to 3."""


@pytest.fixture
def scene(tmp_path: Path) -> Path:
    path = tmp_path / "scene.usda"
    path.write_text(MOVING_SQUARE)
    return path


Run = Callable[..., subprocess.CompletedProcess[str]]


@pytest.fixture
def msbvh(tmp_path: Path) -> Run:
    """Runs the command line in `tmp_path`, as a process of its own."""

    def run(*arguments: object) -> subprocess.CompletedProcess[str]:
        command = [sys.executable, "-m", "msbvh", *map(str, arguments)]
        return subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=120, check=False)

    return run


Fails = Callable[..., None]


@pytest.fixture
def fails(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]) -> Fails:
    """Runs the command line in this process, which is quicker, and expects an exit code and one line on
    stderr."""
    monkeypatch.chdir(tmp_path)

    def run(arguments: Sequence[object], code: int, message: str) -> None:
        before = set(os.listdir(tmp_path))
        assert main([str(argument) for argument in arguments]) == code
        errors = capfd.readouterr().err
        assert re.fullmatch(r"msbvh: error: [^\n]+\n", errors)
        assert message in errors
        assert set(os.listdir(tmp_path)) == before

    return run
