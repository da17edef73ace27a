"""Whittle's likelihood of averaged powers, ``ln L = -K (ln S + P / S)`` in every line, its level free."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def level_profile(mean_ratio: Array, weight: float, spreads: Array) -> Array:
    """Ln evidence, over that of the best level, of levels spread normally about the record's.

    `mean_ratio`: power found over power expected; `weight`: how many exponential deviates it is the mean of;
    `spreads`: standard deviations of ln level, each a hypothesis (..., len(spreads)).
    """
    found = 0.5 * np.log(np.maximum(mean_ratio, 1e-12))[..., None]
    error = 0.5 / np.sqrt(weight)
    width2 = spreads**2 + error**2
    result: Array = -0.5 * found**2 / width2 - 0.5 * np.log(width2 / error**2)
    return result


def mean_ratio(ratio: Array, pieces: Array) -> Array:
    """Means of ratios (..., F), each line with the weight of its pieces (F,)."""
    result: Array = (ratio @ pieces) / pieces.sum()
    return result


def peak(grid: Array, logs: Array) -> tuple[float, float]:
    """Where ln likelihood is highest, and its width, from a parabola in ln grid."""
    k = int(np.clip(np.argmax(logs), 1, len(grid) - 2))
    x = np.log(grid[k - 1 : k + 2])
    a, b, _ = np.polyfit(x - x[1], logs[k - 1 : k + 2] - logs[k], 2)
    if a >= 0.0:
        return float(grid[int(np.argmax(logs))]), float(grid[k])
    shift = float(np.clip(-b / (2.0 * a), x[0] - x[1], x[2] - x[1]))
    value = float(np.exp(x[1] + shift))
    return value, value / np.sqrt(-2.0 * a)
