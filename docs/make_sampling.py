"""Writes the table of docs/design/path_tracing.md.

    python docs/make_sampling.py [build/release/bench/msbvh_bench_sampling]    # two minutes

The executable comes with -DMSBVH_BUILD_BENCH=ON (`make setup` has it), and prints what stands between the marks.
"""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PAGE = ROOT / "docs" / "design" / "path_tracing.md"
BEGIN, END = "<!-- python docs/make_sampling.py -->\n", "<!-- end -->\n"


def main(bench: str = str(ROOT / "build/release/bench/msbvh_bench_sampling")) -> None:
    table = subprocess.run([bench], check=True, capture_output=True, text=True).stdout
    head, _, rest = PAGE.read_text(encoding="utf-8").partition(BEGIN)
    _, _, tail = rest.partition(END)
    PAGE.write_text(f"{head}{BEGIN}{table}{END}{tail}", encoding="utf-8")


if __name__ == "__main__":
    main(*sys.argv[1:])
