"""Gets the headers that belong to the OpenImageIO library of PyPI's wheel: from PyPI's source archive of the same version,
which is unpacked in part and not built. The wheel has the library without them, and a package of a system has another
version, of which a process must not hold a second copy."""

from __future__ import annotations

import shutil
import subprocess
import sys
import tarfile
import tempfile
from pathlib import Path

ARCHIVE_SHA256 = {"3.2.2.0": "d66c829016b4f092c443b7f7896f06d0ab6af02a103d635d1b0b841c14bfd7c1"}
"""By version of the wheel."""

FMT_HEADERS = ("format", "ostream", "printf")
"""That OpenImageIO's build would copy beside its own; here they lead to those that are installed."""


def download(version: str, folder: Path) -> Path:
    """The archive. pip checks its sum; its metadata is made by scikit-build-core, which builds nothing for that."""
    if version not in ARCHIVE_SHA256:
        raise SystemExit(
            f"OpenImageIO {version}: found no sum of its archive; expected one of {', '.join(ARCHIVE_SHA256)}"
        )
    wanted = folder / "requirements.txt"
    wanted.write_text(f"OpenImageIO=={version} --hash=sha256:{ARCHIVE_SHA256[version]}\n", encoding="utf-8")
    options = ["--quiet", "--no-deps", "--no-build-isolation", "--no-binary", "OpenImageIO", "--require-hashes"]
    command = [sys.executable, "-m", "pip", "download", *options, "--dest", str(folder), "--requirement", str(wanted)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise SystemExit(f"pip download of OpenImageIO {version}: {(done.stderr or done.stdout).strip()}")
    return next(folder.glob("*.tar.gz"))


def version_header(template: str, version: str) -> str:
    """oiioversion.h as the wheel's build made it."""
    major, minor, patch, tweak = version.split(".")
    values = {
        "PROJECT_VERSION_MAJOR": major,
        "PROJECT_VERSION_MINOR": minor,
        "PROJECT_VERSION_PATCH": patch,
        "PROJECT_VERSION_TWEAK": tweak,
        "PROJECT_VERSION_RELEASE_TYPE": "",
        "OIIO_USE_COMPILED_FMT_VALUE": "0",
        "PROJ_NAMESPACE": "OpenImageIO",
        "PROJ_VERSION_NAMESPACE": f"v{major}_{minor}",
        "Imath_VERSION_MAJOR": "3",
        "Imath_VERSION_MINOR": "1",
        "CMAKE_CXX_STANDARD": "17",
    }
    for name, value in values.items():
        template = template.replace(f"@{name}@", value)
    return template.replace("#cmakedefine01 OIIO_TBB", "#define OIIO_TBB 0")


def unpack(archive: Path, version: str, folder: Path) -> None:
    """OpenImageIO/*.h to `folder`."""
    home = f"openimageio-{version}/src/include/OpenImageIO/"
    with tarfile.open(archive) as files:
        for member in files.getmembers():
            name = member.name.removeprefix(home)
            source = files.extractfile(member) if member.isfile() and name != member.name else None
            if source is None or not name.endswith((".h", ".hpp", ".h.in")):
                continue
            text = source.read().decode("utf-8")
            if name == "oiioversion.h.in":
                name, text = "oiioversion.h", version_header(text, version)
            path = folder / "OpenImageIO" / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8")
    for name in FMT_HEADERS:
        path = folder / "OpenImageIO" / "detail" / "fmt" / f"{name}.h"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(f"#pragma once\n#include <fmt/{name}.h>\n", encoding="utf-8")


def main() -> None:
    version, target = sys.argv[1], Path(sys.argv[2])
    target.parent.mkdir(parents=True, exist_ok=True)
    # Whole, or not at all: an interrupted run leaves no half of it under the final name.
    with tempfile.TemporaryDirectory(dir=target.parent) as name:
        folder = Path(name)
        unpack(download(version, folder), version, folder / "headers")
        shutil.rmtree(target, ignore_errors=True)
        (folder / "headers").rename(target)


if __name__ == "__main__":
    main()
