"""Surfaces, lights and skies of benchmarks' scenes in Blender: what cycles_script runs, inside bpy's own Python.

It imports nothing of ours. A look is what `looks.Look.plain()` gives.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

LIGHT_SHARE = math.pi
"""Of a Blender area light that is not normalised: its energy for each unit of radiance."""


def material_of(data: Any, look: Mapping[str, Any] | None) -> Any:
    """A material: a Diffuse BSDF of displayColor without a look, else a Principled BSDF, or of a
    metal a Glossy BSDF: UsdPreviewSurface's reflects its colour at every angle, Principled's white at grazing ones."""
    material = data.materials.new("look")
    nodes, links = material.node_tree.nodes, material.node_tree.links
    nodes.clear()
    output = nodes.new("ShaderNodeOutputMaterial")
    if look is None:
        surface = nodes.new("ShaderNodeBsdfDiffuse")
        links.new(_display_color(nodes), surface.inputs["Color"])
        links.new(surface.outputs["BSDF"], output.inputs["Surface"])
        return material
    metal = look["metallic"] == 1.0
    surface = nodes.new("ShaderNodeBsdfGlossy" if metal else "ShaderNodeBsdfPrincipled")
    surface.distribution = "MULTI_GGX"
    base = surface.inputs["Color" if metal else "Base Color"]
    if metal:
        surface.inputs["Roughness"].default_value = look["roughness"]
    else:
        _set_numbers(surface, look)
    if look["image"]:
        links.new(_image(data, nodes, look["image"], "sRGB").outputs["Color"], base)
    elif look["colour"] is None:
        links.new(_display_color(nodes), base)
    else:
        base.default_value = (*look["colour"], 1.0)
    if look["normal"]:
        material.cycles.use_bump_map_correction = (
            False  # Darkens by up to some percent, which UsdPreviewSurface does not.
        )
        bump = nodes.new("ShaderNodeNormalMap")
        links.new(_image(data, nodes, look["normal"], "Non-Color").outputs["Color"], bump.inputs["Color"])
        links.new(bump.outputs["Normal"], surface.inputs["Normal"])
    if look["cutout"]:
        above = nodes.new("ShaderNodeMath")
        above.operation = "GREATER_THAN"
        above.inputs[1].default_value = 0.5
        links.new(_image(data, nodes, look["cutout"], "Non-Color").outputs["Color"], above.inputs[0])
        links.new(above.outputs[0], surface.inputs["Alpha"])
    links.new(surface.outputs["BSDF"], output.inputs["Surface"])
    return material


def _set_numbers(surface: Any, look: Mapping[str, Any]) -> None:
    numbers = {
        "Roughness": look["roughness"],
        "IOR": look["ior"],
        "Coat Weight": look["coat"],
        "Coat Roughness": look["coat_roughness"],
        "Coat IOR": look["ior"],
        "Emission Color": (*look["emission"], 1.0),
        "Emission Strength": 1.0,
    }
    for name, value in numbers.items():
        surface.inputs[name].default_value = value


def _display_color(nodes: Any) -> Any:
    colour = nodes.new("ShaderNodeAttribute")
    colour.attribute_name = "displayColor"
    return colour.outputs["Color"]


def _image(data: Any, nodes: Any, path: str, space: str) -> Any:
    """A texture of the mesh's coordinates, repeated."""
    texture = nodes.new("ShaderNodeTexImage")
    texture.image = data.images.load(path, check_existing=True)
    texture.image.colorspace_settings.name = space
    return texture


def set_lights(data: Any, job: Mapping[str, Any]) -> None:
    """As bright as ours: Blender's importer has conventions of its own."""
    for light in data.lights:
        if light.type == "SUN":
            light.energy = job["irradiance"]
        elif light.type == "AREA":
            light.shape, light.use_shadow = "RECTANGLE", True
            light.normalize, light.energy = False, job["radiance"] * LIGHT_SHARE
    for world in data.worlds:
        data.worlds.remove(world)


def set_sky(data: Any, scene: Any, sky: str) -> None:
    """A latlong picture on a dome whose top is +z: USD's longitudes begin a quarter further on than Blender's."""
    world, background = _world(data, scene)
    nodes, links = world.node_tree.nodes, world.node_tree.links
    coordinates, turn = nodes.new("ShaderNodeTexCoord"), nodes.new("ShaderNodeMapping")
    turn.inputs["Rotation"].default_value[2] = math.pi / 2
    picture = nodes.new("ShaderNodeTexEnvironment")
    picture.image = data.images.load(sky)
    picture.image.colorspace_settings.name = "Linear Rec.709"
    links.new(coordinates.outputs["Generated"], turn.inputs["Vector"])
    links.new(turn.outputs["Vector"], picture.inputs["Vector"])
    links.new(picture.outputs["Color"], background.inputs["Color"])
    world.cycles.sampling_method = "AUTOMATIC"


def set_dome(data: Any, scene: Any, radiance: float) -> None:
    """The same from everywhere, and not seen by the camera."""
    _, background = _world(data, scene)
    background.inputs["Color"].default_value = (radiance, radiance, radiance, 1.0)


def _world(data: Any, scene: Any) -> tuple[Any, Any]:
    """A world, and its background."""
    world = data.worlds.new("sky")
    scene.world = world
    world.use_nodes = True
    nodes, links = world.node_tree.nodes, world.node_tree.links
    nodes.clear()
    background, output = nodes.new("ShaderNodeBackground"), nodes.new("ShaderNodeOutputWorld")
    links.new(background.outputs["Background"], output.inputs["Surface"])
    scene.render.film_transparent = True
    return world, background
