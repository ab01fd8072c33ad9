"""What may be written where: found before anything is rendered."""

from __future__ import annotations

import os
import socket
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from conftest import MOVING_SQUARE, Fails, Run
from msbvh.output.images import ImageSettings, write_image
from test_images import metadata

SMALL = ("-w", 48, "--spp", 4)
PIXELS = np.zeros((2, 2, 4), np.float32)


@pytest.fixture
def layered(tmp_path: Path) -> Path:
    """A scene with a layer of each kind: sublayer, reference, payload, clip, variant; and textures, one of them
    of UDIM tiles."""
    square = MOVING_SQUARE.replace('defaultPrim = "world"', 'defaultPrim = "world"\n    subLayers = [@sub/layer.usda@]')
    parts = """
def "referenced" (references = @ref.usda@</a>) { }
def "loaded" (payload = @pay.usda@</a>) { }
def "clipped" (
    clips = { dictionary default = {
        asset[] assetPaths = [@./clip.usda@]
        asset manifestAssetPath = @./manifest.usda@
        string primPath = "/a"
        double2[] active = [(0, 0)]
        double2[] times = [(0, 0), (10, 10)]
    } }
)
{
    double x
}
def DomeLight "dome" {
    asset inputs:texture:file = @tex/dome.exr@
}
def Shader "tiles" {
    asset inputs:file = @tex/tile.<UDIM>.png@
}
"""
    (tmp_path / "sub").mkdir()
    (tmp_path / "tex").mkdir()
    for name in ("sub/layer", "ref", "pay", "clip", "manifest"):
        (tmp_path / f"{name}.usda").write_text('#usda 1.0\ndef "a"\n{\n    double x.timeSamples = { 0: 1 }\n}\n')
    for name in ("tex/dome.exr", "tex/tile.1001.png"):
        write_image(tmp_path / name, PIXELS, metadata(), ImageSettings())
    path = tmp_path / "scene.usda"
    path.write_text(square + parts)
    return path


READ = ("scene.usda", "sub/layer.usda", "ref.usda", "pay.usda", "clip.usda", "manifest.usda")
TEXTURES = ("tex/dome.exr", "tex/tile.1001.png")


def test_what_the_scene_reads_is_not_overwritten(fails: Fails, layered: Path, tmp_path: Path) -> None:
    before = {name: (tmp_path / name).read_bytes() for name in (*READ, *TEXTURES)}
    for name in (*READ, *TEXTURES):
        fails(("record", layered, "a.exr", "--stats", name, *SMALL), 2, f"'{name}' is read by the scene")
    for name in TEXTURES:
        fails(("record", layered, name, *SMALL), 2, f"'{name}' is read by the scene")
    os.symlink("sub", "link")
    os.symlink("tex/dome.exr", "link.exr")
    os.link("scene.usda", "hard.exr")
    fails(("record", layered, "a.exr", "--stats", "link/layer.usda", *SMALL), 2, "is read by the scene")
    fails(("record", layered, "link.exr", *SMALL), 2, "'link.exr' is read by the scene")
    fails(("record", layered, "hard.exr", *SMALL), 2, "'hard.exr' is read by the scene")
    fails(("record", layered, "tex/tile.####.png", "-f", "1000:1002", *SMALL), 2, "'tex/tile.1001.png' is read")
    assert before == {name: (tmp_path / name).read_bytes() for name in before}


def test_two_outputs_in_one_file(fails: Fails, scene: Path, tmp_path: Path) -> None:
    (tmp_path / "there").mkdir()
    os.symlink("there", "again")
    os.symlink("b.exr", "c.exr")
    for first, second in (("a.exr", "./a.exr"), ("there/a.exr", "again/a.exr"), ("b.exr", "c.exr")):
        fails(("record", scene, first, second, *SMALL), 2, f"'{first}' and '{second}' are the same file")
    fails(("record", scene, "a.exr", "--stats", "a.exr", *SMALL), 2, "are the same file")
    fails(("record", scene, "o.#.exr", "o.2.exr", "-f", "1:2", *SMALL), 2, "placeholder")
    fails(("record", scene, "o.#.exr", "--stats", "o.2.exr", "-f", "1:2", *SMALL), 2, "are the same file")


