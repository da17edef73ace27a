"""What a solution leaves of the readings: by run over time, by segment over the rate about the input axis.

In the first the turn-on bias of each run is taken out; in the second it is not, since of a run of one rate
it would take everything along.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fogreduce.calibrate.equations import DEPARTURE, MOTION, READING, SHAPE, SHAPES, columns
from fogreduce.calibrate.noise import GyroNoise
from fogreduce.calibrate.readings import Readings
from fogreduce.calibrate.solution import Solution
from fogreduce.calibrate.turn_on import TurnOn

Array = NDArray[np.float64]

#: Means of a run over time: enough to see a drift or a step.
BLOCKS = 30


@dataclass(frozen=True)
class Residual:
    """A mean of what is left of one gyro's readings.

    Attributes
    ----------
    run, gyro : int
    rate_deg_s : float
        Mean rate about the gyro's input axis.
    deg_h, std_deg_h : float
        Mean, and its standard error by white noise alone (over time), or by white noise and
        turn-on bias (by segment).
    """

    run: int
    gyro: int
    rate_deg_s: float
    deg_h: float
    std_deg_h: float


def left_of(one: Readings, run: int, gyro: int, solution: Solution) -> Array:
    """What a solution leaves of each bin with a reading [deg/h]; turn-on biases are not taken out."""
    layout = solution.layout
    at = columns(one, gyro, np.isfinite(one.raw[gyro]))
    start, vector, change = layout.gyro(gyro).start, layout.vector(gyro), solution.change
    # by azimuth, latitude, table rate
    departures = at[:, DEPARTURE].reshape(len(at), 3, 3) @ solution.values[vector]
    left: Array = at[:, READING] - change[start] - at[:, MOTION] @ change[vector]
    left -= departures @ change[layout.motion(run)]
    for k, shape in enumerate(layout.shapes):
        left -= change[start + 4 + k] * at[:, SHAPE.start + SHAPES.index(shape)]
    return left


def over_time(
    readings: Sequence[Readings], noise: Sequence[GyroNoise], solution: Solution, turn_on: Sequence[TurnOn]
) -> list[Residual]:
    """Means over blocks of each run, the run's turn-on bias taken out; gyro after gyro, in order of time."""
    bias = {(one.run, one.gyro): one.deg_h for one in turn_on}
    found = []
    for gyro in range(solution.layout.gyros):
        for run, one in enumerate(readings):
            if (run, gyro) not in bias:
                continue
            left = left_of(one, run, gyro, solution) - bias[run, gyro]
            rate = _rate(one, gyro)[np.isfinite(one.raw[gyro])]
            for block in np.array_split(np.arange(left.size), min(BLOCKS, left.size)):
                std = _white(one, noise[gyro], block.size)
                found.append(Residual(run, gyro, float(rate[block].mean()), float(left[block].mean()), std))
    return found


def by_rate(readings: Sequence[Readings], noise: Sequence[GyroNoise], solution: Solution) -> list[Residual]:
    """Means over the segments of each run, in order of the rate about each gyro's input axis."""
    found = []
    for run, one in enumerate(readings):
        for gyro in range(solution.layout.gyros):
            there = np.isfinite(one.raw[gyro])
            if np.count_nonzero(there) < 2:
                continue
            left = left_of(one, run, gyro, solution)
            rate, segment = _rate(one, gyro)[there], one.segment[there]
            for k in np.unique(segment):
                inside = segment == k
                white = _white(one, noise[gyro], int(np.count_nonzero(inside)))
                std = float(np.hypot(white, solution.turn_on_deg_h[gyro]))
                found.append(Residual(run, gyro, float(rate[inside].mean()), float(left[inside].mean()), std))
    return sorted(found, key=lambda one: (one.gyro, one.rate_deg_s))


def _rate(one: Readings, gyro: int) -> Array:
    """About the gyro's input axis by the present record [deg/s]."""
    axis = one.facts.axes[gyro]
    return axis @ one.motion / np.linalg.norm(axis)


def _white(one: Readings, noise: GyroNoise, bins: int) -> float:
    """Standard error of a mean over bins by white noise [deg/h]: 60 N / sqrt(time)."""
    return float(60 * noise.white_deg_sqrt_h / np.sqrt(bins * one.bin_s))
