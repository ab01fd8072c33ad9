"""The files of textures: what an attribute names, and where the bytes of what lies in a package are."""

from __future__ import annotations

import re

from pxr import Ar, Sdf, Tf, Usd, UsdShade

Place = tuple[str, int, int]
"""A file, and where in it the bytes are: their offset, and how many; 0: all of it."""


def texture_files(file: Sdf.AssetPath, attribute: Usd.Attribute) -> list[str]:
    """The resolved paths of what an attribute names: one, a UDIM texture's tiles, or none."""
    if not UsdShade.UdimUtils.IsUdimIdentifier(file.path):
        return [file.resolvedPath] if file.resolvedPath else []
    specs = attribute.GetPropertyStack(Usd.TimeCode.EarliestTime())
    if not specs:
        return []
    tiles = UsdShade.UdimUtils.ResolveUdimTilePaths(file.path, specs[0].layer)
    return [path for path, _ in tiles]


def locate(path: str) -> Place | None:
    """Where the bytes of a resolved file are; None for what is compressed or encrypted in a package, or is not there.
    Packages within packages are looked through."""
    if not Ar.IsPackageRelativePath(path):
        return path, 0, 0
    package, inner = Ar.SplitPackageRelativePathOuter(path)
    offset, opened = 0, package
    while inner:
        name, _, rest = _parts(inner)
        found = _entry(opened, name)
        if found is None:
            return None
        offset, size = offset + found[0], found[1]
        opened, inner = f"{opened}[{name}]" if opened == package else _nested(opened, name), rest
    return package, offset, size


def _parts(inner: str) -> tuple[str, str, str]:
    """What stands before the next bracket, and inside of it."""
    if not Ar.IsPackageRelativePath(inner):
        return inner, "", ""
    name, rest = Ar.SplitPackageRelativePathOuter(inner)
    return name, "[", rest


def _nested(opened: str, name: str) -> str:
    return re.sub(r"(\]+)$", lambda brackets: f"[{name}]" + brackets.group(1), opened)


def _entry(package: str, name: str) -> tuple[int, int] | None:
    """Offset and size of a file in a package, as they stand."""
    try:
        archive = Sdf.ZipFile.Open(package)
        found = archive.GetFileInfo(name) if archive else None
    except Tf.ErrorException:
        return None
    if found is None or found.compressionMethod or found.encrypted:
        return None
    return found.dataOffset, found.size
