"""The interval between two samples, by which angle increments are divided: stated, or as stamps show it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fogreduce.constants import MICROSECONDS_PER_SECOND

_RESOLUTION_US = 1.0  # of stamps, whole microseconds
_GAUSSIAN = 1.4826  # standard deviation of normal errors over the median of their sizes


def sample_interval_s(pulse: NDArray[np.int64], time_us: NDArray[np.int64], stated_rate_hz: float) -> float:
    """Interval between two samples [s].

    The stated rate's, unless the stamps contradict it by more than their scatter allows: a clock that is read
    coarsely or with jitter knows the interval no better than its scatter over the time that it was read.

    Parameters
    ----------
    pulse : (N,) array
        Numbers of the samples.
    time_us : (N,) array
        Their stamps [us]; a few may be wrong.
    stated_rate_hz : float
    """
    stated_us = MICROSECONDS_PER_SECOND / stated_rate_hz
    half = pulse.size // 2
    if half == 0:
        return 1.0 / stated_rate_hz
    # Pairs half the record apart (Theil and Sen): wrong stamps, and what came late, move no median.
    apart = (pulse[half:] - pulse[:-half]).astype(np.float64)
    excess_us = (time_us[half:] - time_us[:-half]) - apart * stated_us
    later = apart > 0
    if not later.any():
        return 1.0 / stated_rate_hz
    excess_us, apart = excess_us[later], apart[later]
    middle_us = float(np.median(excess_us))
    scatter_us = _GAUSSIAN * float(np.median(np.abs(excess_us - middle_us)))
    if abs(middle_us) <= _RESOLUTION_US + 2.0 * scatter_us:
        return 1.0 / stated_rate_hz
    return (stated_us + float(np.median(excess_us / apart))) / MICROSECONDS_PER_SECOND
