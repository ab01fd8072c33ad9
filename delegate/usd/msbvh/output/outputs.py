"""Where a run writes, and what it must not overwrite: the scene, each file that is read for it, and its other outputs.

A file is compared by its place behind symbolic links; with what is read, also by its inode (hard links).
"""

from __future__ import annotations

import contextlib
import os
import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import partial
from pathlib import Path
from typing import Any, TypeVar

from pxr import Ar, Sdf, Tf, Usd, UsdUtils

from ..base.atomic import Folders, OutputClash, check_writable
from ..base.errors import Diagnostics
from ..stage.opening import tf_messages
from .images import check_image_path

_ASSETS = (Sdf.ValueTypeNames.Asset, Sdf.ValueTypeNames.AssetArray)
_WITHOUT_TEXTURES = frozenset(
    [
        "Xform",
        "Scope",
        "Mesh",
        "GeomSubset",
        "Camera",
        "PointInstancer",
        "Points",
        "BasisCurves",
        "Cube",
        "Sphere",
        "Cylinder",
        "Cone",
        "Capsule",
        "Plane",
        "SkelRoot",
        "Skeleton",
        "SkelAnimation",
        "BlendShape",
    ]
)
"""Types that most prims have: looking at their attributes would take as long as opening the stage."""

_T = TypeVar("_T")

Identity = tuple[int, int]
"""Device and inode."""

_NUMBER = re.compile(r"<UDIM>|(\\\#)+")
"""In the escaped name of a texture's tiles, or of value clips by template."""


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
        existing = self._existing()
        if existing:
            layers = stage.GetUsedLayers()
            self._check(_layers_of(layers))
            with tf_messages(Diagnostics()):  # The reader says what is wrong with the scene.
                self._check(_textures_of(stage))
                if any(_may_be_a_layer(self._find(name)) for name in existing.values()):
                    self._check(_named_by(layers))

    def _find(self, name: str) -> Path:
        return next(place for place, other in self._places.items() if other == name)

    def _existing(self) -> dict[Identity, str]:
        """Outputs that are there already: none of the others can be read by anything."""
        found: dict[Identity, str] = {}
        for place, name in self._places.items():
            with contextlib.suppress(OSError):
                found.setdefault(_identity(place), name)
        return found

    def _check(self, files: Iterable[str]) -> None:
        existing = self._existing()
        for file in files:
            name = None
            with contextlib.suppress(OSError, ValueError):
                name = existing.get(_identity(file))
            if name is not None:
                raise OutputClash(f"output '{name}' is read by the scene; expected another file")


def _may_be_a_layer(place: Path) -> bool:
    """By its extension, or because it has other names (hard links), which may have one."""
    return Sdf.FileFormat.FindByExtension(place.suffix[1:]) is not None or place.stat().st_nlink > 1


def _identity(path: str | Path) -> Identity:
    found = os.stat(path)
    return found.st_dev, found.st_ino


def _textures_of(stage: Usd.Stage) -> Iterator[str]:
    """The files that asset attributes name, at any time, in each layer that has an opinion."""
    for root in (stage.GetPseudoRoot(), *stage.GetPrototypes()):
        for prim in Usd.PrimRange(root, Usd.PrimAllPrimsPredicate):
            if any(name in _WITHOUT_TEXTURES for name in _known(partial(_type_names, prim))):
                continue
            for attribute in _known(prim.GetAuthoredAttributes):
                yield from _known(partial(_textures_in, attribute))


def _type_names(prim: Usd.Prim) -> list[str]:
    return [prim.GetTypeName()]


def _known(ask: Callable[[], Iterable[_T]]) -> list[_T]:
    """Nothing where a damaged file does not say: the reader reports what it needs of it."""
    try:
        return list(ask())
    except (Tf.ErrorException, UnicodeDecodeError):
        return []


def _textures_in(attribute: Usd.Attribute) -> Iterator[str]:
    if attribute.GetTypeName() in _ASSETS:
        for spec in attribute.GetPropertyStack():
            layer, path = spec.layer, spec.path
            values = _known(partial(_default_of, spec))
            for time in layer.ListTimeSamplesForPath(path):
                values += _known(partial(_sample_of, layer, path, time))
            for value in values:
                yield from _assets_in(value, layer)


def _default_of(spec: Sdf.AttributeSpec) -> list[object]:
    return [spec.default]


def _sample_of(layer: Sdf.Layer, path: Sdf.Path, time: float) -> list[object]:
    return [layer.QueryTimeSample(path, time)]


def _assets_in(value: Any, layer: Sdf.Layer) -> Iterator[str]:
    if isinstance(value, Sdf.AssetPath):
        yield from _resolved(layer, value.path)
    elif isinstance(value, Sdf.AssetPathArray):
        for asset in value:
            yield from _resolved(layer, asset.path)


def _layers_of(layers: Sequence[Sdf.Layer]) -> Iterator[str]:
    for layer in layers:
        if layer.realPath:
            yield Ar.SplitPackageRelativePathOuter(layer.realPath)[0]


def _named_by(layers: Sequence[Sdf.Layer]) -> Iterator[str]:
    """Whatever layers name, opened or not: sublayers, references, payloads, clips, assets. As slow as half of
    opening them."""
    for layer in layers:
        if layer.realPath:
            for assets in UsdUtils.ExtractExternalReferences(layer.identifier):
                for asset in assets:
                    yield from _resolved(layer, asset)


def _resolved(layer: Sdf.Layer, asset: str) -> list[str]:
    """The files that an asset path means: one, or those of all tiles of a texture or frames of a template. None for
    what is no path at all: the reader has to say so, where it reads it."""
    try:
        path = Path(layer.ComputeAbsolutePath(asset))
        pattern = _NUMBER.sub(r"\\d+", re.escape(path.name))
        if pattern != re.escape(path.name):
            return [entry.path for entry in os.scandir(path.parent) if re.fullmatch(pattern, entry.name)]
        found = Ar.GetResolver().Resolve(Sdf.ComputeAssetPathRelativeToLayer(layer, asset))
        return [Ar.SplitPackageRelativePathOuter(str(found))[0]] if found else []
    except (OSError, ValueError, Tf.ErrorException):
        return []
