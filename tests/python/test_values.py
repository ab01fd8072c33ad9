"""The gate that attribute values come through: what it takes, and that nothing goes around it."""

from __future__ import annotations

import random
import re
from collections.abc import Iterator
from functools import cache

import pytest
from conftest import ROOT
from every_attribute import SCENES
from msbvh.base.errors import SceneError
from msbvh.motion.samples import SampleLog
from msbvh.motion_report.report import motion_report
from msbvh.scene.reader import ReadSettings, read_frame
from msbvh.stage import value_types, values
from msbvh.stage.value_types import Kind
from pxr import Gf, Sdf, Usd
from soak import soak_count, soak_figure
from sound_neighbour import messages, render, shows_good, stage_of

PACKAGE = ROOT / "delegate" / "usd" / "msbvh"
KINDS = [kind for kind in vars(value_types).values() if isinstance(kind, Kind)]

EVALUATORS = {
    r"\.GetCamera\(": set(),
    r"\.ComputePurpose\(": set(),
    r"\.ComputeModelDrawMode\(": set(),
    r"\.ComputeMaskAtTime\(": set(),
    r"\.ComputeVisibility\(": {"framing"},
    r"\.GetIndices\(": set(),
    r"\.GetLocalToWorldTransform\(": {"xform_ops"},
    r"\.GetLocalTransformation\(": {"xform_ops"},
    r"\.ComputeRelativeTransform\(": {"xform_ops"},
    r"BlackbodyTemperatureAsRgb\(": {"light_values"},
    r"\.ComputeWorldBound\(": {"framing"},
    r"\.GetOrderedXformOps\(": {"xform_ops"},
    r"\.GetResetXformStack\(": {"xform_ops"},
    r"\.TransformMightBeTimeVarying\(": {"xform_ops"},
    r"\.ValueMightBeTimeVarying\(": {"values"},
    r"\.GetTimeCodesPerSecond\(": {"stage_metadata"},
    r"\.GetFramesPerSecond\(": {"stage_metadata"},
    r"\.GetStartTimeCode\(": {"stage_metadata", "rays"},
}
"""Calls by which USD reads attributes or metadata itself, and the modules that know what to expect of them."""


