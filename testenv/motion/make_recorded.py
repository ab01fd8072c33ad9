"""Records our own renderer's errors: what later runs of it are held to, beside the noise bound.

    python testenv/motion/make_recorded.py [RULE,...]    # ten minutes for all; with msbvh installed

Run it after a rule was added or corrected (name the rule: the others keep their record), or after a change
that is meant to alter the errors, and say in the commit why they differ. Every rule is rendered with SEEDS
seeds; written are the mean of the errors and their standard deviation, the standard error of one run.
"""

from __future__ import annotations

import json
import statistics
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from msbvh.cli.main import main as msbvh
from msbvh.conform.record import RECORD
from msbvh.conform.suite import Rule, errors, image_of, own_renderer, read_expected, read_rules
from msbvh.output.images import read_alpha

SUITE = Path(__file__).resolve().parent
SPP = 256
"""Samples a pixel: the default of `msbvh conform`."""
SEEDS = 8
DIGITS = 7
"""Behind the decimal point: a step of the expected images' 16 bits is 0.0000153."""
COMMAND = "python testenv/motion/make_recorded.py"


def error_of(rule: Rule, seed: int, folder: Path) -> float:
    """Mean error of alpha of a run in this process, by the command line that `msbvh conform` runs."""
    out, image = image_of(rule, folder)
    command = own_renderer(SPP).command(rule, out)
    arguments = command[command.index("record") :]
    if code := msbvh([*arguments, "--seed", str(seed)]):
        raise SystemExit(f"{rule.name}: exit code {code} of msbvh {' '.join(arguments)}")
    return errors(read_alpha(image), read_expected(rule))[0]


def recorded(rule: Rule) -> dict[str, float]:
    """The entry of a rule."""
    with tempfile.TemporaryDirectory(prefix="msbvh_record_") as folder:
        found = [error_of(rule, seed, Path(folder)) for seed in range(SEEDS)]
    return {
        "error": round(statistics.mean(found), DIGITS),
        "standard_error": round(statistics.stdev(found), DIGITS),
    }


def main(patterns: Sequence[str]) -> None:
    path = SUITE / RECORD
    known: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))["rules"] if path.exists() else {}
    chosen = {rule.name for pattern in patterns or ["*"] for rule in read_rules(SUITE, pattern)}
    rules = {}
    for rule in read_rules(SUITE):
        if rule.name in chosen:
            rules[rule.name] = recorded(rule)
        elif rule.name in known:
            rules[rule.name] = known[rule.name]
    text = json.dumps({"command": COMMAND, "spp": SPP, "seeds": SEEDS, "rules": rules}, indent=1)
    path.write_text(text + "\n", encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
