"""Parity checks of runs: when a gyro fails, and what says which.

Four checks:

- **level**: mean parity of a segment against what the record states (scale factor, bias, axes, turn-on bias)
  and noise. It sees what was wrong from the start: a dead gyro, a wrong scale factor.
- **step**: a CUSUM on the parity's bins within a segment of constant rate. It sees a step of bias or scale
  factor.
- **scatter**: a CUSUM on each gyro's scatter within the bins: a noise burst, an output that goes quiet.
- **output**: a gyro whose readings stay the same or are missing over several bins in which others answer.

Level and step have a chance of a false alarm, scatter and step the rate of them that is asked for. What says
which gyro it is: `fogreduce.characterise.isolation`. A step that the table itself makes is none of parity's.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from fogreduce.calibrate.noise import GyroNoise
from fogreduce.calibrate.readings import Readings, residual_rates
from fogreduce.characterise.cusum import level_changes, scatter_changes
from fogreduce.characterise.isolation import (
    OWN_NOISE,
    OWN_OUTPUT,
    Evidence,
    by_all_runs,
    by_dynamics,
    by_history,
    by_known_motion,
    by_own_noise,
    isolated,
)
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
_FEWEST = 8
#: Bins in a row without a reading, of a gyro while others answer, that are no chance loss.
_SILENT = 2


@dataclass(frozen=True)
class Alarm:
    """One alarm.

    Attributes
    ----------
    run : str
    check : str
        ``level``, ``step``, ``scatter`` or ``output``.
    what : str
        In words.
    since_s, alarm_s : float
        From when on, and when it was noticed [s].
    size : float
        Of a step or level: parity [deg/h]; of scatter: variance over the usual one; of an output: bins.
    evidence : tuple of Evidence
        Of each gyro.
    """

    run: str
    check: str
    what: str
    since_s: float
    alarm_s: float
    size: float
    evidence: tuple[Evidence, ...]

    @property
    def gyro(self) -> int | None:
        """The gyro, from 0, where something isolates it."""
        return isolated(self.evidence)[0]

    @property
    def isolated_by(self) -> str:
        """What isolates it; empty where nothing does."""
        return isolated(self.evidence)[1]


def check_campaign(
    readings: Sequence[Readings], noise: list[GyroNoise], false_alarms_per_hour: float = 0.01
) -> list[Alarm]:
    """All alarms of all runs; what is off from the start is held against every run together."""
    if readings[0].facts.n_gyros < 4:
        return []
    alarms: list[Alarm] = []
    levels, spreads, motions = [], [], []
    for one in readings:
        stated = StatedErrors.of(one.run, one.record)
        alarms += check_run(one, noise, stated, false_alarms_per_hour)
        for inside in _segments(one):
            mean, allowed, _ = _mean_parity(one, noise, stated, inside)
            levels.append(mean[0])
            spreads.append(math.sqrt(allowed[0, 0]))
            motions.append(one.motion[:, inside].mean(axis=1))
    rows = parity_vectors(readings[0].facts.axes)
    if len(rows) > 1 or not any(alarm.check == "level" for alarm in alarms):
        return alarms
    axes = readings[0].facts.axes
    more = by_all_runs(np.array(levels), np.array(spreads), np.array(motions), axes, rows[0])
    return [
        replace(alarm, evidence=(*alarm.evidence, more)) if alarm.check == "level" else alarm
        for alarm in alarms
    ]


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
    for inside in _segments(one):
        alarms += _levels(one, noise, stated, inside)
        alarms += _steps(one, noise, stated, inside, samples)
    alarms += _scatters(one, samples) + _outputs(one)
    return sorted(alarms, key=lambda alarm: alarm.alarm_s)


def _segments(one: Readings) -> list[NDArray[np.intp]]:
    """Bins of each segment in which all gyros answer, where they are enough."""
    whole = np.isfinite(one.raw).all(axis=0)
    found = [np.flatnonzero((one.segment == k) & whole) for k in np.unique(one.segment).tolist()]
    return [inside for inside in found if inside.size >= _FEWEST]


def bin_sigma(one: Readings, noise: list[GyroNoise]) -> Array:
    """White noise of each gyro's bin means, (n, m) [deg/h]."""
    white = np.array([60 * each.white_deg_sqrt_h for each in noise]) / math.sqrt(one.bin_s)
    full = one.facts.sample_rate_hz * one.bin_s
    found: Array = white[:, None] * np.sqrt(full / np.maximum(one.count, 1))
    return found


def _mean_parity(
    one: Readings, noise: list[GyroNoise], stated: StatedErrors, inside: NDArray[np.intp]
) -> tuple[Array, Array, Array]:
    """Mean parity (n - 3,) of a segment, its covariance as stated, and the variances (n,) of gyros' means."""
    rows = parity_vectors(one.facts.axes)
    mean = rows @ residual_rates(one)[:, inside].mean(axis=1)
    departures = gyro_departures(one.facts, stated, one.time_s[inside]).mean(axis=2) * SECONDS_PER_HOUR
    sigma = bin_sigma(one, noise)[:, inside].mean(axis=1)
    flicker = np.array([each.flicker_deg_h for each in noise])
    # Flicker's mean over a run is its variance from 1e-5 Hz to the run's length.
    octaves = max(math.log(1e5 / (inside.size * one.bin_s)), 1.0) / math.pi
    of_noise = sigma**2 / inside.size + flicker**2 * octaves
    allowed = rows @ (departures.T @ departures + np.diag(of_noise)) @ rows.T
    return mean, allowed, np.diag(departures.T @ departures) + of_noise


