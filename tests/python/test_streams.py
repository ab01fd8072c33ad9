"""Where nobody reads what is said: a closed, full or broken stderr or stdout costs no picture."""

from __future__ import annotations

import json
import os
import pty
import signal
import subprocess
import sys
import time
from pathlib import Path

import OpenImageIO as oiio
import pytest
from conftest import MOVING_SQUARE

MSBVH = f"{sys.executable} -m msbvh"
RECORD = f"{MSBVH} record scene.usda a.exr --spp 4 -w 48"


def shell(folder: Path, script: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(["bash", "-c", script], cwd=folder, capture_output=True, text=True, timeout=120, check=False)


def is_whole(path: Path) -> bool:
    image = oiio.ImageInput.open(str(path))
    return image is not None and image.read_image(oiio.FLOAT) is not None


@pytest.mark.parametrize(
    "redirection",
    ["2>&-", ">&- 2>&- <&-", "2>/dev/full >/dev/full", "2>&1 | head -1; exit ${PIPESTATUS[0]}"],
)
def test_the_picture_is_there_all_the_same(tmp_path: Path, scene: Path, redirection: str) -> None:
    """A warning of ours and one of USD are on their way as well: they must not end in the picture."""
    missing = 'def "missing" (references = @nowhere.usda@)\n{\n}\n'
    scene.write_text(MOVING_SQUARE.replace('"none"', '"catmullClark"') + missing)
    done = shell(tmp_path, f"{RECORD} {redirection}")
    assert done.returncode == 0, done.stderr
    assert sorted(os.listdir(tmp_path)) == ["a.exr", "scene.usda"]
    assert is_whole(tmp_path / "a.exr")


def test_a_terminal_that_goes_away(tmp_path: Path, scene: Path) -> None:
    """The window is closed under a job that ignores SIGHUP: the bar's writes fail."""
    ours, theirs = pty.openpty()
    with subprocess.Popen(
        [*RECORD.split(), "--spp", "3000"],
        cwd=tmp_path,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=theirs,
        preexec_fn=lambda: signal.signal(signal.SIGHUP, signal.SIG_IGN),
    ) as process:
        os.close(theirs)
        while b"frame 1" not in os.read(ours, 4096):
            pass
        os.close(ours)
        time.sleep(0.1)
        assert process.wait(timeout=60) == 0
    assert is_whole(tmp_path / "a.exr")


def test_a_report_that_cannot_be_printed(tmp_path: Path, scene: Path) -> None:
    """What is asked for is the text: a full disk is an error; who closes the pipe has read enough."""
    full = "cannot write to standard output: No space left on device"
    for command in ("plan scene.usda", "--help"):
        done = shell(tmp_path, f"{MSBVH} {command} >/dev/full")
        assert (done.returncode, done.stderr) == (1, f"msbvh: error: {full}\n")
    for command, code in (("plan scene.usda --json | true", 0), ("motion scene.usda >&-", 0)):
        done = shell(tmp_path, f"set -o pipefail; {MSBVH} {command}")
        assert (done.returncode, done.stderr) == (code, "")


NAMES = (b"gr\xc3\xbcn \xe7\x8c\xab.exr", b"latin \xfcn.exr", b"new\nline.exr")


@pytest.mark.parametrize("locale", ["LC_ALL=C", "LC_ALL=C PYTHONUTF8=0 PYTHONCOERCECLOCALE=0 PYTHONIOENCODING=ascii"])
def test_names_in_any_locale(tmp_path: Path, locale: str) -> None:
    """A scene with a UTF-8 name, and outputs whose names are UTF-8, Latin-1, and of two lines."""
    (tmp_path / "schön.usda").write_text(MOVING_SQUARE.replace("square", "Würfel"), encoding="utf-8")
    outputs = " ".join("$'" + "".join(f"\\x{byte:02x}" for byte in name) + "'" for name in NAMES)
    done = shell(tmp_path, f"export {locale}; {MSBVH} record schön.usda {outputs} --stats s.json --spp 1 -w 16")
    assert done.returncode == 0, done.stderr
    assert set(os.listdir(os.fsencode(tmp_path))) == {*NAMES, "schön.usda".encode(), b"s.json"}
    assert json.loads((tmp_path / "s.json").read_text())["scene"] == "schön.usda"
    done = shell(tmp_path, f"export {locale}; {MSBVH} motion schön.usda /world/Würfel")
    assert done.returncode == 0 and "/world/W" in done.stdout, done.stderr


def test_a_scene_whose_name_is_no_text(tmp_path: Path) -> None:
    (Path(os.fsdecode(bytes(tmp_path) + b"/\xfc.usda"))).write_text(MOVING_SQUARE)
    done = shell(tmp_path, f"{MSBVH} record $'\\xfc.usda' a.exr")
    assert done.returncode == 2 and done.stderr.count("\n") == 1, done.stderr
    assert "expected a name in UTF-8" in done.stderr
