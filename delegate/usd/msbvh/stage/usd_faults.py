"""Errors that USD raises while a prim is evaluated, in terms of the prim's attributes."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from pxr import Tf, Usd

from .opening import tf_reason
from .values import Unreadable, leave_out, raw, type_name


@contextmanager
def leaving_out(prim: Usd.Prim, code: Usd.TimeCode) -> Iterator[None]:
    """What cannot be read of a prim inside is reported, and the prim left out."""
    try:
        yield
    except FAULTS as error:
        report_left_out(prim, error, code)


FAULTS = (Unreadable, Tf.ErrorException, UnicodeDecodeError)
"""What may be raised while a prim is evaluated, through no fault of ours."""


def report_left_out(prim: Usd.Prim, error: Exception, code: Usd.TimeCode) -> None:
    """Names the attribute that a prim is left out for: that of the first value of a type that the prim's schema does
    not have, where USD itself does not say."""
    if not isinstance(error, Unreadable):
        message = f"USD cannot evaluate it: {tf_reason(error)}"
        error = _wrong_type_if_any(prim, code) or Unreadable(str(prim.GetPath()), "", message)
    leave_out(error)


def _wrong_type_if_any(prim: Usd.Prim, code: Usd.TimeCode) -> Unreadable | None:
    try:
        return _wrong_type(prim, code)
    except (Tf.ErrorException, UnicodeDecodeError):  # A damaged file.
        return None


def _wrong_type(prim: Usd.Prim, code: Usd.TimeCode) -> Unreadable | None:
    """The first authored attribute with a value of another type than the prim's schema has for it."""
    definition = prim.GetPrimDefinition()
    for attribute in prim.GetAuthoredAttributes():
        known = definition.GetAttributeDefinition(attribute.GetName())
        found = raw(attribute, code)
        if not known or found is None:
            continue
        expected = known.GetTypeName()
        if expected.defaultValue is not None and type(expected.defaultValue) is not type(found):
            message = f"found {type_name(attribute, found)}, expected {expected}"
            return Unreadable(str(prim.GetPath()), attribute.GetName(), message)
    return None
