"""The plot of docs/performance.md: ratios to the peer and bytes, by scene."""

from __future__ import annotations

from pathlib import Path

from performance_rows import KINDS, Row, group, one


def plot(ours: list[Row], path: Path) -> bool:
    """False where matplotlib is not installed."""
    try:
        import matplotlib
    except ImportError:
        return False
    matplotlib.use("Agg")
    from matplotlib import pyplot

    groups = group(row for row in ours if row["threads"] == ours[0]["threads"])
    names = [f"{scene}, {keys} keys" for scene, _, keys, _ in groups]
    places = range(len(names))
    size = (11, 1.5 + 0.36 * len(names))
    figure_, (left, right) = pyplot.subplots(1, 2, figsize=size, sharey=True, layout="constrained")
    for i, kind in enumerate(KINDS):
        values = [found[kind]["ratio"] or 0.0 if kind in found else 0.0 for found in groups.values()]
        left.barh([place + 0.27 * (i - 1) for place in places], values, 0.25, label=f"{kind} rays")
    left.axvline(1.0, color="black", linewidth=0.8)
    left.set_yticks(list(places), names)
    left.invert_yaxis()
    left.set_xlabel("rays a second, ours, many at once / peer, best mode (robust)")
    left.legend()
    bytes_ = [one(found) for found in groups.values()]
    right.barh([p - 0.2 for p in places], [row["bytes_per_tri"] for row in bytes_], 0.38, label="ours")
    right.barh([p + 0.2 for p in places], [row["peer_bytes_per_tri"] or 0 for row in bytes_], 0.38, label="peer")
    right.set_xscale("log")
    right.set_xlabel("bytes a triangle")
    right.legend()
    figure_.savefig(path, dpi=80)
    return True
