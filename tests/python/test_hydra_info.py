"""`msbvh hydra-info`: the plugin and its hosts by their files alone."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from msbvh.cli.main import main
from msbvh.hydra_info.plugin import PluginError, find_host, find_plugin, namespace_of, search_folders, version_of

ROOT = Path(__file__).resolve().parents[2]
OURS = b"..._ZN34pxrInternal_v0_24_11__pxrReserved__8HdCameraE..."
OTHER = b"..._ZN33pxrInternal_v0_25_8__pxrReserved__8HdCameraE..."


@pytest.fixture
def plugin(tmp_path: Path) -> Path:
    """As CMake fills the template in."""
    folder = tmp_path / "plugin" / "usd" / "hdMsbvh"
    folder.mkdir(parents=True)
    text = (ROOT / "plugInfo" / "plugInfo.json.in").read_text()
    values = {"PROJECT_VERSION": "0.1.0", "PXR_VERSION": "2411", "MSBVH_PLUGIN_LIBRARY": "hdMsbvh.so"}
    for name, value in values.items():
        text = text.replace(f"@{name}@", value)
    assert "@" not in text
    (folder / "plugInfo.json").write_text("# a comment, as OpenUSD allows\n" + text)
    (folder / "hdMsbvh.so").write_bytes(OURS)
    return folder


def host(tmp_path: Path, name: str, symbols: bytes) -> Path:
    folder = tmp_path / name / "lib"
    folder.mkdir(parents=True)
    (folder / "libusd_hd.so").write_bytes(symbols)
    return folder.parent


def test_the_template_names_the_types_that_are_registered(plugin: Path) -> None:
    (entry,) = json.loads("".join((plugin / "plugInfo.json").read_text().splitlines(True)[1:]))["Plugins"]
    types = entry["Info"]["Types"]
    sources = "".join(path.read_text() for path in (ROOT / "delegate" / "hydra").glob("*.cpp"))
    for name, info in types.items():
        assert f"Define<{name}>" in sources
        assert {"displayName", "priority"} <= info.keys()
    assert types["HdMsbvhRendererPlugin"]["displayName"] == "MSBVH"


def test_finds_the_plugin_by_the_search_path(
    plugin: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("PXR_PLUGINPATH_NAME", f"{tmp_path}/nothing:{plugin}")
    assert search_folders() == [tmp_path / "nothing", plugin]
    assert main(["hydra-info"]) == 0
    assert capsys.readouterr().out.splitlines() == [
        f"plugin: {plugin}",
        f"library: {plugin}/hdMsbvh.so",
        "version: 0.1.0",
        "OpenUSD: 24.11",
    ]


def test_says_which_host_can_load_it(plugin: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    same, other = host(tmp_path, "same", OURS), host(tmp_path, "other", OTHER)
    (tmp_path / "empty").mkdir()
    ask = ["hydra-info", "--json", "--plugin", str(plugin), "--host"]
    assert main([*ask, str(same)]) == 0
    assert json.loads(capsys.readouterr().out)["loads"] == "yes"
    assert main([*ask, str(other)]) == 1
    facts = json.loads(capsys.readouterr().out)
    assert facts["loads"] == "no" and facts["host"].endswith("(OpenUSD 25.08)")
    assert main([*ask, str(tmp_path / "empty")]) == 1
    assert "no OpenUSD library found" in json.loads(capsys.readouterr().out)["host"]


def test_a_plugin_that_is_not_there_is_an_error(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.delenv("PXR_PLUGINPATH_NAME", raising=False)
    assert main(["hydra-info"]) == 1
    assert "PXR_PLUGINPATH_NAME, which names no folder" in capsys.readouterr().err
    assert main(["hydra-info", "--plugin", str(tmp_path)]) == 1
    assert f"found no plugin hdMsbvh in {tmp_path}" in capsys.readouterr().err
    (tmp_path / "plugInfo.json").write_text("{")
    with pytest.raises(PluginError, match="expected JSON"):
        find_plugin([tmp_path])
    assert main(["hydra-info", "--plugin", str(tmp_path)]) == 1
    assert capsys.readouterr().err.count("\n") == 1


def test_a_missing_library_is_told(plugin: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (plugin / "hdMsbvh.so").unlink()
    assert main(["hydra-info", "--plugin", str(plugin)]) == 1
    out = capsys.readouterr().out
    assert "hdMsbvh.so (missing)" in out and "OpenUSD: 2411" in out


def test_versions_stand_in_namespaces(tmp_path: Path) -> None:
    assert version_of("pxrInternal_v0_24_11__pxrReserved__") == "24.11"
    assert version_of("pxrInternal_v0_25_8__pxrReserved__") == "25.08"
    for name, content in (("empty.so", b""), ("other.so", b"no symbols")):
        (tmp_path / name).write_bytes(content)
        assert namespace_of(tmp_path / name) is None
    assert find_host(tmp_path / "other.so") is None
