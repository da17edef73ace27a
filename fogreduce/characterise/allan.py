"""Allan deviation of rates, with limits and noise coefficients (of a reduced run: `allan_run`)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Literal, cast

import numpy as np
from numpy.typing import ArrayLike

from fogreduce.characterise.allan_channel import KINDS, channel_of
from fogreduce.characterise.allan_freedom import Kind
from fogreduce.characterise.allan_result import Allan
from fogreduce.characterise.grid import on_grid
from fogreduce.constants import SECONDS_PER_HOUR

if TYPE_CHECKING:
    import xarray as xr

_TO_DEG_H = {"deg/h": 1.0, "deg/s": SECONDS_PER_HOUR}


def allan(
    rates: ArrayLike | xr.Dataset,
    rate_hz: float | None = None,
    *,
    time_s: ArrayLike | None = None,
    unit: Literal["deg/s", "deg/h"] = "deg/s",
    names: Sequence[str] | None = None,
    kinds: Sequence[Kind] = KINDS,
    factors: Sequence[int] | None = None,
    terms: str = "QNBKR",
) -> Allan:
    """Allan deviations, their limits, noise coefficients and spectral density.

    Parameters
    ----------
    rates : (N,) or (n, N) array, or Dataset of `open_run`
        Rates of one or several channels, each the mean over its interval; NaN = missing. Of a run: all gyros
        and x, y, z over its longest segment of constant rate, flagged samples left out, less the sine that
        the table's turn makes of Earth's rate.
    rate_hz : float, optional
        Sample rate [Hz] of an array without gaps in time.
    time_s : (N,) array, optional
        Instead of it, the samples' times [s]: rising, with gaps; equal intervals but for their scatter.
    unit : {"deg/s", "deg/h"}
        Of `rates`. Everything returned is in deg/h, coefficients in the units of IEEE 952.
    names : sequence of str, optional
        Of the channels.
    kinds : sequence of {"overlapping", "modified", "total"}
        Deviations to compute; the noise coefficients need the overlapping one.
    factors : sequence of int, optional
        Averaging times in intervals; by default ten a decade, up to a quarter of the record.
    terms : str
        Noise coefficients to fit, of ``QNBKR``; none for an empty text.

    Returns
    -------
    Allan

    Raises
    ------
    ValueError
        Neither or both of `rate_hz` and `time_s`, or arrays of other shapes.

    Notes
    -----
    Definitions: NIST SP 1065 (Riley 2008). Degrees of freedom: Greenhall and Riley 2003. See docs/allan.md.
    """
    if hasattr(rates, "data_vars"):
        from fogreduce.characterise.allan_run import allan_of_view

        return allan_of_view(cast("xr.Dataset", rates), kinds=kinds, factors=factors, terms=terms)
    values = np.atleast_2d(np.asarray(rates, np.float64))
    if values.ndim != 2:
        raise ValueError(f"rates of shape {np.shape(rates)}; expected (N,) or (channels, N)")
    if (rate_hz is None) == (time_s is None):
        raise ValueError("either rate_hz or time_s is needed, and not both")
    if time_s is not None:
        values, interval_s = on_grid(np.asarray(time_s, np.float64), values)
    else:
        assert rate_hz is not None
        if not rate_hz > 0:
            raise ValueError(f"rate_hz is {rate_hz}; expected a positive number")
        interval_s = 1.0 / rate_hz
    names = [f"channel{k + 1}" for k in range(len(values))] if names is None else list(names)
    if len(names) != len(values):
        raise ValueError(f"{len(names)} names for {len(values)} channels")
    values = values * _TO_DEG_H[unit]
    return Allan(
        [
            channel_of(name, row, interval_s, kinds, factors, terms)
            for name, row in zip(names, values, strict=True)
        ],
        interval_s,
    )
