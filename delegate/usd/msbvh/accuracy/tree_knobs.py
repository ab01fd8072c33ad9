"""Knobs of the acceleration structure: they change what a frame costs and nothing in its picture."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from .. import _core
from .facts import FRAMES_OF_A_SEQUENCE, SceneFacts
from .knobs import Knob, Step, steps_of

FRAMES = "frames"
"""Not of `record` as it stands here: how many frames a point renders, one after the other."""


def _builders(facts: SceneFacts, few: bool) -> Mapping[str, Sequence[Step]]:
    return {"": steps_of("builder", ("msbvh", "mbvh") if few else tuple(_core.builders()))}


def _layouts(facts: SceneFacts, few: bool) -> Mapping[str, Sequence[Step]]:
    return {"": steps_of("layout", ("full", "compact"))}


def _budgets(facts: SceneFacts, few: bool) -> Mapping[str, Sequence[Step]]:
    return {"": steps_of("split-budget", (0.0, 1.0) if few else (0.0, 0.25, 0.5, 1.0, 2.0, 4.0))}


def _refits(facts: SceneFacts, few: bool) -> Mapping[str, Sequence[Step]]:
    frames = min(facts.frames, FRAMES_OF_A_SEQUENCE)
    return {f"{frames} frames": steps_of("refit", ("never", "auto", "always"), **{FRAMES: frames})}


TREE_KNOBS = (
    Knob(
        name="Builder",
        option="builder",
        unit="",
        says="Which acceleration structure: msbvh splits primitives, mbvh does not, swept has boxes that stand still,"
        " timesplit a tree for each motion segment.",
        error="none",
        steps=_builders,
        joint=False,
    ),
    Knob(
        name="Node precision",
        option="layout",
        unit="",
        says="How trees are kept: full has boxes of 32 bits and leaves with vertices of their own, compact boxes of 16 bits and"
        " leaves that read the meshes' points.",
        error="none",
        steps=_layouts,
        joint=False,
    ),
    Knob(
        name="Split budget",
        option="split-budget",
        unit="",
        says="References that spatial splits may add, as a share of the triangles.",
        error="none",
        steps=_budgets,
        joint=False,
    ),
    Knob(
        name="Robust traversal",
        option="robust",
        unit="",
        says="Whether rays that pass through edges and corners are certain to be met.",
        error="none",
        steps=lambda facts, few: {},
        idle=lambda facts: "rays are always traced robustly, there is no other way here",
        joint=False,
    ),
    Knob(
        name="Refit",
        option="refit",
        unit="",
        says="Whether a frame takes over the trees of the frame before it. Times are those of a whole sequence.",
        error="none",
        steps=_refits,
        idle=lambda facts: "" if facts.frames > 1 else "the stage has no frame after this one",
        joint=False,
    ),
)
