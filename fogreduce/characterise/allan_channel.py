"""Allan deviation of one channel of rates, with limits and noise coefficients; its spectral density."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fogreduce.characterise.allan_distribution import relative_limits
from fogreduce.characterise.allan_fit import Coefficient, fit_noise_terms
from fogreduce.characterise.allan_freedom import Kind, degrees_of_freedom
from fogreduce.characterise.allan_noise_type import noise_types
from fogreduce.characterise.spectrum import Spectrum, spectrum
from fogreduce.estimate.allan_variance import (
    Estimate,
    Series,
    modified,
    overlapping,
    spaced_factors,
    total,
)

Array = NDArray[np.float64]

KINDS: tuple[Kind, ...] = ("overlapping", "modified", "total")
_PER_DECADE = 10.0
_LONGEST_PART = 4  # averaging times go up to this part of the series
_FIT_PART = 6  # and up to this part of it in the fit
_FIT_PER_OCTAVE = 2  # averaging times in the fit: more of them tell nothing new
_FIT_FEWEST = 8
#: Below so many intervals the variance of a flicker or walk that is sampled differs from that of its means:
#: Q takes that up; a fit without Q begins there.
_FIT_FIRST = 3


@dataclass(frozen=True)
class Deviations:
    """One Allan deviation of one channel; arrays are (k,), along the averaging times.

    Attributes
    ----------
    tau_s : array
        Averaging times [s].
    deviation : array
        [deg/h]; NaN where no window is whole enough, or gaps leave it undetermined. A total deviation is as
        defined, not corrected for its bias; its limits are.
    alpha : array of int
        Type of noise: exponent of the rate's density, 2 (quantization) to -2 (rate random walk).
    freedom : array
        Equivalent degrees of freedom.
    windows : array
        Second differences that it is the mean of.
    low_68, high_68, low_95, high_95 : arrays
        Limits of the true Allan deviation [deg/h], as much on either side; noise of this record only.
    """

    tau_s: Array
    deviation: Array
    alpha: NDArray[np.int64]
    freedom: Array
    windows: Array
    low_68: Array
    high_68: Array
    low_95: Array
    high_95: Array


@dataclass(frozen=True)
class Channel:
    """Allan deviations, noise coefficients and spectral density [(deg/h)^2/Hz] of one gyro or axis."""

    name: str
    samples: int
    missing: int
    deviations: dict[Kind, Deviations]
    coefficients: list[Coefficient]
    spectrum: Spectrum

    def coefficient(self, symbol: str) -> Coefficient:
        """The coefficient of that symbol: Q, N, B, K or R."""
        return next(one for one in self.coefficients if one.noise.symbol == symbol)


def channel_of(
    name: str,
    values: Array,
    interval_s: float,
    kinds: Sequence[Kind] = KINDS,
    factors: Sequence[int] | None = None,
    terms: str = "QNBKR",
    *,
    density: bool = True,
) -> Channel:
    """One channel: rates [deg/h] at equal intervals, NaN where there is none; `density`: its spectrum too."""
    series = Series(values)
    size = values.size
    used = sorted(set(factors)) if factors is not None else spaced_factors(size // _LONGEST_PART, _PER_DECADE)
    some = np.isfinite(values).any()
    alphas = noise_types(series, used) if some else []
    deviations = {kind: _deviations(series, kind, used, alphas, interval_s) for kind in kinds} if some else {}
    missing = 0 if series.there is None else int(np.count_nonzero(~series.there))
    return Channel(
        name,
        size,
        missing,
        deviations,
        _coefficients(series, interval_s, terms) if terms and some else [],
        spectrum(series, interval_s) if some and density else Spectrum(*np.zeros((3, 0))),
    )


def _deviations(
    series: Series, kind: Kind, factors: list[int], alphas: list[int], interval_s: float
) -> Deviations:
    estimates = _estimates(series, kind, factors)
    size = series.values.size
    variance = np.array([one.variance for one in estimates])
    # Windows lost to gaps, and the scatter of what is taken away for samples lost within them.
    share = np.array([one.part / one.inflation**2 for one in estimates])
    whole = [degrees_of_freedom(kind, alpha, m, size) for alpha, m in zip(alphas, factors, strict=True)]
    freedom = share * np.array(whole)
    variance[~(variance > 0) | ~(freedom > 0)] = np.nan
    deviation = np.sqrt(variance)
    rows = zip(alphas, factors, freedom.tolist(), share.tolist(), strict=True)
    around = np.array([relative_limits(kind, alpha, m, size, each, part) for alpha, m, each, part in rows])
    return Deviations(
        np.array(factors, float) * interval_s,
        deviation,
        np.array(alphas, np.int64),
        freedom,
        np.array([one.windows for one in estimates]),
        *(deviation[:, None] * around.reshape(-1, 4)).T,
    )


def _estimates(series: Series, kind: Kind, factors: list[int]) -> list[Estimate]:
    if kind == "overlapping":
        return [overlapping(series, factor) for factor in factors]
    if kind == "modified":
        return [modified(series, factor) for factor in factors]
    reach = min(max(factors, default=1), series.values.size)
    extended = series.mirrored(reach)
    return [total(series, factor, extended) for factor in factors]


def _coefficients(series: Series, interval_s: float, terms: str) -> list[Coefficient]:
    """The fit, on averaging times of its own; none where too few of them are determined."""
    size = series.values.size
    longest = size // _FIT_PART
    octaves = int(np.log2(longest) * _FIT_PER_OCTAVE) + 1 if longest >= 1 else 0
    first = 1 if "Q" in terms else _FIT_FIRST
    spaced = {round(2.0 ** (k / _FIT_PER_OCTAVE)) for k in range(octaves)}
    factors = sorted(factor for factor in spaced if factor >= first)
    found = [(factor, overlapping(series, factor)) for factor in factors]
    good = [(factor, one) for factor, one in found if one.variance > 0 and one.part > 0]
    if len(good) < _FIT_FEWEST:
        return []
    return fit_noise_terms(
        tuple(factor for factor, _ in good),
        interval_s,
        size,
        np.array([one.variance for _, one in good]),
        np.array([one.inflation / np.sqrt(one.part) for _, one in good]),
        terms,
    )
