"""What rounding to whole counts does to a mean curve when the noise is too small to even it out.

Noise of standard deviation s before rounding to steps of q leaves an error that depends on where between two
steps the value lies: a sum of sines of amplitude q / (pi k) exp(-2 (pi k s / q)^2), k = 1, 2, ... (Widrow and
Kollar, Quantization Noise, 2008, ch. 9). At s = q it is 1e-9 of a step; without noise its variance is
q^2 / 12. As the value moves slowly, the error stays the same from record to record, and no averaging takes
it away.
"""

from __future__ import annotations

import math

import numpy as np

_TERMS = 1000  # of the series, which without noise is then short of its sum by 6e-4
_NEGLIGIBLE = 1e-9  # of the noise's variance
#: A sawtooth is like itself for about this part of its period, which is a step of the value.
_LIKE_ITSELF = 0.25


def systematic_variance(step: float, sigma: float) -> float:
    """Variance of the error that rounding leaves in the mean.

    Parameters
    ----------
    step : float
        q.
    sigma : float
        Standard deviation of the rounded values about their mean curve. Rounding itself is in it.

    Returns
    -------
    float
        In the square of their unit; 0 where it is negligible beside the noise.
    """
    if step <= 0:
        return 0.0
    quiet = math.sqrt(max(0.0, sigma**2 - step**2 / 12)) / step
    if quiet == 0.0:
        return step**2 / 12
    k = np.arange(1, _TERMS + 1)
    amplitudes = step / (math.pi * k) * np.exp(-2 * (math.pi * k * quiet) ** 2)
    total = 0.5 * float(amplitudes @ amplitudes)
    return total if total > _NEGLIGIBLE * sigma**2 else 0.0


def correlation_time(step: float, moved: float, duration_s: float) -> float:
    """How long the error of rounding stays like itself [s], while a value moves by `moved` in a segment."""
    return _LIKE_ITSELF * duration_s / max(1.0, moved / step)
