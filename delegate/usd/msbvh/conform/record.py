"""What our own renderer is held to beside the noise bound: the errors of a recorded run, a rule each.

testenv/motion/make_recorded.py makes the record. Other renderers are not held to it.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from ..base.errors import SceneError

RECORD = "recorded.json"
STANDARD_ERRORS = 3.0
HALF_STEP = 0.5 / 65535
"""Of an expected image's 16 bits: where a rule's scene is sharp, this is all that is left of the error."""


@dataclass(frozen=True)
class Recorded:
    """A rule's mean error of alpha in the recorded run."""

    error: float
    """Mean over the seeds."""
    standard_error: float
    """Of one seed's error: the standard deviation over the seeds."""

    @property
    def allowed(self) -> float:
        """The largest error that a run of ours may have."""
        return self.error + max(STANDARD_ERRORS * self.standard_error, HALF_STEP)


def read_record(suite: Path, spp: int) -> Mapping[str, Recorded]:
    """The record by rule; empty for a suite without one, and at other samples a pixel than it was made with.

    Raises SceneError where it cannot be read.
    """
    path = suite / RECORD
    if not path.is_file():
        return {}
    try:
        record = json.loads(path.read_text(encoding="utf-8"))
        rules = {name: Recorded(entry["error"], entry["standard_error"]) for name, entry in record["rules"].items()}
        return rules if record["spp"] == spp else {}
    except (OSError, ValueError, KeyError, TypeError, AttributeError) as error:
        raise SceneError(
            f"{path}: found {type(error).__name__}: {error}, expected what make_recorded.py writes"
        ) from None
