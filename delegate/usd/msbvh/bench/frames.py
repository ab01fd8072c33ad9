"""Whole frames, measured: each renderer renders the same five scenes in turn, in processes of their own.

A round renders a scene once by every side, in an order that turns from round to round; a side's seed differs in each.
Errors are those beside a converged picture of the same renderer, made of two halves that share no noise: what it lacks
itself is known, and taken away. Sides whose converged pictures differ have not rendered the same scene: their times are
not compared.
"""

from __future__ import annotations

import fnmatch
import os
import shutil
import tempfile
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from statistics import median
from typing import Any

from ..base import signals
from ..base.atomic import check_folder
from ..base.errors import SceneError
from .cycles_peer import find_cycles
from .frame_looks import DISPLAY_COLOR
from .frame_noise import Likeness, Noise, Picture, likeness, noise
from .frame_scenes import SCENES, FrameScene
from .frame_sides import PHASES, Job, Run, Side, old_build, rendered, this_build
from .rays import host

Row = dict[str, Any]
Figures = Sequence[float]

REFERENCE_SEED = 1_000_000
"""Converged pictures begin here; measured ones take seeds from 1 on."""
HALVES = 2


@dataclass(frozen=True)
class FrameSettings:
    """What is measured, and how often."""

    scenes: Sequence[str] = ("*",)
    """Globs of names."""
    peer: str | None = None
    peer_folder: Path | None = None
    """Of the peer's environment; None: in the user's cache."""
    old: str | None = None
    """The command of another msbvh."""
    quick: bool = False
    """Small scenes and pictures, for tests: the figures say nothing."""
    threads: Sequence[int] | None = None
    """0: all. None: 1 and all, or for a quick run 1."""
    seed: int = 1
    repetitions: int | None = None
    """None: 3, or for a quick run 2."""
    resolution: tuple[int, int] | None = None
    """None: 480 x 320, or for a quick run 96 x 64."""
    spp: int | None = None
    """None: 128, or for a quick run 16."""
    reference_spp: int | None = None
    """Of converged pictures; 0: none are made. None: 2048, or for a quick run 256."""
    max_bounces: int = 2
    looks: Sequence[str] = (DISPLAY_COLOR,)
    """Of LOOKS: each scene with each of them."""

    @property
    def size(self) -> tuple[int, int]:
        return self.resolution or ((96, 64) if self.quick else (480, 320))

    @property
    def samples(self) -> int:
        return self.spp or (16 if self.quick else 128)

    @property
    def reference_samples(self) -> int:
        """Of both halves together."""
        if self.reference_spp is not None:
            return self.reference_spp
        return 256 if self.quick else 2048

    @property
    def rounds(self) -> int:
        return self.repetitions or (2 if self.quick else 3)

    @property
    def thread_counts(self) -> Sequence[int]:
        """Without repetitions, each at least 1."""
        all_of_them = len(os.sched_getaffinity(0))
        asked = self.threads if self.threads is not None else ((1,) if self.quick else (1, 0))
        return tuple(dict.fromkeys(min(count, all_of_them) or all_of_them for count in asked))

    @property
    def chosen(self) -> Sequence[FrameScene]:
        """Raises SceneError where there is none."""
        found = [s for s in SCENES.values() if any(fnmatch.fnmatchcase(s.name, pattern) for pattern in self.scenes)]
        if not found:
            raise SceneError(
                f"--scenes {','.join(self.scenes)}: matches nothing; expected globs of {', '.join(SCENES)}"
            )
        return [scene.dressed(look) for look in self.looks for scene in found]


def run(
    settings: FrameSettings,
    out: Path | None,
    progress: Callable[[float], object],
    note: Callable[[str], None],
) -> dict[str, Any]:
    """Measures; {"machine": ..., "rows": [...]}. Scenes and last pictures stay in `out`, if given."""
    begin, load = time.monotonic(), os.getloadavg()[0]
    chosen = settings.chosen
    sides = _sides(settings, note)
    with _folder(out) as folder:
        bench = _Bench(settings, sides, folder, progress, len(chosen))
        rows = [row for scene in chosen for row in bench.rows(scene)]
    progress(1.0)
    about = {
        **host(),
        **_about(settings, bench.software),
        "load_average": load,
        "seconds": time.monotonic() - begin,
    }
    return {"machine": about, "rows": rows}


