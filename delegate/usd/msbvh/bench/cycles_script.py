"""Renders a frame of the benchmark with Cycles: a script that Blender's Python module (bpy) runs.

    python -I cycles_script.py JOB.json FIGURES.json

It imports nothing of ours but cycles_looks beside it: bpy has an environment of its own. A job is what cycles_peer writes.
"""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

BUILDING, TRACING, DONE = "Updating Scene", "Sample ", "Finished"
"""How Cycles' status lines begin when a phase does."""

Status = Sequence[tuple[float, str]]
"""Times, and what Cycles said then."""


def main(arguments: Sequence[str]) -> None:
    job = json.loads(Path(arguments[0]).read_text(encoding="utf-8"))
    import bpy

    begin = time.perf_counter()
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.wm.usd_import(filepath=job["scene"])
    scene = bpy.context.scene
    scene.camera = bpy.data.objects[job["camera"]]
    _look(bpy, job)
    _motion(bpy.data, scene, job)
    _sampling(scene, job)
    status: list[tuple[float, str]] = []
    bpy.app.handlers.render_stats.append(lambda *said: status.append((time.perf_counter(), str(said[0]))))
    bpy.ops.render.render(write_still=True)
    seconds = phases(begin, status, time.perf_counter())
    figures = {"seconds": seconds, "software": f"Cycles of Blender {bpy.app.version_string}"}
    Path(arguments[1]).write_text(json.dumps(figures), encoding="utf-8")


def phases(begin: float, status: Status, end: float) -> Mapping[str, float]:
    """Seconds of each phase. Raises ValueError where Cycles has not said when one begins."""
    starts = [begin, *(_said(status, first) for first in (BUILDING, TRACING, DONE)), end]
    named = zip(("read", "build", "trace", "write"), starts, starts[1:], strict=False)
    return {name: start_of_next - start for name, start, start_of_next in named}


def _said(status: Status, first: str) -> float:
    """When Cycles first said so."""
    for at, said in status:
        if said.rpartition("| ")[2].startswith(first):
            return at
    raise ValueError(f"found no status '{first}', expected one of Cycles' own")


def _look(bpy: Any, job: Mapping[str, Any]) -> None:
    """Each mesh's surface, lights as bright as ours, and a sky where there is one."""
    sys.path.append(str(Path(__file__).parent))  # Isolated, Python looks nowhere near a script.
    import cycles_looks

    data, made = bpy.data, {}
    for mesh in data.meshes:
        name = mesh.name if mesh.name in job["looks"] else "*"
        if name not in made:
            made[name] = cycles_looks.material_of(data, job["looks"][name])
        mesh.materials.clear()
        mesh.materials.append(made[name])
        if mesh.name in job["smooth"]:
            mesh.shade_smooth()
        else:
            mesh.shade_flat()  # Blender's importer makes smooth what has no normals.
    cycles_looks.set_lights(data, job)
    if job["dome"]:
        cycles_looks.set_dome(data, bpy.context.scene, job["dome"])
    if job["sky"]:
        cycles_looks.set_sky(data, bpy.context.scene, job["sky"])


def _motion(data: Any, scene: Any, job: Mapping[str, Any]) -> None:
    scene.frame_set(job["frame"])
    render = scene.render
    render.fps = job["rate"]
    render.use_motion_blur = True
    opened, closed = job["shutter"]
    if opened + closed:
        raise ValueError(f"found a shutter of {opened}:{closed}, expected one centred about the frame")
    render.motion_blur_shutter, render.motion_blur_position = closed - opened, "CENTER"
    for found in data.objects:
        found.cycles.use_motion_blur = found.cycles.use_deform_motion = True
        found.cycles.motion_steps = job["motion_steps"]


def _sampling(scene: Any, job: Mapping[str, Any]) -> None:
    """The same picture as ours: a box filter, no denoiser, as many samples everywhere, no clamp. Spatial splits gain
    up to 5 %."""
    render, cycles = scene.render, scene.cycles
    render.engine, cycles.device = "CYCLES", "CPU"
    render.threads_mode, render.threads = "FIXED", job["threads"]
    cycles.samples, cycles.seed = job["spp"], job["seed"]
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    cycles.max_bounces = cycles.diffuse_bounces = cycles.glossy_bounces = job["bounces"]
    cycles.blur_glossy = 0.0
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0.0
    cycles.pixel_filter_type, cycles.filter_width = "BOX", 1.0
    cycles.debug_use_spatial_splits = True
    cycles.use_auto_tile = render.use_persistent_data = False
    render.resolution_x, render.resolution_y, render.resolution_percentage = job["width"], job["height"], 100
    render.image_settings.file_format, render.image_settings.color_depth = "OPEN_EXR", "32"
    render.filepath = job["picture"]


if __name__ == "__main__":
    main(sys.argv[1:])
