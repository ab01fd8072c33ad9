"""What a recording is asked for, and what a render settings prim makes of that."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from pxr import Usd

from ..base.errors import Diagnostics, SceneError
from ..output.images import ImageSettings
from ..render_settings.asked import Asked, SettingsChoice, applied_to_reading, asked_of, own_render_settings
from ..render_settings.layers import FileLayers, file_layers, tell_unwritten
from ..scene.reader import ReadSettings
from ..stage.rendering_space import LINEAR_REC709
from .budget import Goals
from .film import Film
from .sampling import clash_with_noise


@dataclass(frozen=True)
class RenderSettings:
    """How the renderer samples; see core/api/renderer.h for what each costs."""

    spp: int = 64
    seed: int = 0
    max_bounces: int = 2
    threads: int = 0
    """0: all."""
    show_domes: bool = False
    """Whether dome lights are seen behind the scene (usdrecord's --enableDomeLightVisibility)."""
    builder: str = "msbvh"
    layout: str = "full"
    """Of the trees, full or compact: core/build/settings.h."""
    aovs: tuple[str, ...] = ()
    """What is written beside colour, of _core.aov_names()."""
    refit: str = "auto"
    """What a frame's trees take over from those of the frame before: core/build/settings.h."""
    sampler: str = "sobol"
    """core/integrate/sampler.h."""
    split_budget: float = 1.0
    """References that spatial splits may add, as a share of the triangles: core/build/settings.h."""
    sample_stages: bool = False
    """Whether the renderer's statistics say what its threads were found at."""
    film: Film = Film()
    refraction: bool = False
    """Whether what is transparent bends light by its ior."""
    texture_memory_mb: float = 1024.0
    """Of texels that are kept, at most: core/texture/texture_cache.h."""
    texture_rate: float = 1.0
    """Times the widths that textures are filtered over."""
    noise: float = 0.0
    """Relative error that a pixel may keep, core/film/noise_goal.h; spp is then the most. 0: off."""
    min_spp: int = 32
    clamp_indirect: float = 0.0
    """Most indirect light of a sample, which is lost above; 0: off."""
    rendering_space: str = LINEAR_REC709
    """That textures are converted to; a recording takes what RecordSettings.read has."""


@dataclass(frozen=True)
class RecordSettings:
    """Everything about a recording but the scene and the files."""

    read: ReadSettings = ReadSettings()
    render: RenderSettings = RenderSettings()
    image: ImageSettings = ImageSettings()
    mask: tuple[str, ...] = ()
    """Prims that the stage is limited to; empty: all."""
    stats: Path | None = None
    """Where the run's figures go, as JSON."""
    goals: Goals = Goals()
    """What every frame has to keep."""
    time_limit: float | None = None
    """Seconds of a frame after which no more samples are taken, from its reading on."""
    denoise: bool = False
    """Whether a denoised picture is written beside the raw one."""
    ray_costs: bool = False
    """Whether they say what rays cost: Renderer.ray_costs()."""
    choice: SettingsChoice | None = None
    """Which render settings prim counts; None: none does, not even one that the stage's metadata names."""
    layers: FileLayers | None = None
    """Of .exr files, with the formats of their channels; None: render.aovs under their own names."""


FrameJob = tuple[float | None, Sequence[str]]
"""A time code (None: USD's default time) and the files that its image is written to."""


def in_one_space(settings: RecordSettings) -> RecordSettings:
    """Textures and the picture are in the rendering space of what is read."""
    space = settings.read.rendering_space
    return replace(
        settings,
        render=replace(settings.render, rendering_space=space),
        image=replace(settings.image, color=replace(settings.image.color, rendering_space=space)),
    )


def check_samples(settings: RecordSettings) -> None:
    """Raises SceneError where more than one of the settings decides how many samples there are."""
    clash = clash_with_noise(settings.goals, settings.render.film)
    if clash and (settings.render.noise > 0.0 or settings.time_limit is not None):
        raise SceneError(f"noise and time limit: {clash}")


def with_asked(
    asked: Asked, files: Sequence[str], settings: RecordSettings, diagnostics: Diagnostics
) -> RecordSettings:
    """The settings as a render settings prim changes them; `files`: of the first picture."""
    given = settings.choice.given if settings.choice else frozenset()
    layers = file_layers(asked, settings.render.aovs, diagnostics)
    tell_unwritten(asked, files, diagnostics)
    image = settings.image
    if layers.color_half is not None and "exr_float" not in given:
        image = replace(image, exr_float=not layers.color_half)
    read = applied_to_reading(asked, settings.read, given, diagnostics)
    own = own_render_settings(asked.spec.own, given)
    clash = clash_with_noise(settings.goals, settings.render.film)
    if own.get("noise") and clash:
        diagnostics.warning(asked.path, "msbvh:noise", f"ignored: {clash}")
        del own["noise"]
        if asked.spec.own.samples is None:
            own.pop("spp", None)
    diagnostics.note("", "", f"render settings: {asked.path}")
    return in_one_space(
        replace(
            settings,
            read=replace(read, keep_faces="elementId" in layers.aovs, keep_st="st" in layers.aovs),
            render=replace(settings.render, aovs=layers.aovs, **own),
            image=image,
            layers=layers,
        )
    )


def asked_settings(
    stage: Usd.Stage, job: FrameJob, settings: RecordSettings, diagnostics: Diagnostics
) -> RecordSettings:
    """With what a render settings prim changes, where one counts; `job`: the first. Raises SceneError where the one that
    is asked for is not there."""
    if settings.choice is None:
        return settings
    frame, files = job
    asked = asked_of(stage, settings.choice, frame, diagnostics)
    return settings if asked is None else with_asked(asked, files, settings, diagnostics)
