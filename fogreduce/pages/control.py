"""Control charts of single runs: a centre line, and limits by each run's own error and what all scatter.

Runs differ in length, so their errors do. Run k has the standard deviation sqrt(s_k^2 + t^2): s_k is the
standard error of its own noise, t what the runs scatter beyond that (a bias that is another at each turn-on,
say), the same for all. The centre is the median of the runs. t is taken from moving ranges, the differences
between one run and the next, as in Shewhart's chart of individuals (ISO 7870-2), by their median, so that
neither one strange run nor a slow change of level widens the limits: it is such that the median moving range,
each value in units of its own standard deviation, is that of independent normal values, 0.6745 sqrt(2).
Limits: centre +- 3 standard deviations.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

#: Below so many runs there is a centre and no limits.
FEWEST_RUNS = 8
#: The level has moved where more in a row lie on one side of the centre than chance gives so often.
_CHANCE = 0.01
WIDTH = 3.0
#: Median of |u - v|, u and v standard normal.
_MEDIAN_RANGE = 0.6744897501960817 * 2**0.5
_HALVINGS = 60


@dataclass(frozen=True)
class Control:
    """A control chart's numbers, in the unit of its values.

    Attributes
    ----------
    centre : float
    extra : float or None
        Scatter of the runs beyond their own errors, t; None: too few runs.
    limits : list of (low, high) or None
        Of each run.
    out : tuple of int
        Runs outside their limits.
    longest : int
        Most runs in a row on one side of the centre.
    moved : bool
        Whether so long a row is more than chance would give.
    """

    centre: float
    extra: float | None
    limits: list[tuple[float, float]] | None
    out: tuple[int, ...]
    longest: int
    moved: bool


def control(values: Sequence[float], errors: Sequence[float]) -> Control:
    """The control chart of runs in the order of time.

    Parameters
    ----------
    values, errors : sequence of float
        Of each run, and the standard error of its own noise (0: not known); at least one.
    """
    x, s = np.array(values, float), np.array(errors, float)
    centre = float(np.median(x))
    longest = _longest_row(x > centre, x < centre)
    if x.size < FEWEST_RUNS:
        return Control(centre, None, None, (), longest, False)
    extra = _extra(x - centre, s)
    half = WIDTH * np.sqrt(s**2 + extra**2)
    out = np.flatnonzero(np.abs(x - centre) > half)
    limits = list(zip((centre - half).tolist(), (centre + half).tolist(), strict=True))
    # A row of L begins at a given run by chance with probability 2^-L.
    moved = x.size * 2.0**-longest < _CHANCE
    return Control(centre, extra, limits, tuple(out.tolist()), longest, moved)


def _extra(x: Array, s: Array) -> float:
    """The scatter t by halving the interval; 0 where the errors alone explain the moving ranges."""

    def too_small(t: float) -> bool:
        deviation = np.sqrt(s**2 + t**2)
        # Errors next to nothing make values endlessly far; two of those are not known to be near each other.
        with np.errstate(over="ignore", invalid="ignore"):
            counted = np.divide(x, deviation, out=np.zeros_like(x), where=deviation > 0)
            counted[(deviation == 0) & (x != 0)] = np.inf
            ranges = np.nan_to_num(np.abs(np.diff(counted)), nan=np.inf, posinf=np.inf)
        return bool(np.median(ranges) > _MEDIAN_RANGE)

    if not too_small(0.0):
        return 0.0
    low, high = 0.0, 4.0 * float(np.max(np.abs(x)))
    for _ in range(_HALVINGS):
        middle = (low + high) / 2
        low, high = (middle, high) if too_small(middle) else (low, middle)
    return high


def _longest_row(*sides: NDArray[np.bool_]) -> int:
    """Most neighbours that are true, on any side."""
    longest = 0
    for side in sides:
        now = 0
        for true in side.tolist():
            now = now + 1 if true else 0
            longest = max(longest, now)
    return longest
