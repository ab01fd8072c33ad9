"""One run of a frame: `msbvh record` in a process of its own, so that its times and its peak of memory are its own."""

from __future__ import annotations

import json
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ..base.errors import SceneError
from ..bench.frame_sides import launched
from ..output.stats import PHASES
from .options import Options
from .store import PICTURE, Figures
from .tree_knobs import FRAMES

STATS = "stats.json"
KEPT_STATS = ("scene", "render", "subdivision", "width", "height", "shutter")


@dataclass(frozen=True)
class Shot:
    """What is rendered, whatever the settings."""

    scene: str
    frame: float | None
    arguments: tuple[str, ...]
    """Of `msbvh record` that all runs share: camera, size, mask ..."""
    threads: int
    """At least 1: processors that a run gets."""

    def command(self, options: Options, picture: str, more: Sequence[str] = ()) -> list[str]:
        """Of a run, as a user types it, from `record` on."""
        frames = int(options.get(FRAMES, 1))
        if frames > 1 and self.frame is not None:
            path = Path(picture)
            number = ".####" if float(self.frame).is_integer() else ".####.######"
            picture = str(path.with_name(f"{path.stem}{number}{path.suffix}"))
            time = ["--frames", f"{_code(self.frame)}:{_code(self.frame + frames - 1)}"]
        else:
            time = ["--defaultTime"] if self.frame is None else ["--frames", _code(self.frame)]
        return ["record", self.scene, picture, *time, *self.arguments, *options.without(FRAMES).arguments(), *more]


def _code(frame: float) -> str:
    """A time code with all its digits."""
    return f"{frame:.0f}" if float(frame).is_integer() else repr(float(frame))


def run(shot: Shot, options: Options, seed: int, folder: Path) -> Figures:
    """Renders; the picture of the first frame stays in the folder. Raises SceneError where that fails."""
    folder.mkdir(parents=True, exist_ok=True)
    for old in folder.iterdir():
        old.unlink()  # What an interrupted run left must not pass for this one's.
    more = [
        "--exr-float",
        "--stats",
        str(folder / STATS),
        "--ray-costs",
        "--seed",
        str(seed),
        "--threads",
        str(shot.threads),
    ]
    command = [sys.executable, "-m", "msbvh", *shot.command(options, str(folder / PICTURE), more)]
    took = launched(f"msbvh {options.text()}", command, shot.threads, folder)
    stats = json.loads((folder / STATS).read_text(encoding="utf-8"))
    _first_frame_alone(folder, Path(stats["frames"][0]["output"][0]))
    return _figures(stats["frames"], int(took["memory_bytes"]))


def _first_frame_alone(folder: Path, first: Path) -> None:
    """Of a sequence; and no statistics, of which figures keep what counts."""
    try:
        first.rename(folder / PICTURE)
    except OSError as error:
        raise SceneError(
            f"accuracy: '{first}': {error.strerror}; expected a picture that msbvh record has written"
        ) from None
    for left in folder.iterdir():
        if left.name != PICTURE:
            left.unlink()


def _figures(frames: Sequence[dict[str, Any]], peak_bytes: int) -> Figures:
    seconds = {phase: sum(frame["seconds"][phase] for frame in frames) for phase in PHASES}
    first = frames[0]
    return Figures(seconds, peak_bytes, {name: first[name] for name in KEPT_STATS}, tuple(first["tracks"]))
