"""Noise coefficients of a gyro in the standard's units."""

from __future__ import annotations

import math

import numpy as np

from fogreduce.calibrate.derive import Derivation
from fogreduce.characterise.parity import residual_rates
from fogreduce.characterise.quantity import Quantity, normal, undetermined
from fogreduce.estimate.coloured import FLICKER_FLAT

_FEWEST = 30


def noise_quantities(found: Derivation, gyro: int) -> list[Quantity]:
    """Angle random walk; what needs long records is left to those."""
    of = f"gyro{gyro + 1}"
    return [
        _angle_random_walk(found, gyro, of),
        undetermined("bias_instability", of, "deg/h", "an hour or more at one rate (see `fogreduce plan`)"),
        undetermined("rate_random_walk", of, "deg/h/sqrt(h)", "several hours at one rate"),
    ]


def _angle_random_walk(found: Derivation, gyro: int, of: str) -> Quantity:
    """From differences of neighbouring bins, the flat of flicker taken away."""
    squares, count = 0.0, 0
    for one in found.readings:
        residual = residual_rates(one)[gyro]
        next_to = (np.diff(one.place) == 1) & (np.diff(one.segment) == 0)
        steps = np.diff(residual)[next_to & np.isfinite(np.diff(residual))]
        flicker = FLICKER_FLAT * found.noise[gyro].flicker_deg_h ** 2
        squares += float(np.sum(steps**2 / 2 - flicker)) * one.bin_s
        count += steps.size
    if count < _FEWEST or squares <= 0:
        return undetermined("angle_random_walk", of, "deg/sqrt(h)", f"{_FEWEST} s and more at one rate")
    value = math.sqrt(squares / count) / 60
    # The variance of the mean of squared differences of white noise is 3 sigma^4 / count.
    return normal("angle_random_walk", of, "deg/sqrt(h)", value, value * math.sqrt(3 / count) / 2)
