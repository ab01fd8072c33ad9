"""The whole of `msbvh accuracy`: from a scene to the figures of its report."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from .. import _core
from ..base.errors import Diagnostics
from ..bench.rays import host
from ..render.budget import Goals
from ..scene.reader import ReadSettings
from ..stage.opening import open_stage
from ..stage.stage_metadata import start_time
from .all_knobs import ALL
from .facts import SceneFacts, scene_facts
from .findings import findings
from .front import guesses, promising
from .kinds import finest, kinds_in, motion_pixels
from .launch import Shot
from .measure import HALVES, REFERENCE_SEED, Measurement
from .motion_knobs import DENSE_TOLERANCE
from .options import Options
from .picture_errors import own_noise
from .pictures import write_pictures
from .points import Point, front_of
from .prims import prim_rows
from .shapes import ShapeErrors
from .store import Store, build, fingerprint
from .sweep import Axis, Partners, axes, named
from .targets import Target, aim
from .tree_knobs import FRAMES

REFERENCE_FACTOR = 16
"""Samples of the reference, as a multiple of the base's."""
LEAST_REFERENCE_SAMPLES = 256
MOST_SAMPLES = 1 << 20
"""Of one picture."""


@dataclass(frozen=True)
class AccuracySettings:
    """What is measured, and how often."""

    scene: str
    read: ReadSettings
    base: Options
    """Of `msbvh record`: what is held while one knob is turned."""
    shared: tuple[str, ...] = ()
    """Arguments of `msbvh record` that all points have: camera, mask ..."""
    frame: float | None = None
    default_time: bool = False
    mask: tuple[str, ...] = ()
    rounds: int = 3
    few: bool = False
    globs: Sequence[str] = ("*",)
    seed: int = 1
    threads: int = 0
    goals: Goals = Goals()
    command: str = ""
    """As the user typed it."""

    @property
    def seeds(self) -> Sequence[int]:
        return range(self.seed, self.seed + self.rounds)

    @property
    def processors(self) -> int:
        most = len(os.sched_getaffinity(0))
        return min(self.threads, most) or most

    @property
    def reference_samples(self) -> int:
        """Of both halves."""
        wanted = max(REFERENCE_FACTOR * int(self.base.get("spp", 16)), 32 if self.few else LEAST_REFERENCE_SAMPLES)
        return min(wanted, HALVES * MOST_SAMPLES)


def run_accuracy(
    settings: AccuracySettings,
    out: Path,
    progress: Callable[[float], object],
    tell: Callable[[Diagnostics], object],
) -> dict[str, Any]:
    """Measures and writes pictures; the report's data. `tell` gets what the reader has to say, before the first point. Raises
    SceneError for a scene that cannot be rendered."""
    load, diagnostics = os.getloadavg()[0], Diagnostics()
    stage = open_stage(settings.scene, diagnostics, settings.mask)
    time = settings.frame if settings.frame is not None or settings.default_time else start_time(stage)
    facts, result = scene_facts(stage, time, settings.read, int(settings.base.get("max-bounces", 2)), diagnostics)
    tell(diagnostics)
    camera = result.camera
    size = ("--resolution", str(camera.width), str(camera.height))
    by_options_alone = ("--renderSettingsPrimPath", "")
    shot = Shot(settings.scene, time, (*settings.shared, *size, *by_options_alone), settings.processors)
    identity = repr((fingerprint(stage), build(), shot))
    shapes = ShapeErrors(stage, time, settings.read, "shape" in kinds_in(facts))
    measurement = Measurement(shot, Store(out / "points", identity), settings.seeds, progress, shapes)
    report = _Report(settings, facts, measurement)
    report.measure()
    data = {
        "software": f"msbvh {_core.__version__}",
        "scene": settings.scene,
        "frame": time,
        "camera": camera.path or "framing camera",
        "resolution": [camera.width, camera.height],
        "shutter": [camera.shutter.open, camera.shutter.close],
        "threads": settings.processors,
        "command": settings.command,
        "machine": {**host(), "load_before": load, "load_after": os.getloadavg()[0], "noise": report.measurement.noise},
        "base": settings.base.plain(),
        **report.plain(shot),
        "prims": prim_rows(stage, facts, settings.read, measurement, settings.base),
        "warnings": [*(str(found) for found in diagnostics), *report.warnings()],
    }
    write_pictures(data, report.pictures(), out)
    data["findings"] = findings(data)
    return finite(data)


def finite(data: Any) -> Any:
    """The same with None for what is no number or infinite: JSON has neither."""
    if isinstance(data, dict):
        return {key: finite(value) for key, value in data.items()}
    if isinstance(data, (list, tuple)):
        return [finite(value) for value in data]
    return None if isinstance(data, float) and not math.isfinite(data) else data


