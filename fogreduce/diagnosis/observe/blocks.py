"""Short blocks of a run (about one second): where their means are taken, and at which times a model is
asked.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fogreduce.metadata.facts import RunFacts

Array = NDArray[np.float64]

SHORTEST_S = 1.0
MOST_BLOCKS = 400
_INSIDE = 8  # times at which a model is asked in a block without an edge of the profile
_AT_EDGE = 256  # and, at most, in a block with one
_LEAST_SAMPLES = 2


@dataclass(frozen=True)
class Blocks:
    """Blocks of one run.

    Attributes
    ----------
    length_s : float
        One block's length [s]: one second, longer where a run would have more than `MOST_BLOCKS` of them or a
        block fewer than two samples.
    count : int
    time_s : (K,) array
        True times [s] at which a model is asked, in order.
    first : (count,) array of int
        Where each block's times begin in `time_s`.
    """

    length_s: float
    count: int
    time_s: Array
    first: NDArray[np.intp]

    @classmethod
    def of(cls, facts: RunFacts, further: frozenset[int] = frozenset()) -> Blocks:
        """Blocks of a run; samples at its end that fill no block are left out.

        Parameters
        ----------
        facts : RunFacts
        further : numbers of blocks
            Taken to have an edge in them beside those in which the profile has one.
        """
        rate, samples = facts.sample_rate_hz, facts.n_expected
        duration = samples / rate
        length = max(SHORTEST_S, duration / MOST_BLOCKS, _LEAST_SAMPLES / rate)
        count = max(int(duration / length + 1e-9), 1)
        length = min(length, duration / count)
        edged = further.union(np.floor((facts.profile.edges_s + 1e-9) / length).astype(np.intp).tolist())
        inside = (np.arange(_INSIDE) + 0.5) / _INSIDE
        times, first, total = [], [], 0
        for k in range(count):
            start, end = k * length, (k + 1) * length
            low, high = int(np.ceil(start * rate - 1e-6)), int(np.ceil(end * rate - 1e-6))
            index = np.arange(low, max(high, low + 1))
            if k in edged:
                # where the rate jumps, the very instants of the samples count
                at = index[:: max(1, len(index) // _AT_EDGE)] / rate
            elif len(index) <= _INSIDE:
                at = index / rate
            else:
                # a sample stands for half a step before it and half a step after
                at = (low - 0.5 + inside * len(index)) / rate
            times.append(at)
            first.append(total)
            total += len(at)
        return cls(length, count, np.concatenate(times), np.array(first))

    @property
    def centre_s(self) -> Array:
        """(count,) middles [s]."""
        return (np.arange(self.count, dtype=np.float64) + 0.5) * self.length_s

    def holding(self, time_s: Array) -> frozenset[int]:
        """Numbers of the blocks that hold times [s]."""
        index = np.floor(time_s / self.length_s + 1e-9).astype(np.intp)
        return frozenset(index[(index >= 0) & (index < self.count)].tolist())

    def edge_step_s(self, sample_rate_hz: float) -> float:
        """Time between two instants asked for in a block with an edge [s]."""
        return max(1, int(self.length_s * sample_rate_hz) // _AT_EDGE) / sample_rate_hz

    def means(self, values: NDArray[Any]) -> Array:
        """Means over each block of values (..., K) at `time_s`: (..., count)."""
        means: Array = np.add.reduceat(values, self.first, axis=-1) / self._asked
        return means

    @cached_property
    def _asked(self) -> Array:
        """(count,) times in each block."""
        return np.diff(np.append(self.first, len(self.time_s))).astype(np.float64)

    def of_samples(self, time_s: Array) -> NDArray[np.intp]:
        """The block of each sample; `count` for those beyond the last."""
        index = np.floor(time_s / self.length_s + 1e-9).astype(np.intp)
        return np.clip(index, 0, self.count)
