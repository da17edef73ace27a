"""Noise coefficients of a gyro in the standard's units."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from fogreduce.calibrate.derive import Derivation
from fogreduce.calibrate.noise import steps_between
from fogreduce.calibrate.readings import residual_rates
from fogreduce.characterise.allan_channel import channel_of
from fogreduce.characterise.allan_fit import NOISES, Coefficient
from fogreduce.characterise.quantity import K95, Quantity, normal, undetermined
from fogreduce.characterise.stretch import Stretch, longest_stretch
from fogreduce.estimate.coloured import FLICKER_FLAT

Array = NDArray[np.float64]

_FEWEST = 30
#: Bins of a stretch at one rate from which on an Allan fit tells flicker and walk from white noise.
_FEWEST_IN_FIT = 256
_COEFFICIENTS = {
    "Q": ("quantization", "minutes at one rate"),
    "B": (
        "bias_instability",
        "an hour or more at one rate, longer than bins of white noise take to average below it",
    ),
    "K": ("rate_random_walk", "several hours at one rate"),
    "R": ("rate_ramp", "several hours at one rate"),
}


def noise_quantities(found: Derivation, gyro: int) -> list[Quantity]:
    """Angle random walk from all runs; Q, B, K and R from the longest stretch at one rate."""
    of = f"gyro{gyro + 1}"
    return [_angle_random_walk(found, gyro, of), *_of_allan(found, gyro, of)]


def _angle_random_walk(found: Derivation, gyro: int, of: str) -> Quantity:
    """From differences of neighbouring bins, the flat of flicker taken away."""
    squares, count = 0.0, 0
    for one in found.readings:
        steps = steps_between(one, residual_rates(one)[gyro])
        flicker = FLICKER_FLAT * found.noise[gyro].flicker_deg_h ** 2
        squares += float(np.sum(steps**2 / 2 - flicker)) * one.bin_s
        count += steps.size
    if count < _FEWEST or squares <= 0:
        return undetermined("angle_random_walk", of, "deg/sqrt(h)", f"{_FEWEST} s and more at one rate")
    value = math.sqrt(squares / count) / 60
    # The variance of the mean of squared differences of white noise is 3 sigma^4 / count.
    return normal("angle_random_walk", of, "deg/sqrt(h)", value, value * math.sqrt(3 / count) / 2)


def _of_allan(found: Derivation, gyro: int, of: str) -> list[Quantity]:
    """Of the Allan deviation of the longest stretch at one rate; bounded where the fit does not see them."""
    stretch = longest_stretch(found, gyro)
    channel = None
    if stretch is not None and np.count_nonzero(np.isfinite(stretch.values)) >= _FEWEST_IN_FIT:
        channel = channel_of(of, stretch.values, stretch.bin_s, ("overlapping",), (1,), density=False)
    quantities = []
    for symbol, (name, needs) in _COEFFICIENTS.items():
        unit = next(noise.unit for noise in NOISES if noise.symbol == symbol)
        if stretch is None or channel is None or not channel.coefficients:
            quantities.append(undetermined(name, of, unit, needs))
        else:
            quantities.append(_coefficient(channel.coefficient(symbol), name, of, stretch))
    return quantities


def _coefficient(one: Coefficient, name: str, of: str, stretch: Stretch) -> Quantity:
    """Its interval is that of its square, which is linear in the variances; 0 where it is not seen."""
    half = K95 * one.square_error
    low, high = (math.sqrt(max(0.0, one.square + side)) for side in (-half, half))
    note = f"run {stretch.run}, {stretch.duration_s:.0f} s"
    if low > 0:
        return Quantity(name, of, one.noise.unit, one.value, low, high, note=note)
    high = math.sqrt(max(0.0, one.square) + half)
    return Quantity(name, of, one.noise.unit, 0.0, 0.0, high, note=f"{note}: not seen, a bound")
