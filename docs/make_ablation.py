"""Writes docs/ablation.md: what each effect costs where it is on, and that it costs nothing where it is off.

    python docs/make_ablation.py [--only GLOB] [--pairs N] [--table-1-only] [--time-again] [--page-only] [--allow-dirty]

For each effect whose name (with hyphens for spaces) matches GLOB:

1. Table 1: build/release/bench/msbvh_bench_ablation (`make setup`) renders a base scene and the same with the effect in turn.
2. Table 2: the bench is built in build/ablation without the effect's code (-DMSBVH_OMIT_EFFECTS), and renders the base scene,
   which does not need it, beside a build that has everything: the picture's bits, instructions by callgrind, and time in
   interleaved pairs.
3. Table 3: both builds render the frames of table 1 that do not need the effect: instructions by callgrind.

The build `all-at-once` leaves out every effect that has code. A build takes a minute, or ten where the effect is in the kernels
too (instances, displacement, curves, points, polynomial motion, time remaps). What is measured is kept in build/ablation as long
as the sources of the bench do not change: the same command goes on after an interruption, and --page-only writes what there is.
Rows that were not measured say so. --time-again repeats the times of both tables where they were taken on a busy machine. Needs
valgrind. A tree with uncommitted changes is refused, or with --allow-dirty measured, marked, and not kept.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import platform
import shutil
import sys
from collections.abc import Sequence
from fnmatch import fnmatch
from pathlib import Path
from typing import Any

import provenance
from ablation_counts import Failed, base_count, beside_counts, effect_count, output
from ablation_page import Machine, Row, page

ROOT = Path(__file__).resolve().parents[1]
BENCH = ROOT / "build/release/bench/msbvh_bench_ablation"
BUILD = ROOT / "build/ablation"
TREE = ROOT / "build/omitted"
"""Of all builds. As deep as build/release, so that a compiler cache knows what they share."""
SOURCES = ("CMakeLists.txt", "cmake", "core", "bench")
NO_SOURCES = (".md", ".py")
"""Among the bench's sources, but nothing that it is compiled from."""
EFFECTS = (
    "deforming keys",
    "instances",
    "moving instances",
    "camera motion",
    "moving lights",
    "opacity",
    "area lights",
    "dome light",
    "indirect light",
    "lens",
    "polynomial motion",
    "time remaps",
    "AOVs",
    "curves",
    "points",
    "displacement",
    "subdivision",
    "specular",
    "textures",
    "light controls",
    "image dome",
    "refraction",
    "fibre",
)
"""As `msbvh plan` names them: core/plan/effect_plan.cpp."""
STAGE_MARKS = "stage marks"
"""No effect, but left out in the same way: what samples stages (core/integrate/stage_mark.h)."""
ALL = "all at once"
"""A build that draws still triangles, and the limit surfaces that are made of such, under lights that stand still."""
WITH_CODE = tuple(effect for effect in EFFECTS if effect != "subdivision")
WHOLE = "whole"
INSTRUCTION_SETS = ("sse4", "avx2")
"""That callgrind knows; valgrind 3.19 knows no AVX-512."""
TIMED_SET = "avx2"


def main() -> None:
    options = _parser().parse_args()
    try:
        commit = provenance.commit(allow_dirty=options.allow_dirty)
        chosen = [name for name in (*EFFECTS, ALL, STAGE_MARKS) if fnmatch(option_name(name), options.only)]
        if not chosen:
            raise Failed(f"--only: found no effect that matches '{options.only}'; expected one of {_known()}")
        if not options.table_1_only and not shutil.which("valgrind"):
            raise Failed(
                "valgrind: found none on PATH; expected it for the instructions of table 2: install the package valgrind, or"
                " ask for --table-1-only"
            )
        kept = Kept(BUILD / "rows.json", sources_key())
        if options.time_again:
            time_again(chosen, options, kept)
        elif not options.page_only:
            measure(chosen, options, kept)
    except (Failed, provenance.DirtyTree) as error:
        sys.exit(f"make_ablation: error: {error}")
    machine = Machine(commit, provenance.processor(), os.cpu_count() or 1, f"{platform.system()} {platform.release()}")
    rows = {name: kept.rows.get(name, {}) for name in (*EFFECTS, ALL, STAGE_MARKS)}
    (ROOT / "docs" / "ablation.md").write_text("\n".join(page(machine, rows)) + "\n", encoding="utf-8")


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--only", default="*", metavar="GLOB", help="effects, by names with hyphens for spaces")
    parser.add_argument("--pairs", type=int, default=25, metavar="N", help="of runs that are timed for table 2")
    parser.add_argument("--table-1-only", action="store_true", help="build nothing")
    parser.add_argument(
        "--time-again", action="store_true", help="the times of rows that there are, with the same binaries"
    )
    parser.add_argument("--page-only", action="store_true", help="measure nothing: the page of rows that there are")
    parser.add_argument("--allow-dirty", action="store_true", help="measure a tree with uncommitted changes")
    return parser


def option_name(effect: str) -> str:
    """As MSBVH_OMIT_EFFECTS has it."""
    return effect.lower().replace(" ", "-")


def _known() -> str:
    return ", ".join(option_name(name) for name in (*EFFECTS, ALL, STAGE_MARKS))


def sources_key() -> str | None:
    """Of what the bench is compiled from, as it is committed. None: it has uncommitted changes."""
    if any(path.startswith(SOURCES) and not path.endswith(NO_SOURCES) for path in provenance.changed_files()):
        return None
    files = output(["git", "-C", ROOT, "ls-tree", "-r", "HEAD", "--", *SOURCES]).splitlines()
    compiled = [line for line in files if not line.endswith(NO_SOURCES)]
    return hashlib.sha256("\n".join(compiled).encode()).hexdigest()


