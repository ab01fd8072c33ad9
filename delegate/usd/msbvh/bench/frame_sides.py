"""The renderers that `msbvh bench --frames` measures: how each renders a frame, and what it took."""

from __future__ import annotations

import json
import os
import shlex
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

import numpy as np

from ..base.errors import SceneError
from ..base.processes import exit_code, last_line
from ..output.images import ImageReadError, read_colour
from . import frame_launch
from .frame_scenes import FrameScene
from .scene_parts import CAMERA, FRAME

PHASES = ("read", "build", "trace", "write")
"""read: from the file to the renderer's scene, evaluated over the shutter. build: trees, and whatever else comes before
the first ray. trace: pixels. write: the picture."""
PICTURE = "picture.exr"
FIGURES = "figures.json"


@dataclass(frozen=True)
class Job:
    """A frame to render."""

    scene: FrameScene
    file: Path
    width: int
    height: int
    bounces: int
    spp: int
    seed: int
    threads: int
    """At least 1: processors that the renderer is given, and threads that it is asked for."""


@dataclass(frozen=True)
class Run:
    """What a frame took."""

    seconds: Mapping[str, float]
    """Of each of PHASES, wall clock."""
    process: float
    """From the start of the process to its end."""
    cpu: float
    """Seconds that its threads ran, whatever else the machine did."""
    memory_bytes: int
    """The most that the process held at once."""
    software: str
    pixels: np.ndarray
    """float64[height, width, 3]: linear colours, top row first."""

    @property
    def frame(self) -> float:
        """All phases."""
        return sum(self.seconds.values())

    @property
    def start(self) -> float:
        """What is in no phase: the interpreter and its libraries start and end."""
        return self.process - self.frame


class Side(Protocol):
    """A renderer."""

    @property
    def name(self) -> str:
        """In the report."""

    def command(self, job: Job, folder: Path) -> Sequence[str]:
        """Renders a job to PICTURE in a folder, and writes what figures() reads."""

    def figures(self, folder: Path) -> tuple[Mapping[str, float], str]:
        """Seconds of each of PHASES, and the software's name and version."""


@dataclass(frozen=True)
class Msbvh:
    """This renderer, or an older build of it."""

    name: str
    program: Sequence[str]
    """The command line before `record`."""

    def command(self, job: Job, folder: Path) -> Sequence[str]:
        return [
            *self.program, "record", str(job.file), str(folder / PICTURE), "--frames", str(FRAME), "--camera", CAMERA,
            "--resolution", str(job.width), str(job.height), "--spp", str(job.spp), "--seed", str(job.seed),
            "--max-bounces", str(job.bounces), "--threads", str(job.threads), "--exr-float",
            "--stats", str(folder / FIGURES),
        ]  # fmt: skip

    def figures(self, folder: Path) -> tuple[Mapping[str, float], str]:
        stats = json.loads((folder / FIGURES).read_text(encoding="utf-8"))
        seconds = stats["frames"][0]["seconds"]
        found = {phase: seconds[phase] for phase in PHASES}
        return {**found, "read": seconds["read"] + seconds["sample"]}, stats["software"]


def this_build() -> Msbvh:
    """The one that runs."""
    return Msbvh("msbvh", (sys.executable, "-m", "msbvh"))


def old_build(command_line: str) -> Msbvh:
    """Another one, given as a command line. Raises SceneError where it is empty or its quotes do not match."""
    try:
        program = tuple(shlex.split(command_line))
    except ValueError as error:
        raise SceneError(f"--old: found {command_line!r}, expected a command line: {error}") from None
    if not program:
        raise SceneError("--old: found nothing, expected the command of another msbvh, such as /opt/old/bin/msbvh")
    return Msbvh("old", program)


def rendered(side: Side, job: Job, folder: Path) -> Run:
    """Renders a frame in a process of its own, on as many processors as it has threads. Raises SceneError where the
    renderer fails."""
    folder.mkdir(parents=True, exist_ok=True)
    for file in (PICTURE, FIGURES):
        (folder / file).unlink(missing_ok=True)  # What an earlier frame left must not pass for this one's.
    took = launched(f"bench: {side.name}", side.command(job, folder), job.threads, folder)
    try:
        seconds, software = side.figures(folder)
        pixels = read_colour(folder / PICTURE)
    except (OSError, ValueError, KeyError, ImageReadError) as error:
        raise SceneError(
            f"bench: {side.name}, {job.scene.name}: found {error}, expected a picture and its figures"
        ) from None
    if pixels.shape[:2] != (job.height, job.width):
        found, wanted = f"{pixels.shape[1]} x {pixels.shape[0]}", f"{job.width} x {job.height}"
        raise SceneError(f"bench: {side.name}, {job.scene.name}: found a picture of {found} pixels, expected {wanted}")
    return Run(seconds, took["seconds"], took["cpu_seconds"], int(took["memory_bytes"]), software, pixels)


def launched(name: str, command: Sequence[str], threads: int, folder: Path) -> dict[str, float]:
    """Runs a renderer's command on so many processors; its wall-clock `seconds` and its peak `memory_bytes`. Raises
    SceneError, with the last line that it said, where it fails."""
    result = folder / "took.json"
    processors = ",".join(map(str, sorted(os.sched_getaffinity(0))[:threads]))
    # -I and -S: nothing of the user's site, and little memory.
    launcher = [sys.executable, "-I", "-S", str(Path(frame_launch.__file__)), str(result), processors]
    with os.fdopen(os.memfd_create("msbvh"), "r+b") as log:  # A full disk is no fault of the renderer's.
        code = exit_code([*launcher, *command], log)
        log.seek(0)
        said = log.read()
    if code:
        raise SceneError(f"{name}: exit code {code}: {last_line(said)}")
    took: dict[str, float] = json.loads(result.read_text(encoding="utf-8"))
    return took
