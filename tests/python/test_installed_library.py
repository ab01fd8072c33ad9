"""The C++ package as a stranger uses it: installed, found by CMake, an example built against it and run."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest
from conftest import ROOT

BUILD = ROOT / "build" / "release"


def run(*command: object) -> str:
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True, check=False)
    assert done.returncode == 0, f"{' '.join(map(str, command))}\n{done.stdout}{done.stderr}"
    return done.stdout


@pytest.mark.slow
def test_examples_build_against_the_installed_package(tmp_path: Path) -> None:
    if not (BUILD / "CMakeCache.txt").exists():
        pytest.skip("no build tree in build/release; make setup makes it")
    prefix, source, build = tmp_path / "prefix", tmp_path / "examples", tmp_path / "build"
    run("cmake", "--install", BUILD, "--prefix", prefix, "--component", "library")
    # A copy, so that nothing of the checkout is in reach of a relative path.
    shutil.copytree(ROOT / "examples", source)
    run("cmake", "-S", source, "-B", build, "-G", "Ninja", f"-DCMAKE_PREFIX_PATH={prefix}")
    run("cmake", "--build", build)
    programs = [path for path in build.iterdir() if path.is_file() and path.stat().st_mode & 0o100]
    assert programs, "examples/ makes no program"
    for program in programs:
        assert run(program).strip(), f"{program.name} says nothing"
