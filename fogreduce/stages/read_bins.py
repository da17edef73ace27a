"""A run's bins read back, for who shows them; and gathered into no more columns than a screen has.

No extreme is lost: a column has the lowest and the highest of its bins.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fogreduce.stages.dataset import StageDataset
from fogreduce.stages.setup import Setup, seconds

Array = NDArray[np.float64]

MOST_COLUMNS = 800  # a band of so many has twice as many corners
_GAP = 2.5  # a step in time of so many typical steps is a gap: the band is broken
_KINDS = ("mean", "lowest", "highest", "count")


@dataclass(frozen=True)
class Columns:
    """Bins gathered into columns: middle [s], lowest, highest and mean of each; NaN breaks the band."""

    time_s: Array
    lowest: Array
    highest: Array
    mean: Array


@dataclass(frozen=True)
class Family:
    """Bins of several channels of one kind: gyros [raw unit] or axes [deg/s]; arrays are (channels, m)."""

    names: list[str]
    time_s: Array
    mean: Array
    lowest: Array
    highest: Array
    count: Array

    def columns(self, channel: int) -> Columns:
        """One channel as a band."""
        parts = (self.lowest, self.highest, self.mean, self.count)
        return columns_of(self.time_s, *(part[channel] for part in parts))


def read_bins(setup: Setup) -> tuple[Family, Family | None]:
    """Bins of the gyros [raw unit], and of x, y, z [deg/s] without Earth's rate (None: no such axes).

    Raises
    ------
    BadInput
        datasets/bins.nc is missing, damaged, or of another version than the manifest.
    """
    families = [(setup.facts.raw_unit.variable, setup.gyros)]
    families += [("axis_rate", setup.axes)] if setup.axes else []
    names = [f"{family}_{kind}" for family, _ in families for kind in _KINDS]
    with StageDataset(setup, "bins") as source:
        parts = [part for _, part in source.blocks(["time", *names])]
    data = {name: np.concatenate([part[name] for part in parts], axis=-1) for name in parts[0]}
    time_s = _steady(seconds(data["time"]))
    made = [
        Family(channels, time_s, *(data[f"{family}_{kind}"] for kind in _KINDS))
        for family, channels in families
    ]
    return made[0], made[1] if setup.axes else None


def _steady(time_s: Array) -> Array:
    """Times of bins with one wrong among right ones replaced: a stamp that is wrong moves its bin's mean."""
    if time_s.size < 3:
        return time_s
    inner = np.median([time_s[:-2], time_s[1:-1], time_s[2:]], axis=0)
    step = 3 * float(np.median(np.diff(inner))) if inner.size > 1 else np.inf
    first = np.clip(time_s[0], inner[0] - step, inner[0])
    last = np.clip(time_s[-1], inner[-1], inner[-1] + step)
    return np.concatenate(([first], inner, [last]))


def columns_of(
    time_s: Array, lowest: Array, highest: Array, mean: Array, count: Array, most: int = MOST_COLUMNS
) -> Columns:
    """Gather bins (m,) into at most `most` columns; means are weighted by `count`."""
    group = -(-time_s.size // most)
    starts = np.arange(0, time_s.size, group)
    weight = np.where(np.isfinite(mean), count, 0.0)
    total = np.add.reduceat(weight, starts)
    sums = np.add.reduceat(np.where(weight > 0, mean, 0.0) * weight, starts)
    middles = np.add.reduceat(time_s, starts) / np.diff(np.append(starts, time_s.size))
    gathered = Columns(
        middles,
        np.fmin.reduceat(lowest, starts),
        np.fmax.reduceat(highest, starts),
        np.divide(sums, total, out=np.full(total.shape, np.nan), where=total > 0),
    )
    return _broken_at_gaps(gathered)


def _broken_at_gaps(columns: Columns) -> Columns:
    steps = np.diff(columns.time_s)
    if steps.size == 0:
        return columns
    gaps = np.flatnonzero(steps > _GAP * np.median(steps)) + 1
    middles = (columns.time_s[gaps] + columns.time_s[gaps - 1]) / 2
    values = (np.insert(part, gaps, np.nan) for part in (columns.lowest, columns.highest, columns.mean))
    return Columns(np.insert(columns.time_s, gaps, middles), *values)
