"""A disk that fills up: exit code 1 and one line, nothing under a final name, nothing left beside it."""

from __future__ import annotations

import json
import os
import resource
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from conftest import Run

FORMATS = ("exr", "png", "jpg", "tif")
NOISY = ("-w", 96, "--spp", 1)
"""Some kB in each format, more than the limits below."""


def limited(bytes_: int) -> Callable[[], None]:
    """Limits the size of every file that a child writes, as `ulimit -f` does."""
    return lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (bytes_, bytes_))


def record(folder: Path, *arguments: object, limit: int | None = None) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "msbvh", *map(str, arguments)],
        cwd=folder,
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
        preexec_fn=limited(limit) if limit else None,
    )


def said_once(done: subprocess.CompletedProcess[str], *parts: str) -> bool:
    errors = [line for line in done.stderr.splitlines() if line.startswith("msbvh: error: ")]
    return len(errors) == 1 and all(part in errors[0] for part in parts) and "Traceback" not in done.stderr


@pytest.mark.parametrize("limit", [1, 700])
def test_a_file_size_limit(tmp_path: Path, scene: Path, limit: int) -> None:
    """In the first byte and in the middle of each format."""
    for suffix in FORMATS:
        done = record(tmp_path, "record", scene, f"a.{suffix}", *NOISY, limit=limit)
        assert done.returncode == 1, (suffix, done.stderr)
        assert said_once(done, f"cannot write 'a.{suffix}': File too large"), done.stderr
        assert os.listdir(tmp_path) == ["scene.usda"]


def test_what_fits_is_kept_and_the_rest_is_named(tmp_path: Path, scene: Path) -> None:
    """A black JPEG is smaller than a float EXR: the picture that could be written is not lost with the other."""
    outputs = ("a.exr", "b.jpg", "c.exr")
    done = record(tmp_path, "record", scene, *outputs, "--exr-float", "--mask", "/world/square", *NOISY, limit=4000)
    assert done.returncode == 1, done.stderr
    assert said_once(done, "cannot write 'a.exr': File too large", "cannot write 'c.exr'"), done.stderr
    assert sorted(os.listdir(tmp_path)) == ["b.jpg", "scene.usda"]


@pytest.fixture
def small_disk(tmp_path: Path) -> Iterator[Path]:
    """A file system of 16 kB, almost full, that holds a small old picture in each format."""
    folder = tmp_path / "disk"
    folder.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", "size=16k", "msbvh_test", str(folder)]
    if subprocess.run(mount, capture_output=True, check=False).returncode:
        pytest.skip("mounting a tmpfs takes root")
    try:
        for suffix in FORMATS:
            (folder / f"a.{suffix}").write_text("old")
        with (folder / "filler").open("wb", buffering=0) as filler:
            filler.write(bytes(1 << 16))
    except OSError:
        pass  # Full, as it shall be.
    try:
        yield folder
    finally:
        subprocess.run(["umount", str(folder)], check=True)


def test_a_full_disk(tmp_path: Path, scene: Path, small_disk: Path) -> None:
    before = sorted(os.listdir(small_disk))
    outputs = [f"disk/a.{suffix}" for suffix in FORMATS]
    done = record(tmp_path, "record", scene, *outputs, "--stats", "disk/s.json", *NOISY)
    assert done.returncode == 1, done.stderr
    assert said_once(done, "No space left on device", *outputs), done.stderr
    assert sorted(os.listdir(small_disk)) == before
    assert all((small_disk / f"a.{suffix}").read_text() == "old" for suffix in FORMATS)


def test_the_files_of_bench_and_conform(msbvh: Run, tmp_path: Path, scene: Path) -> None:
    (tmp_path / "file").touch()
    for command in (("bench", "--quick"), ("conform", "--rules", "rotate_op")):
        done = msbvh(*command, "--out", "file/below")
        assert done.returncode == 1 and done.stdout == "", done.stderr
        assert done.stderr.startswith("msbvh: error: cannot write 'file/below") and done.stderr.count("\n") == 1
    tiny = ("--quick", "--scenes", "mini", "--triangles", 600, "--repetitions", 1, "--out", "out")
    done = record(tmp_path, "bench", *tiny, limit=64)
    assert done.returncode == 1 and said_once(done, "out/bench.json", "File too large"), done.stderr
    assert os.listdir(tmp_path / "out") == []


def test_stats_are_whole(msbvh: Run, tmp_path: Path, scene: Path) -> None:
    assert msbvh("record", scene, "a.png", "--stats", "s.json", *NOISY).returncode == 0
    assert json.loads((tmp_path / "s.json").read_text())["frames"][0]["output"] == ["a.png"]
    assert sorted(os.listdir(tmp_path)) == ["a.png", "s.json", "scene.usda"]
