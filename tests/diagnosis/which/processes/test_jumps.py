"""Jumps between two levels: told from a Gaussian process of the same spectrum, not seen in mere noise."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fogreduce.diagnosis.which.processes.jumps import Background, Record, jumps_add

Array = NDArray[np.float64]

RUNS, BLOCKS, STAY_S = 8, 300, 30.0


def _telegraph(rng: np.random.Generator) -> Array:
    """Two levels one apart, turned over at random."""
    turned = rng.random((RUNS, BLOCKS)) < 1.0 / STAY_S
    return np.asarray((np.cumsum(turned, axis=1) % 2) - 0.5)


def _gaussian(rng: np.random.Generator) -> Array:
    """Of the telegraph's covariance."""
    keep = np.exp(-2.0 / STAY_S)
    out = np.empty((RUNS, BLOCKS))
    now = 0.5 * rng.standard_normal(RUNS)
    for k in range(BLOCKS):
        now = keep * now + np.sqrt(1.0 - keep**2) * 0.5 * rng.standard_normal(RUNS)
        out[:, k] = now
    return out


def _added(process: Array, rng: np.random.Generator, weights: Array) -> float:
    values = 1.2 * process * weights[:, None] + rng.standard_normal(process.shape)
    seen = np.ones(values.shape, bool)
    seen[:, 7] = False
    values[:, 7] = 1e6  # what does not count may be anything
    backgrounds, lengths = [Background(1.0, 0.0, 0.0)] * len(values), np.ones(len(values))
    return jumps_add([Record(values, seen, weights, backgrounds, lengths)])[0]


def test_jumps_are_told_from_a_gaussian_process() -> None:
    rng = np.random.default_rng(1)
    even = np.ones(RUNS)
    assert _added(_telegraph(rng), rng, even) > 5.0
    assert _added(_gaussian(rng), rng, even) < -2.0


def test_jumps_that_go_with_the_reading() -> None:
    rng = np.random.default_rng(2)
    weights = np.array([1.0, -1.0, 1.0, -1.0, 1.0, -1.0, 0.1, 0.0])
    assert _added(_telegraph(rng), rng, weights) > 5.0


def test_noise_alone_has_no_jumps() -> None:
    rng = np.random.default_rng(3)
    assert abs(_added(np.zeros((RUNS, BLOCKS)), rng, np.ones(RUNS))) < 2.0


def test_background_of_a_covariance() -> None:
    lag = np.arange(100)
    found = Background.of(4.0 * (lag == 0) + 0.5 * np.exp(-lag / 10.0) + 9.0)
    assert np.isclose(found.sigma, 2.0, rtol=0.02)
    assert np.isclose(found.variance, 0.5, rtol=0.15)
    assert np.isclose(found.keep, np.exp(-1.0 / 10.0), atol=0.02)
