"""How far stamps lead their records' places, and where records were lost: one window of a capture.

Lead is where a stamp puts its record, in intervals at the rate that the stamps show, less its place in the
file. It is constant while nothing is lost and steps up where records are. Two cases:

- Stamps that resolve the sampling: intervals are whole numbers of samples but for a small part. Rounded, they
  say which record is lost, late, or has a stamp of its neighbour.
- Stamps that do not (whole seconds, records delivered in bunches, jitter of half an interval and more):
  only a step of the lead's level that stays, at a long interval, is a hole. What a burst of short intervals
  makes up for is none.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fogreduce.estimate.outliers import running_median

Array = NDArray[np.float64]
Integers = NDArray[np.int64]
Flags = NDArray[np.bool_]

#: Intervals within this part of their median are one sample long, whatever their jitter.
_ONE_SAMPLE = 0.25
#: Intervals are whole numbers of samples where so many of them are, to within so much.
_WHOLE, _SHARE = 0.3, 0.98
#: At most so many stamps that repeat or go back, where stamps resolve the sampling.
_FEW = 0.05
#: A resolution coarser than this, in samples: a slow beat of stamps and samples looks like lost records.
_COARSE = 0.4
#: Lengths of a sample that may be believed without more, in those at the stated rate.
_PLAUSIBLE = (0.4, 2.5)
#: Records on each side over which the lead's level is formed: at least, and in lengths of a bunch.
_LEVEL, _BUNCHES = 48, 4
#: Standard errors of the level's step, and part of the lead's range in a bunch, that a hole must exceed.
_CERTAIN, _OF_RANGE = 5.0, 0.5
#: The lowest lead must rise by this part of the mean's step: a burst that catches up does not.
_LOWEST_TOO = 0.3
#: Length of the interval that holds the middle half of normal deviates, in their standard deviations.
_MIDDLE_HALF = 1.3489795003921634

_HALF = 4  # samples on each side in the running median


@dataclass(frozen=True)
class WindowOrder:
    """The order of a window's records.

    Attributes
    ----------
    number : (N,) int64
        Numbers of the records, from that of the first, which is 0 unless it came late.
    off : (N,)
        How far each stamp is from where its number puts it [samples], less the window's median.
    interval : float
        Length of a sample by the stamps [samples at the stated rate].
    """

    number: Integers
    off: Array
    interval: float


def window_order(place: Array, resolution: float = 0.0) -> WindowOrder:
    """Number the records of a window.

    Parameters
    ----------
    place : (N,) array
        Stamps [samples at the stated rate], without records sent again and steps back.
    resolution : float
        Of which the stamps are multiples, in the same unit.
    """
    index = np.arange(place.size)
    if place.size < 3:
        number = np.rint(place - place[0]).astype(np.int64) if place.size else index
        number = np.maximum(number, index)
        return WindowOrder(number, np.zeros(place.size), 1.0)
    steps = np.diff(place)
    interval, resolved = _interval(place, steps, resolution)
    if resolved:
        number = _resolved_numbers(steps, interval)
    else:
        number = index + _lost_before(place, interval, resolution)
    if np.ptp(number) > 0:
        interval = _slope(place, number)
    if not resolved and interval > 0:
        number = index + _lost_before(place, interval, resolution)
        interval = _slope(place, number)
    off = place / interval - number if interval > 0 else np.zeros(place.size)
    return WindowOrder(number, off - np.median(off), interval)


def _interval(place: Array, steps: Array, resolution: float) -> tuple[float, bool]:
    """Length of a sample [samples at the stated rate], and whether the stamps resolve single samples."""
    mean = float(place[-1] - place[0]) / steps.size
    typical = float(np.median(steps))
    if typical > 0 and (typical > 0.5 * mean or _PLAUSIBLE[0] < typical < _PLAUSIBLE[1]):
        near = steps[np.abs(steps - typical) < _ONE_SAMPLE * typical]
        interval = float(near.mean())
        whole = np.rint(steps / interval)
        astray = np.count_nonzero(np.abs(steps / interval - whole) > _WHOLE)
        back = np.count_nonzero(whole <= 0)
        if astray <= (1 - _SHARE) * steps.size and back <= max(2, _FEW * steps.size):
            if resolution <= _COARSE * interval or abs(interval - 1) <= abs(mean - 1):
                return interval, True
            # With coarse stamps a beat looks like lost records: the stated rate decides which of them it is.
            return mean, False
    return _interval_of_bunches(place, steps), False


def _interval_of_bunches(place: Array, steps: Array) -> float:
    """Length of a sample where single intervals do not tell: the level's median rise from group to group."""
    longest = _longest_run(steps <= 0.5 * (place[-1] - place[0]) / steps.size)
    size = max(1, min(_LEVEL, place.size // 8))
    if longest > size // _BUNCHES:
        starts = np.flatnonzero(steps > 0.5 * (place[-1] - place[0]) / steps.size)
        if starts.size > 2:
            return float(np.median((place[starts + 1] - place[starts])[1:] / np.diff(starts)))
    groups = place[: place.size // size * size].reshape(-1, size)
    interval = _shortest_half(np.diff(np.median(groups, axis=1)))[0] / size
    return interval if interval > 0 else max(float(place[-1] - place[0]) / steps.size, 0.0)


def _resolved_numbers(steps: Array, interval: float) -> Integers:
    """Numbers where intervals are whole numbers of samples.

    Records keep their order; one whose stamp puts it into a place that no other has came late or early.
    """
    whole = np.rint(steps / interval).astype(np.int64)
    lead = np.concatenate(([0], np.cumsum(whole - 1)))
    index = np.arange(lead.size)
    if not lead.any():
        return index
    apart = lead != median_of_nine(lead)
    number = np.empty(lead.size, np.int64)
    in_order = np.flatnonzero(~apart)
    lead_in_order = lead[in_order] + in_order - np.arange(in_order.size)
    # Late records that then come in a burst lost nothing: only what stays is lost.
    level = _least_of_next(median_of_nine(lead_in_order), _longest_run(whole < 1))
    number[in_order] = np.arange(in_order.size) + np.cumsum(np.maximum(np.diff(level, prepend=level[0]), 0))
    taken = set(number[in_order].tolist())
    for k in np.flatnonzero(apart).tolist():
        # beside records in order of the same lead, a stamp tells a number by its distance
        near = in_order[min(int(np.searchsorted(in_order, k)), in_order.size - 1)]
        wanted = int(number[near] + (lead[k] + k) - (lead[near] + near))
        before = int(number[k - 1]) if k else -1
        free = wanted not in taken and 0 <= wanted <= number[in_order[-1]]
        number[k] = wanted if free else before + 1 if before + 1 not in taken else before
        taken.add(int(number[k]))
    return number


def _lost_before(place: Array, interval: float, resolution: float) -> Integers:
    """Records lost before each one: steps of the lead's level that stay."""
    lost = np.zeros(place.size, np.int64)
    steps = np.diff(place) / interval
    if steps.max(initial=0.0) < 1.5:
        return lost
    lead = place / interval - np.arange(place.size)
    calm = median_of_nine(lead)
    far = np.abs(lead - calm) > np.ptp(calm) + 1
    lead = np.where(far, calm, lead)
    bunch = _longest_run(steps < 0.9)
    width = max(1, min(max(_LEVEL, _BUNCHES * bunch), place.size // 4))
    coarse = 1.5 * resolution / interval if resolution > _COARSE * interval and bunch <= 2 else 0.0
    least = max(coarse, _least_rise(lead, steps, width, bunch))
    # A window that holds less than two bunches has no level.
    margin = 2 * bunch if bunch > 2 else 0
    while True:
        found = _steps_up(lead, steps, width, least, margin)
        if not found:
            return lost
        for at, rise in found:
            lost[at + 1 :] += rise
            lead[at + 1 :] -= rise


def _least_rise(lead: Array, steps: Array, width: int, bunch: int) -> float:
    """The least step of the level that is a hole, in samples."""
    groups = lead[: lead.size // width * width].reshape(-1, width)
    rises = np.diff(groups.mean(axis=1))
    error = _shortest_half(rises)[1] if rises.size > 4 else 0.0
    usual = float(np.quantile(steps, 1 - 1 / (2 * bunch))) if bunch > 2 else 1.0
    return max(0.5, _CERTAIN * error, _OF_RANGE * (usual - 1))


def _shortest_half(values: Array) -> tuple[float, float]:
    """Middle of the shortest interval that holds half of the values, and the standard deviation it tells.

    Steps that holes make in less than half of them do not move it.
    """
    ordered = np.sort(values)
    half = (ordered.size + 1) // 2
    lengths = ordered[half - 1 :] - ordered[: ordered.size - half + 1]
    at = int(np.argmin(lengths))
    return float(np.median(ordered[at : at + half])), float(lengths[at]) / _MIDDLE_HALF


def _steps_up(lead: Array, steps: Array, width: int, least: float, margin: int) -> list[tuple[int, int]]:
    """Records after which the lead's level rises, and by how many records; none nearer than `width`."""
    sums = np.concatenate(([0.0], np.cumsum(lead)))
    index = np.arange(1, lead.size)
    low, high = np.maximum(index - width, 0), np.minimum(index + width, lead.size)
    before = (sums[index] - sums[low]) / (index - low)
    after = (sums[high] - sums[index]) / (high - index)
    rise = np.where(steps > 1 + _OF_RANGE * least, after - before, 0.0)
    rise[:margin] = 0.0
    rise[rise.size - margin :] = 0.0
    candidates = np.flatnonzero(rise > least)
    taken = np.zeros(lead.size, bool)
    found = []
    for at in candidates[np.argsort(-rise[candidates], kind="stable")].tolist():
        if taken[at]:
            continue
        behind, ahead = slice(max(at + 1 - width, 0), at + 1), slice(at + 1, at + 1 + width)
        if lead[ahead].min() - lead[behind].min() > _LOWEST_TOO * rise[at]:
            taken[max(at - width, 0) : at + width] = True
            found.append((at, max(1, round(float(rise[at])))))
    return found


def _least_of_next(values: Integers, width: int) -> Integers:
    """Least of each value and the `width` that follow it."""
    least, reach = values, 1
    while reach <= width:
        step = min(reach, width + 1 - reach)
        following = np.concatenate((least[step:], np.full(min(step, least.size), least[-1])))[: least.size]
        least = np.minimum(least, following)
        reach += step
    return least


def _slope(place: Array, number: Integers) -> float:
    """Least squares slope of stamps over numbers, stamps far off left out."""
    x = number - number.mean()
    keep = np.ones(place.size, bool)
    slope = 0.0
    for _ in range(2):
        u = x[keep] - x[keep].mean()
        if not u.any():
            return slope
        slope = float(u @ place[keep]) / float(u @ u)
        left = np.abs(place - slope * x - np.median(place - slope * x))
        keep = left <= max(8.0, 5 * float(np.median(left)))
        if keep.all() or np.count_nonzero(keep) < 3:
            break
    return slope


def median_of_nine(values: NDArray[Any]) -> NDArray[Any]:
    """Running median over nine, over fewer at the ends: monotone steps keep their place."""
    calm = values.copy()
    if values.size > 2 * _HALF:
        windows = np.lib.stride_tricks.sliding_window_view(values, 2 * _HALF + 1)
        calm[_HALF:-_HALF] = running_median(windows)
    for k in range(1, min(_HALF, (values.size + 1) // 2)):
        calm[k] = running_median(values[: 2 * k + 1])
        calm[-1 - k] = running_median(values[-2 * k - 1 :])
    return calm


def _longest_run(flags: Flags) -> int:
    """Length of the longest stretch of True."""
    edges = np.flatnonzero(np.diff(np.concatenate(([0], flags.view(np.int8), [0]))))
    return int((edges[1::2] - edges[::2]).max(initial=0))