def _about(settings: FrameSettings, software: Mapping[str, str]) -> dict[str, Any]:
    return {
        "sides": dict(software),
        "scenes": list(settings.scenes),
        "threads": list(settings.thread_counts),
        "resolution": list(settings.size),
        "spp": settings.samples,
        "reference_spp": settings.reference_samples,
        "max_bounces": settings.max_bounces,
        "seed": settings.seed,
        "repetitions": settings.rounds,
        "quick": settings.quick,
        "looks": list(settings.looks),
    }


def _sides(settings: FrameSettings, note: Callable[[str], None]) -> Sequence[Side]:
    """Ours is the first."""
    sides: list[Side] = [this_build()]
    if settings.old is not None:
        sides.append(old_build(settings.old))
    if settings.peer is not None:
        sides.append(find_cycles(settings.peer_folder, note))
    return sides


@contextmanager
def _folder(out: Path | None) -> Iterator[Path]:
    """Where scenes and pictures go: one that stays, or one that lasts as long as the run."""
    if out is not None:
        check_folder(out / "frames")
        yield out / "frames"
        return

    def make() -> Path:
        return Path(tempfile.mkdtemp(prefix="msbvh_bench_"))

    with signals.undone(make, lambda folder: shutil.rmtree(folder, ignore_errors=True)) as folder:
        yield folder


class _Bench:
    """A run: its sides, and how far it is."""

    def __init__(
        self,
        settings: FrameSettings,
        sides: Sequence[Side],
        folder: Path,
        progress: Callable[[float], object],
        scenes: int,
    ) -> None:
        self._settings = settings
        self._sides = sides
        self._folder = folder
        self._progress = progress
        self.software: dict[str, str] = {}
        """Name and version of each side that has rendered."""
        # In samples that one thread takes: what a run lasts.
        rounds = settings.rounds * sum(1 / threads for threads in settings.thread_counts)
        references = settings.reference_samples / max(settings.thread_counts)
        self._all = scenes * len(sides) * (settings.samples * rounds + references)
        self._done = 0.0

    def rows(self, scene: FrameScene) -> Iterator[Row]:
        """One for each number of threads and side."""
        file = (self._folder / f"{scene.title}.usdc").absolute()
        file.unlink(missing_ok=True)
        scene.write(file, 0.12 if self._settings.quick else 1.0)
        measured = {threads: self._rounds(scene, file, threads) for threads in self._settings.thread_counts}
        converged = self._converged(scene, file)
        pictures = converged or self._pictures(measured)
        ours = self._sides[0].name
        alike = (
            {side.name: likeness(pictures[ours], pictures[side.name]) for side in self._sides[1:]} if pictures else {}
        )
        for threads, runs in measured.items():
            noises = {name: [noise(run.pixels, converged[name]) for run in runs[name]] for name in converged}
            for side in self._sides:
                yield {
                    "scene": scene.name,
                    "look": scene.look,
                    "says": scene.says,
                    "threads": threads,
                    "side": side.name,
                    **_cost(runs[side.name]),
                    **_errors(runs[side.name], noises.get(side.name)),
                    **_ratios(side.name, ours, runs, noises, alike.get(side.name)),
                }

    def _rounds(self, scene: FrameScene, file: Path, threads: int) -> Mapping[str, list[Run]]:
        """The runs of each side: a round has one turn of each."""
        runs: dict[str, list[Run]] = {side.name: [] for side in self._sides}
        for turn in range(self._settings.rounds):
            first = turn % len(self._sides)
            for side in [*self._sides[first:], *self._sides[:first]]:
                runs[side.name].append(
                    self._run(side, scene, file, threads, self._settings.samples, self._settings.seed + turn)
                )
        return runs

    def _converged(self, scene: FrameScene, file: Path) -> Mapping[str, Picture]:
        """Of each side, on all threads that are measured; empty where none are made."""
        spp, threads = self._settings.reference_samples // HALVES, max(self._settings.thread_counts)
        if not spp:
            return {}
        seeds = [REFERENCE_SEED + self._settings.seed + half for half in range(HALVES)]
        return {
            side.name: Picture.of([self._run(side, scene, file, threads, spp, seed).pixels for seed in seeds])
            for side in self._sides
        }

    def _pictures(self, measured: Mapping[int, Mapping[str, list[Run]]]) -> Mapping[str, Picture]:
        """For comparison where there are no converged ones: all rounds of one number of threads."""
        runs = next(iter(measured.values()))
        if self._settings.rounds < HALVES:
            return {}
        return {name: Picture.of([run.pixels for run in found]) for name, found in runs.items()}

    def _run(self, side: Side, scene: FrameScene, file: Path, threads: int, spp: int, seed: int) -> Run:
        width, height = self._settings.size
        job = Job(scene, file, width, height, self._settings.max_bounces, spp, seed, threads)
        run = rendered(side, job, (self._folder / scene.title / side.name).absolute())
        self.software[side.name] = run.software
        self._done += spp / threads
        self._progress(min(self._done / self._all, 1.0))
        return run


