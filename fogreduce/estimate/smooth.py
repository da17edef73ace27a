"""A slow quantity out of a log that has white noise: the smoother of a random walk of its second derivative.

With d the third differences of the rows, ``d = D y`` is noise of covariance ``s^2 (D D' + q I)``: the log's
own noise, and how far the quantity bends. The ratio q is the one of greatest likelihood, s^2 goes with it.
Smoothed rows are ``y - D' (D D' + q I)^-1 D y`` (Whittaker 1923; q by likelihood: Kitagawa and Gersch 1984,
J. Amer. Statist. Assoc. 79, 378).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_THIRD = np.array([-1.0, 3.0, -3.0, 1.0])
#: Of 1e-12, rows are smooth over some hundred of them; of 10, as good as free.
_RATIOS = np.geomspace(1e-12, 10.0, 14)


def smoothed(values: Array) -> Array:
    """Evenly spaced rows (k,) less their white noise; as they are where there are fewer than eight."""
    from scipy.linalg import cho_solve_banded, cholesky_banded

    rows = len(values)
    if rows < 8:
        return values
    d = np.diff(values, 3)
    of_differences = np.zeros((4, rows - 3))  # of D D', below its diagonal
    for lag in range(4):
        of_differences[lag, : rows - 3 - lag] = _THIRD[: 4 - lag] @ _THIRD[lag:]
    best, least = values, np.inf
    for ratio in _RATIOS:
        covariance = of_differences.copy()
        covariance[0] += ratio
        factor = cholesky_banded(covariance, lower=True)
        solved = cho_solve_banded((factor, True), d)
        squares = float(d @ solved)
        if squares <= 0.0:
            return values
        minus = 0.5 * len(d) * np.log(squares) + float(np.sum(np.log(factor[0])))
        if minus < least:
            noise = np.convolve(solved, _THIRD)
            best, least = values - noise, minus
    return best
