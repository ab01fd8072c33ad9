"""Shading networks as plain data: the nodes that a material reads, what their inputs hold, and what is
connected to what. What they mean is decided in delegate/translate/look."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from pxr import Gf, Sdf, Usd, UsdShade

from .. import _core
from ..motion.context import FrameContext
from ..motion.held_values import values_within
from ..stage.rendering_space import color_space, rendered_color
from ..stage.value_types import TOKEN
from ..stage.values import raw, type_name, value
from .texture_files import texture_files

NUMBERS = (int, float, Gf.TimeCode, Gf.Duration)


def surface_network(material: UsdShade.Material, context: FrameContext) -> _core.ShaderNetwork:
    """What a material's surface and its displacement read at the frame, through node graphs and material interfaces."""
    pending, terminals = [], {}
    for name, source in (("surface", _surface(material)), ("displacement", _source(material, "displacement"))):
        if source is not None:
            shader, output = source
            pending.append(shader.GetPrim())
            terminals[name] = _core.ShaderConnection(str(shader.GetPath()), output)
    nodes: dict[str, _core.ShaderNode] = {}
    while pending:
        prim = pending.pop()
        path = str(prim.GetPath())
        if path not in nodes:
            nodes[path], read = _node(prim, context)
            pending += read
    return _core.ShaderNetwork(str(material.GetPath()), list(nodes.values()), terminals)


def primvar_names(material: UsdShade.Material, context: FrameContext) -> frozenset[str]:
    """The names of the primvars that the network may read."""
    names = set()
    for node in surface_network(material, context).nodes:
        if node.identifier.startswith("ND_"):
            names.add("st")  # Which images read that say nothing else.
        found = (each.value for each in node.inputs if each.name in ("varname", "geomprop"))
        names.update(value.data for value in found if value is not None and isinstance(value.data, str))
    return frozenset(names)


Source = tuple[UsdShade.Shader, str]
"""A shader, and the name of its output."""


def _surface(material: UsdShade.Material) -> Source | None:
    """The universal surface where there is one; else the one of a render context that can be drawn, and best."""
    universal = _source(material, "surface")
    if universal is not None:
        return universal
    contexts = [output.GetBaseName().rpartition(":")[0] for output in material.GetSurfaceOutputs()]
    found = [source for context in contexts if context and (source := _source(material, "surface", context))]
    return min(found, key=lambda source: _core.surface_rank(_identifier(source[0])), default=None)


def _source(material: UsdShade.Material, terminal: str, context: str = "") -> Source | None:
    compute = material.ComputeSurfaceSource if terminal == "surface" else material.ComputeDisplacementSource
    shader, output, _ = compute(context)
    return (shader, str(output)) if shader else None


def _node(prim: Usd.Prim, context: FrameContext) -> tuple[_core.ShaderNode, list[Usd.Prim]]:
    """A node, and those that it reads."""
    shader = UsdShade.Shader(prim)
    identifier = _identifier(shader)
    inputs, sources = [], []
    for name in _core.evaluated_inputs(identifier):
        shader_input = shader.GetInput(name)
        attributes = shader_input.GetValueProducingAttributes() if shader_input else ()
        if not attributes:
            continue
        outputs = [attribute for attribute in attributes if _is_output(attribute)]
        if _is_output(attributes[0]):
            inputs.append(_core.ShaderInput(name, connections=[_connection(each) for each in outputs]))
            sources += [each.GetPrim() for each in outputs]
        else:
            inputs.append(_constant(name, attributes[0], context))
    return _core.ShaderNode(str(prim.GetPath()), identifier, inputs), sources


def _identifier(shader: UsdShade.Shader) -> str:
    """shader.GetShaderId(), and a report where its type is what is wrong with it."""
    attribute = shader.GetIdAttr()
    if attribute and attribute.HasAuthoredValue():
        value(attribute, Usd.TimeCode.Default(), TOKEN)
    return shader.GetShaderId() or ""


def _is_output(attribute: Usd.Attribute) -> bool:
    """Whether a node computes the attribute, so that it holds no value itself."""
    return UsdShade.Utils.GetType(attribute.GetName()) == UsdShade.AttributeType.Output


def _connection(output: Usd.Attribute) -> _core.ShaderConnection:
    return _core.ShaderConnection(str(output.GetPrimPath()), output.GetName().split(":")[-1])


def _constant(name: str, source: Usd.Attribute, context: FrameContext) -> _core.ShaderInput:
    """An input whose value an attribute holds."""
    found = raw(source, context.code)
    distinct: list[Any] = []
    for each in values_within(source, context.shutter):
        if all(each != known for known in distinct):
            distinct.append(each)
    in_shutter = [] if len(distinct) == 1 and distinct[0] == found else distinct
    return _core.ShaderInput(
        name,
        _value(found, source),
        [_value(each, source) for each in in_shutter],
        origin=_core.Origin(str(source.GetPrimPath()), source.GetName()),
    )


def _value(found: Any, source: Usd.Attribute) -> _core.ShaderValue | None:
    return None if found is None else _core.ShaderValue(_data(found, source), repr(found), type_name(source, found))


def _data(found: Any, source: Usd.Attribute) -> _core.ShaderData:
    if isinstance(found, (bool, str)):
        return found
    if isinstance(found, Sdf.AssetPath):
        return _core.Asset(found.path, texture_files(found, source), color_space(source))
    if isinstance(found, NUMBERS):
        return float(found)
    numbers = _vector(found)
    return rendered_color(numbers, source) if numbers and len(numbers) > 2 else numbers


def _vector(found: Any) -> Sequence[float] | None:
    """Two to four numbers."""
    try:
        parts = tuple(found) if 2 <= len(found) <= 4 else ()
    except TypeError:
        return None
    return tuple(map(float, parts)) if parts and all(isinstance(part, NUMBERS) for part in parts) else None
