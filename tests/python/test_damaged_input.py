"""Layers with random faults and binary layers with damaged bytes: what can be read is drawn, the rest is one line."""

from __future__ import annotations

import os
import signal
import struct
import subprocess
import sys
from collections import Counter
from pathlib import Path

import lz4.block
import numpy as np
import pytest
from batches import batches
from msbvh.base.errors import Diagnostics, SceneError
from msbvh.stage.crate_check import crate_fault, path_jumps
from msbvh.stage.opening import open_stage
from pxr import Usd, UsdGeom
from soak import soak_count, soak_figure


@pytest.mark.soak
def test_a_layer_with_random_faults_never_ends_in_an_internal_error():
    """Nor in a crash, a hang or a pixel that is no number."""
    count = soak_count(150, 100_000)
    done = [line for line in batches("mutations.py", (), count) if "outcome" in line]
    wrong = [line for line in done if line["outcome"].startswith("WRONG")]
    assert not wrong, "\n".join(f"{line['seed']}: {line}" for line in wrong[:10])
    assert len(done) == count
    kinds = Counter(line["outcome"].partition(":")[0] for line in done)
    assert kinds["drawn"] > count / 2 and kinds["crashed"] < count / 1000
    soak_figure("mutated layers", f"{count}: " + ", ".join(f"{n} {kind}" for kind, n in kinds.items()))


@pytest.mark.parametrize("length", [6, 2**20, 2**62])
def test_an_array_longer_than_its_file_is_refused_before_usd_makes_room_for_it(tmp_path, length):
    sound, damaged = tmp_path / "sound.usdc", tmp_path / "damaged.usdc"
    stage = Usd.Stage.CreateNew(str(sound))
    mesh = UsdGeom.Mesh.Define(stage, "/Mesh")
    mesh.CreateFaceVertexCountsAttr([3, 4, 5, 6, 7])
    mesh.CreatePointsAttr([(i, 0, 0) for i in range(1000)])
    mesh.CreateFaceVertexIndicesAttr(list(range(1000)))  # Compressed, as long arrays of integers are.
    stage.Save()
    assert crate_fault(str(sound)) == ""
    content, counted = sound.read_bytes(), struct.pack("<Q5i", 5, 3, 4, 5, 6, 7)
    assert content.count(counted) == 1
    damaged.write_bytes(content.replace(counted, struct.pack("<Q5i", length, 3, 4, 5, 6, 7)))
    found = crate_fault(str(damaged))
    if length > len(content):
        assert found.startswith(f"found an array of {length} elements where the file has bytes for ")
        with pytest.raises(SceneError, match=r"damaged\.usdc: cannot be read as USD: found an array"):
            open_stage(str(damaged), Diagnostics())
    else:
        assert found == ""


@pytest.mark.parametrize("at", [0, 8, 16, "values"])
@pytest.mark.parametrize("number", [0, 2**31, 2**60 - 1, 2**61, 2**63 - 1, 2**63, 2**64 - 1])
def test_damaged_numbers_in_the_table_of_fields_are_left_to_usd(tmp_path: Path, at: int | str, number: int) -> None:
    """The number of fields, the bytes of their names' numbers, the first of those, the bytes of their values."""
    sound, damaged = tmp_path / "sound.usdc", tmp_path / "damaged.usdc"
    Usd.Stage.CreateNew(str(sound)).Save()
    content = bytearray(sound.read_bytes())
    (contents,) = struct.unpack_from("<q", content, 16)
    entry = content.index(b"FIELDS\0", contents)
    (start,) = struct.unpack_from("<q", content, entry + 16)
    (index_bytes,) = struct.unpack_from("<Q", content, start + 8)
    struct.pack_into("<Q", content, start + (16 + index_bytes if at == "values" else at), number)
    damaged.write_bytes(content)
    found = crate_fault(str(damaged))
    assert found == "" or found.startswith(f"found {number} elements in the ")


