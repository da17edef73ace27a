"""Stretches in which a gyro's reading does not change, longer than chance: a rail, a dead or a frozen gyro.

A reading repeats the one before with a probability p that the record shows by itself, at the same
commanded rate; a run of L repeats among N readings then occurs by chance N p^L times. Readings coarser
than the noise repeat often, and for as long as the rate rests between two transitions; those without noise
repeat always: they are left alone, unless the unit's other gyros scatter by many steps, so that one that
never has changed is dead.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fogreduce.estimate.outliers import Values

Flags = NDArray[np.bool_]
Integers = NDArray[np.integer[Any]]

#: Readings of a constant stretch: at least a second's, between these limits.
_FEWEST, _MOST = 16, 128
#: Chance at which a run of repeats in a record is no accident, as its natural logarithm.
_LN_CHANCE = math.log(1e-6)
#: Share of repeats up to which a gyro scatters by many steps: of normal noise of 3 steps a tenth repeat.
_ALIVE = 0.1
#: Share of steps that go back on the one before from which on readings scatter: 2/3 in noise, 0 in a wave.
_BACK = 0.5
#: Steps of the converter: where half of all changes are smaller, readings move by single steps.
_SINGLE = 1.5


class ConstantSearch:
    """Finds constant stretches block by block.

    Parameters
    ----------
    n_gyros : int
    sample_rate_hz : float
    """

    def __init__(self, n_gyros: int, sample_rate_hz: float) -> None:
        self._shortest = round(min(max(sample_rate_hz, _FEWEST), _MOST))
        self._readings = 0
        self._repeats = np.zeros(n_gyros, np.int64)
        self._run = np.zeros(n_gyros, np.int64)
        self._last: Values | None = None
        self._dead: set[int] = set()

    @property
    def repeated(self) -> NDArray[np.float64]:
        """Share of readings that repeat the one before, each gyro (n,); NaN before the second reading."""
        return self._repeats / (self._readings - 1) if self._readings > 1 else np.full(self._run.size, np.nan)

    def flags(
        self, values: Values, following: Values | None, segments: Callable[[], Integers]
    ) -> Flags | None:
        """Which readings lie in constant stretches, None for none.

        Parameters
        ----------
        values, following : (n, N) arrays
            Readings of this block and of the next, None at the record's end.
        segments : function
            Segment of the profile in which each reading of both lies, (N + N',).
        """
        n, size = values.shape
        first = values[:, :1] if self._last is None else self._last
        repeats = np.diff(values, axis=1, prepend=first) == 0
        if self._last is None:
            repeats[:, 0] = False
        self._readings += size
        self._repeats += np.count_nonzero(repeats, axis=1)
        self._last = values[:, -1:]
        # A long run holds a whole piece of half its length.
        half = self._shortest // 2
        pieces = repeats[:, : size // half * half].reshape(n, -1, half).all(axis=2)
        suspects = np.flatnonzero(pieces.any(axis=1) | (self._run > 0) | repeats[:, -1])
        found: Flags | None = None
        run = np.zeros(n, np.int64)
        for gyro in suspects.tolist():
            if self._is_dead(gyro, values):
                self._dead.add(gyro)
                found = np.zeros(values.shape, bool) if found is None else found
                found[gyro] = True
                continue
            starts, stops = _stretches(repeats[gyro])
            lengths = stops - starts
            if starts.size and starts[0] == 0:
                lengths[0] += self._run[gyro]
            if starts.size and stops[-1] == size:
                run[gyro] = lengths[-1]
                lengths[-1] += _goes_on(values[gyro, -1], following, gyro)
            for k in np.flatnonzero(lengths >= self._shortest).tolist():
                start, stop = int(starts[k]), int(stops[k])
                near = values[gyro] if following is None else np.append(values[gyro], following[gyro])
                if lengths[k] < _least_run(near, segments(), (start + stop) // 2):
                    continue
                found = np.zeros(values.shape, bool) if found is None else found
                found[gyro, max(start - 1, 0) : stop] = True
        self._run = run
        return found

    def _is_dead(self, gyro: int, values: Values) -> bool:
        """Whether a gyro has never changed its reading so far, while every other scatters by many steps."""
        shares = self.repeated
        others = np.flatnonzero(shares < 1.0)
        if shares[gyro] < 1.0 or not others.size:
            return False
        if gyro in self._dead or values.shape[1] < self._shortest:
            return gyro in self._dead
        steps = np.sign(np.diff(values[others].astype(np.float64), axis=1))
        back = (steps[:, 1:] * steps[:, :-1] < 0).mean(axis=1)
        return bool(shares[others].max() <= _ALIVE and back.min() >= _BACK)


def _least_run(readings: Values, segments: Integers, within: int) -> float:
    """Repeats of a run about reading `within` that are no accident, by all readings of its segment.

    Where readings move by single steps of the converter, a rate that rests between two transitions repeats
    for as long as it does: only a value that the changing readings never come near is then no accident.
    """
    here = readings[segments == segments[within]]
    steps = np.abs(np.diff(here.astype(np.float64)))
    moved = np.flatnonzero(steps)
    if moved.size <= 2:
        return math.inf
    least = steps[moved].min()
    if np.median(steps[moved]) < _SINGLE * least:
        value, changing = readings[within], here[np.concatenate((moved, moved + 1))]
        others = changing[changing != value]
        if others.min() - _SINGLE * least <= value <= others.max() + _SINGLE * least:
            return math.inf
    return (math.log(here.size) - _LN_CHANCE) / -math.log1p(-moved.size / (here.size + 1))


def _stretches(flags: Flags) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Where stretches of True start, and where they have ended."""
    edges = np.flatnonzero(np.diff(np.concatenate(([0], flags.view(np.int8), [0]))))
    return edges[::2], edges[1::2]


def _goes_on(value: object, following: Values | None, gyro: int) -> int:
    """How many readings of the next block still have this value."""
    if following is None:
        return 0
    same = following[gyro] == value
    return int(same.size if same.all() else np.argmin(same))
