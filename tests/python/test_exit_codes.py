"""The exit codes: one table, in the help and in README, and what each stands for."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest
from conftest import MOVING_SQUARE, ROOT, Run
from msbvh.cli import main as cli
from msbvh.cli import record_command

CODES = [0, 1, 2, 3, 70, 129, 130, 143]


def test_help_and_readme_have_the_table(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["--help"]) == 0
    shown = capsys.readouterr().out
    assert [int(code) for code in re.findall(r"^ +(\d+) +\S", shown, re.MULTILINE)] == CODES
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| (\d+) \| (.*) \|$", readme, re.MULTILINE)
    assert [int(code) for code, _ in rows] == CODES
    words = " ".join(shown.split())
    assert all(" ".join(text.replace("`", "").split()) in words for _, text in rows)


def test_a_command_imports_what_it_needs_alone() -> None:
    said = "import sys; from msbvh.cli.main import load; load(sys.argv[1:]); print(*sys.modules)"

    def modules(*arguments: str) -> set[str]:
        done = subprocess.run([sys.executable, "-c", said, *arguments], capture_output=True, text=True, check=True)
        return set(done.stdout.split())

    assert not {"pxr", "numpy", "OpenImageIO"} & modules("--version")
    recording = modules("record", "a.usda", "a.exr")
    assert {"pxr", "msbvh.render.record"} <= recording
    assert not {"msbvh.bench.rays", "msbvh.accuracy.run", "msbvh.conform.suite", "jinja2", "matplotlib"} & recording


def test_a_defect_of_ours(
    monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str], scene: Path, tmp_path: Path
) -> None:
    def broken(*_: object, **__: object) -> None:
        raise ZeroDivisionError("planted\nhere")

    monkeypatch.setattr(record_command, "record", broken)
    arguments = ["record", str(scene), str(tmp_path / "a.exr")]
    assert cli.main(arguments) == 70
    line = capfd.readouterr().err
    assert line.startswith("msbvh: error: internal error: ZeroDivisionError: planted here") and line.count("\n") == 1
    assert "report" in line and "issue tracker" in line
    monkeypatch.setenv("MSBVH_TRACEBACK", "1")
    assert cli.main(arguments) == 70
    assert "Traceback" in capfd.readouterr().err


def test_a_rejected_prim_is_an_error_line(msbvh: Run, tmp_path: Path, scene: Path) -> None:
    scene.write_text(MOVING_SQUARE.replace("[0, 1, 2, 3]", "[0, 1, 2, 9]"))
    done = msbvh("record", scene, "a.exr", "--strict", "--stats", "s.json", "-w", 16, "--spp", 1)
    assert done.returncode == 3, done.stderr
    assert "msbvh: error: /world/square.faceVertexIndices: " in done.stderr
    assert "msbvh: warning: /world/square" not in done.stderr
    assert "/world/square.faceVertexIndices" in (tmp_path / "s.json").read_text()
    assert "msbvh: error: /world/square.faceVertexIndices: " in msbvh("plan", scene).stderr


def test_what_usd_says_of_many_prims_is_one_line(msbvh: Run, scene: Path) -> None:
    parts = "".join(f'def "lost{i}" (references = @nowhere.usda@) {{ }}\n' for i in range(40))
    scene.write_text(MOVING_SQUARE + parts)
    done = msbvh("plan", scene)
    lines = [line for line in done.stderr.splitlines() if "nowhere.usda" in line]
    assert len(lines) == 1 and "/lost0" in lines[0] and "(and 39 more prims)" in lines[0], done.stderr


def test_more_threads_than_there_are(msbvh: Run, scene: Path) -> None:
    done = msbvh("record", scene, "a.exr", "--threads", 4096, "-w", 16, "--spp", 1)
    assert done.returncode == 0 and "TBB" not in done.stderr, done.stderr
    assert len([line for line in done.stderr.splitlines() if "--threads 4096" in line]) == 1
    assert all(line.startswith("msbvh: ") for line in done.stderr.splitlines())
