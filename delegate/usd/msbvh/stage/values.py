"""The one gate through which attribute values come from a stage.

A value of the type that is meant passes as it is, one that converts without loss is converted, and any other is
reported once, with the prim, the attribute, the type that was found and the one that was expected. What depends on
it is left out, and everything else is drawn. tests/python/test_values.py holds every module to this gate.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from types import TracebackType
from typing import Any

from pxr import Sdf, Tf, Usd

from ..base.errors import Diagnostics
from .value_types import Kind, Lossy

_reports: ContextVar[Diagnostics] = ContextVar("reports")
"""Where faults of the frame that is being read are reported. A context, not an argument: every module reads values,
many of them in places that have nothing else to report."""

_undecoded: list[str] = []
"""Text that is no UTF-8, as far as it is, which USD has found since the last look."""

asked: dict[tuple[str, str], Kind] | None = None
"""For tests: where it is a dictionary, every (prim type, attribute) that was asked for is noted there."""


LOOP_STEP = 1e-9
"""Time codes: far less than a ray's time can tell apart, more than rounding."""


class Unreadable(Exception):
    """An attribute that a prim cannot do without holds no value that can be read."""

    def __init__(self, path: str, attribute: str, message: str) -> None:
        super().__init__(f"{path}.{attribute}: {message}")
        self.path, self.attribute, self.message = path, attribute, message


@contextmanager
def reported_to(diagnostics: Diagnostics) -> Iterator[None]:
    """Faults that are found inside are reported there."""
    token, hook = _reports.set(diagnostics), sys.excepthook

    def note(kind: type[BaseException], error: BaseException, trace: TracebackType | None) -> None:
        if isinstance(error, UnicodeDecodeError):
            _undecoded.append(error.object.decode("utf-8", "replace"))
        else:
            hook(kind, error, trace)

    sys.excepthook = note  # USD has Python print what it cannot hand over, and hands over nothing.
    try:
        yield
    finally:
        sys.excepthook = hook
        _undecoded.clear()
        _reports.reset(token)


def diagnostics() -> Diagnostics:
    """Of the frame that is being read; one that nobody looks at outside of reported_to()."""
    found = _reports.get(None)
    return Diagnostics() if found is None else found


def required(attribute: Usd.Attribute, code: Usd.TimeCode | float, kind: Kind) -> Any:
    """A value as `kind.exact`; None where the attribute has none. Raises Unreadable for another type."""
    if asked is not None:
        asked[str(attribute.GetPrim().GetTypeName()), attribute.GetName()] = kind
    try:
        found = attribute.Get(code)
    except _UNREAD as error:
        found = _unread(attribute, error, code)
    if type(found) is kind.exact:
        return found
    if found is None:
        _check_decoded(attribute)
        return None
    return _converted(attribute, found, kind)


def targets(prim: Usd.Prim, name: str) -> list[Sdf.Path]:
    """What a relationship leads to in the end. Raises Unreadable where a layer has an attribute of that name."""
    try:
        return prim.GetRelationship(name).GetForwardedTargets()
    except Tf.ErrorException as error:
        if "is not a relationship" not in str(error):
            raise
        raise Unreadable(str(prim.GetPath()), name, "found an attribute, expected a relationship") from None


def value(attribute: Usd.Attribute, code: Usd.TimeCode | float, kind: Kind) -> Any:
    """Like required(), but a value of another type is reported and counts as none."""
    try:
        return required(attribute, code, kind)
    except Unreadable as fault:
        ignore(fault)
        return None


def might_vary(attribute: Usd.Attribute) -> bool:
    """attribute.ValueMightBeTimeVarying(), which raises where a sample's time is NaN: then whoever reads the samples finds
    out."""
    try:
        return attribute.ValueMightBeTimeVarying()
    except Tf.ErrorException:
        return True


