"""Parity checks of a run: when a gyro fails, and what says which.

Three checks, each with its share of the false alarms asked for:

- **level**: mean parity of a segment against what the record states (scale factor, bias, axes, turn-on bias)
  and noise. It sees what was wrong from the start: a dead gyro, a wrong scale factor.
- **step**: a CUSUM on the parity's bins within a segment of constant rate. It sees a step of bias or scale
  factor, and a gyro that gets stuck while the table turns.
- **scatter**: a CUSUM on each gyro's scatter within the bins: a noise burst, an output that goes quiet.

With four gyros parity is one number, and says that a gyro failed but not which. What else says it: the
scatter is of one gyro; a step is held against the motion that table and Earth give each gyro. A step that the
table itself makes is none of parity's. Size against the bias instability that is known of each gyro (its
history) tells little, since the four parity factors are nearly alike.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fogreduce.calibrate.noise import GyroNoise
from fogreduce.calibrate.readings import Readings
from fogreduce.characterise.cusum import Change, level_changes, scatter_changes
from fogreduce.characterise.run_length import level_limit
from fogreduce.constants import SECONDS_PER_HOUR
from fogreduce.estimate.uncertainty import StatedErrors, gyro_departures
from fogreduce.physics.redundancy import parity_vectors
from fogreduce.physics.special import log_chi2_tail

Array = NDArray[np.float64]

#: A step of so many standard deviations of a bin is what the CUSUM is best at (k of half of it).
SHIFT = 1.0
#: Wander of the parity's flicker that must not add up: so many of its bias instabilities.
_WANDER = 3.0
#: Variance of a noise burst and of a quiet gyro, over the usual one, that the scatter's CUSUM is best at.
BURST, QUIET = 2.25, 0.25
#: Chance of a false alarm of the level check, in a run.
LEVEL_CHANCE = 1e-4
#: Share of the hypotheses at which a gyro counts as isolated.
_CLEAR = 0.99
_FEWEST = 8


@dataclass(frozen=True)
class Alarm:
    """One alarm.

    Attributes
    ----------
    check : str
        ``level``, ``step`` or ``scatter``.
    what : str
        In words.
    since_s, alarm_s : float
        From when on, and when it was noticed [s].
    size : float
        Of a step or level: parity [deg/h]; of scatter: variance over the usual one.
    gyro : int or None
        The gyro, from 0, where something isolates it.
    isolated_by : str
        What isolates it; empty where nothing does.
    odds : (n,) array
        Probabilities of the gyros, equal beforehand.
    """

    check: str
    what: str
    since_s: float
    alarm_s: float
    size: float
    gyro: int | None
    isolated_by: str
    odds: Array


def check_run(
    one: Readings, noise: list[GyroNoise], stated: StatedErrors, false_alarms_per_hour: float = 0.01
) -> list[Alarm]:
    """All alarms of a run, in the order of their times.

    Parameters
    ----------
    one : Readings
    noise : list of GyroNoise
        Of each gyro.
    stated : StatedErrors
    false_alarms_per_hour : float
        Of the step and scatter checks together.
    """
    n = one.facts.n_gyros
    if n < 4:
        return []
    shares = (n - 3) + 2 * n
    samples = SECONDS_PER_HOUR / one.bin_s / (false_alarms_per_hour / shares)
    alarms: list[Alarm] = []
    for k in np.unique(one.segment).tolist():
        inside = np.flatnonzero((one.segment == k) & np.isfinite(one.raw).all(axis=0))
        if inside.size >= _FEWEST:
            alarms += _levels(one, noise, stated, inside)
            alarms += _steps(one, noise, inside, samples)
    alarms += _scatters(one, samples)
    return sorted(alarms, key=lambda alarm: alarm.alarm_s)


def residual_rates(one: Readings) -> Array:
    """What the gyros read beyond table and Earth by the record, (n, m) [deg/h]."""
    facts = one.facts
    rates = (one.raw - facts.bias[:, None]) / facts.scale_factor[:, None] - facts.axes @ one.motion
    found: Array = rates * SECONDS_PER_HOUR
    return found


def bin_sigma(one: Readings, noise: list[GyroNoise]) -> Array:
    """White noise of each gyro's bin means, (n, m) [deg/h]."""
    white = np.array([60 * each.white_deg_sqrt_h for each in noise]) / math.sqrt(one.bin_s)
    full = one.facts.sample_rate_hz * one.bin_s
    found: Array = white[:, None] * np.sqrt(full / np.maximum(one.count, 1))
    return found


