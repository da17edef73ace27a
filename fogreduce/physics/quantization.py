"""Volts <-> ADC counts, and what counts stand for "no answer" (capture contract, step 6)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fogreduce.constants import LARGEST_COUNT, MISSING_COUNT


def counts_from_volts(volts: NDArray[np.float64], volts_per_count: float) -> NDArray[np.int32]:
    """ADC counts: ``round(v / volts_per_count)`` kept to +-2147483647; NaN becomes "no answer".

    Halves round to even, as IEEE 754 does.

    Parameters
    ----------
    volts : array
        Raw volts [V]; NaN where a gyro does not answer.
    volts_per_count : float
        Size of one count [V].
    """
    counts = volts / volts_per_count
    np.rint(counts, out=counts)
    np.clip(counts, -LARGEST_COUNT, LARGEST_COUNT, out=counts)
    counts[np.isnan(counts)] = MISSING_COUNT
    return counts.astype(np.int32)


def volts_from_counts(counts: NDArray[np.int32], volts_per_count: float) -> NDArray[np.float64]:
    """Raw volts [V]: ``count * volts_per_count``; NaN where the gyro did not answer.

    Inverse of `counts_from_volts` to within half a count.
    """
    volts = counts * np.float64(volts_per_count)
    missing = counts == MISSING_COUNT
    if missing.any():
        volts[missing] = np.nan
    return volts
