"""Figures as text for people. Each takes any value, since a report says what it knows: what is missing, or no number, is an en
dash; infinity is said as such."""

from __future__ import annotations

import math
from collections.abc import Callable

MISSING = "\N{EN DASH}"
MINUS = "\N{MINUS SIGN}"
SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
BYTES_PER_MB = 1e6


def number(value: object) -> float | None:
    """A finite number, or None. Truth values are no numbers."""
    if isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value):
        return float(value)
    return None


def _shown(value: object, form: Callable[[float], str]) -> str:
    """The text of a finite number by `form`."""
    if (found := number(value)) is not None:
        return form(found)
    if isinstance(value, float) and math.isinf(value):
        return "∞" if value > 0 else f"{MINUS}∞"
    return MISSING


def power_of_ten(exponent: int) -> str:
    """10⁻⁵: as in text, without markup."""
    return f"10{str(exponent).translate(SUPERSCRIPTS)}"


def figure(value: object) -> str:
    """Three significant digits: 0.00123, 1.23, 1,230; small and large ones as 1.23×10⁻⁷."""
    return _shown(value, _three_digits)


def _three_digits(value: float) -> str:
    if value == 0.0:
        return "0"
    mantissa, _, power = f"{value:.2e}".partition("e")
    exponent = int(power)
    if -4 <= exponent < 7:
        text = f"{value:,.{max(0, 2 - exponent)}f}"
    else:
        text = f"{mantissa}×{power_of_ten(exponent)}"
    return text.replace("-", MINUS)


def plain(value: object) -> str:
    """Within a sentence: as short as it goes."""
    return _shown(value, lambda found: f"{found:.4g}".replace("-", MINUS))


def seconds(value: object) -> str:
    """Three significant digits; never with a power of ten."""
    return _shown(value, lambda found: "<0.0001" if 0.0 < found < 1e-4 else _three_digits(found))


def megabytes(value: object) -> str:
    """Of bytes, in units of 10⁶ bytes."""
    return _shown(value, _megabytes)


def _megabytes(count: float) -> str:
    amount = count / BYTES_PER_MB
    if 0.0 < amount < 0.001:
        return "<0.001"
    digits = 0 if amount >= 100 else 1 if amount >= 10 else 2 if amount >= 1 else 3
    return f"{amount:,.{digits}f}" if amount else "0"


def count(value: object) -> str:
    """Whole below ten thousand; else three digits with the unit: 12.3 M."""
    return _shown(value, _count)


def _count(value: float) -> str:
    for size, unit in ((1e9, "G"), (1e6, "M"), (1e4, "k")):
        if abs(value) >= size:
            return f"{_three_digits(value / (1e3 if unit == 'k' else size))} {unit}"
    return f"{value:,.0f}" if value == int(value) else f"{value:,.1f}"


def share(value: object) -> str:
    """Of a whole, in per cent: 12 %, 0.3 %."""
    return _shown(value, lambda found: _percent(found, ""))


def change(value: object) -> str:
    """A share with its sign: -11 %, +0.3 %."""
    return _shown(value, lambda found: _percent(found, "+"))


def _percent(value: float, sign: str) -> str:
    percent = 100.0 * value
    text = f"{percent:{sign},.{0 if abs(percent) >= 10 else 1}f}"
    return "0 %" if percent == 0.0 else f"{text.replace('-', MINUS)} %"


def spread(values: object) -> str:
    """`low to high` of [median, low, high]; empty where they are not known or one."""
    if not isinstance(values, (list, tuple)) or len(values) < 3:
        return ""
    low, high = number(values[1]), number(values[2])
    if low is None or high is None or low == high:
        return ""
    return f"{seconds(low)}{MISSING}{seconds(high)}"


def median(values: object) -> float | None:
    """Of [median, low, high]."""
    return number(values[0]) if isinstance(values, (list, tuple)) and values else None


def options_text(options: object, if_none: str = "base settings") -> str:
    """`segments 1, interpolation linear`."""
    if not isinstance(options, dict) or not options:
        return if_none
    return ", ".join(f"{name} {_option(value)}" for name, value in options.items())


def _option(value: object) -> str:
    """As a user types it; truth values as on and off."""
    if isinstance(value, bool):
        return "on" if value else "off"
    if isinstance(value, float):
        return _shown(value, lambda found: f"{found:g}")
    return MISSING if value is None else str(value)
