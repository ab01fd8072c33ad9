"""The gate that attribute values come through: what it takes, and that nothing goes around it."""

from __future__ import annotations

import random
import re
from collections.abc import Iterator
from functools import cache

import pytest
from conftest import ROOT
from every_attribute import SCENES
from msbvh import value_types, values
from msbvh.value_types import Kind
from pxr import Sdf, Usd
from soak import soak_count, soak_figure
from sound_neighbour import messages, render, shows_good, stage_of

PACKAGE = ROOT / "delegate" / "usd" / "msbvh"
KINDS = [kind for kind in vars(value_types).values() if isinstance(kind, Kind)]

EVALUATORS = {
    r"\.GetCamera\(": set(),
    r"\.ComputePurpose\(": set(),
    r"\.ComputeModelDrawMode\(": set(),
    r"\.ComputeMaskAtTime\(": set(),
    r"\.ComputeVisibility\(": {"bounds"},
    r"\.GetIndices\(": set(),
    r"\.GetLocalToWorldTransform\(": {"xform_ops"},
    r"\.GetLocalTransformation\(": {"xform_ops"},
    r"\.ComputeRelativeTransform\(": {"xform_ops"},
    r"BlackbodyTemperatureAsRgb\(": {"light_values"},
    r"\.ComputeWorldBound\(": {"bounds"},
    r"\.GetTimeCodesPerSecond\(": {"stage_metadata"},
    r"\.GetFramesPerSecond\(": {"stage_metadata"},
    r"\.GetStartTimeCode\(": {"stage_metadata", "bench"},
}
"""Calls by which USD reads attributes or metadata itself, and the modules that know what to expect of them."""


def test_no_module_reads_attributes_around_the_gate():
    around = [
        f"{path.stem}: {line.strip()}"
        for path in sorted(PACKAGE.glob("*.py"))
        for line in path.read_text(encoding="utf-8").splitlines()
        for pattern, homes in {r"\.Get\(": {"values"}, **EVALUATORS}.items()
        if re.search(pattern, line) and path.stem not in homes and '"""' not in line
    ]
    assert around == []


@cache
def asked(scene: str) -> dict[tuple[str, str], Kind]:
    """What the reader asks the gate for on a scene: (type of prim, attribute), and the kind that it wants."""
    values.asked = {}
    try:
        render(stage_of(SCENES[scene]))
        return values.asked
    finally:
        values.asked = None


def attributes(scene: str) -> Iterator[tuple[Usd.Attribute, Kind]]:
    """Those that are authored on a scene and read, each prim type's once; and the ops, which USD reads itself."""
    stage = stage_of(SCENES[scene])
    seen = set()
    for prim in stage.Traverse():
        for attribute in prim.GetAuthoredAttributes():
            key = (str(prim.GetTypeName()), attribute.GetName())
            if prim.GetPath() == Sdf.Path("/Good") or key in seen:
                continue
            kind = asked(scene).get(key)
            if kind is None and not attribute.GetName().startswith("xformOp:"):
                continue
            seen.add(key)
            yield attribute, _kind(attribute, kind)


def _kind(attribute: Usd.Attribute, kind: Kind | None) -> Kind:
    """Where the reader looks at types itself: what the scene authors."""
    if kind is not None and kind is not values.ANY:
        return kind
    own = type(attribute.Get(1.0))
    return next((known for known in KINDS if known.exact is own), Kind(str(attribute.GetTypeName()), own))


@pytest.mark.parametrize("scene", SCENES)
def test_every_attribute_that_is_authored_is_asked_for(scene):
    """Otherwise the sweep would not try it."""
    read = {attribute.GetName() for attribute, _ in attributes(scene)}
    authored = {
        attribute.GetName()
        for prim in stage_of(SCENES[scene]).Traverse()
        for attribute in prim.GetAuthoredAttributes()
        if not UsdOutput.search(attribute.GetName())
    }
    assert authored - read == set()


UsdOutput = re.compile(r"^outputs:")


@pytest.mark.parametrize("scene", SCENES)
def test_the_kinds_that_are_asked_for_are_those_of_the_schemas(scene):
    for attribute, kind in attributes(scene):
        definition = attribute.GetPrim().GetPrimDefinition().GetAttributeDefinition(attribute.GetName())
        if definition:
            meant = type(definition.GetTypeName().defaultValue)
            assert meant is kind.exact or meant in kind.conversions, attribute.GetPath()


TYPES = [
    each
    for each in vars(Sdf.ValueTypeNames).values()
    if isinstance(each, Sdf.ValueTypeName) and each.defaultValue is not None
]


def test_every_type_of_value_is_tried():
    assert len(TYPES) > 100 and {str(each) for each in TYPES} > {"double3", "quath[]", "timecode", "pathExpression"}


def sample_of(typed: Sdf.ValueTypeName) -> object:
    """A value; an array has one element."""
    if not typed.isArray:
        return typed.defaultValue
    return type(typed.defaultValue)([typed.scalarType.defaultValue])


def retyped(scene: str, path: Sdf.Path, typed: Sdf.ValueTypeName) -> Usd.Stage:
    """A scene on whose session layer an attribute has another type."""
    stage = stage_of(SCENES[scene])
    spec = Sdf.CreatePrimInLayer(stage.GetSessionLayer(), path.GetPrimPath())
    Sdf.AttributeSpec(spec, path.name, typed).default = sample_of(typed)
    return stage


CASES = 600
"""Of the sweep, in a sample."""


def cases() -> list[tuple[str, Usd.Attribute, Kind, Sdf.ValueTypeName]]:
    return [
        (scene, attribute, kind, typed)
        for scene in SCENES
        for attribute, kind in attributes(scene)
        for typed in TYPES
    ]


@pytest.mark.soak
def test_a_value_of_any_type_is_taken_or_named():
    """Every attribute that is read x every type of value, scalar and array."""
    every = cases()
    chosen = random.Random(11).sample(every, soak_count(min(CASES, len(every)), len(every)))
    faults = [fault for case in chosen if (fault := _fault(*case))]
    assert not faults, f"{len(faults)} of {len(chosen)}:\n" + "\n".join(faults[:40])
    soak_figure("values of any type", f"{len(chosen)} of {len(every)} attributes x types, all taken or named")


def _fault(scene: str, attribute: Usd.Attribute, kind: Kind, typed: Sdf.ValueTypeName) -> str:
    path = attribute.GetPath()
    label = f"{scene}: {path} as {typed}"
    try:
        result, pixels = render(retyped(scene, path, typed))
    except Exception as error:
        return f"{label}: {type(error).__name__}: {error}"
    if not shows_good(pixels):
        return f"{label}: the neighbour is missing"
    value = sample_of(typed)
    takes = type(value) is kind.exact or type(value) in kind.conversions
    if not takes and not any(str(path) in message for message in messages(result)):
        return f"{label}: not a word; said {messages(result)}"
    return ""
