"""Evidence of a low pass in averaged spectra, and its time constant.

What stands between noise and samples is left open by a time constant alone (`pieces.filter_gains`): the
catalogue's own filter is the most likely, the other two kinds are there for what is not quite it.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from fogreduce.diagnosis.which.full_rate.whittle import level_profile, mean_ratio, peak

Array = NDArray[np.float64]

_TAUS_MS = np.geomspace(0.1, 200.0, 40)
_KINDS = np.log([0.8, 0.1, 0.1])
_NEAR = np.geomspace(1.0 / 1.2, 1.2, 13)  # of a point of that grid: to its neighbours


def filter_logs(ratio: Array, pieces: Array, gains: Array, spread: float) -> Array:
    """Ln likelihood (...,) of gains (..., F), the level spread about the record's.

    Parameters
    ----------
    ratio, pieces : (F,) arrays
        Power found over power expected, and of how many spectra it is the mean.
    gains : (..., F) array
    spread : float
        Standard deviation of ln level.
    """
    level, weight = mean_ratio(ratio / gains, pieces), float(pieces.sum())
    result: Array = level_profile(level, weight, np.array([spread]))[..., 0]
    return result - weight * (np.log(level) + 1.0) - np.log(gains) @ pieces


def filter_evidence(
    ratio: Array, pieces: Array, gains_of: Callable[[Array], Array], spread: float, nothing: float
) -> tuple[float, float, float, float]:
    """Ln evidence of a low pass, its best ln likelihood, its time constant [ms] and that one's error.

    Parameters
    ----------
    ratio, pieces, spread : as `filter_logs` has them
    gains_of : callable
        From time constants (taus,) [ms] to gains (kinds, taus, F).
    nothing : float
        Ln likelihood of no filter: where a filter is no better, it is not looked at more closely.
    """
    logs = filter_logs(ratio, pieces, gains_of(_TAUS_MS), spread) + _KINDS[:, None]
    log_z = float(np.logaddexp.reduce(logs.ravel()) - np.log(_TAUS_MS.size))
    tau, std = peak(_TAUS_MS, max(logs, key=np.max))
    if log_z <= nothing:
        return log_z, float(logs.max()), tau, std
    tops, values, errors = [], [], []
    for kind, row in enumerate(logs):
        near = float(_TAUS_MS[int(np.argmax(row))]) * _NEAR
        fine = filter_logs(ratio, pieces, gains_of(near)[kind], spread)
        value, error = peak(near, fine)
        tops.append(float(fine.max()))
        values.append(value)
        errors.append(error)
    best = int(np.argmax(tops + _KINDS))
    # where kinds do as well as each other, the time constant is that of any of them: its error holds what
    # the spectrum alone says, not how rare a kind is
    share = np.exp(np.array(tops) - np.max(tops))
    share /= share.sum()
    std = float(np.sqrt(share @ (np.square(errors) + (np.array(values) - values[best]) ** 2)))
    # a peak narrower than the grid's cells has its own width of them
    cells = float(np.log(_TAUS_MS[-1] / _TAUS_MS[0]))
    width = np.sqrt(2.0 * np.pi) * min(errors[best] / values[best], 1.0) / cells
    top = tops[best] + float(_KINDS[best])
    return max(log_z, top + float(np.log(width))), top, values[best], std
