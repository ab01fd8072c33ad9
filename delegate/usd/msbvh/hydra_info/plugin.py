"""The Hydra plugin as its files tell of it: nothing is loaded."""

from __future__ import annotations

import json
import mmap
import os
import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

NAME = "hdMsbvh"
SEARCH_PATH = "PXR_PLUGINPATH_NAME"
"""The environment variable by which OpenUSD finds plugins."""
_NAMESPACE = re.compile(rb"pxrInternal_v(\d+)_(\d+)(?:_(\d+))?__pxrReserved__")
_LIBRARIES = ("*usd_hd.so*", "*usd_ms.so*", "libhd.so*", "*usd_ms.dylib", "*usd_hd.dylib")


@dataclass(frozen=True)
class Plugin:
    """What a plugInfo.json says of it."""

    folder: Path
    library: Path
    version: str
    """Of msbvh."""
    openusd: str
    """That it was built for, as PXR_VERSION has it, such as 2411."""

    @property
    def namespace(self) -> str | None:
        """Of OpenUSD's symbols that it calls; None where there is no library, or it calls none."""
        return namespace_of(self.library) if self.library.is_file() else None


@dataclass(frozen=True)
class Host:
    """An application's OpenUSD."""

    library: Path
    namespace: str


class PluginError(ValueError):
    """A plugInfo.json that cannot be read; str() is one line."""


def search_folders(value: str | None = None) -> list[Path]:
    """Of PXR_PLUGINPATH_NAME: folders that hold a plugInfo.json, or such files."""
    parts = (os.environ.get(SEARCH_PATH, "") if value is None else value).split(os.pathsep)
    return [Path(part) for part in parts if part]


def find_plugin(folders: Iterable[Path]) -> Plugin | None:
    """The first one; None if no folder has it. Raises PluginError."""
    for folder in folders:
        file = folder if folder.suffix == ".json" else folder / "plugInfo.json"
        if file.is_file() and (found := _read(file)):
            return found
    return None


def _read(file: Path) -> Plugin | None:
    """Lines that start with # are OpenUSD's comments."""
    try:
        text = "\n".join(line for line in file.read_text(encoding="utf-8").splitlines() if line[:1] != "#")
        plugins = json.loads(text).get("Plugins", [])
        for plugin in plugins:
            if plugin.get("Name") == NAME:
                root = file.parent / plugin.get("Root", ".")
                ours = plugin.get("Info", {}).get("msbvh", {})
                library = (root / plugin.get("LibraryPath", "")).resolve()
                return Plugin(file.parent.resolve(), library, ours.get("version", ""), ours.get("openusd", ""))
    except (OSError, ValueError, AttributeError, TypeError) as error:
        raise PluginError(f"{file}: cannot be read: {error}; expected JSON that lists plugins") from None
    return None


def namespace_of(library: Path) -> str | None:
    """The namespace of OpenUSD's symbols in a library, such as pxrInternal_v0_24_11__pxrReserved__: a plugin loads in a
    host that has the same. Raises OSError."""
    with library.open("rb") as file:
        if library.stat().st_size == 0:
            return None
        with mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as data:
            match = _NAMESPACE.search(data)
            return match.group().decode() if match else None


def version_of(namespace: str) -> str:
    """Of a namespace: 24.11."""
    match = _NAMESPACE.fullmatch(namespace.encode())
    if not match:
        return namespace
    major, minor, patch = (part.decode() if part else "" for part in match.groups())
    return f"{minor}.{int(patch):02}" if major == "0" and patch else f"{major}.{minor}{f'.{patch}' if patch else ''}"


def find_host(path: Path) -> Host | None:
    """OpenUSD in a library, or in a folder at any depth; None where there is none. Raises OSError."""
    for library in _candidates(path):
        namespace = namespace_of(library)
        if namespace:
            return Host(library, namespace)
    return None


def _candidates(path: Path) -> Iterator[Path]:
    if path.is_file():
        yield path
        return
    for pattern in _LIBRARIES:
        yield from sorted(each for each in path.rglob(pattern) if each.is_file())
