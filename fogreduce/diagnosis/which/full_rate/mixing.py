"""Lines that no effect of the catalogue makes: locked to the run's start, or two that mix."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fogreduce.diagnosis.which.full_rate.line_evidence import best_of, leading, sizes_log

Array = NDArray[np.float64]

_TONES = 14  # the strongest lines that are tried in pairs
_BEYOND = 3.0  # ln evidence that a second line and a mixture must bring beside the strongest line alone


def unknown_lines(
    lines: Sequence[NDArray[np.complex128]], power: Array, hz: Array, free: NDArray[np.bool_], count: float
) -> list[tuple[float, float, int]]:
    """What no line of the catalogue does: one whose phase is the same in every run, two that mix.

    Parameters
    ----------
    lines : (L,) arrays
        Amplitudes of one gyro in each run, of unit variance in each quadrature.
    power : (L,) array
        Sum over runs of their squares.
    hz : (L,) array
    free : (L,) array of bool
        Which lines may be looked at.
    count : float
        Lines that are independent.

    Returns
    -------
    list of (ln evidence, gain in ln likelihood, index of the line)
    """
    out: list[tuple[float, float, int]] = []
    kinds: list[tuple[list[Array], Array]] = []
    if len(lines) > 1:
        together = np.abs(np.sum(lines, axis=0)) / np.sqrt(len(lines))
        leaders = leading(together, free)
        if leaders.size and together[leaders[-1]] > 0.0:
            k, log_sum, top = best_of(together[leaders, None])
            out.append((float(log_sum - np.log(count)), top, int(leaders[k])))
        kinds.append(([together], together))
    kinds.append(([np.asarray(one) for one in lines], power))
    for parts, strength in kinds:
        mixed = _mixed(parts, strength, hz, free, count)
        if mixed is not None:
            out.append(mixed)
    return out


def _mixed(
    parts: Sequence[NDArray[Any]], strength: Array, hz: Array, free: NDArray[np.bool_], count: float
) -> tuple[float, float, int] | None:
    """Two lines with their sum, their difference or both: ln evidence, gain, index of the stronger one."""

    def moduli(index: NDArray[np.intp]) -> Array:
        return np.abs(np.stack([part[index] for part in parts], axis=-1))

    peaks: list[int] = []
    for k in leading(strength, free)[::-1].tolist():
        if strength[k] > 0.0 and all(abs(k - other) > 4 for other in peaks):
            peaks.append(k)
        if len(peaks) == _TONES:
            break
    if len(peaks) < 2:
        return None
    rank = np.array([(a, b) for a in range(len(peaks)) for b in range(a + 1, len(peaks))])
    pairs = np.array(peaks)[rank]
    own, own_gain = sizes_log(moduli(np.array(peaks)))
    offset = hz[0] / (hz[1] - hz[0])
    mixes = []
    for at in (pairs.sum(axis=1) + offset, np.abs(pairs[:, 0] - pairs[:, 1]) - offset):
        near = np.rint(at).astype(int)[:, None] + np.arange(-2, 3)
        inside = np.clip(near, 0, len(hz) - 1)
        mean, gain = sizes_log(moduli(inside))
        # not where one of the two lines themselves stands, nor one that is a cause already
        apart = np.all(np.abs(near[:, :, None] - pairs[:, None, :]) > 8, axis=2) & free[inside]
        mean = np.where((near >= 0) & (near < len(hz)) & apart, mean, -np.inf)
        at_best = mean.argmax(axis=1)[:, None]
        mixes.append((mean.max(axis=1) - np.log(3.0), np.take_along_axis(gain, at_best, 1)[:, 0]))
    (plus, plus_gain), (minus, minus_gain) = mixes
    either = np.logaddexp(np.logaddexp(plus, minus), plus + minus) - np.log(3.0)
    logs = own[rank].sum(axis=1) + either
    best = int(np.argmax(logs))
    log_b = float(np.logaddexp.reduce(logs) - 2.0 * np.log(count) - np.log(2.0))
    if log_b < float(own.max() - np.log(count)) + _BEYOND:
        return None
    whole = float(own_gain[rank[best]].sum() + max(plus_gain[best], minus_gain[best]))
    return log_b, whole, int(pairs[best, 0])
