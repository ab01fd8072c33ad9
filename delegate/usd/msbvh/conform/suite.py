"""The conformance suite: scenes with one rule each, their expected coverage, and how a renderer compares.

A suite is a folder with rules.json (see testenv/motion/make_scenes.py). Every rule names a scene, a camera,
frames, a size, and an image of the coverage that usd-core's own evaluation has. The renderer is a command
line of usdrecord's kind, ours by default; whatever it does wrong is a row of the table, never its end.
"""

from __future__ import annotations

import contextlib
import fnmatch
import json
import os
import shlex
import shutil
import sys
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ..base import signals
from ..base.atomic import OutputError, check_folder, write_whole
from ..base.errors import SceneError
from ..base.processes import exit_code, last_line
from ..farm.frames import format_frame
from ..output.images import ImageReadError, read_alpha
from .record import Recorded

MANIFEST = "rules.json"
EVEN_ERROR = 0.004
"""Mean error that no number of samples takes away: a tenth of a pixel that tracks may stray, over blurs that
are some ten pixels long, and the expected images' own sampling (512 times, 16 places)."""
WORST_EVEN_ERROR = 0.06
"""The same for a single pixel, where the blur is as short as two pixels."""
MEAN_DEVIATIONS = 3.0
"""Standard deviations of the mean error over an image: one image in seven hundred goes beyond."""
WORST_DEVIATIONS = 5.0
"""Standard deviations of a pixel's noise: one in two million pixels goes beyond."""


@dataclass(frozen=True)
class Rule:
    """A line of the manifest."""

    name: str
    topic: str
    statement: str
    scene: Path
    expected: Path
    camera: str
    frames: tuple[float, ...]
    """Rendered in one run; the last one is compared."""
    width: int
    height: int
    slack: float
    """Added to the allowed error, where answers may differ for the reason in the manifest."""


@dataclass(frozen=True)
class Outcome:
    """How a renderer did on a rule."""

    rule: Rule
    passed: bool
    error: float | None
    """Mean absolute error of alpha over the pixels that either image covers; None: there is no image."""
    allowed: float
    """By noise: what the samples a pixel explain."""
    worst: float | None
    """The largest absolute error of a pixel."""
    worst_allowed: float
    reason: str
    """Why it failed; empty where it passed."""
    recorded: Recorded | None = None
    """The recorded run that our own renderer is held to as well."""

    @property
    def bound(self) -> float:
        """The smaller one of what noise and the record allow."""
        return min(self.allowed, self.recorded.allowed) if self.recorded else self.allowed

    def plain(self) -> dict[str, Any]:
        """For JSON."""
        return {
            "rule": self.rule.name,
            "topic": self.rule.topic,
            "statement": self.rule.statement,
            "passed": self.passed,
            "error": self.error,
            "allowed": self.allowed,
            "worst": self.worst,
            "worst_allowed": self.worst_allowed,
            "recorded": self.recorded.error if self.recorded else None,
            "recorded_allowed": self.recorded.allowed if self.recorded else None,
            "reason": self.reason,
        }


@dataclass(frozen=True)
class Renderer:
    """A command line, and how long it may take."""

    name: str
    arguments: tuple[str, ...]
    """May contain {scene} {out} {frame} {frames} {width} {height} {camera} {shutter}."""
    timeout_seconds: float = 120.0
    shutter: str = ""
    """OPEN:CLOSE in place of the cameras' own."""

    @property
    def knows_shutter(self) -> bool:
        """Whether its command takes that shutter, so that the scenes need not author it."""
        return any("{shutter}" in argument for argument in self.arguments)

    def command(self, rule: Rule, out: str) -> list[str]:
        """What is run for a rule."""
        values = {
            "scene": str(rule.scene),
            "out": out,
            "frame": f"{rule.frames[-1]:g}",
            "frames": ",".join(f"{frame:g}" for frame in rule.frames),
            "width": str(rule.width),
            "height": str(rule.height),
            "camera": rule.camera,
            "shutter": self.shutter,
        }
        return [_filled(argument, values) for argument in self.arguments]


USDRECORD_ARGUMENTS = (
    "--frames",
    "{frames}",
    "--imageWidth",
    "{width}",
    "--camera",
    "{camera}",
    "{scene}",
    "{out}",
)
"""What follows a command line that names no scene itself."""


def own_renderer(spp: int, shutter: str = "") -> Renderer:
    """msbvh in a process of its own, so that a crash is a row of the table."""
    command = (sys.executable, "-m", "msbvh", "record", "--spp", str(spp), "--max-bounces", "0")
    more = ("--shutter={shutter}",) if shutter else ()
    return Renderer("msbvh", (*command, *more, *USDRECORD_ARGUMENTS), shutter=shutter)