def packed(numbers: list[int]) -> bytes:
    """As Usd_IntegerCompression packs integers, each difference in four bytes."""
    differences = np.diff(numbers, prepend=0).astype("<i4")
    codes = np.full((2 * len(numbers) + 7) // 8, 255, np.uint8)
    return b"\0" + lz4.block.compress(bytes(4) + codes.tobytes() + differences.tobytes(), store_size=False)


@pytest.mark.parametrize(
    "jumps", [[-1, 0, 3, -1, -2, -2], [-1, 0, 2, -1, -2, -2], [-1, 4, 3, -1, -2, -2], [-1, 0, 9, -2, -2, -2]]
)
def test_paths_that_are_no_tree_are_refused_before_usd_follows_them(tmp_path: Path, jumps: list[int]) -> None:
    """/, /A, /B, /B/C, /B/C/D, /E: an element's jump leads to its sibling."""
    sound, damaged = tmp_path / "sound.usdc", tmp_path / "damaged.usdc"
    stage = Usd.Stage.CreateNew(str(sound))
    for path in ("/A", "/B/C/D", "/E"):
        stage.DefinePrim(path)
    stage.Save()
    content = bytearray(sound.read_bytes())
    (contents,) = struct.unpack_from("<q", content, 16)
    entry = content.index(b"PATHS\0", contents)
    start, length = struct.unpack_from("<qq", content, entry + 16)
    assert path_jumps(bytes(content[start : start + length])).tolist() == [-1, 0, 3, -1, -2, -2]
    at = start + 16
    for _ in range(2):
        at += 8 + struct.unpack_from("<Q", content, at)[0]
    new = packed(jumps)
    table = bytes(content[start:at]) + struct.pack("<Q", len(new)) + new
    struct.pack_into("<qq", content, entry + 16, len(content), len(table))
    damaged.write_bytes(bytes(content) + table)
    if jumps == [-1, 0, 3, -1, -2, -2]:
        assert crate_fault(str(damaged)) == ""
        assert str(Usd.Stage.Open(str(damaged)).GetPrimAtPath("/B/C/D").GetPath()) == "/B/C/D"
        return
    with pytest.raises(
        SceneError,
        match=r"damaged\.usdc: cannot be read as USD: found (\d of 6 paths that are reached|a sibling outside)",
    ):
        open_stage(str(damaged), Diagnostics())


def test_the_paths_of_a_large_layer_are_a_tree(tmp_path: Path) -> None:
    rng, stage = np.random.default_rng(3), Usd.Stage.CreateNew(str(tmp_path / "large.usdc"))
    paths = ["/Root"]
    for i in range(3000):
        paths.append(f"{paths[rng.integers(len(paths))]}/P{i}")
        UsdGeom.Xform.Define(stage, paths[-1]).AddTranslateOp()
    stage.Save()
    assert crate_fault(str(tmp_path / "large.usdc")) == ""


@pytest.mark.soak
def test_a_damaged_crate_file_is_drawn_or_one_error_that_names_it(tmp_path):
    count = soak_count(60, 20_000)
    done = list(batches("damaged_crates.py", (tmp_path,), count))
    assert len(done) == count
    wrong = [line for line in done if not _is_right(line)]
    assert not wrong, "\n".join(f"{line['seed']}: {line['code']}: {line['said'][-600:]}" for line in wrong[:10])
    kinds = Counter("drawn" if line["code"] == 0 else _kind(line) for line in done)
    soak_figure("damaged crates", f"{count}: " + ", ".join(f"{n} {kind}" for kind, n in kinds.items()))


def _is_right(line: dict) -> bool:
    if line["code"] == 0:
        return "internal error" not in line["said"]
    errors = [said for said in line["said"].splitlines() if said.startswith("msbvh: error:")]
    return line["code"] == 1 and len(errors) == 1 and "internal error" not in errors[0]


def _kind(line: dict) -> str:
    return "crashed inside USD" if "a library crashed" in line["said"] else "refused"


SIGNALS = (signal.SIGSEGV, signal.SIGBUS, signal.SIGFPE, signal.SIGABRT, signal.SIGILL)


def _in_fresh_process(body: str) -> tuple[int, str]:
    done = subprocess.run(
        [sys.executable, "-c", "import os, sys, ctypes\nfrom msbvh.base.crash_line import crash_line\n" + body],
        capture_output=True,
        text=True,
        check=False,
    )
    return done.returncode, done.stderr


@pytest.mark.parametrize("number", SIGNALS)
def test_a_crash_while_a_file_is_read_is_one_line(number: int):
    body = f"with crash_line('/a/b.usdc'):\n with crash_line('/c.usdc'): pass\n os.kill(os.getpid(), {int(number)})"
    code, said = _in_fresh_process(body)
    assert code == 1
    assert said.startswith("msbvh: error: /a/b.usdc: a library crashed while it was read;") and said.count("\n") == 1


def test_a_stack_that_overflows_is_one_line():
    """The handler has a stack of its own."""
    body = """
from ctypes import CFUNCTYPE, c_int, c_void_p, CDLL
libc = CDLL(None)
deep = CFUNCTYPE(c_int, c_void_p, c_void_p)
import resource; resource.setrlimit(resource.RLIMIT_STACK, (1 << 20, 1 << 20))
sys.setrecursionlimit(10**9)
numbers = (c_int * 4)(4, 3, 2, 1)
@deep
def compare(a, b):
    libc.qsort(numbers, 4, 4, compare)
    return 0
with crash_line('/deep.usda'):
    compare(None, None)
"""
    code, said = _in_fresh_process(body)
    assert code == 1 and "msbvh: error: /deep.usda: a library crashed" in said


def test_outside_of_reading_a_crash_is_a_crash():
    code, said = _in_fresh_process("with crash_line('/a'): pass\nos.kill(os.getpid(), 11)")
    assert code == -signal.SIGSEGV and said == ""
    os.environ["MSBVH_TRACEBACK"] = "1"
    try:
        assert _in_fresh_process("with crash_line('/a'): os.kill(os.getpid(), 11)")[0] == -signal.SIGSEGV
    finally:
        del os.environ["MSBVH_TRACEBACK"]
