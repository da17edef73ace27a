"""Raw readings <-> counts, and what counts stand for "no answer" (capture contract, step 6)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fogreduce.constants import LARGEST_COUNT, MISSING_COUNT


def counts_from_raw(raw: NDArray[np.float64], least_count: float) -> NDArray[np.int32]:
    """Counts: ``round(v / least_count)`` kept to +-2147483647; NaN becomes "no answer".

    Halves round to even, as IEEE 754 does.

    Parameters
    ----------
    raw : array
        Raw readings [raw unit]; NaN where a gyro does not answer.
    least_count : float
        What one count stands for [raw unit].
    """
    counts = raw / least_count
    np.rint(counts, out=counts)
    np.clip(counts, -LARGEST_COUNT, LARGEST_COUNT, out=counts)
    counts[np.isnan(counts)] = MISSING_COUNT
    return counts.astype(np.int32)


def raw_from_counts(counts: NDArray[np.int32], least_count: float) -> NDArray[np.float64]:
    """Raw readings [raw unit]: ``count * least_count``; NaN where the gyro did not answer.

    Inverse of `counts_from_raw` to within half a count.
    """
    raw = counts * np.float64(least_count)
    missing = counts == MISSING_COUNT
    if missing.any():
        raw[missing] = np.nan
    return raw