class Kept:
    """Rows that were measured of these sources. Those of others are removed, and their binaries."""

    def __init__(self, path: Path, key: str | None) -> None:
        self._path, self._key = path, key
        found = json.loads(path.read_text(encoding="utf-8")) if path.is_file() else {}
        same = key is not None and found.get("key") == key
        self.rows: dict[str, Row] = found["rows"] if same else {}
        if not same:
            for old in [path, *path.parent.glob(binary("*").name), path.parent / binary(None).name]:
                old.unlink(missing_ok=True)

    def has(self, effect: str, table: str) -> bool:
        return table in self.rows.get(effect, {})

    def add(self, effect: str, table: str, row: dict[str, Any]) -> None:
        self.rows.setdefault(effect, {})[table] = row
        if self._key is None:
            return
        self._path.parent.mkdir(parents=True, exist_ok=True)
        unfinished = self._path.with_suffix(".part")
        unfinished.write_text(json.dumps({"key": self._key, "rows": self.rows}, indent=1), encoding="utf-8")
        unfinished.replace(self._path)


def measure(chosen: Sequence[str], options: argparse.Namespace, kept: Kept) -> None:
    for effect in chosen:
        if effect in EFFECTS and not kept.has(effect, "on"):
            _say(f"{effect}: on and off in turn")
            kept.add(effect, "on", on_row(effect))
    if options.table_1_only:
        return
    for effect in chosen:
        if not kept.has(effect, "omitted"):
            _say(f"{effect}: a build without")
            kept.add(effect, "omitted", omitted_row(built(None), built(effect), options.pairs))
    for effect in chosen:
        if effect != ALL and not kept.has(effect, "beside"):
            _say(f"{effect}: other effects without its code")
            kept.add(effect, "beside", beside_counts(whole_counts(kept), built(effect), effect))


def whole_counts(kept: Kept) -> dict[str, dict[str, Any]]:
    """Of the build with everything, by effect."""
    if not kept.has(WHOLE, "counts"):
        kept.add(WHOLE, "counts", {effect: effect_count(built(None), effect) for effect in EFFECTS})
    return dict(kept.rows[WHOLE]["counts"])


def time_again(chosen: Sequence[str], options: argparse.Namespace, kept: Kept) -> None:
    for effect in chosen:
        if kept.has(effect, "omitted"):
            _say(f"{effect}: times of pairs")
            row = kept.rows[effect]["omitted"]
            kept.add(effect, "omitted", row | timed_pairs(binary(None), binary(effect), options.pairs))
    for effect in chosen:
        if kept.has(effect, "on"):
            _say(f"{effect}: on and off in turn")
            kept.add(effect, "on", on_row(effect))


def _say(text: str) -> None:
    print(f"make_ablation: {text}", file=sys.stderr, flush=True)


def on_row(effect: str) -> dict[str, Any]:
    """Table 1's, as the bench prints it."""
    if not BENCH.is_file():
        raise Failed(f"{BENCH}: found none; expected it of `make setup`")
    row = json.loads(output([BENCH, "effects", "20000", "256", "15", effect]))
    return {**row, "load": os.getloadavg()[0]}


def built(effect: str | None) -> Path:
    """The bench without the effect's code, which is built once. One build tree: the kernels are compiled again only where it is
    in them."""
    if binary(effect).is_file():
        return binary(effect)
    omitted = ";".join(map(option_name, WITH_CODE)) if effect == ALL else option_name(effect) if effect else ""
    generator = ["-G", "Ninja"] if shutil.which("ninja") else []
    output(
        ["cmake", "-S", ROOT, "-B", TREE, *generator, "-DCMAKE_BUILD_TYPE=Release", "-DMSBVH_BUILD_BENCH=ON",
         "-DMSBVH_BUILD_TESTS=OFF", "-DMSBVH_BUILD_PYTHON=OFF", f"-DMSBVH_OMIT_EFFECTS={omitted}"]
    )  # fmt: skip
    output(["cmake", "--build", TREE, "--target", "msbvh_bench_ablation"])
    BUILD.mkdir(parents=True, exist_ok=True)
    unfinished = binary(effect).with_suffix(".part")
    shutil.copy2(TREE / "bench/msbvh_bench_ablation", unfinished)
    return unfinished.replace(binary(effect))


def binary(effect: str | None) -> Path:
    return BUILD / (f"without-{option_name(effect)}" if effect else "whole")


def omitted_row(whole: Path, without: Path, pairs: int) -> dict[str, Any]:
    """Table 2's: both on the base scene."""
    row: dict[str, Any] = {"hash": {}, "count": {}}
    for instructions in INSTRUCTION_SETS:
        sides = [base_count(bench, instructions) for bench in (whole, without)]
        row["hash"][instructions] = [side["hash"] for side in sides]
        row["count"][instructions] = [side["count"] for side in sides]
    return row | timed_pairs(whole, without, pairs)


def timed_pairs(whole: Path, without: Path, pairs: int) -> dict[str, Any]:
    """A row's part, with how busy the machine was."""
    return {"seconds": [timed_pair(whole, without, turn) for turn in range(pairs)], "load": os.getloadavg()[0]}


def timed_pair(whole: Path, without: Path, turn: int) -> tuple[float, float]:
    """Seconds of a frame by each build, the first one first in every other turn."""
    order = (whole, without) if turn % 2 == 0 else (without, whole)
    seconds = {bench: json.loads(output([bench, "base", TIMED_SET]))["seconds"] for bench in order}
    return seconds[whole], seconds[without]


if __name__ == "__main__":
    main()
