"""The conformance suite under another shutter: its scenes stay, its answers are made anew by its own
evaluation."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import replace
from pathlib import Path

from pxr import Sdf

from ..base.errors import SceneError
from .suite import Rule

SCRIPT = "make_expected.py"
"""Of a suite: `make_expected.py --shutter OPEN:CLOSE --out FOLDER RULE` writes FOLDER/RULE.png."""

STAGE_METADATA = (
    "timeCodesPerSecond",
    "framesPerSecond",
    "startTimeCode",
    "endTimeCode",
    "upAxis",
    "metersPerUnit",
)
"""What a stage takes from its root layer alone."""


def shutter_text(shutter: tuple[float, float]) -> str:
    """As the option has it."""
    return f"{shutter[0]!r}:{shutter[1]!r}"


def check_suite(suite: Path) -> None:
    """Raises SceneError for a suite that cannot evaluate its scenes."""
    if not (suite / SCRIPT).is_file():
        raise SceneError(
            f"--shutter: found no {SCRIPT} in {suite}, expected the script that makes a suite's answers for another"
            " shutter"
        )


def with_shutter(rule: Rule, suite: Path, shutter: tuple[float, float], folder: Path, renderer_knows: bool) -> Rule:
    """A rule with the answer for a shutter. A renderer that does not know of it gets a scene whose camera has
    it.

    Raises SceneError where the suite's own evaluation fails.
    """
    text = shutter_text(shutter)
    command = [sys.executable, str(suite / SCRIPT), f"--shutter={text}", "--out", str(folder), rule.name]
    done = subprocess.run(command, capture_output=True, text=True, check=False, stdin=subprocess.DEVNULL)
    if done.returncode:
        last = next((line for line in reversed(done.stderr.splitlines()) if line.strip()), "it said nothing")
        raise SceneError(f"{suite / SCRIPT}: no answer for rule {rule.name} and --shutter {text}: {last}")
    made = folder / f"{rule.name}.png"
    expected = made.replace(folder / "expected.png")
    scene = rule.scene if renderer_knows else _overlay(rule, shutter, folder / f"{rule.name}.usda")
    return replace(rule, expected=expected, scene=scene)


def _overlay(rule: Rule, shutter: tuple[float, float], path: Path) -> Path:
    """A layer over a rule's scene in which its camera has a shutter."""
    below = Sdf.Layer.FindOrOpen(str(rule.scene))
    if below is None:
        raise SceneError(f"{rule.scene}: cannot be read, expected the scene of rule {rule.name}")
    path.unlink(missing_ok=True)
    layer = Sdf.Layer.CreateNew(str(path))
    layer.subLayerPaths = [str(rule.scene.resolve())]
    for name in STAGE_METADATA:
        if below.pseudoRoot.HasInfo(name):
            layer.pseudoRoot.SetInfo(name, below.pseudoRoot.GetInfo(name))
    camera = Sdf.CreatePrimInLayer(layer, rule.camera)
    for name, value in zip(("shutter:open", "shutter:close"), shutter, strict=True):
        Sdf.AttributeSpec(camera, name, Sdf.ValueTypeNames.Double).default = value
    layer.Save()
    return path
