"""Knobs of light and noise: samples, their pattern, and how far paths go."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from .._core import MOST_SAMPLES_OF_NOISE
from .facts import SceneFacts
from .knobs import Knob, Step, steps_of

SAMPLES = (1, 4, 16, 64, 256)
BOUNCES = (0, 1, 2, 4, 8)
NOISE = (0.2, 0.1, 0.05)
TEXTURE_RATES = (4.0, 2.0, 1.0, 0.5)
MOST_BOUNCES = 8
"""Stands for paths without an end."""


def _samples(facts: SceneFacts, few: bool) -> Mapping[str, Sequence[Step]]:
    return {"": steps_of("spp", (1, 4, 16) if few else SAMPLES)}


def _bounces(facts: SceneFacts, few: bool) -> Mapping[str, Sequence[Step]]:
    return {"": steps_of("max-bounces", (0, 2, 8) if few else BOUNCES)}


def _samplers(facts: SceneFacts, few: bool) -> Mapping[str, Sequence[Step]]:
    return {"": steps_of("sampler", ("independent", "sobol"))}


def _noise(facts: SceneFacts, few: bool) -> Mapping[str, Sequence[Step]]:
    return {"": steps_of("noise", NOISE[:2] if few else NOISE, spp=MOST_SAMPLES_OF_NOISE)}


def _texture_rates(facts: SceneFacts, few: bool) -> Mapping[str, Sequence[Step]]:
    return {"": steps_of("texture-rate", (4.0, 1.0) if few else TEXTURE_RATES)}


SAMPLING_KNOBS = (
    Knob(
        name="Samples",
        option="spp",
        unit="a pixel",
        says="Samples per pixel. They mend noise and nothing else.",
        error="noise",
        steps=_samples,
    ),
    Knob(
        name="Noise target",
        option="noise",
        unit="relative error",
        says="The error each pixel may keep; cleaner pixels take fewer samples.",
        error="noise",
        steps=_noise,
        joint=False,
    ),
    Knob(
        name="Path depth",
        option="max-bounces",
        unit="bounces",
        says="How often light goes from surface to surface before it is left out.",
        error="light",
        steps=_bounces,
        idle=lambda facts: "" if facts.has("indirect light") else "no light goes from one surface to another here",
    ),
    Knob(
        name="Sampler",
        option="sampler",
        unit="",
        says="How samples are spread over a pixel, the shutter and the lights: each by itself at random, or by"
        " Owen-scrambled Sobol' points, which keep clear of each other.",
        error="noise",
        steps=_samplers,
        joint=False,
    ),
    Knob(
        name="Texture rate",
        option="texture-rate",
        unit="of the footprint",
        says="Texture filter width over the ray's footprint: above 1 softer, fewer texels.",
        error="look",
        steps=_texture_rates,
        idle=lambda facts: "" if facts.has("textures") else "nothing is textured here",
        joint=False,
    ),
)
