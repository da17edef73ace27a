"""Covariance of a gyro's block means under nominal noise, in closed form.

White noise, flicker and rate random walk by the contract's definitions; a run's turn-on bias, which is one
unknown constant a run and gyro, stands in it too.  Unit: (deg/h)^2.
"""

from functools import lru_cache

import numpy as np
from scipy.special import sici

from withheld.arrays import Array
from withheld.chain.noise import LOWEST_HZ


def flicker_lags(blocks: int, block_s: float) -> Array:
    """Autocovariance of block means of flicker of unit bias instability at lags 0 ... blocks-1, (blocks,).

    The variance of the integral over a time s is V(s) = s^2 / pi J(2 pi f s) with f the lowest frequency and
    J(y) = (1 - cos y) / y^2 + sin(y) / y - Ci(y), which is the density 1 / (pi f) integrated against
    sin^2(pi f s) / (pi f)^2; block means' covariance is its second difference.
    """
    s = np.arange(blocks + 1) * block_s
    y = 2 * np.pi * LOWEST_HZ * s[1:]
    v = np.concatenate([[0.0], s[1:] ** 2 / np.pi * ((1 - np.cos(y)) / y**2 + np.sin(y) / y - sici(y)[1])])
    before = np.concatenate([[v[1]], v[:-2]])
    result: Array = (v[1:] - 2.0 * v[:-1] + before) / (2.0 * block_s**2)
    return result


def walk(blocks: int, block_s: float) -> Array:
    """Covariance of block means of a rate random walk of K = 1 deg/h/sqrt(h) from 0, (blocks, blocks)."""
    hours = block_s / 3600.0
    start = np.arange(blocks) * hours
    covariance = np.minimum.outer(start, start) + hours / 2.0
    np.fill_diagonal(covariance, start + hours / 3.0)
    result: Array = covariance
    return result


@lru_cache(maxsize=64)
def block_covariance(
    blocks: int, block_s: float, arw: float, instability: float, rrw: float, turn_on: float
) -> Array:
    """(blocks, blocks) for one gyro and run; arguments in the calibration record's units."""
    covariance = np.eye(blocks) * arw**2 * 3600.0 / block_s + turn_on**2
    lags = flicker_lags(blocks, block_s)
    index = np.arange(blocks)
    covariance = covariance + instability**2 * lags[np.abs(index[:, None] - index)]
    covariance = covariance + rrw**2 * walk(blocks, block_s)
    covariance.setflags(write=False)
    result: Array = covariance
    return result


@lru_cache(maxsize=64)
def whitening(
    blocks: int, block_s: float, arw: float, instability: float, rrw: float, turn_on: float
) -> Array:
    """The inverse of the covariance's Cholesky factor, (blocks, blocks)."""
    factor = np.linalg.cholesky(block_covariance(blocks, block_s, arw, instability, rrw, turn_on))
    inverse = np.linalg.inv(factor)
    inverse.setflags(write=False)
    return inverse
