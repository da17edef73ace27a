"""How the table really moved, by its encoder's log: what its command leaves out, spin-ups and all.

The log less the command is a polygon with as few corners as its noise allows (Ramer 1972, Douglas and Peucker
1973), fitted by least squares. A fault of the table that the catalogue has (a rate error, a ripple, a late
start, the wrong sense) is no such motion: it is to be named, not to be taken for granted.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fogreduce.datasets.logs import TableLog
from fogreduce.diagnosis import priors
from fogreduce.effects.motion import Departure
from fogreduce.physics.table_motion import Profile

Array = NDArray[np.float64]

_LEAST_ROWS = 12
_HARMONICS = 36  # of ripples looked for: the catalogue's realistic range
_NORMAL_MAD = 1.4826  # standard deviation over median absolute deviation
_CLIPS, _CLIPPED = 5, 4.0  # rounds in which what is so many standard deviations out is left out
_MOST_CORNERS = 400
_BENT = 4.0  # standard deviations of chi-squared
_STEPS = 3  # to a late start's delay


@dataclass(frozen=True)
class TableMotion:
    """What a run's table did beside its command.

    Attributes
    ----------
    departure : Departure
        True angle less the commanded one.
    errors_rad : (k, k) array
        Of the angles at its corners: rows are independent, of one standard deviation each.
    """

    departure: Departure
    errors_rad: Array

    def error_rates(self, time_s: Array) -> Array:
        """Rates (k, N) [deg/s] at times [s], one standard deviation each, by which the log may be off."""
        departure = self.departure
        return np.array([Departure(departure.time_s, row).rate_at(time_s) for row in self.errors_rad])


def table_motion(log: TableLog, profile: Profile) -> TableMotion | None:
    """The motion that a log shows; None where it is the command's, or a fault that the catalogue names.

    Parameters
    ----------
    log : TableLog
    profile : Profile
        As commanded.
    """
    time = log.time_s
    if len(time) < _LEAST_ROWS:
        return None
    angle = log.angle_deg - float(np.interp(0.0, time, log.angle_deg))
    off = angle - np.degrees(profile.angle_at(time.copy()))
    noise = _noise(time, log.angle_deg, off)
    # the largest of so many normal deviates, each held against a chord between two others
    tolerance = noise * np.sqrt(1.5 * 2.0 * np.log(len(time)))
    left = off - _of_catalogue(time, off, profile, tolerance)
    if np.ptp(left) <= 2.0 * tolerance + priors.DEPARTURE * np.ptp(off):
        return None
    corners = _corners(time, off, noise, float(tolerance))
    hats = np.array([np.interp(time, time[corners], unit) for unit in np.eye(len(corners))]).T
    gram = hats.T @ hats
    found = np.linalg.solve(gram, hats.T @ off)
    errors = np.radians(noise * np.linalg.cholesky(np.linalg.inv(gram)).T)
    return TableMotion(Departure(time[corners], np.radians(found - found[0])), errors)


def _noise(time: Array, angle: Array, off: Array) -> float:
    """Standard deviation of one row [deg]: from rows against the chord of their neighbours, and rounding."""
    share = (time[1:-1] - time[:-2]) / (time[2:] - time[:-2])
    bend = off[1:-1] - (off[:-2] + share * (off[2:] - off[:-2]))
    bend /= np.sqrt(1.0 + share**2 + (1.0 - share) ** 2)
    steps = np.abs(np.diff(np.unique(np.round(angle % 1.0, 9))))
    rounding = float(steps[steps > 0.0].min()) / np.sqrt(12.0) if np.any(steps > 0.0) else 0.0
    least = max(rounding, 1e-9)
    noise = max(_NORMAL_MAD * float(np.median(np.abs(bend))), least)
    # of rounded rows the median has few values: what is within a few of it has the right one
    for _ in range(_CLIPS):
        noise = max(float(np.sqrt(np.mean(np.square(bend[np.abs(bend) <= _CLIPPED * noise])))), least)
    return noise


def _of_catalogue(time: Array, off: Array, profile: Profile, tolerance: float) -> Array:
    """What a rate error, a late start and one ripple make of a departure [deg], at best."""
    command = np.degrees(profile.angle_at(time.copy()))
    late = 0.0
    for _ in range(_STEPS):
        shifted = np.degrees(profile.angle_at(time - late))
        slope = (np.degrees(profile.angle_at(time - late - 1e-3)) - shifted) / 1e-3
        columns = np.column_stack([np.ones_like(time), shifted, slope])
        found = np.linalg.lstsq(columns, off + command, rcond=None)[0]
        if abs(found[1]) < 1e-6:
            break
        late += float(found[2] / found[1])
    shifted = np.degrees(profile.angle_at(time - late))
    steady = np.column_stack([np.ones_like(time), shifted])
    best = steady @ np.linalg.lstsq(steady, off + command, rcond=None)[0] - command
    least = float(np.sum((off - best) ** 2))
    if np.ptp(shifted) == 0.0 or np.ptp(off - best) <= 2.0 * tolerance:
        return best
    for n in range(1, _HARMONICS + 1):
        turn = np.radians(n * shifted)
        columns = np.column_stack([steady, np.cos(turn), np.sin(turn)])
        trial = columns @ np.linalg.lstsq(columns, off + command, rcond=None)[0] - command
        if (left := float(np.sum((off - trial) ** 2))) < least:
            best, least = trial, left
    return best


def _corners(time: Array, off: Array, noise: float, tolerance: float) -> NDArray[np.intp]:
    """Rows at which a polygon has its corners that leaves nothing but noise; the ends are among them."""
    corners = {0, len(time) - 1}
    spans = [(0, len(time) - 1)]
    while spans and len(corners) < _MOST_CORNERS:
        low, high = spans.pop(0)
        rows = high - low - 1
        if rows < 1:
            continue
        chord = np.interp(time[low + 1 : high], time[[low, high]], off[[low, high]])
        far = np.abs(off[low + 1 : high] - chord)
        k = low + 1 + int(np.argmax(far))
        # a corner too far out; or rows that lie off together, each by less
        bent = float(np.sum((far / noise) ** 2)) > 2.5 * rows + _BENT * np.sqrt(2.0 * rows)
        if np.max(far) > tolerance or (bent and {low, high} != {0, len(time) - 1}):
            corners.add(k)
            spans += [(low, k), (k, high)]
    return np.array(sorted(corners), np.intp)