def test_links(msbvh: Run, scene: Path, tmp_path: Path) -> None:
    """A symbolic link is written through and stays, dangling or not; other names of a replaced file keep it."""
    (tmp_path / "there").mkdir()
    (tmp_path / "there" / "old.exr").write_text("old")
    os.symlink("there/old.exr", tmp_path / "link.exr")
    os.symlink("there/new.png", tmp_path / "new.png")
    os.symlink("there/s.json", tmp_path / "s.json")
    (tmp_path / "one.tif").write_text("old")
    os.chmod(tmp_path / "one.tif", 0o640)
    os.link(tmp_path / "one.tif", tmp_path / "two.tif")
    done = msbvh("record", scene, "link.exr", "new.png", "one.tif", "--stats", "s.json", *SMALL)
    assert done.returncode == 0, done.stderr
    assert all((tmp_path / name).is_symlink() for name in ("link.exr", "new.png", "s.json"))
    assert sorted(os.listdir(tmp_path / "there")) == ["new.png", "old.exr", "s.json"]
    assert (tmp_path / "there" / "old.exr").stat().st_size > 1000
    assert (tmp_path / "two.tif").read_text() == "old"
    assert (tmp_path / "one.tif").stat().st_mode & 0o777 == 0o640


def made(make: Callable[[str], object], name: str) -> str:
    make(name)
    return name


def test_what_cannot_be_written_is_found_before(fails: Fails, scene: Path, tmp_path: Path) -> None:
    """With a scene that does not exist: nothing of it is read before its outputs are known to be good."""
    os.symlink("nowhere/a.exr", "dangling.exr")
    os.symlink("loop.exr", "loop.exr")
    os.symlink("/dev/full", "full.exr")
    listener = socket.socket(socket.AF_UNIX)
    listener.bind("socket.exr")
    os.mkfifo("fifo.exr")
    os.mkdir("folder.exr")
    (tmp_path / "file").touch()
    for name, said in (
        ("dangling.exr", "there is no folder"),
        ("loop.exr", "symbolic links"),
        ("full.exr", "not a regular file"),
        ("fifo.exr", "not a regular file"),
        ("socket.exr", "not a regular file"),
        ("folder.exr", "not a regular file"),
        ("nowhere/a.exr", "there is no folder"),
        ("file/a.exr", "there is no folder"),
        ("a" * 252 + ".exr", "name is 256 bytes long, at most 255"),
        ("ü" * 126 + ".exr", "name is 256 bytes long, at most 255"),
        ("/proc/a.exr", "cannot write '/proc/a.exr'"),
        ("/sys/a.exr", "cannot write '/sys/a.exr'"),
        ("", "no extension"),
        ("d/" * 2100 + "a.exr", "there is no folder"),
        ("o.##.exr", "there is no --frames"),
    ):
        fails(("record", "missing.usda", name, *SMALL), 2 if "##" in name else 1, said)
    descriptors = ("/dev/stdout", "/dev/fd/1", "/dev/null", "/dev/full")
    for name in (*descriptors, "fifo.exr", "folder.exr", "nowhere/s.json", "a" * 256):
        fails(("record", "missing.usda", "a.exr", "--stats", name, *SMALL), 1, f"cannot write '{name}'")
    (tmp_path / "o.0002.exr").mkdir()
    fails(("record", scene, "o.####.exr", "-f", "1:3", *SMALL), 1, "cannot write 'o.0002.exr'")


def test_long_names(msbvh: Run, scene: Path, tmp_path: Path) -> None:
    names = ["a" * (length - 4) + ".exr" for length in (248, 250, 255)] + ["ü" * 125 + "a.png"]
    done = msbvh("record", scene, *names, "--stats", "s" * 255, *SMALL)
    assert done.returncode == 0, done.stderr
    assert set(os.listdir(tmp_path)) == {*names, "s" * 255, "scene.usda"}
