"""A capture from mean curves that were published where its raw data were not.

Each gyro's raw volts are ``a + b sin(c t + d) + e t`` (the paper's eq. 7) plus white noise, with missing
answers, spurious counts and unstable intervals as the curves file states them.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from fogreduce.constants import MICROSECONDS_PER_SECOND, MISSING_COUNT
from fogreduce.metadata.curves import Curves
from fogreduce.metadata.facts import RunFacts
from fogreduce.physics.noise import BLOCK
from fogreduce.physics.quantization import counts_from_raw
from fogreduce.simulate.forward import SimulatedBlock
from fogreduce.simulate.streams import stream

Array = NDArray[np.float64]


def curve_volts(curves: Curves, time_s: Array) -> Array:
    """The mean curves at times [s]: (n, N) [V]."""
    a, b, c, d, e = (
        np.array(values)[:, None]
        for values in (curves.a_V, curves.b_V, curves.c_rad_s, curves.d_rad, curves.e_V_s)
    )
    volts: Array = a + b * np.sin(c * time_s + d) + e * time_s
    return volts


def noise_factors(curves: Curves, time_s: Array) -> Array:
    """A gyro's noise relative to that of its quiet stretches, (n, N)."""
    factors = np.ones((curves.n, len(time_s)))
    for interval in curves.unstable:
        inside = (time_s >= interval.start_s) & (time_s < interval.end_s)
        for gyro in interval.gyros:
            factors[gyro - 1, inside] *= interval.noise_factor
    return factors


def quiet_sigma(curves: Curves, duration_s: float) -> Array:
    """Noise outside the unstable intervals [V], (n,): the whole record's mean square is then sigma_V^2."""
    edges = {0.0, duration_s}
    edges |= {t for k in curves.unstable for t in (k.start_s, k.end_s) if 0.0 < t < duration_s}
    times = np.array(sorted(edges))
    mean_square = noise_factors(curves, times[:-1]) ** 2 @ np.diff(times) / duration_s
    return np.array(curves.sigma_V) / np.sqrt(mean_square)


def blocks_from_curves(curves: Curves, facts: RunFacts, *, noise: bool = True) -> Iterator[SimulatedBlock]:
    """The capture in blocks; `noise` False leaves curves, rounding and nothing else."""
    sigma = quiet_sigma(curves, facts.profile.end_s)[:, None]
    names = [f"gyro{i + 1}" for i in range(curves.n)]
    white = [stream(curves.seed, "curves", facts.run_id, name, "white") for name in names]
    link = [stream(curves.seed, "curves", facts.run_id, name, "link") for name in names]
    for start in range(0, facts.n_expected, BLOCK):
        pulse = np.arange(start, min(start + BLOCK, facts.n_expected))
        time_s = pulse / facts.sample_rate_hz
        volts = curve_volts(curves, time_s)
        if noise:
            unit = np.array([generator.standard_normal(len(pulse)) for generator in white])
            volts += sigma * noise_factors(curves, time_s) * unit
        counts = counts_from_raw(volts, facts.least_count)
        if noise:
            for row, generator in zip(counts, link, strict=True):
                _spoil(row, generator, curves)
        time_us = np.rint(time_s * MICROSECONDS_PER_SECOND).astype(np.int64)
        yield SimulatedBlock(time_us, pulse, counts)


def _spoil(counts: NDArray[np.int32], generator: np.random.Generator, curves: Curves) -> None:
    """Put spurious counts, uniform over +-2^30, and missing answers into one gyro's fresh counts."""
    spurious = generator.random(len(counts)) < curves.spurious_fraction
    counts[spurious] = generator.integers(-(2**30), 2**30, int(spurious.sum()), dtype=np.int32, endpoint=True)
    counts[generator.random(len(counts)) < curves.missing_fraction] = MISSING_COUNT
