"""make soak: finds the checks by itself, goes on after a kill, tells of failures, and writes what the checks left."""

from __future__ import annotations

import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest
from conftest import ROOT

DOCS = ROOT / "docs"
sys.path.insert(0, str(DOCS))
import make_soak
from soak_checks import Check, SoakError, find_checks

Make = Callable[..., Check]

RAN = re.compile(r"^1 passed", re.MULTILINE)
COUNT = (
    "import os, pathlib, sys; f = pathlib.Path(sys.argv[1]); f.write_text(f.read_text() + 'x' if f.exists() else 'x');"
)
FIGURE = (
    "open(os.environ['MSBVH_SOAK_FIGURES'], 'a').write('rays\\t' + os.environ['MSBVH_SOAK'] + 'e9 rays, 0 leaks\\n');"
)
PASS = "print('1 passed in 0.1 s')"


@pytest.fixture
def check(tmp_path: Path) -> Make:
    """A check of some Python code; how often it ran: the length of tmp_path / its name."""

    def make(name: str, code: str) -> Check:
        command = (sys.executable, "-c", COUNT + code, str(tmp_path / name))
        return Check(name, command, RAN)

    return make


def settings(tmp_path: Path, **changed: object) -> make_soak.Settings:
    known: dict[str, object] = {
        "commit": "abc1234",
        "memory": tmp_path / "memory",
        "page": tmp_path / "soak.md",
        "root": tmp_path,
    }
    return make_soak.Settings(**{**known, **changed})  # type: ignore[arg-type]


def runs(tmp_path: Path, name: str) -> int:
    path = tmp_path / name
    return len(path.read_text()) if path.is_file() else 0


def test_figures_and_results_reach_the_page(tmp_path: Path, check: Make) -> None:
    checks = [check("good", FIGURE + PASS), check("also good", PASS)]
    assert make_soak.run(checks, settings(tmp_path), make_soak.Stop()) == 0
    page = (tmp_path / "soak.md").read_text()
    assert page.startswith("# Soak\n")
    assert "\n## abc1234\n" in page
    assert "| good | passed | 0 s | rays: 1e9 rays, 0 leaks |" in page
    assert "2 checks, 0 s in all: all passed." in page


def test_what_has_passed_is_not_run_again_at_the_same_commit(tmp_path: Path, check: Make) -> None:
    checks = [check("good", FIGURE + PASS)]
    for _ in range(2):
        assert make_soak.run(checks, settings(tmp_path), make_soak.Stop()) == 0
    assert runs(tmp_path, "good") == 1
    page = (tmp_path / "soak.md").read_text()
    assert page.count("## abc1234") == 1
    assert "rays: 1e9 rays" in page
    make_soak.run(checks, settings(tmp_path, commit="def5678", memory=tmp_path / "other"), make_soak.Stop())
    assert runs(tmp_path, "good") == 2
    page = (tmp_path / "soak.md").read_text()
    assert page.index("## abc1234") < page.index("## def5678")


@pytest.mark.parametrize(
    ("code", "said"),
    [
        ("sys.exit(3)", "failed, exit code 3"),
        ("os.kill(os.getpid(), 9)", "killed by SIGKILL"),
        ("print('1 skipped in 0.1 s')", "did not pass"),
        ("import time; time.sleep(60)", "not done in 1 s"),
    ],
)
def test_a_check_that_does_not_pass_fails_the_run(tmp_path: Path, check: Make, code: str, said: str) -> None:
    checks = [check("bad", code), check("good", PASS)]
    assert make_soak.run(checks, settings(tmp_path, limit_seconds=1.0), make_soak.Stop()) == 1
    assert runs(tmp_path, "good") == 1  # the others run all the same
    page = (tmp_path / "soak.md").read_text()
    assert f"| bad | **{said}" in page
    assert "**1 failed**" in page


def test_a_failure_is_not_forgotten_when_the_check_passes_later(tmp_path: Path, check: Make) -> None:
    checks = [check("flaky", "sys.exit(0 if print('1 passed') or len(f.read_text()) > 1 else 1)")]
    assert make_soak.run(checks, settings(tmp_path), make_soak.Stop()) == 1
    assert make_soak.run(checks, settings(tmp_path), make_soak.Stop()) == 0
    assert "| flaky | passed; before: failed, exit code 1 |" in (tmp_path / "soak.md").read_text()


DRIVER = """
import re, sys
from pathlib import Path
sys.path.insert(0, {docs!r})
import make_soak
from soak_checks import Check
tmp = Path({tmp!r})
ran = re.compile("1 passed")
checks = [
    Check("first", (sys.executable, "-c", {count!r} + {ok!r}, str(tmp / "first")), ran),
    Check("second", (sys.executable, "-c", {count!r} + "import time; time.sleep({nap})\\n" + {ok!r}, str(tmp / "second")), ran),
]
stop = make_soak.Stop()
stop.install()
settings = make_soak.Settings("abc1234", tmp / "memory", tmp / "soak.md", tmp)
sys.exit(make_soak.run(checks, settings, stop))
"""


def driver(tmp_path: Path, nap: float) -> subprocess.Popen[str]:
    code = DRIVER.format(docs=str(DOCS), tmp=str(tmp_path), count=COUNT, ok=PASS, nap=nap)
    return subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)


@pytest.mark.parametrize(("number", "code"), [(signal.SIGKILL, -9), (signal.SIGTERM, 143), (signal.SIGINT, 130)])
def test_it_goes_on_after_a_kill(tmp_path: Path, number: signal.Signals, code: int) -> None:
    process = driver(tmp_path, nap=20)
    deadline = time.monotonic() + 60
    while runs(tmp_path, "second") == 0 and time.monotonic() < deadline:
        time.sleep(0.05)
    process.send_signal(number)
    out, _ = process.communicate(timeout=60)
    assert process.returncode == code, out
    assert not (tmp_path / "soak.md").exists()
    again = driver(tmp_path, nap=0)
    out, _ = again.communicate(timeout=60)
    assert again.returncode == 0, out
    assert "1 have passed before" in out
    assert (runs(tmp_path, "first"), runs(tmp_path, "second")) == (1, 2)
    assert "all passed" in (tmp_path / "soak.md").read_text()


def test_the_run_ends_where_the_tree_changes_under_it(tmp_path: Path, check: Make) -> None:
    changing = settings(tmp_path, still_at=lambda: "def5678")
    with pytest.raises(SoakError, match="found def5678; expected abc1234"):
        make_soak.run([check("good", PASS)], changing, make_soak.Stop())
    assert not (tmp_path / "soak.md").exists()


def test_it_finds_the_checks_of_both_languages() -> None:
    checks = find_checks(ROOT, ROOT / "build" / "release")
    names = [check.name for check in checks]
    assert len(set(names)) == len(names)
    assert len({check.slug for check in checks}) == len(names)
    assert any(name.startswith("property: ") for name in names)
    assert any(".py::" in name for name in names)
    assert sum(name.startswith("sanitizers: ") for name in names) == 2
    with pytest.raises(SoakError, match="expected a build"):
        find_checks(ROOT, ROOT / "nowhere")
    with pytest.raises(SoakError, match="found no check for nothing"):
        make_soak.selected(checks, ["nothing*"])
