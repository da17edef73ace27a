"""Exact Gaussian evidence of candidates, in closed form.

A candidate's amplitude has a mixture of scales as its prior: given a scale S, its coefficients are normal
with the covariance ``g G^-1``, G the Gram matrix of its columns and g = S^2 / k, so that its expected
signal-to-noise ratio is S whatever its units. With Q = b' G^-1 b, b the columns' products with the residual,

    ln B = -k/2 ln(1 + g) + Q/2 g / (1 + g).

A grid over other parameters is averaged, so that a finer or wider one costs what it should (look-elsewhere).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fogreduce.diagnosis.inference.candidate import Candidate, pairs
from fogreduce.diagnosis.inference.noise_model import Metric
from fogreduce.physics.special import log_normal_tail

Array = NDArray[np.float64]

#: Scales of the signal-to-noise ratio and their prior weights: even in the logarithm where one looks for
#: effects, a little for gross ones.
SCALES = np.array([3.0, 5.0, 8.0, 13.0, 20.0, 35.0, 60.0, 150.0, 1e3, 1e4, 1e5, 1e6])
_WEIGHTS = np.array([1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 0.5, 0.3, 0.2, 0.1, 0.1, 0.1])
LOG_WEIGHTS = np.log(_WEIGHTS / _WEIGHTS.sum())


def log_mean_exp(values: Array, log_weights: Array | None = None, axis: int = -1) -> Array:
    """Logarithm of the (weighted) mean of exponentials."""
    if log_weights is None:
        log_weights = np.full(values.shape[axis], -np.log(values.shape[axis]))
    shape = [1] * values.ndim
    shape[axis] = -1
    shifted = values + log_weights.reshape(shape)
    top = np.max(shifted, axis=axis, keepdims=True)
    total = np.log(np.sum(np.exp(shifted - top), axis=axis)) + np.squeeze(top, axis)
    return np.asarray(total)


def log_bayes(q: Array, k: int) -> Array:
    """Ln B of k columns with Q against none, the mixture of scales in it; any shape of q."""
    g = SCALES**2 / k
    terms = -0.5 * k * np.log1p(g) + 0.5 * q[..., None] * (g / (1.0 + g))
    return log_mean_exp(terms, LOG_WEIGHTS)


@dataclass(frozen=True)
class Fit:
    """A candidate held against a residual.

    Attributes
    ----------
    candidate : Candidate
    log_b : float
        ln of its evidence over that of nothing more.
    best : int
        Best point of the grid.
    q : float
        Twice the gain in ln likelihood there.
    coefficients : (k,) array
        At the best point.
    covariance : (k, k) array
    """

    candidate: Candidate
    log_b: float
    best: int
    q: float
    coefficients: Array
    covariance: Array


@dataclass(frozen=True)
class Points:
    """What each point of a grid comes to: ln B (J,), q (J,), coefficients (J, k), covariance (J, k, k)."""

    logs: Array
    q: Array
    coefficients: Array
    covariance: Array

    def one(self, candidate: Candidate, point: int) -> Fit:
        """A point as the fit of a candidate that has no other."""
        return Fit(
            candidate,
            float(self.logs[point]),
            0,
            float(self.q[point]),
            self.coefficients[point],
            self.covariance[point],
        )


@dataclass(frozen=True)
class WhitenedResidual:
    """A whitened residual and the metric in which it counts, with its products ready."""

    metric: Metric
    y: Array
    shrunk: Array

    @classmethod
    def of(cls, metric: Metric, y: Array) -> WhitenedResidual:
        """From metric and whitened residual."""
        return cls(metric, y, metric.shrink @ (metric.a.T @ y))

    @property
    def chi2(self) -> float:
        """Y' S^-1 y."""
        return float(self.y @ self.y - (self.metric.a.T @ self.y) @ self.shrunk)

    def products(self, candidate: Candidate) -> tuple[Array, Array]:
        """Of a candidate's columns: b (J, k) and G (J, k, k)."""
        flat, (_, j, k) = candidate.flat, candidate.columns.shape
        ax = self.metric.onto(flat, candidate.rows)
        b = flat.T @ self.y[candidate.rows] - ax.T @ self.shrunk
        shrunk = self.metric.shrink @ ax
        gram = candidate.gram - pairs(ax.reshape(-1, j, k), shrunk.reshape(-1, j, k))
        return b.reshape(j, k), gram

    def fit(self, candidate: Candidate) -> Fit:
        """Evidence and best coefficients of a candidate."""
        k = candidate.columns.shape[2]
        if candidate.fixed:
            b, gram = self.products(candidate)
            gain = b[:, 0] - 0.5 * gram[:, 0, 0]
            best = int(np.argmax(gain))
            return Fit(
                candidate,
                float(log_mean_exp(gain)),
                best,
                2.0 * float(gain[best]),
                np.ones(1),
                np.zeros((1, 1)),
            )
        points = self.points(candidate)
        logs = points.logs
        if candidate.positive and k == 1:
            sign = np.sign(points.coefficients[:, 0] * candidate.steps[:, 0])
            logs = logs + np.log(2.0) + [log_normal_tail(float(x)) for x in sign * np.sqrt(points.q)]
        best = int(np.argmax(logs))
        return Fit(
            candidate,
            float(log_mean_exp(logs, candidate.log_weights)),
            best,
            float(points.q[best]),
            points.coefficients[best],
            points.covariance[best],
        )

    def points(self, candidate: Candidate) -> Points:
        """Evidence and best coefficients at every point of a candidate's grid, either sign allowed."""
        b, gram = self.products(candidate)
        k = b.shape[1]
        # what is not seen at all must not be divided by
        floor = 1e-10 * np.diagonal(candidate.gram, axis1=1, axis2=2) + 1e-30
        gram = gram + floor[:, :, None] * np.eye(k)
        inverse: Array = 1.0 / gram if k == 1 else np.asarray(np.linalg.inv(gram), np.float64)
        found = (inverse @ b[:, :, None])[:, :, 0]
        q = np.maximum(np.sum(b * found, axis=1), 0.0)
        return Points(log_bayes(q, k), q, found, inverse)
