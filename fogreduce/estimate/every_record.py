"""Records in which some gyros did not answer: x, y, z from those that did, by generalised least squares.

A record of three gyros or more, not in a plane, determines x, y and z. Its projection is the left
inverse of the axes that are left, weighted by the gyros' white noise. Two things keep such records
from moving the result:

- What the gyros' biases disagree by (turn-on biases do) goes into x, y, z in other parts when a gyro is
  absent, so that a gap would be a step. The mean of ``M - G Omega`` over the complete records of the same
  segment shows it, and is taken out of the incomplete ones.
- They are noisier, and count less in the mean curve: by the variance of a complete record over theirs.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from fogreduce.physics.redundancy import projection, spans_space

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]


@dataclass(frozen=True)
class SubGeometry:
    """What the gyros that answered determine.

    Attributes
    ----------
    projection : (3, n) array
        Columns of gyros that did not answer are zero.
    weight : (3,) array
        Variance of x, y, z in a complete record over that in such a one.
    """

    projection: Array
    weight: Array


@dataclass
class Geometries:
    """The sub-geometries of a unit, each worked out when it first occurs.

    Parameters
    ----------
    axes : (n, 3) array
        G.
    white : (n,) array or None
        White noise of the gyros, in any unit; None: equal.
    """

    axes: Array
    white: Array | None = None
    _by_pattern: dict[bytes, SubGeometry | None] = field(default_factory=dict)

    @property
    def noise(self) -> Array:
        """(n,): white noise of the gyros, where one is stated as zero (or none at all) equal."""
        if self.white is None or not (self.white > 0).all():
            return np.ones(len(self.axes))
        return self.white

    def of(self, there: Mask) -> SubGeometry | None:
        """With the gyros that answered, (n,); None where they do not determine x, y and z."""
        key = there.tobytes()
        if key not in self._by_pattern:
            self._by_pattern[key] = self._worked_out(there)
        return self._by_pattern[key]

    def _worked_out(self, there: Mask) -> SubGeometry | None:
        if not spans_space(self.axes[there]):
            return None
        found = np.zeros((3, len(self.axes)))
        found[:, there] = projection(self.axes[there], self.noise[there])
        whole = projection(self.axes, self.noise)
        return SubGeometry(found, (whole**2 @ self.noise**2) / (found**2 @ self.noise**2))


def patterns(usable: Mask) -> list[tuple[Mask, NDArray[np.intp]]]:
    """Sets of usable gyros that occur, and the records of each.

    Parameters
    ----------
    usable : (n, N) array of bool
    """
    if usable.all():
        return [(np.ones(len(usable), bool), np.arange(usable.shape[1]))]
    code = np.left_shift(1, np.arange(len(usable))) @ usable
    found = []
    for value in np.unique(code).tolist():
        records = np.flatnonzero(code == value)
        found.append((usable[:, records[0]], records))
    return found


class EveryRecord:
    """Projects blocks of records, the incomplete ones too; carries what the gyros disagree by.

    Parameters
    ----------
    geometries : Geometries
    """

    def __init__(self, geometries: Geometries) -> None:
        self._geometries = geometries
        self._sums: dict[int, tuple[Array, int]] = {}

    def project(self, gyro_rates: Array, usable: Mask, segment: NDArray[np.integer]) -> Array:
        """Rates x, y, z [deg/s], (3, N); NaN where too few gyros answered.

        Parameters
        ----------
        gyro_rates : (n, N) array
            M [deg/s].
        usable : (n, N) array of bool
        segment : (N,) array of int
            Segment of constant rate in which each record lies.
        """
        rates = np.full((3, gyro_rates.shape[1]), np.nan)
        found = patterns(usable)
        for there, records in found:
            if there.all():
                rates[:, records] = self._complete(gyro_rates[:, records], segment[records])
        for there, records in found:
            geometry = self._geometries.of(there)
            if there.all() or geometry is None:
                continue
            read = gyro_rates[:, records] - self._disagreement(segment[records])
            read[~there] = 0.0
            rates[:, records] = geometry.projection @ read
        return rates

    def _complete(self, gyro_rates: Array, segment: NDArray[np.integer]) -> Array:
        """Rates of complete records; what is left of their gyros' readings is added to the sums."""
        geometry = self._geometries.of(np.ones(len(gyro_rates), bool))
        assert geometry is not None
        rates: Array = geometry.projection @ gyro_rates
        left = gyro_rates - self._geometries.axes @ rates
        for k in np.unique(segment).tolist():
            inside = segment == k
            total, count = self._sums.get(k, (np.zeros(len(gyro_rates)), 0))
            self._sums[k] = (total + left[:, inside].sum(axis=1), count + int(inside.sum()))
        return rates

    def _disagreement(self, segment: NDArray[np.integer]) -> Array:
        """(n, N): mean of ``M - G Omega`` over the complete records so far of the same segment, or 0."""
        out = np.zeros((len(self._geometries.axes), segment.size))
        for k in np.unique(segment).tolist():
            if k in self._sums:
                total, count = self._sums[k]
                out[:, segment == k] = (total / count)[:, None]
        return out
