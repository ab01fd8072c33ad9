"""Runs the fuzz targets: `make fuzz`.

    python docs/run_fuzz.py [--seconds N] [--only GLOB]... [--list]

C++ targets (tests/fuzz/fuzz_*.cpp) by libFuzzer with AddressSanitizer and UndefinedBehaviorSanitizer, in the build of the
preset `fuzz`; the reader's parsing and the stages of tests/python/fuzzed_*.py by atheris. Each runs on one processor for so
many seconds. What it has reached is kept in build/fuzz/inputs and is where the next run goes on; an input that fails is in
build/fuzz/found. Exit code 0 if no target found anything.
"""

from __future__ import annotations

import argparse
import fnmatch
import os
import random
import re
import subprocess
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
BUILD = ROOT / "build" / "fuzz"
LONGEST_BYTES = 600
SECONDS_AN_INPUT = 30
MOST_MEGABYTES = 3000
SEEDS = 150
"""Random inputs that a target begins with: it takes long to grow some from nothing."""
PARSERS = ("frame_specs", "options", "crate_tables", "stage_numbers", "stage_texts", "stages")
"""Entries of tests/python/fuzzed_parsers.py."""
CRASHED = "a library crashed while it was read"
"""What the reader says where USD itself crashes (msbvh/base/crash_line.py), which ends the process."""


@dataclass(frozen=True)
class Target:
    """What is fuzzed: `name`, and the command before libFuzzer's own options."""

    name: str
    command: tuple[str, ...]

    @property
    def corpus(self) -> Path:
        """Inputs that failed once."""
        return ROOT / "tests" / "fuzz" / "corpus" / self.name


@dataclass
class Found:
    """What came of a target."""

    inputs: int = 0
    reached: int = 0
    """libFuzzer's count of edges of the control flow."""
    usd_crashes: int = 0
    defect: str = ""


def targets() -> list[Target]:
    sources = sorted((ROOT / "tests" / "fuzz").glob("fuzz_*.cpp"))
    compiled = [Target(s.stem[5:], (str(BUILD / "tests" / "fuzz" / s.stem),)) for s in sources]
    script = str(ROOT / "tests" / "python" / "fuzzed_parsers.py")
    return compiled + [Target(f"reader_{name}", (sys.executable, script, name)) for name in PARSERS]


def build() -> None:
    """Raises CalledProcessError."""
    for step in (["cmake", "--preset", "fuzz"], ["cmake", "--build", "--preset", "fuzz"]):
        done = subprocess.run(step, cwd=ROOT, capture_output=True, text=True)
        if done.returncode:
            print(done.stdout[-4000:], done.stderr[-4000:], file=sys.stderr)
            done.check_returncode()


def fuzz(target: Target, seconds: float) -> Found:
    found, end = Found(), time.monotonic() + seconds
    while not found.defect and (left := end - time.monotonic()) > 1:
        output, code = _run(target, left)
        found.inputs += sum(map(int, re.findall(r"^(?:#|Done )(\d+)(?= runs in|\s+DONE)", output, re.MULTILINE)[:1]))
        found.reached = max([found.reached, *map(int, re.findall(r" cov: (\d+) ", output))])
        if CRASHED in output:
            found.usd_crashes += 1
            found.inputs += max([0, *map(int, re.findall(r"^#(\d+)\t", output, re.MULTILINE))])
        elif code:
            found.defect = _first_words(output)
    return found


def _run(target: Target, seconds: float) -> tuple[str, int]:
    inputs, seeds = BUILD / "inputs" / target.name, BUILD / "seeds" / target.name
    artifacts = BUILD / "found"
    for folder in (inputs, seeds, artifacts):
        folder.mkdir(parents=True, exist_ok=True)
    _write_seeds(seeds)
    folders = [str(folder) for folder in (inputs, seeds, target.corpus) if folder.is_dir()]
    options = [
        f"-max_total_time={max(1, round(seconds))}",
        f"-timeout={SECONDS_AN_INPUT}",
        f"-rss_limit_mb={MOST_MEGABYTES}",
        f"-max_len={LONGEST_BYTES}",
        "-len_control=0",
        f"-artifact_prefix={artifacts}/{target.name}-",
    ]
    environment = {**os.environ, "ASAN_OPTIONS": "abort_on_error=1", "UBSAN_OPTIONS": "print_stacktrace=1"}
    done = subprocess.run(
        [*target.command, *options, *folders],
        cwd=BUILD,
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        preexec_fn=_one_processor,
    )
    output = done.stdout.decode("utf-8", "replace")
    (BUILD / f"{target.name}.log").write_text(output, encoding="utf-8")
    return output, done.returncode


def _one_processor() -> None:
    os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})


def _write_seeds(folder: Path) -> None:
    dice = random.Random(1)
    for i in range(SEEDS):
        content = dice.randbytes(dice.choice((12, 60, 150, 300, LONGEST_BYTES)))
        path = folder / f"{i}"
        if not path.exists():
            path.write_bytes(content)


def _first_words(output: str) -> str:
    lines = [line.strip() for line in output.splitlines()]
    telling = [line for line in lines if re.search(r"defect:|runtime error|ERROR: |Error: |Uncaught", line)]
    where = [line for line in lines if "Test unit written to" in line]
    return "; ".join([*telling[:1], *where[:1]]) or f"ended without a word: {lines[-1] if lines else ''}"


def main(arguments: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seconds", type=float, default=60.0, help="for each target")
    parser.add_argument("--only", action="append", default=[], metavar="GLOB", help="targets by name")
    parser.add_argument("--list", action="store_true", help="names the targets, and runs none")
    options = parser.parse_args(arguments)
    chosen = [t for t in targets() if not options.only or any(fnmatch.fnmatch(t.name, g) for g in options.only)]
    if options.list:
        print("\n".join(target.name for target in chosen))
        return 0
    if not chosen:
        parser.error(f"--only: found no target of that name, expected some of: {', '.join(t.name for t in targets())}")
    if any(not target.name.startswith("reader_") for target in chosen):
        build()
    return _run_all(chosen, options.seconds)


def _run_all(chosen: Sequence[Target], seconds: float) -> int:
    wrong = 0
    for target in chosen:
        found = fuzz(target, seconds)
        words = f"{found.inputs:,} inputs, {found.reached:,} edges reached"
        if found.usd_crashes:
            words += f", {found.usd_crashes} crashes inside USD, each one line"
        print(f"fuzz {target.name}: {words}; {found.defect or 'no defect'}", flush=True)
        if file := os.environ.get("MSBVH_SOAK_FIGURES"):
            with open(file, "a", encoding="utf-8") as lines:
                lines.write(f"fuzz {target.name}\t{words}\n")
        wrong += bool(found.defect)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