def other_renderer(command_line: str, timeout_seconds: float) -> Renderer:
    """One given as a command line. Raises SceneError where it is empty or its quotes do not match."""
    try:
        arguments = tuple(shlex.split(command_line))
    except ValueError as error:
        raise SceneError(f"--command: found {command_line!r}, expected a command line: {error}") from None
    if not arguments:
        raise SceneError("--command: found nothing, expected a command line such as 'usdrecord --renderer X'")
    if not any("{scene}" in argument for argument in arguments):
        arguments += USDRECORD_ARGUMENTS
    return Renderer(command_line, arguments, timeout_seconds)


def _filled(argument: str, values: dict[str, str]) -> str:
    """Puts the values where their names stand; any other braces stay as they are."""
    for name, value in values.items():
        argument = argument.replace("{" + name + "}", value)
    return argument


def find_suite(folder: Path | None) -> Path:
    """The suite's folder: the one named, else testenv/motion of the checkout or of the current folder.

    Raises SceneError where there is none.
    """
    checkout = Path(__file__).resolve().parents[4]
    candidates = [folder] if folder else [root / "testenv" / "motion" for root in (checkout, Path.cwd())]
    for candidate in candidates:
        if (candidate / MANIFEST).is_file():
            return candidate
    searched = " or ".join(str(candidate / MANIFEST) for candidate in candidates)
    raise SceneError(f"conformance suite: found no {searched}; expected a folder with {MANIFEST}, give --suite DIR")


def read_rules(suite: Path, pattern: str = "*") -> list[Rule]:
    """The rules whose names match, in the manifest's order.

    Raises SceneError for a broken manifest, and where none matches.
    """
    manifest = suite / MANIFEST
    try:
        entries = json.loads(manifest.read_text(encoding="utf-8"))["rules"]
        rules = [_rule(suite, entry) for entry in entries]
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise SceneError(f"{manifest}: found {type(error).__name__}: {error}, expected a list of rules") from None
    chosen = [rule for rule in rules if any(fnmatch.fnmatchcase(rule.name, p) for p in pattern.split(","))]
    if not chosen:
        raise SceneError(f"--rules: found '{pattern}', which none of the {len(rules)} rules matches")
    return chosen


def _rule(suite: Path, entry: dict[str, Any]) -> Rule:
    return Rule(
        name=entry["rule"],
        topic=entry["topic"],
        statement=entry["statement"],
        scene=suite / entry["scene"],
        expected=suite / entry["expected"],
        camera=entry["camera"],
        frames=tuple(entry["frames"]),
        width=entry["width"],
        height=entry["height"],
        slack=entry.get("slack", 0.0),
    )


def conform(
    rules: Sequence[Rule],
    renderer: Renderer,
    spp: int,
    out: Path | None = None,
    progress: Callable[[float], None] = lambda _: None,
    record: Mapping[str, Recorded] | None = None,
    prepare: Callable[[Rule, Path], Rule] = lambda rule, _: rule,
) -> Iterator[Outcome]:
    """Runs the renderer on every rule. `spp`: samples a pixel that the allowed error is for. `out`: where its
    images stay. `record`: of our own renderer, see read_record(). `prepare`: makes of a rule the one that the renderer
    is held to, with a folder at hand."""
    if out is not None:
        for rule in rules:
            check_folder(out / rule.name)
    with _scratch() as scratch:
        for done, rule in enumerate(rules):
            folder = (out or scratch) / rule.name
            folder.mkdir(parents=True, exist_ok=True)
            progress(done / len(rules))
            rule = prepare(rule, folder)
            expected = read_expected(rule)
            try:
                found = _rendered(rule, renderer, folder, expected.shape)
            except _Failure as failure:
                allowed, worst_allowed = allowed_errors(expected, spp, rule.slack)
                yield Outcome(rule, False, None, allowed, None, worst_allowed, str(failure))
            else:
                yield judged(rule, found, expected, spp, (record or {}).get(rule.name))
        progress(1.0)


@contextlib.contextmanager
def _scratch() -> Iterator[Path]:
    """A folder that lasts as long as the run. Raises OutputError where none can be made."""

    def make() -> Path:
        try:
            return Path(tempfile.mkdtemp(prefix="msbvh_conform_"))
        except OSError as error:
            raise OutputError(f"cannot make a temporary folder: {error.strerror}") from None

    with signals.undone(make, lambda folder: shutil.rmtree(folder, ignore_errors=True)) as folder:
        yield folder


def judged(rule: Rule, found: np.ndarray, expected: np.ndarray, spp: int, recorded: Recorded | None = None) -> Outcome:
    """How the coverage that was found does beside the expected one, float[H, W] both."""
    allowed, worst_allowed = allowed_errors(expected, spp, rule.slack)
    error, worst = errors(found, expected)
    reason = ""
    if not error <= allowed:
        reason = f"mean alpha error {error:.4f}, allowed {allowed:.4f}"
    elif not worst <= worst_allowed:
        reason = f"a pixel is out by {worst:.3f}, allowed {worst_allowed:.3f}"
    elif recorded and not error <= recorded.allowed:
        reason = (
            f"mean alpha error {error:.5f}, recorded {recorded.error:.5f}, allowed {recorded.allowed:.5f};"
            " testenv/motion/make_recorded.py records errors that are meant"
        )
    return Outcome(rule, not reason, error, allowed, worst, worst_allowed, reason, recorded)


