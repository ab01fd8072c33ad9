"""The record command: stage in, images out."""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

from pxr import Usd

from .. import _core
from ..base.atomic import OutputError
from ..base.errors import Diagnostics
from ..base.image_metadata import ImageMetadata
from ..base.progress import PATIENCE_SECONDS, Progress
from ..base.reporter import Reporter
from ..base.software import software
from ..output.images import ImageSettings, Layers, write_image
from ..output.outputs import Outputs
from ..output.stats import FrameStats, RunStats
from ..plan_report.measured import measured_effects
from ..plan_report.ray_shares import ray_shares
from ..scene.reader import ReadResult, ReadSettings, read_frame
from ..stage.opening import open_stage
from ..stage.stage_metadata import frames_per_second, start_time
from .budget import AIM, writing_seconds
from .budget_told import tell_budget
from .film import film_settings
from .fine_enough import FineEnough
from .frame_layers import Rendered, frame_layers
from .sampling import Wanted, rendered_aovs, time_limit_note, traced, with_denoised
from .settings import FrameJob, RecordSettings, RenderSettings, asked_settings, check_samples, in_one_space

TRACK_FIELDS = (
    "path",
    "source",
    "rule",
    "segments",
    "degree",
    "time_remap",
    "hidden_partly",
    "moving_transform",
    "error_pixels",
    "tolerance_pixels",
    "error_outside",
    "outside",
    "coarser",
    "keys_saved",
    "shape_error_pixels",
    "bytes",
    "count",
)
"""Of a _core.TrackReport, for statistics."""

NOTHING_SEEN = (
    "nothing is in the picture: the camera was made for the stage's bounds, and authored extents that do not fit the points put"
    " those elsewhere; expected a camera on the stage, or extents that fit"
)
MOTION_AOVS = {"forward", "backward", "motionCurve"}
NO_MOTION = "AOVs of motion are 0: the shutter is closed; expected an open one, as by --shutter -0.25:0.25"


def record(
    scene: str, jobs: Sequence[FrameJob] | Sequence[str], settings: RecordSettings, reporter: Reporter
) -> RunStats:
    """Renders the frames of a scene and writes their images; file names alone mean the stage's start time.

    Raises SceneError and _core.Error for a scene that cannot be rendered, OutputError for a file that cannot
    be written, OutputClash for one that must not be, ColorError for an unknown display or view. Every file is
    checked before the first frame.
    """
    settings = in_one_space(settings)
    check_samples(settings)
    settings.image.color.resolve()
    images = [file for job in jobs for file in ([job] if isinstance(job, str) else job[1])]
    outputs = Outputs(images, settings.stats)
    outputs.check_scene(scene)

    run = RunStats(software(), scene, _plain(settings), _core.supported_instruction_sets())
    diagnostics = Diagnostics()
    start = time.perf_counter()
    stage = open_stage(scene, diagnostics, settings.mask)
    read_seconds = time.perf_counter() - start
    report(diagnostics, reporter)
    outputs.check_stage(stage)
    frame_jobs = _frame_jobs(jobs, stage)
    settings = _with_render_settings(stage, frame_jobs, settings, reporter)
    run.settings = _plain(settings)
    rendered = replace(settings.render, aovs=_sampling(settings).aovs, sample_stages=settings.ray_costs)
    kept = Kept(Trees(rendered, len(frame_jobs)), _core.RefinementCache(), FineEnough())
    for frame, files in frame_jobs:
        run.frames.append(_record_frame(stage, frame, files, settings, kept, reporter, read_seconds))
        read_seconds = 0.0  # The stage is opened once: its time stands with the first frame.
    run.warnings, run.errors = list(reporter.warnings), list(reporter.errors)
    if settings.stats is not None:
        run.write(settings.stats)
    return run


def _with_render_settings(
    stage: Usd.Stage, jobs: Sequence[FrameJob], settings: RecordSettings, reporter: Reporter
) -> RecordSettings:
    diagnostics = Diagnostics()
    settings = asked_settings(stage, jobs[0], settings, diagnostics)
    report(diagnostics, reporter)
    return settings