def test_no_module_reads_attributes_around_the_gate():
    around = [
        f"{path.stem}: {line.strip()}"
        for path in sorted(PACKAGE.rglob("*.py"))
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
        stage, log = stage_of(SCENES[scene]), SampleLog()
        settings = ReadSettings(width=32, height=18)
        motion_report(stage, 1.0, read_frame(stage, 1.0, settings, found=log), log, 0.1, None)
        return values.asked
    finally:
        values.asked = None


@cache
def stage_for(scene: str) -> Usd.Stage:
    return stage_of(SCENES[scene])


def attributes(scene: str) -> Iterator[tuple[Usd.Attribute, Kind]]:
    """Those that are authored on a scene and read, each prim type's once; and the ops, which USD reads itself."""
    stage = stage_for(scene)
    seen = set()
    for prim in stage.Traverse():
        for attribute in prim.GetAuthoredAttributes():
            key = (str(prim.GetTypeName()), attribute.GetName())
            if key in seen or not _is_tried(attribute):
                continue
            kind = asked(scene).get(key)
            if kind is None and not attribute.GetName().startswith("xformOp:"):
                continue
            seen.add(key)
            yield attribute, _kind(attribute, kind)


def _is_tried(attribute: Usd.Attribute) -> bool:
    """Not the sound square's, nor what places the camera before it."""
    camera = attribute.GetPrimPath() == "/Cam" and attribute.GetName() in ("xformOp:translate", "xformOpOrder")
    return not camera and attribute.GetPrimPath() != "/Good"


_OP_VECTOR = Kind("double3", Gf.Vec3d, {Gf.Vec3f: Gf.Vec3d, Gf.Vec3h: Gf.Vec3d})


def _kind(attribute: Usd.Attribute, kind: Kind | None) -> Kind:
    """Where the reader looks at types itself: what the scene authors."""
    if attribute.GetName().startswith("xformOp:") and isinstance(attribute.Get(1.0), (Gf.Vec3d, Gf.Vec3f)):
        return _OP_VECTOR  # USD takes any precision.
    if kind is not None and kind is not values.ANY:
        return kind
    own = type(attribute.Get(1.0))
    return next((known for known in KINDS if known.exact is own), Kind(str(attribute.GetTypeName()), own))


@pytest.mark.parametrize("scene", SCENES)
def test_every_attribute_that_is_authored_is_asked_for(scene):
    """Otherwise the sweep would not try it."""
    read = {attribute.GetName() for attribute, _ in attributes(scene)}
    stage = stage_of(SCENES[scene])
    authored = {
        attribute.GetName()
        for prim in stage.Traverse()
        for attribute in prim.GetAuthoredAttributes()
        if _is_tried(attribute) and attribute.HasAuthoredValue()
    }
    assert authored - read == set()


@pytest.mark.parametrize("scene", SCENES)
def test_the_kinds_that_are_asked_for_are_those_of_the_schemas(scene):
    for attribute, kind in attributes(scene):
        definition = attribute.GetPrim().GetPrimDefinition().GetAttributeDefinition(attribute.GetName())
        if definition:
            meant = type(definition.GetTypeName().defaultValue)
            assert meant is kind.exact or meant in kind.conversions, attribute.GetPath()


EXPRESSION = Sdf.PathExpression("/a")
"""An empty one counts as no value."""
TYPES = [
    each
    for each in (getattr(Sdf.ValueTypeNames, name) for name in dir(Sdf.ValueTypeNames))
    if isinstance(each, Sdf.ValueTypeName) and str(each) not in ("group", "opaque")
]


def test_every_type_of_value_is_tried():
    assert len(TYPES) > 100 and {str(each) for each in TYPES} > {"double3", "quath[]", "timecode", "pathExpression"}


def sample_of(typed: Sdf.ValueTypeName) -> object:
    """A value; an array has one element."""
    value = EXPRESSION if typed.scalarType == Sdf.ValueTypeNames.PathExpression else typed.scalarType.defaultValue
    return type(typed.defaultValue)([value]) if typed.isArray else value


def retyped(scene: str, path: Sdf.Path, typed: Sdf.ValueTypeName) -> Usd.Stage:
    """A scene on whose session layer an attribute has another type."""
    stage = stage_of(SCENES[scene])
    spec = Sdf.CreatePrimInLayer(stage.GetSessionLayer(), path.GetPrimPath())
    Sdf.AttributeSpec(spec, path.name, typed).default = sample_of(typed)
    return stage


CASES = 300
"""Of the sweep, in a sample."""


NOT_DRAWN = "motion:nonlinearSampleCount"
"""Read for a remark of `msbvh motion` alone."""


def cases() -> list[tuple[str, Usd.Attribute, Kind, Sdf.ValueTypeName]]:
    return [
        (scene, attribute, kind, typed)
        for scene in SCENES
        for attribute, kind in attributes(scene)
        for typed in TYPES
        if attribute.GetName() != NOT_DRAWN
    ]


def test_what_only_the_motion_report_reads_is_named_by_it():
    stage, log = retyped("mesh", Sdf.Path(f"/World.{NOT_DRAWN}"), Sdf.ValueTypeNames.Float2), SampleLog()
    result = read_frame(stage, 1.0, ReadSettings(width=32, height=18), found=log)
    motion_report(stage, 1.0, result, log, 0.1, None)
    assert f"/World.{NOT_DRAWN}: found float2, expected int; ignored" in messages(result)


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
    except SceneError as error:
        return "" if str(path) in str(error) else f"{label}: {error}"
    except Exception as error:
        return f"{label}: {type(error).__name__}: {error}"
    if not shows_good(pixels):
        return f"{label}: the neighbour is missing"
    stage = retyped(scene, path, typed)
    composed = stage.GetAttributeAtPath(path)  # A few types leave the weaker layer's value where it is.
    found = {type(composed.Get(code)) for code in (Usd.TimeCode.Default(), 1.0)}
    takes = not found.isdisjoint({kind.exact, *kind.conversions})
    if not takes and not any(str(path) in message for message in messages(result)):
        return f"{label}: not a word; said {messages(result)}"
    return ""
