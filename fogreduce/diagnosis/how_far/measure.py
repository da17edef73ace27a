"""How much a feature counts in each of two folds, so that both together count as the whole campaign does.

Where noise changes slowly, or a stated uncertainty is the same in both folds, each of them alone knows a
feature almost as well as both do; where noise is white, half as well. Deviates of the folds as they stand
would count the first kind of feature twice beside the second. With G the inner products of the features over
all blocks and G0, G1 those over the folds, in a basis in which G = 1 and G0 + G1 = D is diagonal, a fold's
sizes d = Gk^-1 bk of the features count as |Gk^1/2 D^-1/2 d|^2: of the same sizes in both, d'Gd.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fogreduce.diagnosis.inference.evidence import WhitenedResidual
from fogreduce.diagnosis.inference.noise_model import Metric, Whitener

Array = NDArray[np.float64]

#: Directions of less than this share of the strongest are none; of less than that of all blocks' knowledge, a
#: fold knows nothing of them.
_NONE, _UNKNOWN = 1e-8, 1e-3
#: Standard deviations beyond its expectation from which what columns gain is no noise.
_CLEAR = 2.0


@dataclass(frozen=True)
class Part:
    """Blocks of one fold, or of both.

    Attributes
    ----------
    whiten : Whitener
    metric : Metric
    y : (rows,) array
        Residual, whitened.
    """

    whiten: Whitener
    metric: Metric
    y: Array


@dataclass(frozen=True)
class Deviates:
    """Squared deviates of a fold, as they count.

    Attributes
    ----------
    metric : Metric
    features : (rows, m) array
        Whitened.
    turn : (r, m) array
        From inner products with the features to deviates.
    spread : (r, r) array
        Covariance of the deviates under noise and stated uncertainties alone.
    """

    metric: Metric
    features: Array
    turn: Array
    spread: Array

    def of(self, y: Array) -> Array:
        """Deviates (r,) of a whitened vector (rows,)."""
        out: Array = self.turn @ self.metric.gram(self.features, y[:, None])[:, 0]
        return out

    @property
    def expected(self) -> float:
        """Sum of their squares under noise and stated uncertainties alone."""
        return float(np.trace(self.spread))


def shows(left: WhitenedResidual, columns: Array, prior: float) -> bool:
    """Whether whitened columns (rows, k), of inverse prior variance `prior`, gain more than noise would."""
    gram = left.metric.gram(columns, columns)
    along = left.metric.gram(columns, left.y[:, None])[:, 0]
    inverse = np.linalg.pinv(gram + prior * np.eye(len(gram)), rcond=_NONE, hermitian=True)
    degrees = float(np.sum(inverse * gram))
    return bool(along @ inverse @ along > degrees + _CLEAR * np.sqrt(2.0 * degrees))


def scattered(left: float, before: Array, after: Array, of_before: Array, of_after: Array) -> float:
    """Variance of |after|^2 - left |before|^2, deviates (r,) of covariances `of_...` (r, r) under noise.

    Both have the same noise, unless they are of different metrics.
    """
    if len(before) != len(after):
        return _of_squares(after, of_after, 1.0) + left**2 * _of_squares(before, of_before, 1.0)
    return _of_squares(after - left * before, of_after, 1.0 - left)


def _of_squares(z: Array, spread: Array, share: float) -> float:
    """Of a sum of squares, z with `share` of the noise in it."""
    noise = share**2 * float(np.sum(spread**2))
    return 2.0 * noise + 4.0 * max(float(z @ spread @ z) - noise, 0.0)


def deviates(whole: Part, folds: Sequence[Part], columns: Array) -> list[Deviates]:
    """Each fold's deviates over the span of features.

    Parameters
    ----------
    whole, folds : Part
    columns : (rows, m) array
        Features, not whitened [deg/h].
    """
    features = [fold.whiten(columns) for fold in folds]
    if not columns.shape[1]:
        nothing = np.zeros((0, 0))
        return [Deviates(f.metric, here, nothing, nothing) for f, here in zip(folds, features, strict=True)]
    white = whole.whiten(columns)
    gram = whole.metric.gram(white, white)
    size = np.sqrt(np.diag(gram) + 1e-300)
    values, vectors = np.linalg.eigh(gram / np.outer(size, size))
    some = values > _NONE * values[-1]
    basis = vectors[:, some] / (size[:, None] * np.sqrt(values[some]))
    grams = [f.metric.gram(here, here) for f, here in zip(folds, features, strict=True)]
    both, turned = np.linalg.eigh(basis.T @ sum(grams) @ basis)
    basis = basis @ turned
    weight = 1.0 / np.sqrt(np.maximum(both, _UNKNOWN))
    out = []
    for fold, here, one in zip(folds, features, grams, strict=True):
        eigenvalues, axes = np.linalg.eigh(basis.T @ one @ basis)
        inverse = np.where(eigenvalues > _UNKNOWN, 1.0 / np.maximum(eigenvalues, _UNKNOWN), 0.0)
        root = np.sqrt(np.maximum(eigenvalues, 0.0))[:, None] * axes.T
        turn = (root * weight) @ (axes * inverse) @ axes.T @ basis.T
        out.append(Deviates(fold.metric, here, turn, turn @ one @ turn.T))
    return out
