"""Spurious samples at random instants: a Hampel test that leaves edges, rails and dead zones alone.

A sample is spurious where it lies further than `threshold` robust standard deviations from the median of
the nine samples around it. A median keeps monotone edges, so a spin-up passes; the scale is that of the
noisiest stretch around, so that a burst of noise passes; and it never falls below what the block and the
calibration record's noise say, so that a saturated or dead stretch, whose own scatter is nil, does not make
outliers of the samples beside it. What lasts for five samples or more is not spurious at a random instant,
and passes too.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

Values = NDArray[Any]  # counts (int32) or raw readings (float64)
Flags = NDArray[np.bool_]

_PIECE = 128  # samples that are searched together, with as many on each side
_STRETCH = 64  # samples whose scatter is judged together: the noisiest of those around counts
_HALF = 4  # samples on each side in the running median
_BURST = 1.6  # of the typical scatter: a stretch is noisier than by chance, four standard errors of its own
_ACTIVE = 0.05  # where fewer differences than this are other than zero, the scatter is not known
_IDLE = 8.0  # floors that stand for a scatter not known: only what is far out is spurious on a rail
#: Quantiles 1/10 and 4/5 of the absolute difference of two normal deviates, in their standard deviations.
_TENTH, _HIGH = 0.1256613468550741 * np.sqrt(2.0), 1.2815515655446004 * np.sqrt(2.0)
_TWO_WIDTHS = 10.0  # the ratio of what these two say of the scatter: 1 in one noise
_FEW_STEPS = 16  # differences of which the lowest tenth says nothing
_PASSES = 6  # after which what is judged by its good neighbours alone no longer changes
_SAME_STEPS = 3  # a smallest step that occurs as often is the converter's; one spike makes two

#: Median of the absolute difference of two normal deviates, in their standard deviations.
_MEDIAN_DIFFERENCE = 0.6744897501960817 * np.sqrt(2.0)

#: Samples of context that a search wants on each side of a block.
CONTEXT = _PIECE


def robust_scale(values: Values, floor: float, idle: float | None = None) -> float:
    """Standard deviation of white noise in `values` (N,), from the differences of neighbours.

    The median absolute difference, differences of zero left out: quantised or clipped values then give
    the size of their steps, not zero. Not below `floor`. Where nearly all differences are zero the scatter
    is not known, and `idle` (default: `floor`) stands for it.
    """
    steps = np.abs(np.diff(values.astype(np.float64, copy=False)))
    steps = steps[steps > 0]
    if steps.size < _ACTIVE * values.size:
        return floor if idle is None else idle
    return max(floor, float(_median(steps) / _MEDIAN_DIFFERENCE))


def robust_scales(parts: Values, floor: float, idle: float) -> NDArray[np.float64]:
    """`robust_scale` of each row of `parts` (..., N), all at once."""
    steps = np.abs(np.diff(parts.astype(np.float64, copy=False), axis=-1))
    steps.sort(axis=-1)
    zeros = np.count_nonzero(steps == 0.0, axis=-1)
    rising = np.count_nonzero(steps > 0.0, axis=-1)
    # the upper median of the steps that are not zero: those that are come first
    middle = np.minimum(zeros + rising // 2, steps.shape[-1] - 1)
    median = np.take_along_axis(steps, middle[..., None], axis=-1)[..., 0]
    scale = np.maximum(floor, median / _MEDIAN_DIFFERENCE)
    return np.where(rising < _ACTIVE * parts.shape[-1], idle, scale)


def _median(values: NDArray[np.float64]) -> float:
    """The upper median: a fraction of np.median's time on a few hundred values, and as good a scale."""
    middle = values.size // 2
    return float(np.partition(values, middle)[middle])


def running_median(windows: Values) -> Values:
    """Median over the last axis of odd length."""
    middle = windows.shape[-1] // 2
    return np.partition(windows, middle, axis=-1)[..., middle]


def isolated(values: Values, threshold: float) -> Flags:
    """Where `values` (N,) leave the median of the nine around them by more than `threshold`."""
    if values.size < 2 * _HALF + 1:
        return np.abs(values - np.median(values)) > threshold
    padded = np.pad(values, _HALF, mode="reflect")
    windows = np.lib.stride_tricks.sliding_window_view(padded, 2 * _HALF + 1)
    return np.abs(np.subtract(values, running_median(windows), dtype=np.float64)) > threshold