class Trees:
    """Renderers of a run's frames; trees go from one to the next as settings.refit says."""

    def __init__(self, settings: RenderSettings, frames: int) -> None:
        """`settings`: with the AOVs that are to be rendered, be they written or not."""
        self._settings = settings
        self._frames_left = frames
        self._renderer: _core.Renderer | None = None

    def renderer(self, result: ReadResult) -> _core.Renderer:
        """Of the next frame. Frees the scene and the trees of the last one, and holds none where none follows."""
        self._frames_left -= 1
        reuse = self._settings.refit != "never"
        settings = {
            **asdict(self._settings),
            "width": result.camera.width,
            "height": result.camera.height,
            "film": film_settings(self._settings.film, result.camera),
            "keep_topology": reuse and self._frames_left > 0,
        }
        if self._renderer is None:
            renderer = _core.Renderer(result.scene, **settings)
        else:
            renderer = self._renderer
            renderer.commit(result.scene, **settings)
        self._renderer = renderer if settings["keep_topology"] else None
        return renderer


@dataclass(frozen=True)
class Kept:
    """What a run's frames take over from each other. The pictures are those of frames by themselves."""

    trees: Trees
    refinements: _core.RefinementCache
    fine_enough: FineEnough


def _frame_jobs(jobs: Sequence[FrameJob] | Sequence[str], stage: Usd.Stage) -> Sequence[FrameJob]:
    files = [job for job in jobs if isinstance(job, str)]
    return [(start_time(stage), files)] if files else [job for job in jobs if not isinstance(job, str)]


def _record_frame(
    stage: Usd.Stage,
    frame: float | None,
    files: Sequence[str],
    settings: RecordSettings,
    kept: Kept,
    reporter: Reporter,
    read_seconds: float,
) -> FrameStats:
    stats, begin = FrameStats(frame, list(files)), time.perf_counter() - read_seconds
    limit = settings.time_limit
    ends = begin + (AIM * (settings.goals.seconds or math.inf) if limit is None else limit)
    stats.seconds["read"] = read_seconds
    before = kept.refinements.counts
    with stats.timed("sample"), reading_progress(frame) as progress:
        read = partial(_read, stage, frame, progress, kept)
        wanted = settings.goals.error_px
        asked = replace(settings.read, max_bounces=settings.render.max_bounces)
        result = read(asked) if wanted is None else kept.fine_enough.read(stage, read, asked, wanted)
    stats.subdivision = {name: count - before[name] for name, count in kept.refinements.counts.items()}
    rate = frames_per_second(stage, result.diagnostics)
    report(result.diagnostics, reporter)
    camera = result.camera
    stats.width, stats.height = camera.width, camera.height
    stats.shutter = (camera.shutter.open, camera.shutter.close)
    stats.scene = dict(result.scene.statistics())
    stats.left_out = result.left_out
    coarser = result.coarser_tracks
    stats.coarser_tracks = {**vars(coarser), "prims": len(coarser.prims)}
    stats.tracks = [{name: getattr(track, name) for name in TRACK_FIELDS} for track in result.tracks]
    with stats.timed("build"):
        renderer = kept.trees.renderer(result)
    stats.plan = plan_entries(renderer)
    sampling = _sampling(settings)
    writing = writing_seconds(camera.width * camera.height, len(files))
    outcome = traced(renderer, sampling, ends - writing, stats, frame_label(frame))
    denoised = with_denoised(outcome, stats) if settings.denoise else None
    _tell_texture_faults(renderer, reporter)
    pixels, aovs = outcome.pixels, {name: outcome.aovs[name] for name in settings.render.aovs}
    if settings.ray_costs:
        with stats.timed("ray_costs"):
            costs = renderer.ray_costs()
            rendered = ", ".join(sampling.aovs)
            effects = _core.effects(
                result.scene,
                max_bounces=settings.render.max_bounces,
                aovs=rendered,
                refraction=settings.render.refraction,
            )
            stats.render["ray_costs"] = {**costs, "effects": ray_shares(effects, costs)}
            stats.render["effects"] = measured_effects(effects, stats.render["stages"], costs)
    if camera.shutter.open == camera.shutter.close and MOTION_AOVS & set(settings.render.aovs):
        reporter.warning(NO_MOTION)
    if not camera.path and not pixels[..., 3].any():
        reporter.warning(NOTHING_SEEN)
    with stats.timed("write"):
        rendered_frame = Rendered(pixels, aovs, outcome.slices, denoised)
        layers = frame_layers(rendered_frame, result, settings.layers, renderer.crypto_manifest)
        _write_images(
            files, layers, _metadata(rate, result, stats, replace(settings.render, spp=outcome.samples)), settings.image
        )
    limited = time_limit_note(sampling, outcome.samples)
    if limited is not None:
        reporter.note(f"{frame_label(frame)}: {limited}")
    if settings.goals.any:
        tell_budget(stats, settings.goals, outcome, reporter)
    reporter.note(f"{frame_label(frame)}: wrote {', '.join(files)} in {sum(stats.seconds.values()):.1f} s")
    return stats