def _levels(
    one: Readings, noise: list[GyroNoise], stated: StatedErrors, inside: NDArray[np.intp]
) -> list[Alarm]:
    """The mean parity of a segment against what is stated."""
    rows = parity_vectors(one.facts.axes)
    mean = rows @ residual_rates(one)[:, inside].mean(axis=1)
    departures = gyro_departures(one.facts, stated, one.time_s[inside]).mean(axis=2) * SECONDS_PER_HOUR
    allowed = rows @ departures.T @ departures @ rows.T
    sigma = bin_sigma(one, noise)[:, inside].mean(axis=1)
    flicker = np.array([each.flicker_deg_h for each in noise])
    # Flicker's mean over a run is its variance from 1e-5 Hz to the run's length.
    octaves = max(math.log(1e5 / (inside.size * one.bin_s)), 1.0) / math.pi
    allowed += rows @ np.diag(sigma**2 / inside.size + flicker**2 * octaves) @ rows.T
    square = float(mean @ np.linalg.solve(allowed, mean))
    if log_chi2_tail(square, len(rows)) > math.log(LEVEL_CHANCE / max(1, int(one.segment[-1]) + 1)):
        return []
    spread = np.diag(departures.T @ departures) + sigma**2 / inside.size + flicker**2 * octaves
    gyro, by, odds = _isolated(residual_rates(one)[:, inside].mean(axis=1), spread)
    what = "parity is off from the start: a bias, a scale factor, an axis, or a dead gyro"
    start, stop = float(one.time_s[inside[0]]), float(one.time_s[inside[-1]])
    return [Alarm("level", what, start, stop, float(np.linalg.norm(mean)), gyro, by, odds)]


def _steps(one: Readings, noise: list[GyroNoise], inside: NDArray[np.intp], samples: float) -> list[Alarm]:
    """Steps of the parity within a segment."""
    rows = parity_vectors(one.facts.axes)
    residual, sigma = residual_rates(one)[:, inside], bin_sigma(one, noise)[:, inside]
    flicker = np.array([each.flicker_deg_h for each in noise])
    alarms = []
    for row in rows:
        spread = np.sqrt(row**2 @ sigma**2)
        wander = _WANDER * math.sqrt(row**2 @ flicker**2) / float(np.median(spread))
        allowance = SHIFT / 2 + wander
        limit = level_limit(samples, allowance)
        changes = level_changes(row @ residual, spread, limit, allowance)
        for k, change in enumerate(changes):
            begun = changes[k - 1].start if k else 0
            ended = changes[k + 1].start if k + 1 < len(changes) else inside.size
            alarms.append(_step(one, change, residual, sigma, inside, (begun, ended)))
    return alarms


def _step(
    one: Readings,
    change: Change,
    residual: Array,
    sigma: Array,
    inside: NDArray[np.intp],
    span: tuple[int, int],
) -> Alarm:
    """A step, and the gyro whose step it is by the known motion."""
    before, after = slice(span[0], change.start), slice(change.start, span[1])
    step = residual[:, after].mean(axis=1) - residual[:, before].mean(axis=1)
    variance = sum((sigma[:, part] ** 2).mean(axis=1) / sigma[:, part].shape[1] for part in (before, after))
    gyro, by, odds = _isolated(step, np.asarray(variance))
    what = "parity steps: a bias or a scale factor changed, or an output got stuck"
    times = one.time_s[inside]
    since, noticed = float(times[change.start]), float(times[change.alarm])
    return Alarm("step", what, since, noticed, change.size, gyro, by, odds)


def _isolated(off: Array, variance: Array) -> tuple[int | None, str, Array]:
    """The gyro that is off, by what each reads beyond the known motion.

    Parameters
    ----------
    off, variance : (n,) arrays
        Readings beyond the motion, and their variances.
    """
    explained = off**2 / variance / 2
    odds = np.exp(explained - explained.max())
    odds /= odds.sum()
    best = int(np.argmax(odds))
    if odds[best] < _CLEAR:
        return None, "", odds
    return best, "the known motion of the table", odds


def _scatters(one: Readings, samples: float) -> list[Alarm]:
    """Noise bursts and quiet outputs, of each gyro by itself."""
    alarms = []
    n = one.facts.n_gyros
    for i in range(n):
        there = np.flatnonzero((one.count[i] >= 4) & np.isfinite(one.scatter[i]))
        if there.size < _FEWEST:
            continue
        variance, freedom = one.scatter[i, there] ** 2, one.count[i, there] - 1
        odds = np.eye(n)[i]
        for what, changes in zip(
            ("the output goes quiet: stuck, or its noise is gone", "a noise burst"),
            scatter_changes(variance, freedom, (QUIET, BURST), samples),
            strict=True,
        ):
            for change in changes:
                times = float(one.time_s[there[change.start]]), float(one.time_s[there[change.alarm]])
                alarms.append(Alarm("scatter", what, *times, change.size, i, "its own scatter", odds))
    return alarms