def narrow_scales(steps: Values) -> tuple[NDArray[np.float64], Flags]:
    """Standard deviation of the narrower of two noises in each row, and which rows hold two widths.

    Parameters
    ----------
    steps : (m, N) array
        Absolute differences of neighbours, 0 where they say nothing.

    Returns
    -------
    scales : (m,) array
        By the median difference; where the largest fifth is far above what the lowest tenth says, by the
        lowest tenth: of the differences, a quarter at least are noise where half of the samples are.
        0 where all say nothing.
    two : (m,) array of bool
    """
    rows = np.sort(steps, axis=-1)
    rising = np.count_nonzero(rows > 0.0, axis=-1)
    zeros, last = rows.shape[-1] - rising, rows.shape[-1] - 1

    def at(place: NDArray[np.intp]) -> NDArray[np.float64]:
        found: NDArray[np.float64] = np.take_along_axis(rows, np.minimum(place, last)[:, None], axis=1)[:, 0]
        return found

    middle = at(zeros + rising // 2) / _MEDIAN_DIFFERENCE
    lowest, high = at(zeros + rising // 10) / _TENTH, at(zeros + rising * 4 // 5) / _HIGH
    two = (rising >= _FEW_STEPS) & (high > _TWO_WIDTHS * lowest)
    return np.where(two, lowest, middle), two


def dense(values: Values, repeated: Flags, threshold: float, floor: float) -> Flags | None:
    """Spurious samples where they are many, up to a half: two widths in the differences of neighbours.

    The running median of nine is taken over good neighbours alone, found in a few passes; so long as good
    and spurious samples are mixed in each stretch, a burst of noise is none of this.

    Parameters
    ----------
    values : (N,) array
        Samples less what they should be: no edges of a profile in them.
    repeated : (N - 1,) array of bool
        Neighbours that came as the same count, which say nothing of the noise.
    threshold, floor : float
        Standard deviations beyond which a sample is spurious, and the least of these.

    Returns
    -------
    (N,) array of bool, or None where fewer than a quarter of the stretches hold two widths.
    """
    stretches = len(repeated) // _STRETCH
    if not stretches:
        return None
    steps = np.where(repeated, 0.0, np.abs(np.diff(values)))
    scales, two = narrow_scales(steps[: stretches * _STRETCH].reshape(stretches, _STRETCH))
    if np.count_nonzero(two) < 0.25 * stretches:
        return None
    place = np.minimum(np.arange(len(values)) // _STRETCH, stretches - 1)
    limit = threshold * np.maximum(scales, floor)[place]
    found = np.zeros(len(values), bool)
    for _ in range(_PASSES):
        good = np.flatnonzero(~found)
        if good.size < 2 * _HALF + 1:
            return found
        around = np.clip(np.searchsorted(good, np.arange(len(values))), _HALF, good.size - 1 - _HALF)
        windows = np.lib.stride_tricks.sliding_window_view(values[good], 2 * _HALF + 1)
        again = np.abs(values - running_median(windows)[around - _HALF]) > limit
        if np.array_equal(again, found):
            break
        found = again
    return found


class OutlierSearch:
    """Finds spurious samples block by block.

    Parameters
    ----------
    threshold_sigma : float
        Robust standard deviations beyond which a sample is spurious.
    floor : (n,) array
        Least scale of each gyro, in the values' unit: the quantum, or a part of the stated noise.
    """

    def __init__(self, threshold_sigma: float, floor: NDArray[np.float64]) -> None:
        self._threshold = threshold_sigma
        self._floor = floor

    def flags(self, before: Values | None, values: Values, after: Values | None) -> Flags:
        """Which samples are spurious.

        Parameters
        ----------
        before, after : (n, CONTEXT) arrays or None
            The neighbouring samples; None at the ends of the record.
        values : (n, N) array
            Samples, those missing replaced by a neighbour.

        Returns
        -------
        (n, N) array of bool
        """
        n, size = values.shape
        flags = np.zeros((n, size), bool)
        if before is None and after is None and size < 2 * _HALF + 1:
            return flags
        pieces = -(-size // _PIECE)
        padded = _with_context(before, values, after, pieces * _PIECE - size)
        parts = padded.reshape(n, pieces + 2, _PIECE)
        lowest, highest = parts.min(axis=2), parts.max(axis=2)
        spread = np.subtract(_three(highest, np.maximum), _three(lowest, np.minimum), dtype=np.float64)
        stride = max(1, size // 8192)
        for gyro in range(n):
            pairs = padded[gyro, : padded.shape[1] // 2 * 2].reshape(-1, 2)[::stride]
            typical, idle = _scales_of_pairs(pairs, self._floor[gyro])
            # A sample beyond the threshold makes the range of its three pieces at least as wide.
            suspects = np.flatnonzero(spread[gyro] > self._threshold * typical)
            if suspects.size:
                around = np.lib.stride_tricks.sliding_window_view(padded[gyro], 3 * _PIECE)[suspects * _PIECE]
                found = self._search(around, typical, self._floor[gyro], idle)
                whole = np.zeros((pieces, _PIECE), bool)
                whole[suspects] = found
                flags[gyro] = whole.ravel()[:size]
        return flags

    def _search(self, around: Values, typical: float, floor: float, idle: float) -> Flags:
        """Spurious samples of pieces (m, PIECE), each given with its two neighbours, (m, 3 PIECE)."""
        # A burst of noise that begins at the edge of a piece must not be judged by the quiet before it.
        local = robust_scales(around.reshape(len(around), -1, _STRETCH), floor, idle).max(axis=1)
        # The largest of six scales is a fifth above the true one by chance alone: that is no burst.
        local = np.where(local > _BURST * typical, local, typical)
        inner = around[:, _PIECE - _HALF : 2 * _PIECE + _HALF]
        windows = np.lib.stride_tricks.sliding_window_view(inner, 2 * _HALF + 1, axis=1)
        middle = running_median(windows)
        distance = np.abs(np.subtract(around[:, _PIECE : 2 * _PIECE], middle, dtype=np.float64))
        return distance > self._threshold * local[:, None]


def _scales_of_pairs(pairs: Values, floor: float) -> tuple[float, float]:
    """Scatter of a block, and what stands for it where a stretch rests: not below the converter's step."""
    steps = np.abs(np.subtract(pairs[:, 1], pairs[:, 0], dtype=np.float64))
    steps = steps[steps > 0]
    idle = _IDLE * floor
    if steps.size >= _SAME_STEPS:
        least = steps.min()
        if np.count_nonzero(steps == least) >= _SAME_STEPS:
            idle = max(idle, float(least))
    if steps.size < _ACTIVE * len(pairs):
        return floor, idle
    return max(floor, _median(steps) / _MEDIAN_DIFFERENCE), idle


def _with_context(before: Values | None, values: Values, after: Values | None, fill: int) -> Values:
    """Values with CONTEXT samples on each side (mirrored at the record's ends) and padded to whole pieces."""
    size = values.shape[1]
    if before is None:
        head = values[:, np.minimum(np.arange(CONTEXT, 0, -1), size - 1)]
    else:
        head = _fit(before, CONTEXT, last=True)
    joined = np.concatenate((head, values), axis=1)
    tail_size = CONTEXT + fill
    if after is None:
        last = joined.shape[1] - 1
        tail = joined[:, last - np.minimum(np.arange(1, tail_size + 1), last)]
    else:
        tail = _fit(after, tail_size, last=False)
    return np.concatenate((joined, tail), axis=1)


def _fit(context: Values, size: int, *, last: bool) -> Values:
    """Exactly `size` samples nearest to the block, repeating the far end where there are fewer."""
    have = context.shape[1]
    index = np.clip(np.arange(have - size, have), 0, None) if last else np.minimum(np.arange(size), have - 1)
    return context[:, index]


def _three(values: Values, choose: np.ufunc) -> Values:
    """The extreme over each inner piece and its two neighbours."""
    return choose(choose(values[:, :-2], values[:, 1:-1]), values[:, 2:])
