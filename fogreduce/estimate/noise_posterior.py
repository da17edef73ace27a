"""White noise, flicker and random walk of each gyro in a run: what the record states, what residuals show.

A mean curve absorbs the lowest frequencies, so that the residuals of one run often leave open how large
flicker and walk are, and that decides the error of a drift. So nothing is estimated as one value: the
posterior probability of every size is formed, and errors are averaged over it. Beforehand one of two holds:

- each gyro's flicker and walk are those of its calibration record, to 30 %; or (a record that is silent, a
  gyro that has changed) they are anything: absent, or of any size, all sizes alike;
- the gyros of a unit are alike: flicker and walk are anything, but of one ratio to the white noise.

What the readings say decides between them. The white noise always comes from the readings.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fogreduce.estimate.coloured import ColouredNoise
from fogreduce.estimate.noise_grid import Likelihood, NoiseGrid

Array = NDArray[np.float64]

#: Scatter of a gyro's flicker and walk, from run to run, about what its record states, logarithmic.
RECORD_SCATTER = 0.3
#: Probability that a record's noise still holds.
_RECORD_HOLDS = 0.95
#: Probability that the gyros of a unit are alike: with a record that states noise, and without.
_ALIKE_STATED, _ALIKE = 0.02, 0.5
#: Probability that there is no flicker, and no walk, worth mentioning, where nothing is stated.
_NO_FLICKER, _NO_WALK = 0.85, 0.8


@dataclass(frozen=True)
class NoisePosterior:
    """What is known of the noise of a channel.

    Attributes
    ----------
    mean : ColouredNoise
        Posterior means of the coefficients, so that `combined(forms, mean)` is a mean covariance.
    spread : (3, 3) array
        Their posterior covariance.
    """

    mean: ColouredNoise
    spread: Array

    def variance_of(self, variances: Array) -> float:
        """Variance of what `combined` gives for unit variances (3,): how well a variance is known."""
        return float(variances @ self.spread @ variances)

    def scaled(self, factor: float) -> NoisePosterior:
        """In another unit, `factor` its square."""
        mean = ColouredNoise(factor * self.mean.white, factor * self.mean.flicker, factor * self.mean.walk)
        return NoisePosterior(mean, factor**2 * self.spread)

    @classmethod
    def none(cls) -> NoisePosterior:
        """Of a channel that has no noise, or none that is known."""
        return cls(ColouredNoise(0.0, 0.0, 0.0), np.zeros((3, 3)))


def posteriors(
    grid: NoiseGrid, found: Likelihood, flicker: Array | None, walk: Array | None
) -> list[NoisePosterior]:
    """Of each gyro.

    Parameters
    ----------
    grid : NoiseGrid
    found : Likelihood
        Of the gyros' residuals; one without any has no noise.
    flicker, walk : (n,) arrays or None
        Stated coefficients B^2 and K^2 in the residuals' unit; None where the record states none.
    """
    at = np.flatnonzero(found.is_determined).tolist()
    if not at:
        return [NoisePosterior.none() for _ in found.freedom]
    logs, white = (np.array(part) for part in zip(*(found.log(gyro) for gyro in at), strict=True))
    anything = np.log(_anything(grid.flicker, _NO_FLICKER))[:, None] + np.log(_anything(grid.walk, _NO_WALK))
    is_stated = flicker is not None or walk is not None
    each, evidence = [], 0.0
    for k, gyro in enumerate(at):
        prior = np.exp(anything)
        if is_stated:
            stated = _prior(grid.flicker[:, None], white[k], flicker, gyro, _NO_FLICKER, axis=0)
            stated = stated * _prior(grid.walk[None, :], white[k], walk, gyro, _NO_WALK, axis=1)
            prior = _RECORD_HOLDS * stated + (1.0 - _RECORD_HOLDS) * prior
        probability, part = _normalised(logs[k] + np.log(np.maximum(prior, 1e-300)))
        each.append(probability)
        evidence += part
    alike, of_alike = _normalised(logs.sum(axis=0) + anything)
    before = _ALIKE_STATED if is_stated else _ALIKE
    odds = np.log(before / (1.0 - before)) + of_alike - evidence
    weight = float(1.0 / (1.0 + np.exp(-np.clip(odds, -700.0, 700.0)))) if len(at) > 1 else 0.0
    determined = {
        gyro: _moments(grid, weight * alike + (1.0 - weight) * each[k], white[k]) for k, gyro in enumerate(at)
    }
    return [determined.get(i, NoisePosterior.none()) for i in range(len(found.freedom))]


def _anything(sizes: Array, none: float) -> Array:
    """Prior of the sizes of a grid: none at all, or of any size."""
    prior = np.full(sizes.size, (1.0 - none) / (sizes.size - 1))
    prior[0] = none
    return prior


def _prior(ratio: Array, white: Array, stated: Array | None, gyro: int, none: float, axis: int) -> Array:
    """Prior over the grid along an axis by what the record states of one gyro, normalised along that axis."""
    shape = white.shape
    if stated is None:
        return np.broadcast_to(np.reshape(_anything(np.ravel(ratio), none), ratio.shape), shape)
    prior = np.zeros(shape)
    first = (0, slice(None)) if axis == 0 else (slice(None), 0)
    if stated[gyro] <= 0:
        prior[first] = 1.0
        return prior
    size = ratio * white
    with np.errstate(divide="ignore"):
        away = np.log(size / stated[gyro]) / (2.0 * RECORD_SCATTER)  # of amplitudes: half that of variances
    prior = np.exp(-0.5 * np.maximum(away**2 - np.min(away**2, axis=axis, keepdims=True), 0.0))
    # less than the smallest size of the grid counts as none
    smallest = np.take(size, [1], axis=axis)
    below = np.squeeze(smallest > stated[gyro] * np.exp(2.0 * RECORD_SCATTER), axis=axis)
    prior[first] = 0.0
    prior = prior / prior.sum(axis=axis, keepdims=True)
    nothing = np.zeros(shape)
    nothing[first] = 1.0
    mixed: Array = np.where(np.expand_dims(below, axis), nothing, prior)
    return mixed


def _normalised(logs: Array) -> tuple[Array, float]:
    """Probabilities, and the logarithm of what they summed to."""
    most = float(logs.max())
    probability = np.exp(logs - most)
    total = float(probability.sum())
    return probability / total, most + float(np.log(total))


def _moments(grid: NoiseGrid, probability: Array, white: Array) -> NoisePosterior:
    """Mean and covariance of the three coefficients."""
    sizes = np.array([white, white * grid.flicker[:, None], white * grid.walk]).reshape(3, -1)
    weights = probability.ravel()
    mean = sizes @ weights
    away = sizes - mean[:, None]
    return NoisePosterior(ColouredNoise(*mean.tolist()), (away * weights) @ away.T)
