"""What the figures say, in sentences: what to use for this shot, and what to leave alone."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

UNSEEN = 0.001
"""FLIP that nobody sees."""
NOTICEABLE = 1.05
"""A ratio of times below it, or below the machine's own noise, is no difference."""


def findings(data: dict[str, Any]) -> list[str]:
    """Of a report's data; each sentence by itself."""
    return [*_largest_error(data), *_habits(data), *_knobs(data), *_targets(data), *_machine(data)]


def _points(data: dict[str, Any], series: dict[str, Any]) -> list[tuple[str, dict[str, Any]]]:
    found = [(step["value"], data["points"][step["id"]]) for step in series["points"]]
    return [(value, point) for value, point in found if not point["failed"]]


def _largest_error(data: dict[str, Any]) -> Iterator[str]:
    ours = data["points"][data["named"][0]["id"]]
    if ours["failed"]:
        return
    errors = {"noise": ours["noise_relative_mse"]}
    errors |= {kind: found["relative_mse"] for kind, found in ours["kinds"].items()}
    total = sum(max(error, 0.0) for error in errors.values())
    if total <= 0.0:
        yield "With the base settings no error can be seen."
        return
    worst = max(errors, key=lambda kind: errors[kind])
    share = errors[worst] / total
    words = {"noise": "noise", "motion": "the motion model", "shape": "shape", "light": "paths that end too early"}
    yield (
        f"With the base settings {share:.0%} of the picture's error is {words[worst]}: "
        + ("more samples pay first." if worst == "noise" else "more samples come second.")
    )


def _habits(data: dict[str, Any]) -> Iterator[str]:
    first, *others = data["named"]
    ours = data["points"][first["id"]]
    for other in others:
        point = data["points"][other["id"]]
        if ours["failed"] or point["failed"]:
            continue
        ratio = point["seconds"]["frame"][0] / ours["seconds"]["frame"][0]
        time = "as long" if _alike(ratio, data) else f"{ratio:.2f} times as long"
        yield (
            f"{other['name']}: motion is off by up to {_pixels(point['motion_px'])}, where ours keeps"
            f" {_pixels(ours['motion_px'])}; the frame takes {time}."
        )


def _pixels(error: float) -> str:
    return f"{error:.2g} px" if error < 100.0 else f"{error:.0f} px"


def _alike(ratio: float, data: dict[str, Any]) -> bool:
    limit = max(NOTICEABLE, data["machine"]["noise"])
    return 1.0 / limit <= ratio <= limit


def _knobs(data: dict[str, Any]) -> Iterator[str]:
    for axis in data["axes"]:
        for series in axis["series"]:
            found = _points(data, series)
            if len(found) > 1:
                yield from _knob(data, axis, series, found)


def _knob(
    data: dict[str, Any], axis: dict[str, Any], series: dict[str, Any], found: list[tuple[str, dict[str, Any]]]
) -> Iterator[str]:
    name = axis["name"] + (f" ({series['name']})" if series["name"] else "")
    times = [point["seconds"]["frame"][0] for _, point in found]
    ratio = max(times) / min(times)
    if axis["error"] in ("none", "look"):
        same = "; the picture is the same" if axis["error"] == "none" else ""
        if _alike(ratio, data):
            yield f"{name} makes no difference here that the clock can tell."
        else:
            cheapest = found[times.index(min(times))][0]
            dearest = found[times.index(max(times))][0]
            yield f"{name}: {cheapest} is the fastest, {dearest} takes {ratio:.2f} times as long{same}."
        return
    if axis["error"] in ("motion", "shape", "light"):
        yield from _seen(data, axis, name, found, times)


def _seen(
    data: dict[str, Any], axis: dict[str, Any], name: str, found: list[tuple[str, dict[str, Any]]], times: list[float]
) -> Iterator[str]:
    """Where a knob's positions, from coarse to fine, stop changing what the picture looks like."""
    errors = [point["kinds"].get(axis["error"], {}).get("flip") for _, point in found]
    if None in errors:
        return
    if max(errors) < UNSEEN:
        fastest = found[times.index(min(times))][0]
        yield f"{name}: no position changes what the picture looks like (FLIP below {UNSEEN:g}); {fastest} is the fastest."
        return
    enough = next((place for place, _ in enumerate(errors) if max(errors[place:]) < UNSEEN), None)
    if enough is None or enough + 1 == len(found):
        return
    ratio = max(times[enough + 1 :]) / times[enough]
    if ratio > 1.0 and not _alike(ratio, data):
        yield f"{name}: {found[enough][0]} is enough (FLIP below {UNSEEN:g}); finer ones take up to {ratio:.2f} times as long."


def _targets(data: dict[str, Any]) -> Iterator[str]:
    for target in data["targets"]:
        if target["holds"]:
            yield f"{target['asked']}: {target['says']}; measured {target['found']:.3g} {target['unit']}."
        else:
            found = "" if target["found"] is None else f" ({target['found']:.3g} {target['unit']})"
            yield f"{target['asked']} cannot be kept{found}: {target['says']}."


def _machine(data: dict[str, Any]) -> Iterator[str]:
    noise = data["machine"]["noise"]
    if noise > 1.2:
        yield (
            f"The machine was noisy: the same frame's time changed by a factor of {noise:.2f}. Differences smaller than that"
            " mean nothing."
        )
