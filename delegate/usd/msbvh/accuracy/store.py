"""What has been measured so far, on disk: an interrupted run goes on where it was.

A run of a frame is a picture and its figures, found by a key of all that they depend on: the scene's files, this build, the
options, the seed. Figures are written last, so that a run without them never happened.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from pxr import Sdf, Usd, UsdUtils

from .. import _core
from ..base.atomic import check_folder, write_whole
from ..base.errors import Diagnostics
from ..bench.rays import host
from ..output.images import ImageReadError, read_colour
from ..stage.opening import tf_messages
from .options import Options

PICTURE = "picture.exr"
FIGURES = "figures.json"
LARGE = 1 << 26
"""Bytes of a file that is not read for its fingerprint."""


def fingerprint(stage: Usd.Stage) -> str:
    """Of all layers that a stage is made of, and of the files that they name, textures say: by content, large ones by size and
    time of change."""
    with tf_messages(Diagnostics()):  # What cannot be found has been said when the stage was opened.
        _, assets, _ = UsdUtils.ComputeAllDependencies(Sdf.AssetPath(stage.GetRootLayer().identifier))
    layers = sorted(map(_told, stage.GetUsedLayers()))  # By text: names of anonymous ones change from run to run.
    told = [*layers, *(_file(str(asset)) for asset in sorted(map(str, assets)))]
    return hashlib.sha256("".join(told).encode()).hexdigest()


def build() -> tuple[object, ...]:
    """What else figures depend on: this machine and the very library."""
    about = host()
    library = hashlib.sha256(Path(_core.__file__).read_bytes()).hexdigest()
    return about["processor"], about["cores"], about["instruction_set"], about["commit"], library


def _told(layer: Sdf.Layer) -> str:
    if told := _file(layer.realPath):
        return told
    return f"{layer.ExportToString()}\n"  # Anonymous: its identifier is another one in each process.


def _file(path: str) -> str:
    """Empty: there is no such file."""
    with contextlib.suppress(OSError):
        if path:
            seen = Path(path).stat()
            if seen.st_size > LARGE:
                return f"{path} {seen.st_size} {seen.st_mtime_ns}\n"
            return f"{path} {hashlib.sha256(Path(path).read_bytes()).hexdigest()}\n"
    return ""


@dataclass(frozen=True)
class Figures:
    """What a run of a frame took."""

    seconds: Mapping[str, float]
    """Of each phase of output/stats.py; over all frames of a sequence."""
    peak_bytes: int
    stats: Mapping[str, Any]
    """Of the first frame, as --stats has it, without the prims' tracks."""
    tracks: tuple[Mapping[str, Any], ...] = ()


class Store:
    """The runs under a folder."""

    def __init__(self, folder: Path, identity: str) -> None:
        """`identity`: all that keys depend on beside options and seeds. Raises OutputError where the folder cannot be made."""
        self._folder = folder
        self._identity = identity
        check_folder(folder)
        self._kept: dict[tuple[Options, int], Figures] = {}

    def folder(self, options: Options, seed: int) -> Path:
        """Of a run; there may be nothing in it yet."""
        text = json.dumps([self._identity, options.pairs, seed])
        return self._folder / hashlib.sha256(text.encode()).hexdigest()[:24]

    def figures(self, options: Options, seed: int) -> Figures | None:
        """Of a run that is complete."""
        if (options, seed) not in self._kept:
            found = self._read(options, seed)
            if found is None:
                return None
            self._kept[options, seed] = found
        return self._kept[options, seed]

    def _read(self, options: Options, seed: int) -> Figures | None:
        folder = self.folder(options, seed)
        try:
            plain = json.loads((folder / FIGURES).read_text(encoding="utf-8"))
            read_colour(folder / PICTURE)
            return Figures(plain["seconds"], plain["peak_bytes"], plain["stats"], tuple(plain["tracks"]))
        except (OSError, ValueError, KeyError, TypeError, ImageReadError):
            return None

    def picture(self, options: Options, seed: int) -> np.ndarray:
        """float64[height, width, 3] of a run that is complete."""
        return read_colour(self.folder(options, seed) / PICTURE)

    def put(self, options: Options, seed: int, figures: Figures) -> None:
        """Makes a run complete, whose picture lies in its folder already."""
        text = json.dumps(vars(figures), allow_nan=False)
        write_whole(self.folder(options, seed) / FIGURES, text.encode())
        self._kept[options, seed] = figures