def read_expected(rule: Rule) -> np.ndarray:
    """The rule's answer: coverage, float[H, W]. Raises SceneError where it cannot be read."""
    try:
        return read_alpha(rule.expected)
    except ImageReadError as error:
        raise SceneError(f"conformance suite: {error}") from None


def errors(found: np.ndarray, expected: np.ndarray) -> tuple[float, float]:
    """Mean and largest absolute error of coverage float[H, W]; the mean is over what either covers, so that
    an empty background dilutes nothing."""
    difference = np.abs(found - expected)
    covered = (found > 0) | (expected > 0)
    return float(difference[covered].mean()) if covered.any() else 0.0, float(difference.max())


def allowed_errors(expected: np.ndarray, spp: int, slack: float = 0.0) -> tuple[float, float]:
    """Mean and largest error that `spp` independent samples a pixel explain.

    A pixel of coverage c has a standard deviation s of sqrt(c (1 - c) / spp). The absolute value of a normal
    error has a mean of sqrt(2 / pi) s and a deviation of sqrt(1 - 2 / pi) s. Renderers that stratify stay far
    below.
    """
    deviation = np.sqrt(expected * (1 - expected) / spp)[expected > 0]
    count = max(len(deviation), 1)
    mean = np.sqrt(2 / np.pi) * deviation.sum() / count
    of_mean = np.sqrt(1 - 2 / np.pi) * np.linalg.norm(deviation) / count
    worst = WORST_DEVIATIONS * 0.5 / np.sqrt(spp)
    return float(mean + MEAN_DEVIATIONS * of_mean + EVEN_ERROR + slack), worst + WORST_EVEN_ERROR + 10 * slack


class _Failure(Exception):
    """The renderer made no image to compare; str() says why."""


def image_of(rule: Rule, folder: Path) -> tuple[str, Path]:
    """The output that a renderer is given, with a placeholder for the frame, and the image that is judged."""
    placeholder = "####" if all(frame == int(frame) for frame in rule.frames) else "####.###"
    out = str(folder / f"image.{placeholder}.exr")
    return out, Path(format_frame(out, placeholder, rule.frames[-1]))


def _rendered(rule: Rule, renderer: Renderer, folder: Path, shape: tuple[int, ...]) -> np.ndarray:
    """The alpha that the renderer writes for a rule: float[H, W]."""
    out, image = image_of(rule, folder)
    image.unlink(missing_ok=True)
    _run(renderer.command(rule, out), folder, renderer.timeout_seconds)
    if not image.exists():
        raise _Failure(f"wrote no {image.name}")
    try:
        alpha = read_alpha(image)
    except ImageReadError as error:
        raise _Failure(str(error)) from None
    if alpha.shape != shape:
        found, wanted = ("x".join(map(str, size[::-1])) for size in (alpha.shape, shape))
        raise _Failure(f"image is {found} pixels, expected {wanted}")
    if not np.isfinite(alpha).all():
        raise _Failure("alpha is not finite everywhere")
    return alpha


def _run(command: Sequence[str], folder: Path, timeout_seconds: float) -> None:
    """Runs a renderer; what it says goes to renderer.log beside its image."""
    with os.fdopen(os.memfd_create("msbvh"), "r+b") as log:  # A full disk is no fault of the renderer's.
        try:
            code = exit_code(command, log, timeout_seconds)
        except OSError as error:
            raise _Failure(f"cannot be run: {command[0]}: {error.strerror}") from None
        log.seek(0)
        said = log.read()
    write_whole(folder / "renderer.log", said)
    if code is None:
        raise _Failure(f"ran for more than {timeout_seconds:g} s")
    if code:
        how = f"exit code {code}" if code > 0 else f"killed by signal {-code}"
        raise _Failure(f"{how}: {last_line(said)}")


def table(outcomes: Sequence[Outcome]) -> str:
    """An aligned table, one line a rule, and a line that sums up."""
    names = max([len(outcome.rule.name) for outcome in outcomes] + [4])
    lines = [f"{'rule':{names}}  result  error   allowed  statement"]
    for outcome in outcomes:
        error = "-" if outcome.error is None else f"{outcome.error:.4f}"
        result = "pass" if outcome.passed else "FAIL"
        why = "" if outcome.passed else f" ({outcome.reason})"
        lines.append(
            f"{outcome.rule.name:{names}}  {result:6}  {error:6}  {outcome.bound:.4f}   {outcome.rule.statement}{why}"
        )
    passed = sum(outcome.passed for outcome in outcomes)
    lines.append(f"{passed} of {len(outcomes)} rules pass")
    return "\n".join(lines)
