"""Knobs of shape: how finely surfaces are cut, and what curves and displaced surfaces become."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from .facts import SceneFacts
from .knobs import Knob, Step, steps_of

EDGE_LENGTHS = (8.0, 4.0, 2.0, 1.0, 0.5)
"""Pixels."""
FINEST_EDGE = 0.5
FINEST_COMPLEXITY = "veryhigh"


def _edges(facts: SceneFacts, few: bool) -> Mapping[str, Sequence[Step]]:
    lengths = steps_of("edge-length", (8.0, 1.0) if few else EDGE_LENGTHS)
    cage = [Step("cage", step.options) for step in steps_of("edge-length", (0.0,))]
    return {"": [*cage, *lengths]}


def _complexities(facts: SceneFacts, few: bool) -> Mapping[str, Sequence[Step]]:
    return {"": steps_of("complexity", ("low", "high") if few else ("low", "medium", "high", "veryhigh"))}


def _displacements(facts: SceneFacts, few: bool) -> Mapping[str, Sequence[Step]]:
    return {"": steps_of("displacement", ("none", "patches", "tessellate"))}


def _curves(facts: SceneFacts, few: bool) -> Mapping[str, Sequence[Step]]:
    return {"": steps_of("curves", ("ribbon", "tube"))}


SHAPE_KNOBS = (
    Knob(
        name="Edge length",
        option="edge-length",
        unit="px",
        says="About how long the edges of subdivided and displaced surfaces are in the picture: also the rate at which"
        " displacement is read. Half of it takes four times the triangles.",
        error="shape",
        steps=_edges,
        idle=lambda facts: "" if facts.has("subdivision") else "nothing in this frame is subdivided",
    ),
    Knob(
        name="Complexity",
        option="complexity",
        unit="",
        says="How finely spheres, cylinders and the like are cut, and subdivided surfaces where no edge length is given.",
        error="shape",
        steps=_complexities,
        idle=lambda facts: "" if facts.cut else "nothing in this frame is cut by it",
    ),
    Knob(
        name="Displacement",
        option="displacement",
        unit="",
        says="Whether surfaces are displaced, and what they become: grids of points in the tree, or triangles.",
        error="shape",
        steps=_displacements,
        idle=lambda facts: "" if facts.has("displacement") else "nothing in this frame is displaced",
        joint=False,
    ),
    Knob(
        name="Curves",
        option="curves",
        unit="",
        says="What curves are drawn as: flat ribbons, or round tubes. They are two looks, neither an error of the other.",
        error="look",
        steps=_curves,
        idle=lambda facts: "" if facts.has("curves") else "there are no curves in this frame",
        joint=False,
    ),
)
