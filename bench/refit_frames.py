"""Refit against rebuild over the frames of a scene, side by side: seconds, cost and speed of the trees.

    .venv/bin/python bench/refit_frames.py SCENE FIRST COUNT [STRIDE]

One row a frame, read once: `always` refits from frame to frame, `never` builds anew, `auto` as it sees fit.
Trees are those that were built + refitted + kept; drift is the SAH cost of `always` against that of its first
frame, and ratios are against `never`, the trace's of the quickest of ROUNDS interleaved renderings.
"""

from __future__ import annotations

import sys

from msbvh import _core
from msbvh.base.errors import Diagnostics
from msbvh.scene.reader import ReadSettings, read_frame
from msbvh.stage.opening import open_stage

ROUNDS = 5
SETTINGS = {"spp": 4, "max_bounces": 1, "threads": 1}
POLICIES = ("always", "auto", "never")
COLUMNS = (
    "frame", "never ms", "always: trees", "ms", "drift", "SAH ratio", "trace ratio",
    "auto: trees", "ms", "trace ratio",
)  # fmt: skip


def trees(accel: _core.AccelStatistics) -> str:
    return f"{accel['built']}+{accel['refitted']}+{accel['kept']}"


def main(scene: str, first: float, count: int, stride: float = 1.0) -> None:
    stage = open_stage(scene, Diagnostics())
    renderers: dict[str, _core.Renderer] = {}
    first_cost = 0.0
    print("| " + " | ".join(COLUMNS) + " |")
    print("|" + "---|" * len(COLUMNS))
    for i in range(count):
        frame = first + i * stride
        result = read_frame(stage, frame, ReadSettings(width=480), Diagnostics())
        size = {"width": result.camera.width, "height": result.camera.height}
        for policy in POLICIES:
            settings = {**SETTINGS, **size, "refit": policy, "keep_topology": policy != "never"}
            if policy in renderers:
                renderers[policy].commit(result.scene, **settings)
            else:
                renderers[policy] = _core.Renderer(result.scene, **settings)
        figures = {policy: renderers[policy].statistics["accel"] for policy in POLICIES}
        build = {policy: renderers[policy].statistics["build_seconds"] for policy in POLICIES}
        seconds: dict[str, list[float]] = {policy: [] for policy in POLICIES}
        for _ in range(ROUNDS):
            for policy in POLICIES:
                renderers[policy].render()
                seconds[policy].append(renderers[policy].statistics["trace_seconds"])
        cost = {policy: figures[policy]["sah_cost"] for policy in POLICIES}
        first_cost = first_cost or cost["always"]
        trace = {policy: min(seconds[policy]) / min(seconds["never"]) for policy in POLICIES}
        values = (
            f"{1e3 * build['never']:.1f}", trees(figures["always"]), f"{1e3 * build['always']:.1f}",
            f"{cost['always'] / first_cost:.2f}", f"{cost['always'] / cost['never']:.2f}",
            f"{trace['always']:.2f}", trees(figures["auto"]), f"{1e3 * build['auto']:.1f}", f"{trace['auto']:.2f}",
        )  # fmt: skip
        print(f"| {frame:g} | " + " | ".join(values) + " |", flush=True)


if __name__ == "__main__":
    main(sys.argv[1], float(sys.argv[2]), int(sys.argv[3]), *map(float, sys.argv[4:]))
