"""The examples for Blender and Houdini name settings, statistics and types that the plugin really has."""

from __future__ import annotations

import ast
import json
import re
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
EXAMPLES = ROOT / "examples"
SETTINGS = (ROOT / "delegate" / "hydra" / "settings.cpp").read_text()
PLUGIN = re.search(r"\"(Hd\w+RendererPlugin)\"", (ROOT / "plugInfo" / "plugInfo.json.in").read_text())
HYDRAS_OWN = {"convergedSamplesPerPixel", "threadLimit"}


def test_blender_is_told_of_settings_that_exist() -> None:
    module = ast.parse((EXAMPLES / "blender_hydra" / "__init__.py").read_text())
    function = next(
        node for node in module.body if isinstance(node, ast.FunctionDef) and node.name == "render_settings"
    )
    keys = {
        key.value
        for node in ast.walk(function)
        if isinstance(node, ast.Dict)
        for key in node.keys
        if isinstance(key, ast.Constant) and isinstance(key.value, str)
    }
    ours = {key for key in keys if key.startswith("msbvh:")}
    assert ours
    assert ours <= set(re.findall(r"\"(msbvh:\w+)\"", SETTINGS))
    assert {key for key in keys - ours if not key.startswith("aovToken:")} == HYDRAS_OWN
    assert all(f"keys->{key}" in SETTINGS for key in HYDRAS_OWN)


@pytest.mark.parametrize("names", ["INTERPOLATIONS", "BUILDERS"])
def test_blender_offers_choices_that_exist(names: str) -> None:
    text = (EXAMPLES / "blender_hydra" / "__init__.py").read_text()
    found = re.search(rf"^{names} = (\(.*\))$", text, re.MULTILINE)
    assert found
    sources = SETTINGS + (ROOT / "core" / "build" / "settings.h").read_text()
    assert all(f'"{name}"' in sources for name in ast.literal_eval(found.group(1)))


def test_hosts_name_the_plugin_as_it_is_registered() -> None:
    assert PLUGIN
    houdini = json.loads((EXAMPLES / "houdini" / "UsdRenderers.json").read_text())
    assert list(houdini) == [PLUGIN.group(1)]
    assert f'PLUGIN = "{PLUGIN.group(1)}"' in (EXAMPLES / "blender_hydra" / "__init__.py").read_text()


def test_houdini_shows_statistics_that_exist() -> None:
    houdini = json.loads((EXAMPLES / "houdini" / "UsdRenderers.json").read_text())
    (entry,) = houdini.values()
    source = (ROOT / "delegate" / "hydra" / "delegate.cpp").read_text()
    assert all(f'"{key}"' in source or f"->{key}" in source for key in entry["viewstats"])


def test_the_manifest_has_the_version_and_the_license_of_the_project() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    manifest = tomllib.loads((EXAMPLES / "blender_hydra" / "blender_manifest.toml").read_text())
    assert manifest["version"] == re.search(
        r"project\(msbvh VERSION (\S+)", (ROOT / "CMakeLists.txt").read_text()
    ).group(1)  # type: ignore[union-attr]
    assert manifest["license"] == [f"SPDX:{project['license']}"]
