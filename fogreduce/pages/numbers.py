"""Numbers as people read them: a value with its standard error, counts, durations."""

from __future__ import annotations

import math
import re
import sys
from collections.abc import Sequence

#: Beyond these a value is written with a power of ten.
_SMALLEST, _LARGEST = 1e-4, 1e7
#: So many roundings of doubles, one upon the other, are no value: the sums of a mean over blocks.
_ROUNDINGS = 64
_NEGATIVE = re.compile(r"(?<![^\s(])-(?=[\d.])")
_SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def plus_minus(value: float | None, error: float | None, unit: str = "") -> str:
    """A value and its standard error to the error's second digit, with their unit; empty without a value."""
    if value is None or not math.isfinite(value):
        return ""
    if error is None or not math.isfinite(error) or error <= 0:
        return f"{number(value)} {unit}".rstrip()
    largest = max(abs(value), error)
    power = 0
    if largest < _SMALLEST or largest >= _LARGEST:
        power = math.floor(math.log10(largest))
    scale = 10.0**power
    digits = min(12, max(0, 1 - math.floor(math.log10(error / scale))))
    if power == 0 and error >= 100.0:  # digits beyond the error's second are noughts
        coarse = 1 - math.floor(math.log10(error))
        value, error = round(value, coarse), round(error, coarse)
    text = f"{_minus(f'{value / scale:.{digits}f}')} ± {error / scale:.{digits}f}"
    if power:
        text = f"({text}) · 10{str(power).translate(_SUPERSCRIPTS)}"
    return f"{text} {unit}".rstrip()


def rounding(value: float | None, of: float) -> float | None:
    """A value; 0 where it is no more than what numbers of the size `of` leave when doubles are subtracted."""
    return 0.0 if value is not None and abs(value) < _ROUNDINGS * sys.float_info.epsilon * of else value


def number(value: float | None, digits: int = 4, *, noughts: bool = False) -> str:
    """A number to so many significant digits, noughts at its end too where asked; empty for None and NaN."""
    if value is None or not math.isfinite(value):
        return ""
    text = f"{value:#.{digits}g}".rstrip(".") if noughts else f"{value:.{digits}g}"
    if "e" not in text:
        return _minus(text)
    mantissa, power = text.split("e")
    return f"{_minus(mantissa)} · 10{str(int(power)).translate(_SUPERSCRIPTS)}"


def minus_signs(text: str) -> str:
    """Words with a minus sign in place of the hyphen before each negative number."""
    return _NEGATIVE.sub("−", text)


def signed(text: str) -> str:
    """A number as `number` and `plus_minus` write it, with a plus where it is above 0."""
    value = text.split(" ")[0]
    return f"+{text}" if "−" not in value and any(c in "123456789" for c in value) else text


def apart(values: Sequence[float]) -> list[str]:
    """Numbers to as many significant digits, four at least, as tell different ones apart."""
    for digits in range(4, 17):
        texts = [number(value, digits) for value in values]
        if len(set(texts)) == len(set(values)):
            break
    return texts


def _minus(text: str) -> str:
    """With a minus sign in place of the hyphen, and without the sign of a zero."""
    return text.lstrip("-") if not any(c in "123456789" for c in text) else text.replace("-", "−")


def count(value: int) -> str:
    """A whole number, thousands parted by a narrow space."""
    return f"{value:,}".replace(",", " ")


def duration(seconds: float) -> str:
    """A duration: ``300 s``, ``100 min``, ``2 h 30 min``."""
    if seconds < 600 or seconds % 60:
        return f"{seconds:g} s"
    minutes = int(seconds // 60)
    if minutes < 180 or minutes % 60:
        return f"{minutes} min"
    return f"{minutes // 60} h"


def size(octets: int) -> str:
    """A file's size."""
    for unit, scale in (("GB", 1e9), ("MB", 1e6), ("kB", 1e3)):
        if octets >= scale:
            return f"{octets / scale:.3g} {unit}"
    return f"{octets} B"
