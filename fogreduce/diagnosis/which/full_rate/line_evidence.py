"""Evidence of one spectral line from its amplitudes in each run.

With z the amplitude found (unit variance in each quadrature) and s the one expected,
``ln L = ln I0(s |z|) - s^2 / 2``.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fogreduce.diagnosis.inference.evidence import log_mean_exp
from fogreduce.physics.special import log_i0

Array = NDArray[np.float64]

_SIZES = np.array([4.0, 6.0, 9.0, 13.0, 20.0, 30.0, 45.0, 70.0, 110.0, 200.0, 400.0])
_LEADERS = 60  # the strongest lines, whose evidence is worked out


def sizes_log(moduli: Array) -> tuple[Array, Array]:
    """Ln mean likelihood over sizes, and the best size's, for moduli (..., runs)."""
    runs = moduli.shape[-1]
    s = _SIZES / np.sqrt(runs)
    logs = log_i0(moduli[..., None, :] * s[:, None]).sum(axis=-1) - 0.5 * runs * s**2
    # sizes lie further apart than the likelihood is wide: the best one is looked for between them
    best = np.sqrt(np.maximum(np.sum(moduli**2, axis=-1) - 2.0 * runs, 0.0) / runs)
    top = log_i0(moduli * best[..., None]).sum(axis=-1) - 0.5 * runs * best**2
    narrow = np.log(2.5 / np.maximum(best * np.sqrt(runs), 2.5))
    mean = np.maximum(log_mean_exp(logs), top + narrow - np.log(3.0))
    return mean, np.maximum(top, logs.max(axis=-1))


def leading(power: Array, free: NDArray[np.bool_]) -> NDArray[np.intp]:
    """The strongest of the lines that are free, the strongest last."""
    power = np.where(free, power, 0.0)
    few = np.argpartition(power, -_LEADERS)[-_LEADERS:] if len(power) > _LEADERS else np.arange(len(power))
    return few[np.argsort(power[few], kind="stable")]


def best_of(moduli: Array) -> tuple[int, float, float]:
    """The best line of (L, R): its index, ln of the sum of evidence over lines, and twice its best gain's
    half.
    """
    mean, top = sizes_log(moduli)
    k = int(np.argmax(mean))
    # neighbours of a line in a spectrum of split lines say the same again
    log_sum = float(log_mean_exp(mean) + np.log(len(mean))) - np.log(2.0)
    return k, log_sum, float(top[k])
