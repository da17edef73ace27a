"""Whether a gyro jumps between two levels: what that says beyond the spectrum, which it shares with others.

A telegraph of two levels a apart, left at random after a mean time T, has the covariance of a Gaussian
process of variance a^2 / 4 that forgets within T / 2. Both are held against the same block means, beside
white noise, a drift and an unknown constant in each run; the ratio of their likelihoods, averaged over one
grid of a and T, is what the jumps add to the evidence of the spectrum.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from fogreduce.diagnosis.inference.evidence import log_mean_exp

Array = NDArray[np.float64]

_STAYS_S = np.array([10.0, 20.0, 40.0, 80.0])
_SIZES = np.array([0.65, 0.9, 1.2, 1.6])  # of the level difference that the variance found asks for
#: Mean stay and size of every telegraph that is tried, (G, 2).
_GRID = np.array([(stay, size) for stay in _STAYS_S.tolist() for size in _SIZES.tolist()])
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
        """From the covariance (lags,) of a block in the middle of a run with itself and those after it."""
        lags = covariance[1:]
        if len(lags) < 2:
            return cls(float(np.sqrt(covariance[0])), 0.0, 0.0)
        over = lags - lags[-1]
        variance = max(float(over[0]), 0.0)
        length = float(over.sum()) / variance if variance > 0.0 else 1.0
        white = max(float(covariance[0] - lags[0]), 1e-12 * float(covariance[0]))
        return cls(float(np.sqrt(white)), variance, float(np.exp(-1.0 / max(length, 1.0))))


@dataclass(frozen=True)
class Record:
    """Block means of one gyro that may jump.

    Attributes
    ----------
    values : (R, T) array
        Block means of each run [deg/h].
    seen : (R, T) array of bool
        Which of them count.
    weights : (R,) array
        What a level difference of 1 is in each run: 1, or the reading for a scale factor that jumps.
    backgrounds : Background of each run
    length_s : (R,) array
        Of a block in each run [s].
    """

    values: Array
    seen: NDArray[np.bool_]
    weights: Array
    backgrounds: Sequence[Background]
    length_s: Array


@dataclass(frozen=True)
class _Rows:
    """Runs of all records side by side: y, seen (R, T), level difference (R, G), the rest (R, 1) each."""

    y: Array
    seen: NDArray[np.bool_]
    step: Array
    noise: Array
    variance: Array
    keep: Array
    length_s: Array


def jumps_add(records: Sequence[Record]) -> list[float]:
    """Ln likelihood ratio of a telegraph over a Gaussian process of the same covariance, for each record.

    Parameters
    ----------
    records : of the same number of blocks
    """
    parts = [_rows(one) for one in records]
    counts = [len(part.y) for part in parts]
    if not sum(counts):
        return [0.0] * len(records)
    rows = _Rows(*(np.concatenate([getattr(p, f.name) for p in parts]) for f in fields(_Rows)))
    stay = 0.5 * (1.0 + np.exp(-2.0 * rows.length_s / _GRID[:, 0]))
    cuts = np.cumsum(counts)[:-1]
    telegraph = np.split(_telegraph(rows, stay), cuts)
    smooth = np.split(_gaussian(rows, 2.0 * stay - 1.0), cuts)
    return [
        float(log_mean_exp(one.sum(axis=0)) - log_mean_exp(other.sum(axis=0)))
        for one, other in zip(telegraph, smooth, strict=True)
    ]


def _rows(record: Record) -> _Rows:
    """The runs of a record in which levels as far apart as its variance asks for would show."""
    seen, weights = record.seen, record.weights
    sigma, variance, keep = (
        np.array([[getattr(b, f.name)] for b in record.backgrounds]) for f in fields(Background)
    )
    count = np.maximum(seen.sum(axis=1, keepdims=True), 1)
    values = np.where(seen, record.values, 0.0)
    y = np.where(seen, values - np.sum(values, axis=1, keepdims=True) / count, 0.0)
    usual = sigma**2 + variance
    excess = np.sum(np.where(seen, y**2 - usual, 0.0)) / max(np.sum(seen * weights[:, None] ** 2), 1e-300)
    size = 2.0 * np.sqrt(max(float(excess), 0.0))
    step = np.abs(np.outer(weights, size * _GRID[:, 1]))
    moved = (step.max(axis=1) > 0.1 * sigma[:, 0]) & (size > 0.0)
    rest = (sigma**2, variance, keep, record.length_s[:, None])
    return _Rows(y[moved], seen[moved], step[moved], *(column[moved] for column in rest))


def _telegraph(rows: _Rows, stay: Array) -> Array:
    """Ln likelihood (R, G): forward sums over both levels, a Kalman filter for the drift on each.

    `stay`: chance (R, G) to stay on a level from one block to the next.

    What the drift is on one level is passed on as one mean and variance (interacting multiple models).
    Arrays are (2, R, G, C): the upper level and the lower one, runs, grid, constants.
    """
    noise, variance, keep = (x[:, :, None] for x in (rows.noise, rows.variance, rows.keep))
    stays = stay[:, :, None]
    level = np.array([0.5, -0.5])[:, None, None, None] * rows.step[:, :, None]
    level = level + rows.step[:, :, None] * _CONSTANTS
    chance = np.full(level.shape, 0.5)
    mean, spread = np.zeros(level.shape), np.broadcast_to(variance, level.shape)
    total = np.zeros(level.shape[1:])
    for k in range(rows.y.shape[1]):
        stayed = stays * chance
        chance = stayed + (1.0 - stays) * chance[::-1]
        share = stayed / chance
        other = 1.0 - share
        apart = mean - mean[::-1]
        m = keep * (mean - other * apart)
        p = share * spread + other * spread[::-1] + (share * other) * (apart * apart)
        p = keep**2 * p + (1.0 - keep**2) * variance
        s = p + noise
        e = rows.y[:, k, None, None] - level - m
        gain, minus, likely = p / s, 0.5 * e * e / s, 1.0 / np.sqrt(s)
        here = rows.seen[:, k]
        if not here.all():
            gain[:, ~here], minus[:, ~here], likely[:, ~here] = 0.0, 0.0, 1.0
        least = np.minimum(minus[0], minus[1])
        chance = chance * likely * np.exp(least - minus)
        whole = chance[0] + chance[1]
        total += np.log(whole) - least
        chance, mean, spread = chance / whole, m + gain * e, p - gain * p
    return log_mean_exp(total, _LIKELY)


def _gaussian(rows: _Rows, process: Array) -> Array:
    """Ln likelihood (R, G) by a Kalman filter for process and drift, with the same constant."""
    variance = 0.25 * rows.step**2
    zero = np.zeros(variance.shape)
    x, d, ux, ud = zero, zero, zero, zero  # process and drift; how much each answers a constant of 1
    keep = rows.keep
    xx, xd, dd = variance, zero, zero + rows.variance
    logs, a11, a1y = zero, zero, zero
    for k in range(rows.y.shape[1]):
        x, ux, d, ud = process * x, process * ux, keep * d, keep * ud
        xx = process**2 * xx + (1.0 - process**2) * variance
        xd = process * keep * xd
        dd = keep**2 * dd + (1.0 - keep**2) * rows.variance
        gx, gd = xx + xd, xd + dd
        s = gx + gd + rows.noise
        e, f = rows.y[:, k, None] - x - d, 1.0 - ux - ud
        here = rows.seen[:, k, None]
        weight = here / s
        logs = logs - 0.5 * (weight * e * e + np.where(here, np.log(s), 0.0))
        a11, a1y = a11 + weight * f * f, a1y + weight * f * e
        hx, hd = weight * gx, weight * gd
        x, d, ux, ud = x + hx * e, d + hd * e, ux + hx * f, ud + hd * f
        xx, xd, dd = xx - hx * gx, xd - hx * gd, dd - hd * gd
    prior = np.maximum(variance, 1e-300)
    result: Array = logs + 0.5 * a1y**2 / (a11 + 1.0 / prior) - 0.5 * np.log1p(a11 * prior)
    return result
