"""Binary layers with damaged bytes, recorded each in a process that is forked from one where everything is imported:
`python damaged_crates.py FOLDER FIRST COUNT` prints a line of JSON for each."""

from __future__ import annotations

import contextlib
import json
import os
import random
import resource
import select
import sys
import tempfile
import time
import warnings
from collections.abc import Callable, Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
SECONDS = 60.0
"""A hang."""
MOST_BYTES = 6 * 2**30


def sound_crates(folder: Path) -> list[bytes]:
    """Binary layers of the scenes with every attribute."""
    from every_attribute import SCENES
    from pxr import Sdf

    crates = []
    for name, text in SCENES.items():
        layer = Sdf.Layer.CreateAnonymous(".usda")
        layer.ImportFromString("#usda 1.0\n" + text)
        file = folder / f"{name}.usdc"
        layer.Export(str(file))
        crates.append(file.read_bytes())
    return crates


def damaged(crates: list[bytes], seed: int) -> bytes:
    """Flipped bytes, a cut, a number in the place of an offset, or zeros."""
    dice = random.Random(seed)
    data = bytearray(dice.choice(crates))
    kind = dice.randrange(4)
    if kind == 0:
        for _ in range(dice.choice((1, 2, 8, 64))):
            data[dice.randrange(9, len(data))] = dice.randrange(256)
    elif kind == 1:
        del data[dice.randrange(8, len(data)) :]
    elif kind == 2:
        at = dice.randrange(8, len(data) - 8)
        number = dice.choice((0, 1, len(data), 2**31, 2**32 - 1, 2**62, 2**64 - 1, dice.getrandbits(64)))
        data[at : at + 8] = number.to_bytes(8, "little")
    else:
        at, size = dice.randrange(8, len(data)), dice.choice((4, 16, 256))
        data[at : at + size] = bytes(len(data[at : at + size]))
    return bytes(data)


def in_child(action: Callable[[], int]) -> tuple[int, str]:
    """Exit code (negative: a signal; -99: it hung) and stderr of a forked process."""
    reader, writer = os.pipe()
    child = os.fork()
    if child == 0:
        os.dup2(writer, 2)
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
        # Some damaged counts ask for gigabytes, which USD fills before it looks at what follows.
        resource.setrlimit(resource.RLIMIT_AS, (MOST_BYTES, MOST_BYTES))
        code = 70
        try:
            code = action()
        finally:
            os._exit(code)
    os.close(writer)
    said, deadline = b"", time.monotonic() + SECONDS
    with contextlib.closing(os.fdopen(reader, "rb", buffering=0)) as pipe:
        while (left := deadline - time.monotonic()) > 0 and select.select([pipe], [], [], left)[0]:
            if not (part := pipe.read(65536)):
                break
            said += part
        else:
            os.kill(child, 9)
    status = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    return (-99 if status == -9 else status), said.decode("utf-8", "replace")


def outcomes(folder: Path, first: int, count: int) -> Iterator[dict]:
    """What `msbvh record` makes of each."""
    warnings.simplefilter("ignore", DeprecationWarning)  # Nothing has started a thread before the forks.
    from msbvh.cli.main import main

    in_child(lambda: sound_crates(folder) and 0)  # USD starts threads, which no fork takes along.
    crates = [file.read_bytes() for file in sorted(folder.glob("*.usdc"))]
    for seed in range(first, first + count):
        file = folder / f"damaged_{seed}.usdc"
        file.write_bytes(damaged(crates, seed))
        picture = folder / "picture.exr"
        arguments = ["record", str(file), str(picture), "-w", "16", "--spp", "1", "--threads", "1"]
        code, said = in_child(lambda arguments=arguments: main(arguments))
        file.unlink()
        yield {"seed": seed, "file": str(file), "code": code, "said": said}


if __name__ == "__main__":
    sys.path.insert(0, str(ROOT / "tests" / "python"))
    with tempfile.TemporaryDirectory(dir=sys.argv[1]) as scratch:
        for outcome in outcomes(Path(scratch), int(sys.argv[2]), int(sys.argv[3])):
            print(json.dumps(outcome), flush=True)
