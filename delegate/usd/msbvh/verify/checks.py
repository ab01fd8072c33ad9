"""The trees of a frame, proved and tried out."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict, dataclass, field
from typing import Any, Literal

from .. import _core
from ..scene.reader import ReadResult


@dataclass(frozen=True)
class VerifySettings:
    """What is tried."""

    rays: int = 100_000
    """Of each probe and instruction set. Time grows with it."""
    seed: int = 1
    builder: Literal["msbvh", "mbvh", "swept", "timesplit"] = "msbvh"


@dataclass(frozen=True)
class Probe:
    """One kind of rays by the kernels of one instruction set."""

    probe: str
    instruction_set: str
    rays: int
    """Traced one by one, interleaved and in packets, which must agree to the bit."""
    judged: int
    """By the oracle, which tests every primitive in double precision."""
    wrong: int
    first: str
    """Of the wrong ones: the ray, and what is wrong; empty for none."""


@dataclass(frozen=True)
class Verdict:
    """What was found in one scene."""

    scene: str
    meshes: int
    closed_meshes: int
    """Rays that start inside of these must not get out."""
    broken_invariant: str
    """Of a tree, naming the node; empty where all hold."""
    probes: list[Probe] = field(default_factory=list)

    @property
    def holds(self) -> bool:
        """Whether nothing is wrong."""
        return not self.broken_invariant and all(probe.wrong == 0 for probe in self.probes)

    def plain(self) -> dict[str, Any]:
        """For JSON."""
        return {**asdict(self), "holds": self.holds}


def verify(
    scene: str, frame: ReadResult, settings: VerifySettings, progress: Callable[[float], object] | None = None
) -> Verdict:
    """Builds the frame's trees as `record` does and looks for defects in them. `progress` takes the finished share."""
    camera = frame.camera
    renderer = _core.Renderer(frame.scene, width=camera.width, height=camera.height, builder=settings.builder)
    try:
        renderer.verify()
        broken = ""
    except _core.Error as error:
        broken = str(error)
    found = renderer.probe(rays=settings.rays, seed=settings.seed, progress=progress)
    probes = [Probe(**row) for row in found["probes"]]
    return Verdict(scene, found["meshes"], found["closed_meshes"], broken, probes)
