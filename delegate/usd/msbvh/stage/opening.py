"""Opening a stage: one clear SceneError where that fails, a warning for every part that does not resolve."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import partial

from pxr import Ar, Sdf, Tf, Usd, UsdUtils

from ..base.crash_line import crash_line
from ..base.errors import Diagnostics, SceneError
from .crate_check import crate_fault
from .materialx_arcs import follow_documents


def open_stage(path: str, diagnostics: Diagnostics, mask: Sequence[str] = ()) -> Usd.Stage:
    """Opens and composes a stage with its payloads.

    `mask` limits it to these prims, their ancestors and descendants (usdrecord's --mask). References,
    payloads and sublayers that do not resolve leave a warning each. Raises SceneError for a missing or
    unreadable file, an invalid layer, a bad mask and a stage without prims.
    """
    resolved = Ar.GetResolver().Resolve(path)
    if not resolved:
        raise SceneError(f"{path}: no such file; expected a USD scene (usd, usda, usdc, usdz)")
    if fault := crate_fault(str(resolved)):
        raise SceneError(f"{path}: cannot be read as USD: {fault}")
    population = _population_mask(mask)
    said: list[str] = []
    with crash_line(path), tf_texts(said):
        try:
            stage = Usd.Stage.OpenMasked(path, population) if mask else Usd.Stage.Open(path)
        except (Tf.ErrorException, RuntimeError, UnicodeDecodeError, MemoryError) as error:
            reason = tf_reason(error).replace(f"{resolved}:", "line ", 1)
            raise SceneError(f"{path}: cannot be read as USD: {reason}") from None
    for text in follow_documents(said, diagnostics, tf_texts):
        _record(text, diagnostics)
    if not stage.GetPseudoRoot().GetAllChildren():
        limits = f" under the mask {', '.join(mask)}" if mask else ""
        found = "; ".join(["found no prims" + limits, *map(str, diagnostics)])
        raise SceneError(f"{path}: the stage is empty: {found}; expected at least one prim")
    return stage


def _population_mask(paths: Sequence[str]) -> Usd.StagePopulationMask:
    mask = Usd.StagePopulationMask()
    for path in paths:
        if not Sdf.Path.IsValidPathString(path) or not Sdf.Path(path).IsAbsoluteRootOrPrimPath():
            raise SceneError(f"mask: found '{path}', expected the absolute path of a prim such as /World/Set")
        if not Sdf.Path(path).IsAbsolutePath():
            raise SceneError(f"mask: found the relative path '{path}', expected an absolute one such as /{path}")
        mask.Add(path)
    return mask


@contextmanager
def tf_messages(diagnostics: Diagnostics) -> Iterator[None]:
    """Turns the warnings that USD's libraries would print into diagnostics, but for those on properties that
    have one already."""
    said: list[str] = []
    try:
        with tf_texts(said):
            yield
    finally:
        for text in said:
            _record(text, diagnostics)


@contextmanager
def tf_texts(said: list[str]) -> Iterator[None]:
    """Collects the warnings that USD's libraries would print."""
    delegate = UsdUtils.CoalescingDiagnosticDelegate()
    try:
        yield
    finally:
        messages = delegate.TakeUncoalescedDiagnostics()
        # USD composes on many threads: sorted, the same scene says the same each time.
        said += sorted(text_of(partial(getattr, message, "commentary")) for message in messages)
        del delegate


_PRIM_PREFIX = re.compile(r"^(?:In )?<?(/[\w/:.]*)>?(?: --|:) ")
_STAGE_SUFFIX = re.compile(r" \((?:instantiating|recomposing|loading)[^()]*stage @[^@]*@ <0x[0-9a-f]+>\)$")
_ADDRESS = re.compile(r" ?<0x[0-9a-f]+>|(?<=@anon:)0x[0-9a-f]+:")


_OP = re.compile(r"attribute associated with the xformOp '([^']*)', on the prim at path <([^>]*)>")


def _record(commentary: str, diagnostics: Diagnostics) -> None:
    """Splits the prim off messages such as `In </World>: Could not open asset @a.usda@ for reference ...`. Many
    prims with the same message become one line."""
    op = _OP.search(commentary)
    if op and any(known.subject == f"{op[2]}.xformOpOrder" and f"'{op[1]}'" in known.message for known in diagnostics):
        return
    text = _ADDRESS.sub("", _STAGE_SUFFIX.sub("", " ".join(commentary.split())))
    prim = _PRIM_PREFIX.match(text)
    if not prim:
        diagnostics.warning("", "", text)
        return
    path = prim[1]
    if "." in path and any(known.subject == path for known in diagnostics):
        return
    # Its own path behind the layer's name says nothing new, and would make each message another.
    diagnostics.group(path, "", text[prim.end() :].replace(f"<{path}>", ""))


_TF_ERROR = re.compile(r"Error in '[^']*' at line \d+ in file \S+ : '(.*)'\s*$")
_GRAMMAR_RULE = re.compile(r" matching pxrInternal.*?(?= at ')")
"""The C++ type of the grammar rule that USD's text parser stopped in."""


def tf_reason(error: Exception) -> str:
    """The first message of a Tf error without the source locations of USD's own code."""
    if isinstance(error, UnicodeDecodeError):
        return f"found text that is no UTF-8 ('{error.object.decode('utf-8', 'replace')}')"
    text = text_of(lambda: str(error))
    for line in text.replace("\n'", "'").splitlines():
        found = _TF_ERROR.search(line)
        if found:
            return _GRAMMAR_RULE.sub("", " ".join(found[1].split()))
    return " ".join(text.split())


def text_of(message: Callable[[], str]) -> str:
    """A message of USD's, which may quote a layer's bytes that are no UTF-8."""
    try:
        return message()
    except UnicodeDecodeError as error:
        return error.object.decode("utf-8", "replace")
