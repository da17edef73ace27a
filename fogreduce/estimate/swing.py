"""A swing of the table: rates that alternate at short intervals, from the command or from the encoder."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fogreduce.physics.table_motion import Profile

Array = NDArray[np.float64]

#: A segment of 2 s holds no bin of a second with a guard of half a second on both sides: rates that change
#: within it serve no quantity that wants a constant rate.
LONGEST_S = 2.0
#: Ten periods: the tenth part of a period that is lost at each end does not count.
FEWEST_CHANGES = 20
#: Of an encoder's log: rows that half a period needs for its wave to be seen, and the least size [deg/s] that
#: is a swing (a table's ripple at its poles is some thousandths of it, contract effects `table_rate_ripple`).
FEWEST_ROWS = 4
LEAST_DEG_S = 0.5


@dataclass(frozen=True)
class RateSteps:
    """A table's rate as a function of steps: `rate_deg_s[k]` holds from `edge_s[k]` on, (k,) each."""

    edge_s: Array
    rate_deg_s: Array

    @classmethod
    def of_profile(cls, profile: Profile) -> RateSteps:
        """Of the command; the table stands after its end."""
        return cls(profile.edges_s, np.append(profile.rate_deg_s, 0.0))

    @classmethod
    def of_log(cls, time_s: Array, angle_deg: Array) -> RateSteps:
        """Of an encoder's log: mean rates between its rows."""
        rate = np.diff(angle_deg) / np.diff(time_s)
        return cls(time_s, np.append(rate, rate[-1]))

    def angle_at(self, time_s: Array) -> Array:
        """Angle [deg] turned since the first edge, at times [s]; the table stands before it."""
        turned = np.concatenate(([0.0], np.cumsum(self.rate_deg_s[:-1] * np.diff(self.edge_s))))
        beyond = np.maximum(time_s - self.edge_s[-1], 0.0) * self.rate_deg_s[-1]
        angle: Array = np.interp(time_s, self.edge_s, turned) + beyond
        return angle


@dataclass(frozen=True)
class Swing:
    """A swing of a run.

    Attributes
    ----------
    steps : RateSteps
        The table's rate over the whole run.
    change_s : (c,) array
        When the rate changed, within the swing [s].
    by_encoder : bool
        Whether the rate is the encoder's; else it is the command's.
    """

    steps: RateSteps
    change_s: Array
    by_encoder: bool

    def covers(self, time_s: Array) -> NDArray[np.bool_]:
        """Which times lie within the swing."""
        inside: NDArray[np.bool_] = (time_s >= self.change_s[0]) & (time_s <= self.change_s[-1])
        return inside

    @property
    def half_s(self) -> float:
        """Median time between changes [s]: half a period."""
        return float(np.median(np.diff(self.change_s)))

    @property
    def is_periodic(self) -> bool:
        """Whether changes are equally far apart (to 5 %), so that the swing has a fundamental."""
        return bool(np.ptp(np.diff(self.change_s)) < 0.05 * self.half_s)


def swing_of(profile: Profile, log: tuple[Array, Array] | None) -> Swing | None:
    """The longest swing of a run; None where the rate alternates too slowly or too seldom.

    Parameters
    ----------
    profile : Profile
        The command.
    log : ((k,) array, (k,) array) or None
        Times [s] and angles [deg] of the encoder's log. Its rates are taken where its rows are close enough.
    """
    commanded = RateSteps.of_profile(profile)
    inner = np.diff(profile.rate_deg_s) != 0
    change = _longest(profile.edges_s[1:-1][inner])
    seen = RateSteps.of_log(*log) if log is not None and log[0].size > FEWEST_CHANGES else None
    if change is None:
        change = None if seen is None else _longest(_alternations(seen, profile))
        return None if seen is None or change is None else Swing(seen, change, True)
    spans = seen is not None and seen.edge_s[0] <= change[0] and seen.edge_s[-1] >= change[-1]
    if seen is None or not spans:
        return Swing(commanded, change, False)
    fine = FEWEST_ROWS * np.median(np.diff(seen.edge_s)) <= np.median(np.diff(change))
    return Swing(seen, change, True) if fine else Swing(commanded, change, False)


def _longest(change_s: Array) -> Array | None:
    """The longest row of changes, none farther than `LONGEST_S` from the next; None if too short."""
    if change_s.size < FEWEST_CHANGES:
        return None
    rows = np.split(change_s, np.flatnonzero(np.diff(change_s) > LONGEST_S) + 1)
    longest = max(rows, key=len)
    return longest if longest.size >= FEWEST_CHANGES else None


def _alternations(seen: RateSteps, profile: Profile) -> Array:
    """When the encoder's rate went from well above the command to well below it, or back [s].

    Well: by half of what it is off by at nine rows in ten at most, so that noise at a crossing counts once.
    """
    middle = (seen.edge_s[:-1] + seen.edge_s[1:]) / 2
    off = seen.rate_deg_s[:-1] - profile.rate_at(middle)
    inside = (middle >= 0) & (middle <= profile.end_s)
    middle, off = middle[inside], off[inside]
    size = float(np.quantile(np.abs(off), 0.9)) if off.size else 0.0
    if size < LEAST_DEG_S:
        return np.zeros(0)
    far = np.flatnonzero(np.abs(off) > size / 2)
    turned = far[1:][np.diff(np.sign(off[far])) != 0]
    if turned.size > 1 and float(np.median(np.diff(turned))) < FEWEST_ROWS:
        return np.zeros(0)
    return middle[turned]
