"""The scatter of values between groups (runs, days) apart from the noise of each: its estimate and interval.

With Q(t) the weighted sum of squares about the fit, each group's variance t^2 plus its noise's, Q(t) is
chi-square distributed where t is the true scatter. The estimate solves Q(t) = degrees of freedom (Paule and
Mandel, J. Res. NBS 87 (1982) 377); the interval takes the t between chi-square's quantiles, and holds the
true one with its probability exactly (Viechtbauer, Statistics in Medicine 26 (2007) 37).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eigh
from scipy.special import chdtri

from fogreduce.calibrate.equations import MOTION, ONE, READING, SHAPE, SHAPES, Product
from fogreduce.characterise.quantity import COVERAGE

Array = NDArray[np.float64]

_RANK = 1e-10  # of scaled information, below which a direction is none
_MORE = 0.5  # share of what is known of s that comes from steps within runs
_STEPS = 80


@dataclass(frozen=True)
class Spread:
    """Scatter between groups: value and 95 % interval, degrees of freedom."""

    value: float
    low: float
    high: float
    freedom: int


def spread_of_values(values: Sequence[float], std: Sequence[float]) -> Spread | None:
    """Scatter of values beyond their standard deviations; None for fewer than three."""
    value, variance = np.asarray(values, float), np.asarray(std, float) ** 2

    def squares(scatter: float) -> float:
        weight = 1 / (variance + scatter**2)
        return float(weight @ (value - weight @ value / weight.sum()) ** 2)

    return _profile(squares, value.size - 1, float(np.ptp(value)) if value.size else 0.0)


def spread_of_runs(
    products: Sequence[Product], gyro: int, change: Array, shapes: Sequence[str] = ()
) -> Spread | None:
    """Scatter of a gyro's bias between runs; None where fewer than two degrees of freedom are left.

    Parameters
    ----------
    products : sequence of Product
    gyro : int
    change : (4,) array
        B [deg/h] and s [deg/h per deg/s] of the solution, less the present record's: what is looked at is
        what differs from the solution.
    shapes : sequence of str
        Departures of `fogreduce.calibrate.equations.SHAPES` that are fitted as well: a bias that follows
        attitude or sense does not scatter.
    """
    grams = [about_solution(one.gram, change, shapes) for one in products if one.gyro == gyro]
    if len(grams) < 3:
        return None
    ones = np.array([gram[0, 0] for gram in grams])
    columns = np.array([gram[0, :-1] / gram[0, 0] for gram in grams])
    means = np.array([gram[0, -1] / gram[0, 0] for gram in grams])
    information, right, square, rank_within = _within(grams, ones, columns)

    def left(weight: Array) -> tuple[float, int]:
        total = information + (columns.T * weight) @ columns
        aim = right + (columns.T * weight) @ means
        inverse, rank = _inverse(total)
        return float(square + weight @ means**2 - aim @ inverse @ aim), rank

    freedom = len(grams) + rank_within - left(ones)[1]
    return _profile(lambda scatter: left(1 / (1 / ones + scatter**2))[0], freedom, float(np.ptp(means)))


def _within(grams: Sequence[Array], ones: Array, columns: Array) -> tuple[Array, Array, float, int]:
    """What the steps within runs say of s, apart from the runs' means: information, right side, square, rank.

    Only in directions in which they say more than the means between runs do: elsewhere their noise would
    hide the scatter.
    """
    size = len(grams[0]) - 2
    within, right = np.zeros((size, size)), np.zeros(size)
    for gram in grams:
        within += gram[1:-1, 1:-1] - np.outer(gram[0, 1:-1], gram[0, 1:-1]) / gram[0, 0]
        right += gram[1:-1, -1] - gram[0, 1:-1] * gram[0, -1] / gram[0, 0]
    about = columns[:, 1:] - ones @ columns[:, 1:] / ones.sum()
    both = within + (about.T * ones) @ about
    both += np.diag(_RANK * np.diag(both) + 1e-300)
    share, vector = eigh(within, both)
    kept = share > _MORE
    back = both @ vector[:, kept]
    aims = vector[:, kept].T @ right
    information, whole = np.zeros((size + 1, size + 1)), np.zeros(size + 1)
    information[1:, 1:] = (back * share[kept]) @ back.T
    whole[1:] = back @ aims
    return information, whole, float(np.sum(aims**2 / share[kept])), int(kept.sum())


def about_solution(gram: Array, change: Array, shapes: Sequence[str] = ()) -> Array:
    """(5 + k, 5 + k): products of (1, Omega, k shapes, reading less what the solution makes of it).

    `gram`: of a `Product`; `change` (4,): as of `spread_of_runs`.
    """
    to = np.zeros((len(gram), 5 + len(shapes)))
    to[ONE, 0] = 1.0
    to[MOTION, 1:4] = np.eye(3)
    for k, shape in enumerate(shapes):
        to[SHAPE.start + SHAPES.index(shape), 4 + k] = 1.0
    to[READING, -1] = 1.0
    to[ONE, -1] = -change[0]
    to[MOTION, -1] = -change[1:]
    found: Array = to.T @ gram @ to
    return found


def _inverse(information: Array) -> tuple[Array, int]:
    """Pseudo-inverse and rank of a symmetric matrix, its unknowns scaled alike."""
    scale = np.sqrt(np.maximum(np.diag(information), 1e-300))
    value, vector = np.linalg.eigh(information / np.outer(scale, scale))
    good = value > _RANK
    inverse = (vector[:, good] / value[good]) @ vector[:, good].T / np.outer(scale, scale)
    return inverse, int(good.sum())


def _profile(squares: Callable[[float], float], freedom: int, widest: float) -> Spread | None:
    if freedom < 2:
        return None
    tail = (1 - COVERAGE) / 2
    low, high = (float(chdtri(freedom, part)) for part in (tail, 1 - tail))
    # Values that happen to scatter less than their errors do not say that there is no scatter: the upper end
    # is then that of values which scatter as their errors do.
    high *= min(1.0, squares(0.0) / freedom)
    top = 100 * max(widest, 1e-12)
    return Spread(
        _root(squares, float(freedom), top), _root(squares, low, top), _root(squares, high, top), freedom
    )


def _root(squares: Callable[[float], float], wanted: float, top: float) -> float:
    """The scatter at which the sum of squares, which falls with it, is what is wanted; 0 below."""
    if squares(0.0) <= wanted:
        return 0.0
    low, high = math.log(top) - 40, math.log(top)
    for _ in range(_STEPS):
        middle = (low + high) / 2
        if squares(math.exp(middle)) > wanted:
            low = middle
        else:
            high = middle
    return math.exp((low + high) / 2)