def _read(stage: Usd.Stage, frame: float | None, progress: Progress, kept: Kept, settings: ReadSettings) -> ReadResult:
    return read_frame(stage, frame, settings, progress=progress, refinements=kept.refinements)


def _sampling(settings: RecordSettings) -> Wanted:
    render = settings.render
    aovs = rendered_aovs(render.aovs, settings.goals, settings.denoise)
    return Wanted(render.spp, settings.goals, settings.time_limit, render.film, aovs, render.noise)


def _tell_texture_faults(renderer: _core.Renderer, reporter: Reporter) -> None:
    for name, file, reason in renderer.texture_faults:
        reporter.warning(f"texture @{name}@: {file}: {reason}; drawn as its fallback")


def report(diagnostics: Diagnostics, reporter: Reporter) -> None:
    """Prints what the reader found, by its weight; a prim that was not rendered does not end the run."""
    for diagnostic in diagnostics:
        say = {"note": reporter.note, "warning": reporter.warning, "error": reporter.missing}
        say[diagnostic.severity](str(diagnostic))


def plan_entries(renderer: Any) -> list[dict[str, str]]:
    """The effect plan as plain data."""
    return [{"effect": effect, "prim": prim, "why": why} for effect, prim, why in renderer.plan]


def reading_progress(frame: float | None) -> Progress:
    """For read_frame(); silent where that is quick."""
    return Progress(f"msbvh: reading {frame_label(frame)}", delay_seconds=PATIENCE_SECONDS)


def frame_label(frame: float | None) -> str:
    """How a frame is called in messages."""
    return "default time" if frame is None else f"frame {frame:g}"


def _metadata(rate: float, result: ReadResult, stats: FrameStats, settings: RenderSettings) -> ImageMetadata:
    camera = result.camera
    return ImageMetadata(
        software=software(),
        frame=stats.frame,
        frames_per_second=rate,
        shutter=(camera.shutter.open, camera.shutter.close),
        spp=settings.spp,
        seed=settings.seed,
        render_seconds=sum(stats.seconds.values()),
        world_to_camera=camera.world_to_camera,
        world_to_ndc=camera.world_to_ndc,
        pixel_aspect_ratio=camera.pixel_aspect_ratio,
        noise=settings.noise,
        min_spp=settings.min_spp,
    )


def _write_images(files: Sequence[str], layers: Layers, metadata: ImageMetadata, settings: ImageSettings) -> None:
    """All that can be written: the picture is not lost where one of several disks is full."""
    faults: list[str] = []
    for file in files:
        try:
            write_image(Path(file), layers, metadata, settings)
        except OutputError as error:
            faults.append(str(error))
    if faults:
        raise OutputError("; ".join(faults))


def _plain(settings: RecordSettings) -> dict[str, Any]:
    """The settings as JSON knows them."""
    values = asdict(settings)
    values["choice"] = None if settings.choice is None else settings.choice.path
    values["stats"] = None if settings.stats is None else str(settings.stats)
    if settings.read.shutter is not None:  # JSON has no NaN.
        values["read"]["shutter"] = [x if math.isfinite(x) else str(x) for x in settings.read.shutter]
    return values
