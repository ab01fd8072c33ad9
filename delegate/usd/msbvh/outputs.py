"""Where a run writes, and what it must not overwrite: the scene, each file that is read for it, and its other outputs.

A file is compared by its place behind symbolic links; with what is read, also by its inode (hard links).
"""

from __future__ import annotations

import contextlib
import os
import re
from collections.abc import Iterator, Sequence
from pathlib import Path

from pxr import Ar, Sdf, Usd, UsdUtils

from .atomic import Folders, OutputError, check_writable
from .images import check_image_path

Identity = tuple[int, int]
"""Device and inode."""

_NUMBER = re.compile(r"<UDIM>|(\\\#)+")
"""In the escaped name of a texture's tiles, or of value clips by template."""


class OutputClash(OutputError):
    """An output would overwrite what must stay; exit code 2."""


class Outputs:
    """Files of a run by their real places."""

    def __init__(self, images: Sequence[str], stats: Path | None) -> None:
        """Raises OutputError for a file that cannot be written, OutputClash for two names of one file."""
        self._places: dict[Path, str] = {}
        folders = Folders()
        for image in images:
            self._add(image, check_image_path(Path(image), folders))
        if stats is not None:
            self._add(str(stats), check_writable(stats, folders))

    def _add(self, name: str, place: Path) -> None:
        if place in self._places:
            raise OutputClash(
                f"outputs '{self._places[place]}' and '{name}' are the same file; expected a file for each"
            )
        self._places[place] = name

    def check_scene(self, scene: str) -> None:
        """Raises OutputClash for an output that is the scene, before that is opened."""
        resolved = Ar.GetResolver().Resolve(scene)
        self._check([str(resolved)] if resolved else [])

    def check_stage(self, stage: Usd.Stage) -> None:
        """The same for each layer of a stage, each layer that it may open later (clips), and each texture."""
        if self._existing():
            self._check(_files_of(stage))

    def _existing(self) -> dict[Identity, str]:
        """Outputs that are there already: none of the others can be read by anything."""
        found: dict[Identity, str] = {}
        for place, name in self._places.items():
            with contextlib.suppress(OSError):
                found.setdefault(_identity(place), name)
        return found

    def _check(self, files: Sequence[str]) -> None:
        existing = self._existing()
        for file in files:
            name = None
            with contextlib.suppress(OSError, ValueError):
                name = existing.get(_identity(file))
            if name is not None:
                raise OutputClash(f"output '{name}' is read by the scene; expected another file")


def _identity(path: str | Path) -> Identity:
    found = os.stat(path)
    return found.st_dev, found.st_ino


def _files_of(stage: Usd.Stage) -> list[str]:
    files: dict[str, None] = {}
    for layer in stage.GetUsedLayers():
        if layer.realPath:
            files[Ar.SplitPackageRelativePathOuter(layer.realPath)[0]] = None
            files.update(dict.fromkeys(_assets_of(layer)))
    return list(files)


def _assets_of(layer: Sdf.Layer) -> Iterator[str]:
    """Whatever a layer names: sublayers, references, payloads, clips, values of assets."""
    for kind in UsdUtils.ExtractExternalReferences(layer.identifier):
        for asset in kind:
            yield from _resolved(layer, asset)


def _resolved(layer: Sdf.Layer, asset: str) -> Iterator[str]:
    """The files that an asset path means: one, or those of all tiles of a texture or frames of a template."""
    path = Path(layer.ComputeAbsolutePath(asset))
    pattern = _NUMBER.sub(r"\\d+", re.escape(path.name))
    if pattern == re.escape(path.name):
        found = Ar.GetResolver().Resolve(Sdf.ComputeAssetPathRelativeToLayer(layer, asset))
        if found:
            yield Ar.SplitPackageRelativePathOuter(str(found))[0]
    elif path.parent.is_dir():
        yield from (entry.path for entry in os.scandir(path.parent) if re.fullmatch(pattern, entry.name))
