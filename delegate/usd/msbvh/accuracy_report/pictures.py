"""The pictures that a report compares, as data URIs."""

from __future__ import annotations

import base64
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from .figures import options_text, seconds
from .plots import frame_seconds

PNG_START = b"\x89PNG\r\n\x1a\n"


@dataclass(frozen=True)
class Choice:
    """A picture that can be chosen."""

    id: str
    label: str
    picture: str
    """Data URI."""
    error_map: str
    """Data URI; empty: there is none."""


@dataclass
class Pictures:
    """All choices: the reference first, then the named settings, those of the targets, then the rest of the front."""

    choices: list[Choice] = field(default_factory=list)
    missing: list[str] = field(default_factory=list)
    """Paths at which no PNG file was found."""

    def read(self, folder: Path, path: object) -> str:
        """A data URI; empty where there is no picture."""
        if not isinstance(path, str) or not path:
            return ""
        try:
            content = (folder / path).read_bytes()
        except OSError:
            content = b""
        if not content.startswith(PNG_START):
            self.missing.append(path)
            return ""
        return f"data:image/png;base64,{base64.b64encode(content).decode('ascii')}"

    def add(self, folder: Path, key: str, label: str, source: Mapping[str, Any]) -> None:
        """Of a point or the reference, once."""
        if any(choice.id == key for choice in self.choices):
            return
        if picture := self.read(folder, source.get("picture")):
            self.choices.append(Choice(key, label, picture, self.read(folder, source.get("error_map"))))


def pictures(data: Mapping[str, Any], folder: Path) -> Pictures:
    """Everything that the report's slider offers."""
    found = Pictures()
    points = data.get("points") or {}
    found.add(folder, "reference", "Reference", data.get("reference") or {})
    for named in data.get("named") or ():
        found.add(folder, str(named.get("id")), str(named.get("name", "")), points.get(named.get("id")) or {})
    for target in data.get("targets") or ():
        found.add(folder, str(target.get("id")), str(target.get("asked", "")), points.get(target.get("id")) or {})
    for key in data.get("front") or ():
        point = points.get(key) or {}
        label = f"Front, {seconds(frame_seconds(point))} s: {options_text(point.get('options'))}"
        found.add(folder, str(key), label, point)
    return found
