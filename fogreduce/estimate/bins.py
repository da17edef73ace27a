"""A record summed up in at most some thousand bins: mean, scatter, lowest and highest value of each.

A bin is a fixed number of consecutive records, so its size does not depend on the data. Lowest and highest
are of every sample that is there, spurious ones too: an envelope drawn from them hides no spike.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

MOST_BINS = 8192
_FEWEST_BINS = 512


def bin_size(n_records: int, sample_rate_hz: float, block_records: int) -> int:
    """Records in a bin: a power of two near one second, more for a long record, fewer for a short one."""
    size = 2 ** max(0, round(math.log2(sample_rate_hz)))
    while n_records / size > MOST_BINS and 2 * size <= block_records:
        size *= 2
    while size > 8 and n_records / size < _FEWEST_BINS:
        size //= 2
    return min(size, block_records)


@dataclass(frozen=True)
class Bins:
    """Bins of several channels.

    Attributes
    ----------
    time_s : (m,) array
        Mean stamp of each bin's records [s].
    count : (channels, m) array
        Usable records.
    mean, scatter : (channels, m) arrays
        Mean and standard deviation (about the bin's mean) of the usable values; NaN where there are too few.
    lowest, highest : (channels, m) arrays
        Extremes of all values that are there; NaN where there is none.
    """

    time_s: Array
    count: Array
    mean: Array
    scatter: Array
    lowest: Array
    highest: Array

    @classmethod
    def joined(cls, parts: list[Bins]) -> Bins:
        """Consecutive bins, put end to end."""
        return cls(
            *(
                np.concatenate([getattr(part, name) for part in parts], axis=-1)
                for name in ("time_s", "count", "mean", "scatter", "lowest", "highest")
            )
        )

    def stacked(self, other: Bins) -> Bins:
        """The same bins with the channels of `other` after these."""
        names = ("count", "mean", "scatter", "lowest", "highest")
        return Bins(
            self.time_s, *(np.concatenate((getattr(self, name), getattr(other, name))) for name in names)
        )


def bins_of(time_s: Array, values: Array, usable: NDArray[np.bool_] | None, size: int) -> Bins:
    """Bins of a block.

    Parameters
    ----------
    time_s : (N,) array
        Stamps [s].
    values : (channels, N) array
        NaN where missing.
    usable : (channels, N) array of bool or None
        Which values count for mean and scatter; None = all (and none is NaN).
    size : int
        Records a bin; the last bin of a block may hold fewer.
    """
    whole = time_s.size // size * size
    parts = [_bins(time_s[:whole], values[:, :whole], _cut(usable, 0, whole), size)]
    if whole < time_s.size:
        rest = time_s.size - whole
        parts.append(_bins(time_s[whole:], values[:, whole:], _cut(usable, whole, None), rest))
    return Bins.joined(parts)


def _cut(usable: NDArray[np.bool_] | None, start: int, stop: int | None) -> NDArray[np.bool_] | None:
    return None if usable is None else usable[:, start:stop]


def _bins(time_s: Array, values: Array, usable: NDArray[np.bool_] | None, size: int) -> Bins:
    cells = values.reshape(len(values), -1, size)
    time = time_s.reshape(-1, size).mean(axis=1)
    mean = cells.mean(axis=2)
    left = cells - mean[:, :, None]
    count = np.full(mean.shape, float(size))
    scatter = np.sqrt(_divide(np.einsum("cms,cms->cm", left, left), count - 1))
    bins = Bins(time, count, mean, scatter, cells.min(axis=2), cells.max(axis=2))
    if usable is not None:
        good = usable.reshape(cells.shape)
        odd = np.nonzero(~good.all(axis=2))
        _mend(bins, odd, cells[odd], good[odd])
    return bins


def _mend(bins: Bins, odd: tuple[NDArray[np.intp], ...], values: Array, good: NDArray[np.bool_]) -> None:
    """The bins in which some values do not count, done again: values and which of them count, (k, size)."""
    count = good.sum(axis=1).astype(np.float64)
    mean = _divide(np.where(good, values, 0.0).sum(axis=1), count)
    left = np.where(good, values - mean[:, None], 0.0)
    there = ~np.isnan(values)
    empty = ~there.any(axis=1)
    lowest = np.where(there, values, np.inf).min(axis=1)
    highest = np.where(there, values, -np.inf).max(axis=1)
    lowest[empty] = highest[empty] = np.nan
    bins.count[odd] = count
    bins.mean[odd] = mean
    bins.scatter[odd] = np.sqrt(_divide(np.einsum("ks,ks->k", left, left), count - 1))
    bins.lowest[odd] = lowest
    bins.highest[odd] = highest


def _divide(values: Array, counts: Array) -> Array:
    """Quotient; NaN where the divisor is not positive."""
    return np.divide(values, counts, out=np.full(values.shape, np.nan), where=counts > 0)
