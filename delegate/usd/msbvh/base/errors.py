"""What can be wrong with a scene: the exception that ends a run, and the record of what was left out or
approximated."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .._core import Diagnostic as TranslatorDiagnostic


class SceneError(Exception):
    """The scene or the settings are wrong; exit code 1.

    Its text is one line that names the file or prim, the attribute, what was found and what is expected.
    """


@dataclass(frozen=True)
class Diagnostic:
    """One thing to tell the user, in one line."""

    severity: str
    """note: nothing is lost. warning: something was approximated or left out. error: the prim was not
    rendered."""
    path: str
    """Of the prim; empty where the stage or a setting is meant."""
    attribute: str
    """Empty where the prim as a whole is meant."""
    message: str

    @property
    def subject(self) -> str:
        """The path of the prim or the property."""
        return ".".join(filter(None, (self.path, self.attribute)))

    def __str__(self) -> str:
        return f"{self.subject}: {self.message}" if self.subject else self.message


class Diagnostics:
    """Records diagnostics, each once, in the order of their first appearance."""

    def __init__(self) -> None:
        self._single: dict[Diagnostic, None] = {}
        self._grouped: dict[tuple[str, str, str], list[str]] = {}

    def note(self, path: str, attribute: str, message: str) -> None:
        """Worth saying, but the picture is what was asked for."""
        self._single[Diagnostic("note", path, attribute, message)] = None

    def warning(self, path: str, attribute: str, message: str) -> None:
        """Something was approximated or left out; the rest of the picture is right."""
        self._single[Diagnostic("warning", path, attribute, message)] = None

    def error(self, path: str, attribute: str, message: str) -> None:
        """A prim is wrong and was not rendered; the rest of the picture is right."""
        self._single[Diagnostic("error", path, attribute, message)] = None

    def group(self, path: str, attribute: str, message: str, severity: str = "warning") -> None:
        """Like warning(), for what many prims have in common: one line for all of them, naming the first."""
        paths = self._grouped.setdefault((severity, attribute, message), [])
        if path not in paths[:1]:
            paths.append(path)

    def take(self, found: Iterable[TranslatorDiagnostic]) -> None:
        """What the C++ side has to say."""
        for each in found:
            message = f"{each.message}; the prim is not drawn" if each.severity == "error" else each.message
            if each.in_common:
                self.group(each.path, each.attribute, message, each.severity)
            else:
                self._single[Diagnostic(each.severity, each.path, each.attribute, message)] = None

    def by_path(self) -> dict[str, list[str]]:
        """Warnings and errors by the prim that they name; what many have in common stands with each."""
        found: dict[str, list[str]] = {}
        for diagnostic in self._single:
            if diagnostic.severity != "note":
                text = str(replace(diagnostic, path=""))
                found.setdefault(diagnostic.path, []).append(text)
        for (severity, attribute, message), paths in self._grouped.items():
            for path in paths if severity != "note" else ():
                found.setdefault(path, []).append(str(Diagnostic(severity, "", attribute, message)))
        return found

    def __iter__(self) -> Iterator[Diagnostic]:
        yield from self._single
        for (severity, attribute, message), paths in self._grouped.items():
            others = f" (and {len(paths) - 1} more prims)" if len(paths) > 1 else ""
            yield Diagnostic(severity, paths[0], attribute, message + others)

    def __len__(self) -> int:
        return len(self._single) + len(self._grouped)
