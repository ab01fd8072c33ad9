"""Cycles as a side of `msbvh bench --frames`: Blender's Python module (bpy) in an environment of its own."""

from __future__ import annotations

import json
import os
import shutil
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from ..base.errors import SceneError
from ..base.processes import exit_code, last_line
from . import cycles_script
from .frame_sides import FIGURES, PICTURE, Job
from .scene_parts import CAMERA, FRAME, IRRADIANCE, RATE, SHUTTER

BPY = "5.0.1"
"""Of the package bpy, which needs PYTHON exactly."""
PYTHON = (3, 11)
PROBE = "import bpy; print(bpy.app.version_string)"


@dataclass(frozen=True)
class Cycles:
    """Cycles on the processor, by the Python of an environment that has bpy."""

    python: Path
    name: str = "cycles"

    def command(self, job: Job, folder: Path) -> Sequence[str]:
        """Writes the job for cycles_script."""
        file = folder / "job.json"
        file.write_text(json.dumps(_plain(job, folder)), encoding="utf-8")
        return [str(self.python), "-I", cycles_script.__file__, str(file), str(folder / FIGURES)]

    def figures(self, folder: Path) -> tuple[Mapping[str, float], str]:
        found = json.loads((folder / FIGURES).read_text(encoding="utf-8"))
        return found["seconds"], found["software"]


def _plain(job: Job, folder: Path) -> Mapping[str, object]:
    """A job as cycles_script reads it."""
    return {
        "scene": str(job.file),
        "picture": str(folder / PICTURE),
        "camera": CAMERA.rpartition("/")[2],
        "frame": FRAME,
        "rate": round(RATE),
        "shutter": SHUTTER,
        "irradiance": IRRADIANCE,
        **_shading(job),
        "motion_steps": job.scene.motion_steps,
        "width": job.width,
        "height": job.height,
        "bounces": job.bounces,
        "spp": job.spp,
        "seed": job.seed,
        "threads": job.threads,
    }


def _shading(job: Job) -> Mapping[str, object]:
    """Looks of meshes, by name or for all others, and what shines. A frame of the benchmark has one look."""
    folder = job.file.parent
    looks = {name: look and look.plain(folder) for name, look in job.scene.looks.items()}
    sky = str(folder / job.scene.sky) if job.scene.sky else ""
    return {
        "looks": looks,
        "smooth": job.scene.smooth,
        "radiance": job.scene.radiance,
        "sky": sky,
        "dome": job.scene.dome,
    }


def usual_folder() -> Path:
    """Of the environment, where none is given: in the user's cache."""
    cache = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    return Path(cache) / "msbvh" / f"bpy-{BPY}"


def installed(folder: Path) -> bool:
    """Whether an environment has the bpy that we measure, and it runs."""
    python = _python(folder)
    if not python.is_file():
        return False
    code, said = _run([str(python), "-I", "-c", PROBE])
    return code == 0 and last_line(said).startswith(BPY)


def find_cycles(folder: Path | None, note: Callable[[str], None]) -> Cycles:
    """Cycles, by the environment in a folder (None: usual_folder()), which is made where there is none: a download of
    some 400 MB and a GB on the disk. Raises SceneError where that fails."""
    folder = (folder or usual_folder()).absolute()
    if not installed(folder):
        _check_ours(folder)
        note(f"bench: installing bpy {BPY} in {folder}: a GB, a minute or more")
        _install(folder)
        if not installed(folder):
            _, said = _run([str(_python(folder)), "-I", "-c", PROBE])
            raise SceneError(f"--peer cycles: bpy {BPY} in {folder} does not run: {last_line(said)}")
    return Cycles(_python(folder))


def _check_ours(folder: Path) -> None:
    """Nothing is installed into a folder that holds something else."""
    if folder.exists() and not (folder / "pyvenv.cfg").is_file() and (not folder.is_dir() or any(folder.iterdir())):
        raise SceneError(f"--peer-env: found '{folder}', which is no Python environment; expected one, or a new folder")


def _install(folder: Path) -> None:
    steps = (
        [_matching_python(), "-m", "venv", str(folder)],
        [
            str(_python(folder)),
            "-m",
            "pip",
            "install",
            "--quiet",
            "--no-input",
            "--disable-pip-version-check",
            f"bpy=={BPY}",
        ],
    )
    for step in steps:
        code, said = _run(step)
        if code:
            raise SceneError(f"--peer cycles: cannot install bpy {BPY} in {folder}: {last_line(said)}")


def _matching_python() -> str:
    """A Python that bpy runs in."""
    name = f"python{PYTHON[0]}.{PYTHON[1]}"
    found = sys.executable if sys.version_info[:2] == PYTHON else shutil.which(name)
    if not found:
        raise SceneError(f"--peer cycles: found no {name}, which bpy {BPY} needs; expected one on the PATH")
    return found


def _python(folder: Path) -> Path:
    return folder / "bin" / "python"


def _run(command: Sequence[str]) -> tuple[int | None, bytes]:
    """Exit code and what was said; 127 where the command cannot be run."""
    with os.fdopen(os.memfd_create("msbvh"), "r+b") as log:
        try:
            code = exit_code(command, log)
        except OSError as error:
            return 127, f"{command[0]}: {error.strerror}".encode()
        log.seek(0)
        return code, log.read()
