"""One published number and what the software makes of it."""

from __future__ import annotations

import math
from dataclasses import dataclass

#: Half a unit of the last printed digit, and a little for the decimal representation.
_HALF = 0.5000001


@dataclass(frozen=True)
class Check:
    """A number.

    Attributes
    ----------
    group, what, source : str
        What it belongs to, which number it is, where it is published.
    expected, obtained : float
    tolerance : float
        Largest difference that is good.
    because : str
        Where the tolerance comes from.
    unit : str
    """

    group: str
    what: str
    source: str
    expected: float
    obtained: float
    tolerance: float
    because: str
    unit: str = ""

    @property
    def good(self) -> bool:
        """Whether the two agree."""
        near = abs(self.obtained - self.expected) <= self.tolerance
        return bool(near and math.isfinite(self.obtained))


def printed(group: str, what: str, source: str, text: str, obtained: float, unit: str = "") -> Check:
    """A number that must agree in all its printed digits, given as it is printed."""
    digits = len(text.partition(".")[2])
    return Check(
        group, what, source, float(text), obtained, _HALF * 10.0**-digits, "its printed digits", unit
    )
