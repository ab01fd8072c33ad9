"""What the exit codes mean: one table, for the help and for README.md."""

from __future__ import annotations

import signal

DONE, WRONG, USAGE, DEGRADED, DEFECT = 0, 1, 2, 3, 70
"""DEFECT is EX_SOFTWARE of sysexits.h."""
BY_SIGNAL = 128
"""A run that a signal ended has this and the signal's number, as shells have it."""

MEANINGS: tuple[tuple[int, str], ...] = (
    (DONE, "done"),
    (
        WRONG,
        "the scene, a setting, a file or the disk is wrong: one line says what was found and what is expected."
        " After a full report: `conform`: a rule fails; `bench`: an answer differs from the oracle's, or a closed"
        " scene leaks (also with `--stability`), or with `--frames` another renderer's picture differs; `motion`: a track"
        " misses `--motion-tolerance`;"
        " `verify`: a ray's answer is wrong, or a tree breaks an invariant; `hydra-info`: there is no plugin, or the"
        " host cannot load it; `record`, `accuracy`: a `--target` or the `--time-budget` was missed by more than 10 %",
    ),
    (USAGE, "usage: a wrong option, or an output that would overwrite the scene, what it reads or another output"),
    (DEGRADED, "rendered, but with `--strict` and something was missing or degraded"),
    (DEFECT, "a defect of msbvh: please report it"),
    (BY_SIGNAL + signal.SIGHUP, "hung up (SIGHUP)"),
    (BY_SIGNAL + signal.SIGINT, "interrupted (SIGINT)"),
    (BY_SIGNAL + signal.SIGTERM, "terminated (SIGTERM); other signals that end a run: 128 and their number"),
)


def table_text() -> str:
    """For the help: click's mark against rewrapping, then a line each, wrapped at 78 columns."""
    lines = ["\b", "Exit codes:"]
    for code, meaning in MEANINGS:
        lines += _wrapped(code, meaning.replace("`", ""))
    return "\n".join(lines)


def _wrapped(code: int, meaning: str) -> list[str]:
    lines = [f"{code:5} "]
    for word in meaning.split():
        if len(lines[-1]) + 1 + len(word) > 76:
            lines.append(" " * 6)
        lines[-1] += f" {word}"
    return lines
