"""Writes the scenes of the suite, and rules.json, which says what each one holds a renderer to.

    python testenv/motion/make_scenes.py    # then make_expected.py

One scene a rule, in scenes/. The functions that write them stand in rules_*.py.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import rules_camera  # noqa: F401  Each import registers its rules.
import rules_instancing  # noqa: F401
import rules_round  # noqa: F401
import rules_shapes  # noqa: F401
import rules_shutter  # noqa: F401
import rules_skinning  # noqa: F401
import rules_subdivision  # noqa: F401
import rules_transforms  # noqa: F401
import rules_velocities  # noqa: F401
from authoring import RULES, SIZE, Rule

SUITE = Path(__file__).resolve().parent
TOLERANCE = (
    "Mean absolute error of alpha over the pixels that either image covers: what the renderer's samples a"
    " pixel explain if they are independent (three standard deviations), plus 0.004 for tracks that stray"
    " by a tenth of a pixel, plus a rule's slack where it gives one: allowed_errors() of conformance.py."
)


def entry(rule: Rule) -> dict[str, Any]:
    """What rules.json says about a rule. Paths are relative to it."""
    found = {
        "rule": rule.name,
        "topic": rule.topic,
        "statement": rule.statement,
        "mistake": rule.mistake,
        "scene": f"scenes/{rule.name}.usda",
        "expected": f"scenes/{rule.name}.expected.png",
        "camera": rule.camera,
        "frames": list(rule.frames),
        "width": SIZE[0],
        "height": SIZE[1],
    }
    if rule.slack:
        found |= {"slack": rule.slack, "slack_reason": rule.slack_reason}
    return found


def main() -> None:
    scenes = SUITE / "scenes"
    scenes.mkdir(exist_ok=True)
    for rule in RULES.values():
        rule.write(scenes)
    manifest = {"tolerance": TOLERANCE, "rules": [entry(rule) for rule in RULES.values()]}
    text = json.dumps(manifest, indent=1)
    (SUITE / "rules.json").write_text(text + "\n", encoding="utf-8")
    print(f"{len(RULES)} rules")


if __name__ == "__main__":
    main()
