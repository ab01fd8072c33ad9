"""What a generated page was made from: the commit and the machine.

A page of a tree with uncommitted changes would name a commit that cannot reproduce it: the generators refuse to make one,
or mark it where `--allow-dirty` asks for it.
"""

from __future__ import annotations

import platform
import subprocess
from collections.abc import Sequence
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]

GENERATED = (
    "docs/performance.md",
    "docs/features.md",
    "docs/ablation.md",
    "docs/conformance.md",
    "docs/soak.md",
    "docs/stability.md",
    "docs/accuracy.md",
    "docs/images/",
)
"""What generators write: a change there is no change of what is measured, and one generator runs after another."""


class DirtyTree(Exception):
    """Files differ from the commit."""


def commit(root: Path = ROOT, *, allow_dirty: bool = False) -> str:
    """The commit of the checkout, `abc1234` or `abc1234-dirty`. Raises DirtyTree unless that is allowed."""
    changed = changed_files(root)
    if changed and not allow_dirty:
        shown = ", ".join(changed[:5]) + (f" and {len(changed) - 5} more" if len(changed) > 5 else "")
        raise DirtyTree(
            f"{root}: found uncommitted changes in {shown}; expected a clean tree: commit them,"
            " or mark the result as dirty with --allow-dirty"
        )
    return _git(root, "rev-parse", "--short", "HEAD").strip() + ("-dirty" if changed else "")


def changed_files(root: Path = ROOT) -> Sequence[str]:
    """Tracked files that differ from HEAD, and new ones that no .gitignore covers; generated pages aside."""
    entries = [entry for entry in _git(root, "status", "--porcelain", "--no-renames", "-z").split("\0") if entry]
    paths = [entry[3:] for entry in entries]
    return [path for path in paths if not path.startswith(GENERATED)]


def processor() -> str:
    """The name that Linux has for it."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return platform.processor()
    return next((line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")), "unknown")


def _git(root: Path, *arguments: str) -> str:
    return subprocess.run(["git", "-C", str(root), *arguments], check=True, capture_output=True, text=True).stdout