def raw(attribute: Usd.Attribute, code: Usd.TimeCode | float) -> Any:
    """A value of any type, for those who look at the type themselves."""
    if asked is not None:
        asked.setdefault((str(attribute.GetPrim().GetTypeName()), attribute.GetName()), ANY)
    try:
        try:
            found = attribute.Get(code)
        except _UNREAD as error:
            found = _unread(attribute, error, code)
        if found is None:
            _check_decoded(attribute)
    except Unreadable as fault:
        ignore(fault)
        return None
    return found


def _check_decoded(attribute: Usd.Attribute) -> None:
    if _undecoded:
        text = _undecoded.pop()
        _undecoded.clear()
        raise Unreadable(str(attribute.GetPrimPath()), attribute.GetName(), f"found '{text}', expected text in UTF-8")


_UNREAD = (UnicodeDecodeError, Tf.ErrorException, RuntimeError)
"""Text that is no UTF-8; a damaged file."""


def _unread(attribute: Usd.Attribute, error: Exception, code: Usd.TimeCode | float) -> object:
    """Text with the bytes replaced that are no UTF-8; next to a knot that a spline's loop repeats, where usd-core 26.11
    raises an error, the value just before. Raises Unreadable for anything else."""
    time = code.GetValue() if isinstance(code, Usd.TimeCode) else code
    if isinstance(error, Tf.ErrorException) and attribute.HasSpline() and not math.isnan(time):
        try:
            return attribute.Get(time - LOOP_STEP)
        except Tf.ErrorException:
            pass
    if isinstance(error, UnicodeDecodeError):
        return error.object.decode("utf-8", "replace")
    message = f"found a value that USD cannot read ({' '.join(str(error).split())[-120:]}), expected one"
    raise Unreadable(str(attribute.GetPrimPath()), attribute.GetName(), message) from None


ANY = Kind("any", object)


def ignore(fault: Unreadable) -> None:
    """Reports a value that is left out."""
    diagnostics().warning(fault.path, fault.attribute, f"{fault.message}; ignored")


def leave_out(fault: Unreadable) -> None:
    """Reports a prim that is left out."""
    diagnostics().error(fault.path, fault.attribute, f"{fault.message}; the prim is not drawn")


def exact(
    prim: Usd.Prim, names: Iterable[tuple[str, Kind]], code: Usd.TimeCode | float, authored: Iterable[str] | None = None
) -> bool:
    """Whether some attributes are of the very types that USD's own computations take, which pass over others without
    a word. Reports each that is not."""
    sound = True
    for name, kind in names:
        if authored is not None and name not in authored:
            continue
        attribute = prim.GetAttribute(name)
        if not attribute or not attribute.HasAuthoredValue():
            continue
        found = raw(attribute, code)
        if found is not None and type(found) is not kind.exact:
            ignore(_fault(attribute, found, kind))
            sound = False
    return sound


def _converted(attribute: Usd.Attribute, found: object, kind: Kind) -> object:
    convert = kind.conversions.get(type(found))
    if convert is None:
        raise _fault(attribute, found, kind)
    try:
        return convert(found)
    except Lossy as lost:
        raise _fault(attribute, found, kind, f" with {lost}, which does not fit") from None


def _fault(attribute: Usd.Attribute, found: object, kind: Kind, detail: str = "") -> Unreadable:
    name, expected = type_name(attribute, found), expected_name(attribute, kind)
    message = f"found {name}{detail}, expected {expected}"
    return Unreadable(str(attribute.GetPrimPath()), attribute.GetName(), message)


def expected_name(attribute: Usd.Attribute, kind: Kind) -> str:
    """The type that the prim's schema gives an attribute; the kind's own where no schema knows it."""
    definition = attribute.GetPrim().GetPrimDefinition().GetAttributeDefinition(attribute.GetName())
    return str(definition.GetTypeName()) if definition else kind.name


def type_name(attribute: Usd.Attribute, found: object) -> str:
    """What Sdf calls the type of a value that was found. Python does not tell all of them apart; the layers do."""
    for spec in attribute.GetPropertyStack():
        if type(spec.typeName.defaultValue) is type(found):
            return str(spec.typeName)
    known = Sdf.GetValueTypeNameForValue(found)
    return str(known) if known else type(found).__name__
