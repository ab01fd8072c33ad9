"""The extension reads textures by the library of the module OpenImageIO: one copy of it in a process, found beside the
package wherever that is installed, and headers that belong to it."""

from __future__ import annotations

import importlib.metadata
import importlib.util
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
from conftest import ROOT

FETCHER = ROOT / "cmake" / "fetch_openimageio_headers.py"
SAY_LIBRARIES = """
lines = open("/proc/self/maps").read().splitlines()
print(*sorted({line.split(maxsplit=5)[5] for line in lines if "libOpenImageIO" in line}), sep="\\n")
"""


def libraries_after(*modules: str) -> list[Path]:
    """Those of OpenImageIO that a process holds once it has imported these."""
    code = f"import {', '.join(modules)}\n{SAY_LIBRARIES}"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    return [Path(line) for line in done.stdout.split()]


@pytest.mark.parametrize(
    "modules", [("msbvh._core",), ("msbvh._core", "OpenImageIO"), ("OpenImageIO", "msbvh._core")], ids="+".join
)
def test_a_process_holds_one_copy(modules: tuple[str, ...]) -> None:
    spec = importlib.util.find_spec("OpenImageIO")
    assert spec is not None and spec.origin is not None
    folder = Path(spec.origin).parent / "lib"
    assert libraries_after(*modules) == sorted(folder.glob("libOpenImageIO*.so.*"))


def test_textures_can_be_read() -> None:
    from msbvh import _core

    assert _core.can_read_textures()


def test_the_headers_are_those_of_the_wheel() -> None:
    version = importlib.metadata.version("OpenImageIO")
    spec = importlib.util.spec_from_file_location("fetcher", FETCHER)
    assert spec is not None and spec.loader is not None
    fetcher = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(fetcher)
    assert version in fetcher.ARCHIVE_SHA256
    header = fetcher.version_header(
        "#define OIIO_VERSION_PATCH @PROJECT_VERSION_PATCH@\n#cmakedefine01 OIIO_TBB\n", version
    )
    assert header == f"#define OIIO_VERSION_PATCH {version.split('.')[2]}\n#define OIIO_TBB 0\n"


def test_the_package_wants_the_version_that_it_was_built_with() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    (wanted,) = [name for name in project["project"]["dependencies"] if name.startswith("OpenImageIO")]
    assert wanted in project["build-system"]["requires"]
    major, minor, patch, _ = importlib.metadata.version("OpenImageIO").split(".")
    assert wanted == f"OpenImageIO=={major}.{minor}.{patch}.*"
    assert f"'{wanted}'" in (ROOT / "Makefile").read_text(encoding="utf-8")


def test_an_unknown_version_is_refused_before_anything_is_fetched(tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, str(FETCHER), "1.2.3.4", str(tmp_path / "headers")],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 1
    assert "OpenImageIO 1.2.3.4: found no sum of its archive; expected one of 3.2.2.0" in done.stderr
    assert list(tmp_path.iterdir()) == []
