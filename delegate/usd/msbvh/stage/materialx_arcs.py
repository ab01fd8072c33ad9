"""References, payloads and sublayers to MaterialX documents, which usd-core cannot open: what USD said of each is taken,
and the arc is pointed at a layer made of the document (materialx_document.py).

The layer that has the arc is changed in memory. Nothing is saved, and no file is touched.
"""

from __future__ import annotations

import os
import re
from collections.abc import Callable
from contextlib import AbstractContextManager
from dataclasses import dataclass, field
from typing import Any

from pxr import Ar, Sdf

from ..base.errors import Diagnostics
from .materialx_document import DocumentFault, layer_of

_MISSING_PACKAGE = (
    "refers to a MaterialX document (.mtlx), which needs the package MaterialX: pip install 'msbvh[materialx]'; drawn without"
    " it"
    " brings what reads it"
)
"""The same of all documents, so that it is said once."""
_OPENED = re.compile(r"Could not open asset @(.+?\.mtlx\]*)@ for (\w+) introduced by @(.+?)@<(.+?)>")
_SUBLAYER = re.compile(r"Could not load sublayer @(.+?\.mtlx\]*)@ of layer @(.+?)@")
_PRIM = re.compile(r"^In <(/[^>]*)>")
_MOST_ROUNDS = 16
"""What is found behind a document's arc may have others."""

_layers: dict[tuple[str, float], Sdf.Layer] = {}
"""By file and time of its last change; kept, since nothing else holds an anonymous layer."""


@dataclass(frozen=True)
class _Arc:
    """One that failed."""

    document: str
    """As USD says it, anchored."""
    layer: str
    """That has the arc."""
    prim: str
    """That has it there, maybe within a variant; empty for a sublayer."""
    seen: str = field(default="", compare=False)
    """The first prim that lacks something for it."""


def follow_documents(
    said: list[str], diagnostics: Diagnostics, listen: Callable[[list[str]], AbstractContextManager[None]]
) -> list[str]:
    """What USD said while a stage was composed, without what is mended. `listen`: puts what it says from then on into a
    list. The stage that composes the layers must be open, and changes."""
    seen: set[_Arc] = set()
    for _ in range(_MOST_ROUNDS):
        arcs = [arc for arc in map(_arc, said) if arc is not None]
        said = [text for text in said if _arc(text) is None]
        fresh = list(dict.fromkeys(arc for arc in arcs if arc not in seen))
        if not fresh:
            break
        more: list[str] = []
        with listen(more), Sdf.ChangeBlock():  # so that the stage is composed once
            for arc in fresh:
                _mend(arc, diagnostics)
        seen.update(fresh)
        said += [text for text in more if text not in said]
    return said


def _arc(text: str) -> _Arc | None:
    prim = _PRIM.match(text)
    seen = prim[1] if prim else ""
    if found := _OPENED.search(text):
        return _Arc(found[1], found[3], found[4], seen)
    if found := _SUBLAYER.search(text):
        return _Arc(found[1], found[2], "", seen)
    return None


def _mend(arc: _Arc, diagnostics: Diagnostics) -> None:
    subject, message = arc.seen or arc.prim, ""
    owner = Sdf.Layer.Find(arc.layer)
    try:
        made = _made_layer(arc.document, owner)
        if owner is None or not _repoint(owner, arc, made.identifier):
            message = "is a MaterialX document, and cannot be found where it is referred to"
    except ImportError:
        diagnostics.group(subject, "", _MISSING_PACKAGE)
        return
    except DocumentFault as fault:
        message = f"cannot be read as MaterialX: {fault}"
    if message:
        diagnostics.group(subject, "", f"@{arc.document}@ {message}; drawn without it")


def _made_layer(document: str, owner: Sdf.Layer | None) -> Sdf.Layer:
    path = owner.ComputeAbsolutePath(document) if owner is not None else document
    resolved = str(Ar.GetResolver().Resolve(path))
    if not resolved:
        raise DocumentFault("there is no such file")
    file = Ar.SplitPackageRelativePathOuter(resolved)[0]
    key = resolved, os.stat(file).st_mtime
    if key not in _layers:
        _layers[key] = layer_of(resolved)
    return _layers[key]


def _repoint(owner: Sdf.Layer, arc: _Arc, to: str) -> bool:
    """Whether the layer has such an arc."""
    target = owner.ComputeAbsolutePath(arc.document)

    def leads_there(path: str) -> bool:
        return bool(path) and owner.ComputeAbsolutePath(path) == target

    editable = owner.permissionToEdit
    owner.SetPermissionToEdit(True)
    try:
        if not arc.prim:
            paths = list(owner.subLayerPaths)
            found = [i for i, path in enumerate(paths) if leads_there(path)]
            for i in found:
                owner.subLayerPaths[i] = to
            return bool(found)
        spec = owner.GetPrimAtPath(arc.prim)
        if spec is None:
            return False
        lists = (spec.referenceList, Sdf.Reference), (spec.payloadList, Sdf.Payload)
        return sum(_repointed(edits, kind, leads_there, to) for edits, kind in lists) > 0  # each of them
    finally:
        owner.SetPermissionToEdit(editable)


_EDITS = ("explicitItems", "prependedItems", "appendedItems", "addedItems")


def _repointed(edits: Any, kind: Any, leads: Callable[[str], bool], to: str) -> bool:
    """Of a list of Sdf.References or Sdf.Payloads."""
    changed = False
    for name in _EDITS:
        items = getattr(edits, name)
        for i, item in enumerate(list(items)):
            if leads(item.assetPath):
                rest = (item.customData,) if kind is Sdf.Reference else ()
                items[i] = kind(to, item.primPath, item.layerOffset, *rest)
                changed = True
    return changed
