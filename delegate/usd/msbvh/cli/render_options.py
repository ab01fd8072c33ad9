"""The options of `msbvh record` that say how the renderer works, with what each costs."""

from __future__ import annotations

from collections.abc import Sequence

import click

from .. import _core
from ..stage.rendering_space import LINEAR_REC709, RENDERING_SPACES
from .options import MAX_SPP, Decorator, finite

THREADS = click.option(
    "--threads",
    type=click.IntRange(0, 4096),
    default=0,
    show_default=True,
    help="Threads to render with; 0: all cores.",
)

MAX_BOUNCES = click.option(
    "--max-bounces",
    type=click.IntRange(0, 64),
    default=2,
    show_default=True,
    help="Bounces of indirect light; 0: direct light only.",
)

REFRACTION = click.option(
    "--refraction/--no-refraction",
    default=False,
    help="Refract light through transparent surfaces (UsdPreviewSurface, opacityMode transparent) by their ior. Each surface"
    " crossed is a bounce: glass needs --max-bounces 4 or more. Alpha is 1 there. Light reaches what is behind glass by"
    " bounces only: noisy, and none from lights without a size. Without it, one sees straight through.",
)

RENDER: Sequence[Decorator] = (
    click.option(
        "--spp",
        type=click.IntRange(1, MAX_SPP),
        default=64,
        show_default=True,
        help="Samples per pixel; with --noise or --time-limit at most. Four times the samples halve the noise and take four"
        " times as long.",
    ),
    click.option(
        "--seed",
        type=click.IntRange(0, 2**32 - 1),
        default=0,
        show_default=True,
        help="Random seed. The same seed gives the same pixels, whatever the number of threads.",
    ),
    MAX_BOUNCES,
    REFRACTION,
    click.option(
        "--enableDomeLightVisibility",
        "show_domes",
        is_flag=True,
        help="Show dome lights behind the scene. Alpha stays the coverage of the scene.",
    ),
    THREADS,
    click.option(
        "--builder",
        type=click.Choice(tuple(_core.builders())),
        default="msbvh",
        show_default=True,
        help="Acceleration structure, for comparisons. mbvh: no spatial splits (the paper's baseline). swept: static boxes"
        " (slow rays). timesplit: one tree per motion segment (memory and build time grow with them).",
    ),
    click.option(
        "--split-budget",
        type=click.FloatRange(0.0, 64.0),
        callback=finite,
        default=1.0,
        show_default=True,
        metavar="SHARE",
        help="References that the builder's spatial splits may add, as a share of the triangles; spent only where boxes overlap."
        " More: faster rays among long, thin triangles, more memory and a longer build. 0: none.",
    ),
    click.option(
        "--sampler",
        type=click.Choice(("sobol", "independent")),
        default="sobol",
        show_default=True,
        help="How samples are spread. sobol: well apart over the pixel, the shutter and the lights. independent: each by itself"
        " at random, for comparisons; noisier at the same cost.",
    ),
    click.option(
        "--texture-memory",
        "texture_memory_mb",
        type=click.FloatRange(16.0, 1048576.0),
        callback=finite,
        default=1024.0,
        show_default=True,
        metavar="MB",
        help="Memory for what is read of textures. Less: parts are read again and again. The picture is the same.",
    ),
    click.option(
        "--texture-rate",
        type=click.FloatRange(1 / 64, 64.0),
        callback=finite,
        default=1.0,
        show_default=True,
        metavar="FACTOR",
        help="Texture filter width, as a multiple of the ray's footprint. Above 1: softer, fewer texels read. Below 1:"
        " sharper with enough samples, noisier with few.",
    ),
    click.option(
        "--rendering-space",
        type=click.Choice(RENDERING_SPACES),
        default=LINEAR_REC709,
        show_default=True,
        help="Colour space to render in. Colours of textures, materials, lights and primvars are converted to it; EXR files"
        " are in this space and tagged with it; display formats are converted from it. acescg: wider gamut, for"
        " compositing.",
    ),
    click.option(
        "--layout",
        type=click.Choice(("full", "compact")),
        default="full",
        show_default=True,
        help="How trees are kept in memory. compact: boxes in 16 bits a plane, leaves that read the meshes' own points. By"
        " measurement 0.15 to 0.5 of the bytes where things move, 0.6 to 0.7 where they stand still, for about a fifth"
        " fewer rays a second, half as many where incoherent rays meet thin strands at 9 keys. The picture is the same.",
    ),
    click.option(
        "--refit",
        type=click.Choice(("auto", "always", "never")),
        default="auto",
        show_default=True,
        help="What happens to trees from frame to frame. auto: keep those of static geometry and refit those of moving"
        " geometry, until tracing is estimated to cost 20 % more. always: the same, regardless of cost. Both hold two"
        " frames in memory. never: rebuild every frame, for the fastest rays and the least memory. The picture is the"
        " same.",
    ),
    click.option(
        "--renderer",
        "-r",
        metavar="NAME",
        help="Accepted for compatibility with usdrecord; the renderer is always msbvh.",
    ),
    click.option(
        "--disableGpu",
        is_flag=True,
        expose_value=False,
        help="Accepted for compatibility with usdrecord; msbvh never uses a GPU.",
    ),
)
"""How the renderer works."""
