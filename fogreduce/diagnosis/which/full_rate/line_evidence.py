"""Evidence of one spectral line from its amplitudes in each run.

With z the amplitude found (unit variance in each quadrature) and s the one expected,
``ln L = ln I0(s |z|) - s^2 / 2`` where the phase may be any in each run.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fogreduce.diagnosis.inference.evidence import log_mean_exp
from fogreduce.physics.special import log_i0

Array = NDArray[np.float64]

_SIZES = np.array([4.0, 6.0, 9.0, 13.0, 20.0, 30.0, 45.0, 70.0, 110.0, 200.0, 400.0])
_LEADERS = 60  # the strongest lines, whose evidence is worked out


def sizes_log(moduli: Array, weights: Array | None = None) -> tuple[Array, Array]:
    """Ln mean likelihood over sizes, and the best size's, for moduli (..., runs).

    Parameters
    ----------
    moduli : (..., runs) array
    weights : (runs,) array or None
        A line's amplitude in each run over that in the longest one; None: they are alike.
    """
    runs = moduli.shape[-1]
    weights = np.ones(runs) if weights is None else weights
    squares = float(np.sum(weights**2))
    s = _SIZES / np.sqrt(squares)
    weighed = moduli * weights
    logs = log_i0(weighed[..., None, :] * s[:, None]).sum(axis=-1) - 0.5 * squares * s**2
    # sizes lie further apart than the likelihood is wide: the best one is looked for between them
    best = np.sqrt(np.maximum(np.sum(moduli**2, axis=-1) - 2.0 * runs, 0.0) / squares)
    top = log_i0(weighed * best[..., None]).sum(axis=-1) - 0.5 * squares * best**2
    narrow = np.log(2.5 / np.maximum(best * np.sqrt(squares), 2.5))
    mean = np.maximum(log_mean_exp(logs), top + narrow - np.log(3.0))
    return mean, np.maximum(top, logs.max(axis=-1))


def leading(power: Array, free: NDArray[np.bool_]) -> NDArray[np.intp]:
    """The strongest of the lines that are free, the strongest last."""
    power = np.where(free, power, 0.0)
    few = np.argpartition(power, -_LEADERS)[-_LEADERS:] if len(power) > _LEADERS else np.arange(len(power))
    return few[np.argsort(power[few], kind="stable")]
