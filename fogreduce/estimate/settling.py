"""How long a table takes to reach the next commanded rate, as the gyros show it.

From an edge of the profile on, the rate about the table's axis is formed in short means. Where it first lags
behind by a good part of the step and then comes to rest at a level, the table was accelerating until then.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_MEAN_S = 0.05  # over which the rate is averaged
_FEWEST = 24  # means, fewer tell no level
_LONGEST_S = 120.0  # after an edge that are looked at
_LAG = 0.3  # of the step: what the rate must lack at first
_NOISE = 6.0  # standard deviations of a mean, and
_REST = 1e-4  # of the step: a departure from the level that is smaller is none
_GAP = 3  # means below that in a row: at rest

#: Median absolute difference of two normal deviates, in their standard deviations.
_MEDIAN_DIFFERENCE = 0.6744897501960817 * np.sqrt(2.0)


def rate_about_axis(gyro_rate: Array, axes: Array, axis: Array) -> Array | None:
    """Rate about an axis [deg/s] (N,), least squares over the gyros; None where no gyro senses it.

    Parameters
    ----------
    gyro_rate : (n, N) array
        Rates about the gyros' input axes [deg/s].
    axes : (n, 3) array
        Directions of the input axes.
    axis : (3,) array
        Unit vector.
    """
    seen = axes @ axis
    if not (square := float(seen @ seen)) > 0:
        return None
    rate: Array = seen @ gyro_rate / square
    return rate


def settling_time_s(time_s: Array, rate_deg_s: Array, step_deg_s: float) -> float:
    """How long after an edge the rate settles.

    Parameters
    ----------
    time_s : (N,) array
        Since the edge [s].
    rate_deg_s : (N,) array
        Rate about the table's axis [deg/s].
    step_deg_s : float
        By how much the commanded rate changes at the edge [deg/s].

    Returns
    -------
    float
        0 where the rate does not lag, or does not come to rest within the first half of the record given [s].
    """
    if time_s.size < _FEWEST or not step_deg_s:
        return 0.0
    size = max(1, round(_MEAN_S * (time_s.size - 1) / max(float(time_s[-1] - time_s[0]), 1e-9)))
    count = time_s.size // size
    if count < _FEWEST:
        return 0.0
    means = np.median(rate_deg_s[: count * size].reshape(count, size), axis=1)
    end_s = time_s[size - 1 : count * size : size]
    later = means[count // 2 :]
    noise = float(np.median(np.abs(np.diff(later)))) / _MEDIAN_DIFFERENCE
    # what the step lacks still, a positive number while the rate lags
    lack = (float(np.median(later)) - means) * np.sign(step_deg_s)
    least = max(_NOISE * noise, _REST * abs(step_deg_s))
    if lack[0] < max(_LAG * abs(step_deg_s), least):
        return 0.0
    moving = np.abs(lack) > least
    moving |= np.convolve(moving, np.ones(_GAP), mode="full")[: moving.size] > 0
    settled = int(np.argmin(moving)) if not moving.all() else count
    return float(end_s[settled - 1]) if settled < count // 2 else 0.0


def window_s(segment_s: float) -> float:
    """How much of a segment of constant rate is looked at [s]."""
    return min(segment_s, _LONGEST_S)