def _cost(runs: Sequence[Run]) -> Row:
    """Seconds and bytes of a side."""
    row: Row = {}
    for phase in PHASES:
        row |= _spread(f"{phase}_s", [run.seconds[phase] for run in runs])
    row |= _spread("frame_s", [run.frame for run in runs])
    row |= _spread("process_s", [run.process for run in runs])
    row |= _spread("start_s", [run.start for run in runs])
    row |= _spread("cpu_s", [run.cpu for run in runs])
    row["memory_bytes"] = max(run.memory_bytes for run in runs)
    return row


def _errors(runs: Sequence[Run], noises: Sequence[Noise] | None) -> Row:
    """Noise of a side, and what it costs; null without converged pictures."""
    if noises is None:
        return {"relative_mse": None, "reference_share": None, "trace_mse": None, "process_mse": None}
    errors = [found.relative_mse for found in noises]
    return {
        **_spread("relative_mse", errors),
        "reference_share": max(found.reference_share for found in noises),
        **_spread("trace_mse", [run.seconds["trace"] * error for run, error in zip(runs, errors, strict=True)]),
        **_spread("process_mse", [run.process * error for run, error in zip(runs, errors, strict=True)]),
    }


def _ratios(
    name: str,
    ours: str,
    runs: Mapping[str, Sequence[Run]],
    noises: Mapping[str, Sequence[Noise]],
    alike: Likeness | None,
) -> Row:
    """A side's figures over ours, round by round; null for ours, and where the pictures differ."""
    row: Row = {"mean_difference": None, "shape_difference": None, "comparable": None}
    if alike:
        row = {"mean_difference": alike.mean, "shape_difference": alike.shape, "comparable": alike.comparable}
    comparable = name != ours and (alike is None or alike.comparable)
    costs: Mapping[str, Callable[[Run], float]] = {
        "trace": lambda run: run.seconds["trace"],
        "frame": lambda run: run.frame,
        "process": lambda run: run.process,
        "cpu": lambda run: run.cpu,
    }
    for cost, of in costs.items():
        times = {side: [of(run) for run in runs[side]] for side in (name, ours)}
        row |= _over(f"{cost}_ratio", times[name], times[ours], comparable)
        if cost in ("frame", "cpu"):
            continue
        products = {
            side: [at * found.relative_mse for at, found in zip(times[side], noises[side], strict=True)]
            for side in (name, ours)
            if noises
        }
        row |= _over(f"{cost}_mse_ratio", products.get(name), products.get(ours), comparable)
    return row


def _over(key: str, theirs: Figures | None, ours: Figures | None, comparable: bool) -> Row:
    """Ratios of rounds; null where one has no meaning."""
    if not comparable or not theirs or not ours or min(*theirs, *ours) <= 0.0:
        return {key: None, f"{key}_low": None, f"{key}_high": None}
    return _spread(key, [their / our for their, our in zip(theirs, ours, strict=True)])


def _spread(key: str, found: Figures) -> Row:
    return {key: median(found), f"{key}_low": min(found), f"{key}_high": max(found)}
