"""Whether a gyro jumps between two levels: what that says beyond the spectrum, which it shares with others.

A telegraph of two levels a apart, left at random after a mean time T, has the covariance of a Gaussian
process of variance a^2 / 4 that forgets within T / 2. Both are held against the same block means, beside
white noise, a drift and an unknown constant in each run; the ratio of their likelihoods, averaged over one
grid of a and T, is what the jumps add to the evidence of the spectrum.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fogreduce.gap.evidence import log_mean_exp

Array = NDArray[np.float64]

_STAYS_S = np.array([10.0, 20.0, 40.0, 80.0])
_SIZES = np.array([0.65, 0.9, 1.2, 1.6])  # of the level difference that the variance found asks for
_CONSTANTS = np.linspace(-1.0, 1.0, 11)  # in units of that difference, spread about 0 by half of it
_LIKELY = np.log(np.exp(-2.0 * _CONSTANTS**2) / np.exp(-2.0 * _CONSTANTS**2).sum())


@dataclass(frozen=True)
class Background:
    """What block means of one gyro hold when nothing is wrong, beside a constant in each run.

    Attributes
    ----------
    sigma : float
        White noise of a block [deg/h].
    variance, keep : float
        Of a drift [(deg/h)^2], and its correlation from one block to the next.
    """

    sigma: float
    variance: float
    keep: float

    @classmethod
    def of(cls, covariance: Array) -> Background:
        """From the covariance (blocks, blocks) of one run."""
        row = len(covariance) // 2
        lags = covariance[row, row + 1 :]
        if len(lags) < 2:
            return cls(float(np.sqrt(covariance[row, row])), 0.0, 0.0)
        over = lags - lags[-1]
        variance = max(float(over[0]), 0.0)
        length = float(over.sum()) / variance if variance > 0.0 else 1.0
        white = max(float(covariance[row, row] - lags[0]), 1e-12 * float(covariance[row, row]))
        return cls(float(np.sqrt(white)), variance, float(np.exp(-1.0 / max(length, 1.0))))


def jumps_add(
    values: Array, seen: NDArray[np.bool_], length_s: float, weights: Array, background: Background
) -> float:
    """Ln likelihood ratio of a telegraph over a Gaussian process of the same covariance.

    Parameters
    ----------
    values : (R, T) array
        Block means of each run [deg/h].
    seen : (R, T) array of bool
        Which of them count.
    length_s : float
        Of a block [s].
    weights : (R,) array
        What a level difference of 1 is in each run: 1, or the reading for a scale factor that jumps.
    background : Background
    """
    count = np.maximum(seen.sum(axis=1, keepdims=True), 1)
    y = np.where(seen, values - np.sum(np.where(seen, values, 0.0), axis=1, keepdims=True) / count, 0.0)
    usual = background.sigma**2 + background.variance
    excess = np.sum(np.where(seen, y**2 - usual, 0.0)) / max(np.sum(seen * weights[:, None] ** 2), 1e-300)
    size = 2.0 * np.sqrt(max(float(excess), 0.0))
    if size == 0.0:
        return 0.0
    grid = [(stay, size * share) for stay in _STAYS_S.tolist() for share in _SIZES.tolist()]
    stays, sizes = np.array(grid).T
    step = np.abs(np.outer(weights, sizes))  # (R, G)
    moved = step.max(axis=1) > 0.1 * background.sigma
    y, seen, step = y[moved], seen[moved], step[moved]
    stay = 0.5 * (1.0 + np.exp(-2.0 * length_s / stays))
    telegraph = _telegraph(y, seen, step, stay, background).sum(axis=0)
    smooth = _gaussian(y, seen, step, 2.0 * stay - 1.0, background).sum(axis=0)
    return float(log_mean_exp(telegraph) - log_mean_exp(smooth))


def _telegraph(y: Array, seen: NDArray[np.bool_], step: Array, stay: Array, b: Background) -> Array:
    """Ln likelihood (R, G): forward sums over both levels, a Kalman filter for the drift on each.

    What the drift is on one level is passed on as one mean and variance (interacting multiple models).
    """
    offset = step[:, :, None] * _CONSTANTS  # (R, G, C)
    half = 0.5 * step[:, :, None]
    stays = stay[:, None]
    moves = np.array([[stays, 1.0 - stays], [1.0 - stays, stays]])
    chance = [np.full(offset.shape, 0.5)] * 2
    mean, spread = [np.zeros(offset.shape)] * 2, [np.full(offset.shape, b.variance)] * 2
    total = np.zeros(offset.shape)
    for k in range(y.shape[1]):
        logs, new_chance, new_mean, new_spread = [], [], [], []
        here = seen[:, k, None, None]
        for level, sign in ((0, 1.0), (1, -1.0)):
            from_0, from_1 = moves[0, level] * chance[0], moves[1, level] * chance[1]
            whole = from_0 + from_1
            share = from_0 / np.maximum(whole, 1e-300)
            apart = mean[0] - mean[1]
            m = b.keep * (mean[1] + share * apart)
            p = share * spread[0] + (1.0 - share) * spread[1] + share * (1.0 - share) * apart**2
            p = b.keep**2 * p + (1.0 - b.keep**2) * b.variance
            s = p + b.sigma**2
            e = y[:, k, None, None] - offset - sign * half - m
            gain = np.where(here, p / s, 0.0)
            logs.append(np.where(here, -0.5 * (e * e / s + np.log(s)), 0.0))
            new_chance.append(whole)
            new_mean.append(m + gain * e)
            new_spread.append(p * (1.0 - gain))
        top = np.maximum(logs[0], logs[1])
        chance = [c * np.exp(one - top) for c, one in zip(new_chance, logs, strict=True)]
        whole = chance[0] + chance[1]
        total += top + np.log(whole)
        chance, mean, spread = [c / whole for c in chance], new_mean, new_spread
    return log_mean_exp(total, _LIKELY)


def _gaussian(y: Array, seen: NDArray[np.bool_], step: Array, keep: Array, b: Background) -> Array:
    """Ln likelihood (R, G) by a Kalman filter for process and drift, with the same constant."""
    variance = 0.25 * step**2
    zero = np.zeros(step.shape)
    x, d, ux, ud = zero, zero, zero, zero  # process and drift; how much each answers a constant of 1
    xx, xd, dd = variance, zero, zero + b.variance
    logs, a11, a1y = zero, zero, zero
    for k in range(y.shape[1]):
        x, ux, d, ud = keep * x, keep * ux, b.keep * d, b.keep * ud
        xx = keep**2 * xx + (1.0 - keep**2) * variance
        xd = keep * b.keep * xd
        dd = b.keep**2 * dd + (1.0 - b.keep**2) * b.variance
        s = xx + 2.0 * xd + dd + b.sigma**2
        e, f = y[:, k, None] - x - d, 1.0 - ux - ud
        here = seen[:, k, None]
        logs = logs + np.where(here, -0.5 * (e * e / s + np.log(s)), 0.0)
        a11, a1y = a11 + np.where(here, f * f / s, 0.0), a1y + np.where(here, f * e / s, 0.0)
        gx, gd = np.where(here, (xx + xd) / s, 0.0), np.where(here, (xd + dd) / s, 0.0)
        x, d, ux, ud = x + gx * e, d + gd * e, ux + gx * f, ud + gd * f
        xx, xd, dd = xx - gx * (xx + xd), xd - gx * (xd + dd), dd - gd * (xd + dd)
    prior = np.maximum(variance, 1e-300)
    result: Array = logs + 0.5 * a1y**2 / (a11 + 1.0 / prior) - 0.5 * np.log1p(a11 * prior)
    return result
