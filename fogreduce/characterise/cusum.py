"""CUSUM detectors of a change of level and of a change of scatter, with false alarms as asked for.

The level: each value less the mean of those before it, over the standard deviation of that difference, is a
unit normal independent of all others as long as nothing changes (a self-starting CUSUM, Hawkins and Olwell,
Cumulative Sum Charts (1998), chapter 7). So no value need be known beforehand, and the theory of
`fogreduce.characterise.run_length` holds to the letter.

The scatter: log likelihood ratio of a chi-square, a given multiple of the usual variance against the usual
one, which is the median of the record where nothing changed.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fogreduce.characterise.run_length import scatter_gain, scatter_limit

Array = NDArray[np.float64]

_ROUNDS = 3  # of the usual scatter, the changed parts left out


@dataclass(frozen=True)
class Change:
    """A change that a detector found: from sample `start` on, noticed at `alarm`, of size `size`."""

    start: int
    alarm: int
    size: float


def level_changes(values: Array, sigma: Array, limit: float, allowance: float) -> list[Change]:
    """Changes of level.

    Parameters
    ----------
    values : (m,) array
    sigma : (m,) array
        Standard deviation of each.
    limit, allowance : float
        h and k, in standard deviations.
    """
    found: list[Change] = []
    weight = 1.0 / sigma**2
    total = information = 0.0
    up = down = 0.0
    up_from = down_from = k = 0
    while k < values.size:
        if information > 0:
            off = (values[k] - total / information) / math.sqrt(1 / weight[k] + 1 / information)
            if up == 0:
                up_from = k
            if down == 0:
                down_from = k
            up, down = max(0.0, up + off - allowance), max(0.0, down - off - allowance)
            if max(up, down) > limit:
                start = up_from if up > down else down_from
                after = slice(start, k + 1)
                size = float(np.average(values[after], weights=weight[after])) - _mean(
                    values, weight, start, found
                )
                found.append(Change(start, k, size))
                # The new level is learnt afresh: what led to the alarm is no fair sample of it.
                total = information = up = down = 0.0
                k += 1
                continue
        total += values[k] * weight[k]
        information += weight[k]
        k += 1
    return found


def _mean(values: Array, weight: Array, stop: int, found: list[Change]) -> float:
    """Mean from the last change up to `stop`."""
    before = slice(found[-1].start if found else 0, stop)
    return float(np.average(values[before], weights=weight[before]))


def scatter_changes(
    variance: Array, freedom: Array, wanted: Sequence[float], samples: float
) -> list[list[Change]]:
    """Changes of scatter to about `wanted` times the usual variance, the median of what is unchanged.

    Parameters
    ----------
    variance : (m,) array
        Sample variances.
    freedom : (m,) array
        Their degrees of freedom.
    wanted : sequence of float
        Above 1 for a burst, below for a gyro that goes quiet; each is a detector by itself.
    samples : float
        Between false alarms of each.

    Returns
    -------
    list of Change for each of `wanted`
    """
    limits = [scatter_limit(samples, float(np.median(freedom)), each) for each in wanted]
    # The median of a chi-square over its degrees of freedom k: (1 - 2 / (9 k))^3.
    centred = variance / (1 - 2 / (9 * freedom)) ** 3
    found: list[list[Change]] = [[] for _ in wanted]
    for _ in range(_ROUNDS):
        for k, each in enumerate(wanted):
            unchanged = _unchanged(found, variance.size)
            usual = float(np.median(centred[unchanged])) if unchanged.any() else 0.0
            if usual <= 0:
                return [[] for _ in wanted]
            found[k] = _scatter_alarms(variance / usual, freedom, each, limits[k])
    return [_joined(changes) for changes in found]


def _unchanged(found: list[list[Change]], size: int) -> NDArray[np.bool_]:
    unchanged = np.ones(size, bool)
    for changes in found:
        for one in changes:
            unchanged[one.start : one.alarm + 1] = False
    return unchanged


def _scatter_alarms(ratio: Array, freedom: Array, wanted: float, limit: float) -> list[Change]:
    total, start = 0.0, 0
    found: list[Change] = []
    for k, gain in enumerate(scatter_gain(ratio, freedom, wanted).tolist()):
        if total == 0:
            start = k
        total = max(0.0, total + gain)
        if total > limit:
            found.append(Change(start, k, float(np.mean(ratio[start : k + 1]))))
            total = 0.0
    return found


def _joined(found: list[Change]) -> list[Change]:
    """Alarms that follow each other without a pause are one change."""
    out: list[Change] = []
    end = -2
    for one in found:
        if one.start > end + 1:
            out.append(one)
        end = one.alarm
    return out