class _Report:
    """What is measured of one scene, in this order: axes and named settings, the front, the targets."""

    def __init__(self, settings: AccuracySettings, facts: SceneFacts, measurement: Measurement) -> None:
        self._settings = settings
        self._facts = facts
        self.measurement = measurement
        self._axes = axes(ALL, facts, settings.base, settings.few, settings.globs)
        self._named = named(settings.base, facts)
        self._targets: list[Target] = []
        self._references: list[np.ndarray] = []

    def measure(self) -> None:
        base, measurement = self._settings.base, self.measurement
        partners = Partners(self._facts)
        of_axes = {axis.knob.option: partners.of_axis(axis) for axis in self._axes}
        names = [one.options for one in self._named]
        apart = measurement.all_partners(names, self._facts)
        swept = [step.options for axis in self._axes for step in axis.steps()]
        without = [one for found in (*of_axes.values(), *apart.values()) for one in found.values()]
        wanted = [base, *names, *swept, *without]
        # First, so that settings that are too fine for this machine are known before an hour of work.
        self._references = self._render_references()
        measurement.expect(wanted, 0.65)
        measurement.measure(wanted, base)
        measurement.judge(self._references)
        for axis in self._axes:
            measurement.set_apart(of_axes[axis.knob.option], axis.knob.error)
        for kind, found in apart.items():
            measurement.set_apart(found, kind)
        self._measure_front()
        self._targets = aim(self._settings.goals, base, self._axes, measurement, self._judge_anew)

    def _render_references(self) -> list[np.ndarray]:
        options = self._reference_options
        found = []
        for half in range(HALVES):
            seed = REFERENCE_SEED + self._settings.seed + half
            self.measurement.run(options, seed)
            self._tell_progress(0.05 * (half + 1))
            found.append(self.measurement.picture(options, seed))
        return found

    def _tell_progress(self, share: float) -> None:
        self.measurement.reach(share)

    @property
    def _reference_options(self) -> Options:
        samples = self._settings.reference_samples // HALVES
        return finest(self._facts, Options.of({"spp": samples}).over(self._settings.base))

    def _measure_front(self) -> None:
        measurement = self.measurement
        found = guesses(self._axes, self._settings.base, measurement.points)
        wanted = promising(found, list(measurement.points))
        measurement.expect(wanted, 0.25)
        measurement.measure(wanted)
        measurement.judge(self._references)

    def _judge_anew(self, options: Options) -> Point:
        """Of settings that a target has picked."""
        self.measurement.expect([options], 0.05)
        self.measurement.measure([options])
        self.measurement.judge(self._references)
        return self.measurement.points[options]

    def warnings(self) -> list[str]:
        """Of what stands for the stage's own motion, where that errs itself."""
        dense = [
            point.motion_px
            for options, point in self.measurement.points.items()
            if point.runs
            and options.get("motion-tolerance", 0.1) == DENSE_TOLERANCE
            and "segments" not in options.plain()
        ]
        if not dense or max(dense) <= 2.0 * DENSE_TOLERANCE:
            return []
        return [
            f"what stands for the stage's own motion is off by {max(dense):.2g} px itself: no track here has more segments"
        ]

    def _joint(self) -> dict[str, Point]:
        """Points that can be held against each other: of one frame, and of the same look."""
        looks = {step.options for axis in self._axes if axis.knob.error == "look" for step in axis.steps()}
        return {
            point.id: point
            for options, point in self.measurement.points.items()
            if options == self._settings.base or (options not in looks and FRAMES not in options.plain())
        }

    def plain(self, shot: Shot) -> dict[str, Any]:
        points, base = self.measurement.points, self._settings.base
        return {
            "reference": self._plain_reference(),
            "axes": [_plain_axis(axis) for axis in self._axes],
            "named": [{"name": one.name, "says": one.says, "id": Point(one.options).id} for one in self._named],
            "comparable": list(self._joint()),
            "front": front_of(self._joint()),
            "targets": [target.plain() for target in self._targets],
            "points": {point.id: point.plain(base, shot) for point in points.values()},
            "rendered": self.measurement.rendered,
            "taken_over": self.measurement.taken_over,
        }

    def _plain_reference(self) -> dict[str, Any]:
        options = self._reference_options
        runs = [self.measurement.run(options, REFERENCE_SEED + self._settings.seed + half) for half in range(HALVES)]
        return {
            "options": options.plain(),
            "samples": self._settings.reference_samples,
            "seconds": sum(sum(run.seconds.values()) for run in runs),
            "motion_px": motion_pixels(runs[0].tracks),
            "noise_share": self._reference_noise_share(),
        }

    def _reference_noise_share(self) -> float | None:
        """What the reference lacks itself, as a share of the base's error."""
        base = self.measurement.points[self._settings.base]
        if base.error is None or base.error.relative_mse <= 0.0:
            return None
        return own_noise(self._references) / base.error.relative_mse

    def pictures(self) -> dict[str, np.ndarray]:
        """The reference and all points that the report shows, the means of their seeds."""
        shown = {point.id for point in map(Point, [one.options for one in self._named])}
        shown |= set(front_of(self._joint())) | {target.id for target in self._targets if target.id}
        found = {"reference": np.mean(self._references, axis=0)}
        for options, point in self.measurement.points.items():
            if point.id in shown and point.runs:
                found[point.id] = self.measurement.pictures(options)[0]
        return found


def _plain_axis(axis: Axis) -> dict[str, Any]:
    knob = axis.knob
    return {
        "name": knob.name,
        "option": knob.option,
        "unit": knob.unit,
        "says": knob.says,
        "error": knob.error,
        "left_out": axis.left_out or None,
        "series": [
            {"name": name, "points": [{"value": step.value, "id": Point(step.options).id} for step in steps]}
            for name, steps in axis.series.items()
        ],
    }
