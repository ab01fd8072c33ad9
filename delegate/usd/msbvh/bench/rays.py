"""The benchmark: scenes, builders and a peer side by side in one run; the rows come from the harness in bench/.

The harness is part of the extension, so that `msbvh bench` works wherever the package is installed. A peer is a
library of its own beside the extension, loaded only by --peer; Embree itself comes from the wheel embreex (the extra
`bench`), whose libraries it finds by itself.
"""

from __future__ import annotations

import fnmatch
import importlib.metadata
import json
import os
import platform
import subprocess
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from pxr import Usd, UsdGeom

from .. import _core
from ..base.errors import Diagnostics, SceneError
from ..camera.render_camera import find_camera
from ..scene.reader import ReadSettings, read_frame
from ..stage.opening import open_stage
from ..stage.value_types import FLOAT
from ..stage.values import value

Row = dict[str, Any]
Report = dict[str, Any]

SHARED = {
    "unitree_g1": "heavy/unitree_g1",
    "chess": "heavy/OpenChessSet",
    "teapots": "heavy/intentvfx_teapotScene",
    "ballistic_usd": "velocity_accel/arnold_1427.3",
}
"""Public scenes that are measured where ../shared/scenes is present: name in the report -> folder."""
SHARED_TRIANGLES = 6_000_000
"""A public scene of more triangles is left out."""
NO_INTERIOR = (0.0, 0.0, 0.0, 0.0)
HALF_A_FRAME = (-0.25, 0.25)


@dataclass(frozen=True)
class BenchSettings:
    """What is measured, and how often."""

    scenes: Sequence[str] = ("*",)
    """Globs of names: `wheels`, or `wheels-9` for one number of keys."""
    peer: str | None = None
    quick: bool = False
    """Small scenes, one thread, the peer's robust mode: under 50 seconds on two cores."""
    builders: Sequence[str] = ()
    """Empty: all of them."""
    threads: Sequence[int] | None = None
    """0: all. None: 1 and all, or for a quick run 1."""
    seed: int = 1
    repetitions: int | None = None
    """None: 5, or for a quick run 3."""
    triangles: int | None = None
    """For every procedural scene; None: each class's own."""

    @property
    def thread_counts(self) -> list[int]:
        return list(self.threads if self.threads is not None else ((1,) if self.quick else (1, 0)))

    @property
    def rounds(self) -> int:
        return self.repetitions or (3 if self.quick else 5)

    def wants(self, *names: str) -> bool:
        """Whether a scene of one of these names is measured."""
        return any(fnmatch.fnmatchcase(name, pattern) for pattern in self.scenes for name in names)


@dataclass(frozen=True)
class Case:
    """A scene to measure: a name, and how to make it: (msbvh._core.Scene, ball inside it)."""

    name: str
    make: Callable[[], tuple[Any, tuple[float, float, float, float]]] = field(repr=False)


@dataclass(frozen=True)
class Peer:
    """Another ray tracer: the library of ours that asks it, and the folder that holds its own."""

    library: Path
    folder: Path

    @property
    def name(self) -> str:
        """As it states itself: `Embree 4.4.0 (AVX-512)`."""
        return _core.bench_peer_name(str(self.library), str(self.folder))


EMBREE = ("embreex", "embreex.libs", "libembree4")
"""The wheel that brings Embree, its folder of libraries, and how the library's name begins."""


def find_peer(peer: str) -> Peer:
    """The peer of this name. Raises SceneError where it is not installed."""
    name = f"msbvh_peer_{peer}.so"
    extension = Path(_core.__file__).parent
    built = [path for path in (extension / name, *_build_folders(name)) if path.is_file()]
    if not built:
        raise SceneError(f"--peer {peer}: found no {extension / name}; expected an installation that has it")
    folder = _embree_folder()
    if folder is None:
        raise SceneError(
            f"--peer {peer}: Embree is not installed; expected the package embreex: pip install embreex==4.4.*"
        )
    return Peer(built[0], folder)


def _embree_folder() -> Path | None:
    """Where the wheel embreex keeps libembree4; None where it is not installed."""
    wheel, folder, library = EMBREE
    try:
        files = importlib.metadata.files(wheel) or []
    except importlib.metadata.PackageNotFoundError:
        return None
    found = [Path(file.locate()) for file in files if file.parent.name == folder and file.name.startswith(library)]
    return found[0].parent if found and found[0].is_file() else None


def _build_folders(name: str) -> Iterator[Path]:
    """Where a build tree of plain CMake keeps the library, when the extension is run from there."""
    extension = Path(_core.__file__).resolve()
    yield from (folder / "bench" / name for folder in extension.parents[:5])


def cases(settings: BenchSettings) -> Iterator[Case]:
    """The scenes to measure: the classes in their order, then the public ones. Raises SceneError for none."""
    found = [*_class_cases(settings), *_shared_cases(settings)]
    if not found:
        known = ", ".join([c["name"] for c in _core.bench_classes()] + [f"shared/{name}" for name in SHARED])
        raise SceneError(f"--scenes {','.join(settings.scenes)}: matches nothing; expected globs of {known}")
    yield from found


def _class_cases(settings: BenchSettings) -> Iterator[Case]:
    for kind in _core.bench_classes():
        triangles = settings.triangles or kind["quick_triangles" if settings.quick else "triangles"]
        for segments, degree in kind["quick_forms" if settings.quick else "forms"]:
            name = kind["name"]
            if settings.wants(name, f"{name}-{segments + 1}"):
                arguments = {"triangles": triangles, "segments": segments, "degree": degree}
                yield Case(name, _maker(name, {**arguments, "seed": settings.seed}))


