"""Evidence of a random process of one unknown size, averaged over sizes."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from fogreduce.diagnosis.inference.evidence import WhitenedResidual, log_mean_exp
from fogreduce.diagnosis.inference.family import diagonal
from fogreduce.diagnosis.inference.noise_model import process_covariance
from fogreduce.diagnosis.observe.blocks import Blocks

Array = NDArray[np.float64]

_LOWEST, _HIGHEST, _STEPS = 1.5, 1e6, 70
#: Times the squared size that the residual's own power asks for: sizes are tried at least to it.
_BEYOND = 10.0
SOME = 1e-6  # of the largest variance: what is below it is none
_FEWER = 1e-8  # the same, before noise weighs them


def size_logs(d: Array, runs: Array, z2: Array) -> tuple[Array, Array]:
    """Squared sizes (sizes,) of a process, evenly spaced in their logarithm, and ln B of each, (sizes, ...).

    Parameters
    ----------
    d : (D,) array
        Variances of the whitened process of unit size in its eigenvectors.
    runs : (D,) array
        How many runs share each.
    z2 : (D, ...) array
        Squared residuals there, summed over those runs.
    """
    # sizes from where the process would hardly show to where it drowns everything
    order = 1.0 / max(float(np.sqrt(np.sum(runs * d**2))), 1e-300)
    ratio = _HIGHEST ** (1.0 / (_STEPS - 1))
    asked = _BEYOND * float(np.max(np.sum(z2, axis=0))) / max(order * float(runs @ d), 1e-300)
    further = max(math.ceil(math.log(max(asked / (_LOWEST * _HIGHEST), 1.0), ratio)), 0)
    a2 = order * _LOWEST * ratio ** np.arange(_STEPS + further)
    grown = a2[:, None] * d
    none = (np.log1p(grown) @ runs).reshape(-1, *(1,) * (z2.ndim - 1))
    return a2, np.asarray(0.5 * ((grown / (1.0 + grown)) @ z2 - none))


def smooth_modes(kind: str, blocks: Blocks) -> Array:
    """Modes (blocks, m) of a smooth process of unit size; summed over them, products are its covariance."""
    values, vectors = np.linalg.eigh(process_covariance(kind, 1.0, blocks))
    some = values > _FEWER * values[-1]
    modes: Array = vectors[:, some] * np.sqrt(values[some])
    return modes


def whole_evidence(
    residual: WhitenedResidual, rows: Sequence[slice], parts: Sequence[tuple[Array, Array]]
) -> float:
    """Ln B of a smooth process in the metric of all stated uncertainties, the runs' means in it.

    Parameters
    ----------
    residual : WhitenedResidual
        Residual and metric.
    rows : slices
        Of the gyro in each run.
    parts : (blocks, m) and (m, m) arrays
        Whitened modes of the process in each run, and their inner products.
    """
    cross = np.hstack([residual.metric.a[at].T @ modes for at, (modes, _) in zip(rows, parts, strict=True)])
    b = np.concatenate([modes.T @ residual.y[at] for at, (modes, _) in zip(rows, parts, strict=True)])
    b -= cross.T @ residual.shrunk
    gram = diagonal([inner for _, inner in parts]) - cross.T @ (residual.metric.shrink @ cross)
    d, vectors = np.linalg.eigh(gram)
    some = d > SOME * d[-1]
    z2 = (vectors[:, some].T @ b) ** 2 / d[some]
    return float(log_mean_exp(size_logs(d[some], np.ones(int(some.sum())), z2)[1]))
