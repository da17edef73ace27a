"""A quantity of a test report: value, 95 % interval, definition, or why the runs do not determine it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtri

Array = NDArray[np.float64]

COVERAGE = 0.95
#: Standard deviations of a normal deviate that hold it with that probability.
K95 = float(ndtri((1 + COVERAGE) / 2))


@dataclass(frozen=True)
class Quantity:
    """One number of a report.

    Attributes
    ----------
    name : str
        Key of `fogreduce.characterise.definitions.DEFINITIONS`.
    of : str
        ``gyro1`` ... or ``unit``; with ``, x`` behind it for a part along an axis.
    unit : str
    value, low, high : float or None
        Value and 95 % interval; None where the runs do not determine it. A value without `high` is a lower
        bound (95 %), `low` is the same.
    needs : str
        The runs that would determine it, where it is not determined.
    note : str
        From which run, and what the interval leaves out.
    """

    name: str
    of: str
    unit: str
    value: float | None = None
    low: float | None = None
    high: float | None = None
    needs: str = ""
    note: str = ""

    @property
    def std(self) -> float | None:
        """Half the interval over 1.96: the standard uncertainty, for a normal one."""
        if self.low is None or self.high is None:
            return None
        return (self.high - self.low) / (2 * K95)


def normal(name: str, of: str, unit: str, value: float, std: float, note: str = "") -> Quantity:
    """A quantity whose error is normal."""
    return Quantity(name, of, unit, value, value - K95 * std, value + K95 * std, note=note)


def not_negative(name: str, of: str, unit: str, value: float, half: float, note: str = "") -> Quantity:
    """A quantity that cannot be negative, off by at most `half` in 95 % of cases."""
    return Quantity(name, of, unit, value, max(0.0, value - half), value + half, note=note)


def undetermined(name: str, of: str, unit: str, needs: str) -> Quantity:
    """A quantity that the runs leave open."""
    return Quantity(name, of, unit, needs=needs)


def largest_error(std: Array) -> float:
    """What the largest of errors of `std` (m,) does not exceed in 95 % of cases, however they are correlated.

    The largest of estimates differs from the largest of true values by no more (the maximum norm is a norm).
    Source: Sidak, Journal of the American Statistical Association 62 (1967) 626.
    """
    each = COVERAGE ** (1 / std.size)
    return float(ndtri((1 + each) / 2) * std.max())