def _levels(
    one: Readings, noise: list[GyroNoise], stated: StatedErrors, inside: NDArray[np.intp]
) -> list[Alarm]:
    """The mean parity of a segment against what is stated."""
    mean, allowed, variance = _mean_parity(one, noise, stated, inside)
    square = float(mean @ np.linalg.solve(allowed, mean))
    chance = LEVEL_CHANCE / max(1, int(one.segment[-1]) + 1)
    if log_chi2_tail(square, len(mean)) > math.log(chance):
        return []
    evidence = by_known_motion(residual_rates(one)[:, inside].mean(axis=1), variance)
    what = "parity is off from the start: a bias, a scale factor, an axis, or a dead gyro"
    start, stop = float(one.time_s[inside[0]]), float(one.time_s[inside[-1]])
    size = float(np.linalg.norm(mean))
    return [Alarm(one.facts.run_id, "level", what, start, stop, size, (evidence,))]


def _steps(
    one: Readings, noise: list[GyroNoise], stated: StatedErrors, inside: NDArray[np.intp], samples: float
) -> list[Alarm]:
    """Steps of the parity within a segment."""
    residual, sigma = residual_rates(one), bin_sigma(one, noise)
    flicker = np.array([each.flicker_deg_h for each in noise])
    usual = np.array(stated.turn_on_bias_deg_h, float)
    alarms = []
    for row in parity_vectors(one.facts.axes):
        spread = np.sqrt(row**2 @ sigma[:, inside] ** 2)
        wander = _WANDER * math.sqrt(row**2 @ flicker**2) / float(np.median(spread))
        allowance = SHIFT / 2 + wander
        limit = level_limit(samples, allowance)
        changes = level_changes(row @ residual[:, inside], spread, limit, allowance)
        for k, change in enumerate(changes):
            begun = inside[changes[k - 1].start if k else 0]
            ended = inside[changes[k + 1].start - 1 if k + 1 < len(changes) else -1] + 1
            start = int(inside[change.start])
            parts = slice(int(begun), start), slice(start, int(ended))
            evidence = [
                _of_motion(residual, sigma, parts),
                by_own_noise(one.scatter, one.count, *parts),
                _of_dynamics(one, row, residual, sigma, start),
                by_history(change.size, row, usual),
            ]
            what = "parity steps: a bias or a scale factor changed"
            since, noticed = float(one.time_s[start]), float(one.time_s[inside[change.alarm]])
            found = tuple(each for each in evidence if each is not None)
            alarms.append(Alarm(one.facts.run_id, "step", what, since, noticed, change.size, found))
    return alarms


def _of_motion(residual: Array, sigma: Array, parts: tuple[slice, slice]) -> Evidence:
    """The step of each gyro beyond the known motion."""
    means, variances = [], []
    for part in parts:
        there = np.isfinite(residual[:, part])
        many = np.maximum(there.sum(axis=1), 1)
        means.append(np.where(there, residual[:, part], 0.0).sum(axis=1) / many)
        variances.append(np.where(there, sigma[:, part] ** 2, 0.0).sum(axis=1) / many**2)
    return by_known_motion(means[1] - means[0], variances[0] + variances[1])


def _of_dynamics(one: Readings, row: Array, residual: Array, sigma: Array, start: int) -> Evidence:
    """Whether the step follows the rate, over all segments of the run."""
    facts = one.facts
    whole = np.isfinite(residual).all(axis=0)
    return by_dynamics(
        row @ residual[:, whole],
        np.sqrt(row**2 @ sigma[:, whole] ** 2),
        facts.profile.rate_deg_s[one.segment[whole]],
        np.arange(whole.size)[whole] >= start,
        row * (facts.axes @ facts.commanded_signs),
    )


def _scatters(one: Readings, samples: float) -> list[Alarm]:
    """Noise bursts and quiet outputs, of each gyro by itself."""
    alarms = []
    n = one.facts.n_gyros
    for i in range(n):
        there = np.flatnonzero((one.count[i] >= 4) & np.isfinite(one.scatter[i]))
        if there.size < _FEWEST:
            continue
        variance, freedom = one.scatter[i, there] ** 2, one.count[i, there] - 1
        evidence = (Evidence(OWN_NOISE, np.eye(n)[i]),)
        for what, changes in zip(
            ("the output goes quiet: its noise is gone", "a noise burst"),
            scatter_changes(variance, freedom, (QUIET, BURST), samples),
            strict=True,
        ):
            for change in changes:
                times = float(one.time_s[there[change.start]]), float(one.time_s[there[change.alarm]])
                alarms.append(Alarm(one.facts.run_id, "scatter", what, *times, change.size, evidence))
    return alarms


def _outputs(one: Readings) -> list[Alarm]:
    """Gyros that give nothing of use over several bins while another answers."""
    n, alarms = one.facts.n_gyros, []
    there = np.isfinite(one.raw)
    for i in range(n):
        silent = np.concatenate(([False], ~there[i] & there.any(axis=0), [False]))
        edges = np.flatnonzero(np.diff(silent.astype(np.int8)))
        for start, stop in zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True):
            if stop - start >= _SILENT:
                since, noticed = (float(one.time_s[k]) for k in (start, start + _SILENT - 1))
                what = "the output is stuck or missing"
                evidence = (Evidence(OWN_OUTPUT, np.eye(n)[i]),)
                alarms.append(
                    Alarm(one.facts.run_id, "output", what, since, noticed, float(stop - start), evidence)
                )
    return alarms
