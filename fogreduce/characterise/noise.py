"""Noise coefficients of a gyro in the standard's units."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from fogreduce.calibrate.derive import Derivation
from fogreduce.characterise.allan import channel_of
from fogreduce.characterise.parity import residual_rates
from fogreduce.characterise.quantity import Quantity, normal, undetermined
from fogreduce.estimate.coloured import FLICKER_FLAT

Array = NDArray[np.float64]

_FEWEST = 30
#: Bins of a stretch at one rate from which on an Allan fit tells flicker and walk from white noise.
_FEWEST_IN_FIT = 256
_COEFFICIENTS = (
    ("bias_instability", "B", "deg/h", "an hour or more at one rate, longer than bins of white noise take to"
     " average below it"),
    ("rate_random_walk", "K", "deg/h/sqrt(h)", "several hours at one rate"),
)  # fmt: skip


def noise_quantities(found: Derivation, gyro: int) -> list[Quantity]:
    """Angle random walk from all runs; bias instability and rate random walk from the longest."""
    of = f"gyro{gyro + 1}"
    return [_angle_random_walk(found, gyro, of), *_of_allan(found, gyro, of)]


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


def _of_allan(found: Derivation, gyro: int, of: str) -> list[Quantity]:
    """Of the Allan deviation of the longest stretch at one rate; stated where the fit finds them there."""
    best: tuple[Array, float, str] | None = None
    for one in found.readings:
        residual = residual_rates(one)[gyro]
        for k in np.unique(one.segment):
            inside = one.segment == k
            place = one.place[inside] - one.place[inside][0]
            series = np.full(int(place[-1]) + 1, np.nan)
            series[place] = residual[inside]
            if best is None or series.size * one.bin_s > best[0].size * best[1]:
                best = series, one.bin_s, one.facts.run_id
    assert best is not None
    series, bin_s, run = best
    channel = None
    if np.count_nonzero(np.isfinite(series)) >= _FEWEST_IN_FIT:
        channel = channel_of(of, series, bin_s, ("overlapping",), None, "NBK")
    quantities = []
    for name, symbol, unit, needs in _COEFFICIENTS:
        coefficient = None if channel is None else channel.coefficient(symbol)
        if coefficient is None or not coefficient.significant:
            limit = "" if coefficient is None else f" (run {run}: {coefficient.upper_95:.2g} at most)"
            quantities.append(undetermined(name, of, unit, needs + limit))
        else:
            quantities.append(normal(name, of, unit, coefficient.value, coefficient.error, f"run {run}"))
    return quantities
