"""The longest stretch at one rate of a campaign: what a gyro reads in it beyond motion and Earth's wave."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fogreduce.calibrate.derive import Derivation
from fogreduce.calibrate.readings import Readings, residual_rates

Array = NDArray[np.float64]

#: Turn from which on Earth's wave is fitted: below, it is no more than a slope and a bend [rad].
_LEAST_TURN = np.pi


@dataclass(frozen=True)
class Stretch:
    """A gyro over a stretch.

    Attributes
    ----------
    run : str
    bin_s : float
    values : (m,) array
        At equal intervals of a bin, NaN where there is none [deg/h].
    fitted : int
        Parameters of the wave that were fitted to them.
    """

    run: str
    bin_s: float
    values: Array
    fitted: int

    @property
    def duration_s(self) -> float:
        """Length of it."""
        return self.values.size * self.bin_s


def longest_stretch(found: Derivation, gyro: int) -> Stretch | None:
    """The longest one in which the gyro answers; None where it never does.

    An axis that is off by a milliradian leaves 0.015 deg/h of Earth's rate, as a wave of the turn: it is
    none of the gyro's noise and is fitted and taken away, of turns by half a circle and more.
    """
    best: tuple[Readings, NDArray[np.bool_]] | None = None
    longest = 0.0
    for one in found.readings:
        there = np.isfinite(one.raw[gyro])
        for k in np.unique(one.segment[there]):
            inside = there & (one.segment == k)
            place = one.place[inside]
            duration = float(place[-1] - place[0] + 1) * one.bin_s
            if duration > longest:
                longest, best = duration, (one, inside)
    if best is None:
        return None
    one, inside = best
    values = residual_rates(one)[gyro, inside]
    wave, fitted = _wave(one.facts.profile.angle_at(one.time_s[inside]), values)
    place = one.place[inside] - int(one.place[inside][0])
    series = np.full(int(place[-1]) + 1, np.nan)
    series[place] = values - wave
    return Stretch(one.facts.run_id, one.bin_s, series, fitted)


def _wave(alpha_rad: Array, values: Array) -> tuple[Array, int]:
    """The wave in the table's angle, and how many parameters it took."""
    columns = np.column_stack((np.ones(alpha_rad.size), np.cos(alpha_rad), np.sin(alpha_rad)))
    if np.ptp(alpha_rad) < _LEAST_TURN or values.size < 2 * columns.shape[1]:
        return np.zeros(values.size), 0
    solved, *_ = np.linalg.lstsq(columns, values, rcond=None)
    return columns[:, 1:] @ solved[1:], 2