def _maker(name: str, arguments: dict[str, int]) -> Callable[[], Any]:
    return lambda: _core.bench_scene(name, **arguments)


def shared_folder() -> Path | None:
    """../shared/scenes of the checkout or of the current folder."""
    for root in (Path(__file__).resolve().parents[4], Path.cwd()):
        if (root.parent / "shared" / "scenes" / "INDEX.tsv").is_file():
            return root.parent / "shared" / "scenes"
    return None


def _shared_cases(settings: BenchSettings) -> Iterator[Case]:
    """Public scenes; a quick run takes them only by name."""
    folder = shared_folder()
    if folder is None:
        return
    lines = [line.split("\t") for line in (folder / "INDEX.tsv").read_text(encoding="utf-8").splitlines()]
    index = [dict(zip(lines[0], line, strict=False)) for line in lines[1:]]
    named = any(pattern.startswith("shared/") for pattern in settings.scenes)
    for name, place in SHARED.items():
        if settings.wants(f"shared/{name}") and (named or not settings.quick):
            for entry in index:
                if f"{entry['group']}/{entry['name']}" == place:
                    path = folder / entry["group"] / entry["name"] / entry["root"]
                    yield Case(f"shared/{name}", reader(path, entry["frame"]))
                    break


def reader(path: Path, frame: str) -> Callable[[], Any]:
    def read() -> tuple[Any, tuple[float, float, float, float]]:
        stage = open_stage(str(path), Diagnostics())
        code = stage.GetStartTimeCode() if frame in ("", "None") else float(frame)
        # Peers know no patches.
        settings = ReadSettings(shutter=_shutter(stage, code), displacement="tessellate")
        return read_frame(stage, code, settings).scene, NO_INTERIOR

    return read


def _shutter(stage: Usd.Stage, code: float) -> tuple[float, float] | None:
    """Half a frame where the stage leaves it shut, or has no camera; else None: the camera's own."""
    prim = find_camera(stage, None, Diagnostics())
    if prim is None:
        return HALF_A_FRAME
    camera = UsdGeom.Camera(prim)
    opening, closing = camera.GetShutterOpenAttr(), camera.GetShutterCloseAttr()
    return HALF_A_FRAME if value(opening, code, FLOAT) == value(closing, code, FLOAT) else None


def run(settings: BenchSettings, progress: Callable[[float], object], note: Callable[[str], None]) -> Report:
    """Measures; {"machine": ..., "rows": [...]}. `note` hears of scenes that are left out."""
    load, begin = os.getloadavg()[0], time.monotonic()
    peer = find_peer(settings.peer) if settings.peer else None
    about = machine(settings, peer)
    every = list(cases(settings))
    rows: list[Row] = []
    for done, case in enumerate(every):
        progress(done / len(every))
        scene, interior = case.make()
        triangles = scene.statistics()["triangles"]
        if triangles > SHARED_TRIANGLES:
            note(f"bench: {case.name} is left out: {triangles} triangles, more than {SHARED_TRIANGLES}")
            continue
        rows += map(json.loads, _core.bench_run(scene, interior, **_run_arguments(settings, case.name, peer)))
        if rows and rows[-1]["peer_missing"]:
            note(f"bench: {case.name} has no peer: {rows[-1]['peer_missing']}")
    progress(1.0)
    return {"machine": {**about, "load_average": load, "seconds": time.monotonic() - begin}, "rows": rows}


def _run_arguments(settings: BenchSettings, name: str, peer: Peer | None) -> dict[str, Any]:
    return {
        "name": name,
        "builders": list(settings.builders),
        "threads": settings.thread_counts,
        "rays": 1 << (15 if settings.quick else 16),
        "repetitions": settings.rounds,
        "build_repetitions": 1 if settings.quick else 3,
        "seed": settings.seed,
        "oracle_tests": 4e5 if settings.quick else 1e7,
        "robust": [True] if settings.quick else [True, False],
        "peer": str(peer.library) if peer else "",
        "peer_folder": str(peer.folder) if peer else "",
    }


def host() -> dict[str, Any]:
    """The machine, and this build."""
    return {
        "processor": _processor(),
        "cores": len(os.sched_getaffinity(0)),
        "system": platform.platform(),
        "instruction_set": _core.supported_instruction_sets()[-1],
        "msbvh": _core.__version__,
        "commit": _commit(),
    }


def machine(settings: BenchSettings, peer: Peer | None) -> dict[str, Any]:
    """What the figures depend on."""
    return {
        **host(),
        "peer": peer.name if peer else None,
        "threads": settings.thread_counts,
        "builders": list(settings.builders),
        "seed": settings.seed,
        "repetitions": settings.rounds,
        "quick": settings.quick,
        "scenes": list(settings.scenes),
        "triangles": settings.triangles,
    }


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return platform.processor()
    return next((line.partition(":")[2].strip() for line in lines if line.startswith("model name")), "unknown")


def _commit() -> str | None:
    """Of the checkout that the package runs from; None where it is none."""
    command = ["git", "-C", str(Path(__file__).resolve().parent), "describe", "--always", "--dirty"]
    try:
        found = subprocess.run(command, capture_output=True, text=True, timeout=10, check=False)
    except OSError:
        return None
    return found.stdout.strip() or None
