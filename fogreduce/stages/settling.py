"""Records taken while the table still changes its rate after an edge of the profile: found in the record."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from fogreduce.constants import MICROSECONDS_PER_SECOND
from fogreduce.estimate.settling import rate_about_axis, settling_time_s, window_s
from fogreduce.metadata.facts import RunFacts
from fogreduce.stages.calibrate import calibrate

Array = NDArray[np.float64]


@dataclass
class Settling:
    """Finds such records block by block.

    Attributes
    ----------
    found : dict
        Segment, from 1 -> how long the table took to reach its rate [s].
    """

    facts: RunFacts
    found: dict[int, float] = field(default_factory=dict)
    _until_us: float = -np.inf
    _seen_us: float = -np.inf
    _from_us: float = np.inf

    def wanted(self, time_us: NDArray[np.int64]) -> bool:
        """Whether a block holds an edge of the profile, or follows one closely; the others need no look."""
        edges_us = self.facts.profile.edges_s[:-1] * MICROSECONDS_PER_SECOND
        after = bool(((edges_us > self._seen_us) & (edges_us <= time_us[-1])).any())
        return after or float(time_us[0]) <= self._until_us

    def flags(
        self, time_us: NDArray[np.int64], raw: Array, following: tuple[NDArray[np.int64], Array] | None
    ) -> NDArray[np.bool_] | None:
        """Which records are such, None for none.

        Parameters
        ----------
        time_us : (N,) array
            Stamps [us].
        raw : (n, N) array
            Raw readings.
        following : the same of the next block, or None
        """
        profile = self.facts.profile
        steps = np.diff(profile.rate_deg_s, prepend=0.0)
        edges_us = profile.edges_s[:-1] * MICROSECONDS_PER_SECOND
        low, high = self._seen_us, float(time_us[-1])
        self._seen_us = max(low, high)
        flags = (time_us >= self._from_us) & (time_us <= self._until_us)
        for k in np.flatnonzero((edges_us > low) & (edges_us <= high) & (steps != 0.0)).tolist():
            length_us = window_s(float(profile.duration_s[k])) * MICROSECONDS_PER_SECOND
            since_s, rate = self._record(time_us, raw, following, edges_us[k], length_us)
            if rate is None or not (settled_s := settling_time_s(since_s, rate, float(steps[k]))):
                continue
            self.found[k + 1] = settled_s
            self._from_us = edges_us[k]
            self._until_us = edges_us[k] + settled_s * MICROSECONDS_PER_SECOND
            flags |= (time_us >= self._from_us) & (time_us <= self._until_us)
        return flags if flags.any() else None

    def _record(
        self,
        time_us: NDArray[np.int64],
        raw: Array,
        following: tuple[NDArray[np.int64], Array] | None,
        edge_us: float,
        length_us: float,
    ) -> tuple[Array, Array | None]:
        """Time since an edge [s] and rate about the table's axis [deg/s], of as much as is at hand."""
        times, rates = [], []
        for stamps, readings in ((time_us, raw), following or (time_us[:0], raw[:, :0])):
            inside = (stamps >= edge_us) & (stamps < edge_us + length_us)
            times.append(stamps[inside])
            rates.append(calibrate(self.facts, readings[:, inside]))
        since_s = (np.concatenate(times) - edge_us) / MICROSECONDS_PER_SECOND
        rate = rate_about_axis(np.concatenate(rates, axis=1), self.facts.axes, self.facts.table_axis)
        return since_s, rate
