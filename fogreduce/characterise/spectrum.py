"""Power spectral density of a series, in bands of equal width on a logarithmic scale."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fogreduce.estimate.allan_variance import Series

Array = NDArray[np.float64]

_BANDS_PER_DECADE = 12
_FIRST = 3  # a Hann window mixes the lowest frequencies with the mean
#: Under a Hann window powers correlate by (2/3)^2 and (1/6)^2 with the next two: so many fewer count.
_HANN = 1.0 + 2.0 * ((2.0 / 3.0) ** 2 + (1.0 / 6.0) ** 2)


class Spectrum(NamedTuple):
    """One-sided density in bands: middles [Hz], density [unit^2/Hz], degrees of freedom."""

    frequency_hz: Array
    density: Array
    freedom: Array


def spectrum(series: Series, interval_s: float) -> Spectrum:
    """Periodogram of the whole series under a Hann window, averaged in bands.

    Holes are bridged by straight lines, and the density is made up for the samples lost: right for white
    noise, and for what is slower than the holes are long.
    """
    values = series.values - np.nanmean(series.values)
    size = values.size
    window = np.hanning(size + 2)[1:-1]
    there = np.ones(size, bool) if series.there is None else series.there
    if series.there is not None:
        at = np.arange(size)
        values = np.where(there, values, np.interp(at, at[there], values[there]))
    power = 2.0 * interval_s * np.abs(np.fft.rfft(values * window)) ** 2 / np.sum(window[there] ** 2)
    frequency = np.fft.rfftfreq(size, interval_s)
    if frequency.size <= _FIRST:
        return Spectrum(np.zeros(0), np.zeros(0), np.zeros(0))
    bands = np.floor(np.log10(frequency[_FIRST:]) * _BANDS_PER_DECADE).astype(int)
    edges = np.concatenate(([0], np.flatnonzero(np.diff(bands)) + 1))
    counts = np.diff(np.concatenate((edges, [bands.size])))
    middles = np.exp(np.add.reduceat(np.log(frequency[_FIRST:]), edges) / counts)
    density = np.add.reduceat(power[_FIRST:], edges) / counts
    return Spectrum(middles, density, np.maximum(2.0, 2.0 * counts / _HANN))
