"""Samples of unequal stamps put on equal intervals; a lost one leaves a hole."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_ROUNDS = 20


def on_grid(time_s: Array, values: Array) -> tuple[Array, float]:
    """Samples at whole numbers of intervals, as their times have it.

    Parameters
    ----------
    time_s : (N,) array
        Times [s], rising; of two samples that fall on one place the first counts.
    values : (n, N) array
        Channels.

    Returns
    -------
    (n, M) array
        NaN where there is no sample.
    float
        The interval [s]: the slope of the times against their places.

    Raises
    ------
    ValueError
        Times that do not rise, are not finite, or are as many as no channel has values.
    """
    if time_s.ndim != 1 or time_s.size != values.shape[1]:
        raise ValueError(f"time_s of shape {time_s.shape} for {values.shape[1]} samples")
    if time_s.size < 2 or not np.isfinite(time_s).all():
        raise ValueError("time_s needs two finite times or more")
    steps = np.diff(time_s)
    if not (steps >= 0).all() or time_s[-1] == time_s[0]:
        first = int(np.argmax(steps < 0)) + 1
        raise ValueError(
            f"time_s[{first}] is {time_s[first]}, before the one before it; expected rising times"
        )
    # Each step alone gives a start that does not drift with a rounded interval; then all places together.
    interval = float(np.median(steps[steps > 0]))
    place = np.concatenate(([0.0], np.cumsum(np.rint(steps / interval))))
    for _ in range(_ROUNDS):
        centred = place - place.mean()
        interval = float(centred @ time_s / (centred @ centred))
        before, place = place, np.rint((time_s - time_s.mean()) / interval + place.mean())
        if np.array_equal(before, place):
            break
    whole = (place - place[0]).astype(np.int64)
    found = np.full((values.shape[0], int(whole.max()) + 1), np.nan)
    found[:, whole[::-1]] = values[:, ::-1]
    return found, interval
