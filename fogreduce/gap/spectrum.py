"""Noise levels, their colour and their sharing among gyros, from averaged spectra (Whittle's likelihood).

A mean power P of K pieces about an expectation S has ``ln L = -K (ln S + P / S)`` in every line.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache, partial
from itertools import combinations
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fogreduce.constants import SECONDS_PER_HOUR
from fogreduce.effects.at import At, Place
from fogreduce.effects.electronics import low_pass
from fogreduce.effects.gyro_names import gyro_name
from fogreduce.effects.table import EFFECTS
from fogreduce.gap.evidence import log_bayes, log_mean_exp
from fogreduce.gap.findings import Finding
from fogreduce.gap.full_rate import FullRate
from fogreduce.metadata.facts import RunFacts
from fogreduce.physics.noise import white_sigma
from fogreduce.simulate.streams import stream

Array = NDArray[np.float64]

#: How well a record's white noise is taken to be known, relative: the contract does not state it.
LEVEL_DOUBT = 0.02
_TAUS_MS = np.geomspace(0.1, 200.0, 40)
_LEVELS = LEVEL_DOUBT * np.array([3.0, 6.0, 12.0, 25.0, 60.0])
_EDGES = 14
_CORRELATIONS = np.array([0.004, 0.007, 0.012, 0.02, 0.035, 0.06, 0.1, 0.2, 0.35, 0.6, 0.85])


@dataclass(frozen=True)
class Levels:
    """Averaged spectra of a campaign's runs, one row a gyro, as ratios to what the record states.

    Attributes
    ----------
    ratio : (n, F) array
        Power over that of the stated white noise, rounding in it.
    pieces : (n,) array
        How many spectra were averaged.
    frequency : (F,) array
        As fractions of the sample rate.
    keep : (n, F) array of bool
        Lines that no spectral line spoils.
    correlation : (n, n) array
        Of the gyros' noises; its diagonal is 1.
    dof : float
        Independent pairs of numbers behind it.
    stated : (n,) array
        N of the record [deg/sqrt(h)].
    rate_hz : float
    expected : (n, F) array
        Power that the record states [(deg/h)^2].
    """

    ratio: Array
    pieces: Array
    frequency: Array
    keep: NDArray[np.bool_]
    correlation: Array
    dof: float
    stated: Array
    rate_hz: float
    expected: Array

    def beside(self, kind: str, size: float, i: int) -> Array:
        """Shape (F,) that a further process gives the spectrum of gyro i; a smooth one does not show."""
        if kind not in ("flicker", "walk"):
            return np.ones(len(self.frequency))
        added = _drifting(self.frequency * self.rate_hz, **{kind: size})
        result: Array = 1.0 + 0.5 * self.rate_hz * added / self.expected[i]
        return result


def levels(
    runs: Sequence[FullRate],
    facts: RunFacts,
    stated: Array,
    spoiled_hz: Sequence[Sequence[float]],
    bits: Array,
    flicker: Array,
    walk: Array,
) -> Levels | None:
    """Averages over runs; None where runs are too short for a spectrum.

    Parameters
    ----------
    runs : statistics of each run
    facts : RunFacts
        Of any run: they share sample rate and calibration here.
    stated : (n,) array
        N of the record [deg/sqrt(h)].
    spoiled_hz : for each gyro
        Frequencies of lines, to be left out.
    bits : (n,) array
        Bits that are always 0, whose rounding adds noise.
    flicker, walk : (n,) arrays
        B [deg/h] and K [deg/h/sqrt(h)] of the record.
    """
    usable = [run for run in runs if run.pieces > 0 and len(run.frequency) == len(runs[0].frequency)]
    if not usable:
        return None
    frequency, n = usable[0].frequency, facts.n_gyros
    white = np.array([float(white_sigma(s, facts.sample_rate_hz)) for s in stated]) * SECONDS_PER_HOUR
    quantum = facts.least_count / np.abs(facts.scale_factor) * SECONDS_PER_HOUR * 2.0**bits
    # what the record states as slow adds to the lowest lines; white noise of variance s^2 has s^2 in each
    spectral = frequency * facts.sample_rate_hz
    drifting = _drifting(spectral, flicker[:, None], walk[:, None])
    expected = (white**2 + quantum**2 / 12.0)[:, None] + 0.5 * facts.sample_rate_hz * drifting
    power, pieces = np.zeros((n, len(frequency))), np.zeros(n)
    cross = np.zeros((len(frequency), n, n))
    for run in usable:
        awake = ~run.at_rest
        power[awake] += run.pieces * run.power[awake]
        pieces += run.pieces * awake
        cross += run.pieces * run.cross * np.outer(awake, awake)
    ratio = power / np.maximum(pieces, 1.0)[:, None] / expected
    keep = np.ones((n, len(frequency)), bool)
    width = 1.6 * (frequency[1] - frequency[0])
    for i, lines in enumerate(spoiled_hz):
        for hz in lines:
            keep[i] &= np.abs(frequency - hz / facts.sample_rate_hz) > width
    clean = keep.all(axis=0)
    total = cross[clean].sum(axis=0)
    scale = np.sqrt(np.maximum(np.diag(total), 1e-300))
    correlation = total / np.outer(scale, scale)
    np.fill_diagonal(correlation, 1.0)  # also of a gyro that rests in every run
    return Levels(
        ratio,
        pieces,
        frequency,
        keep,
        correlation,
        float(sum(run.pieces for run in usable)) * float(clean.sum()),
        stated,
        facts.sample_rate_hz,
        expected,
    )


def _drifting(hertz: Array, flicker: Array | float = 0.0, walk: Array | float = 0.0) -> Array:
    """One-sided density [(deg/h)^2/Hz] of flicker of B [deg/h] and a walk of K [deg/h/sqrt(h)]."""
    turning = 2.0 * np.pi * hertz
    result: Array = 2.0 * np.square(flicker) / turning + 2.0 * np.square(walk) / (
        SECONDS_PER_HOUR * turning**2
    )
    return result


def filter_gain(tau_ms: float, rate_hz: float, frequency: Array) -> Array:
    """Power gain of the simulator's own low pass at frequencies given as fractions of the sample rate."""
    size = 8192
    impulse = np.zeros(size)
    impulse[1] = 1.0
    place = Place("", 0, (), 1, partial(stream, 0, "gap"))
    nowhere: Any = None  # a filter looks at nothing but its input
    at = At(place, impulse, 1.0 / rate_hz, nowhere, impulse, None, impulse, impulse)
    response = np.abs(np.fft.rfft(low_pass(impulse, {"time_constant_ms": tau_ms}, at))) ** 2
    return np.interp(frequency, np.fft.rfftfreq(size), response)


@lru_cache(maxsize=8)
def _gains(rate_hz: float, count: int, frequency: bytes) -> Array:
    """Power gains of low passes of each of `_TAUS_MS`, (taus, F); frequencies as bytes of float64."""
    lines = np.frombuffer(frequency, np.float64, count)
    return np.array([filter_gain(t, rate_hz, lines) for t in _TAUS_MS.tolist()])


def _profile(mean_ratio: Array, weight: float, spreads: Array) -> Array:
    """Ln evidence, over that of the best level, of levels spread normally about the record's.

    `mean_ratio`: power found over power expected; `weight`: how many exponential deviates it is the mean of;
    `spreads`: standard deviations of ln level, each a hypothesis (..., len(spreads)).
    """
    found = 0.5 * np.log(np.maximum(mean_ratio, 1e-12))[..., None]
    error = 0.5 / np.sqrt(weight)
    width2 = spreads**2 + error**2
    result: Array = -0.5 * found**2 / width2 - 0.5 * np.log(width2 / error**2)
    return result


def level_findings(
    lv: Levels, i: int, allowed: frozenset[str], held: Array, free: bool, filtered: bool = False
) -> list[Finding]:
    """White noise of another level, a low pass, or an unknown colour, at gyro i.

    Parameters
    ----------
    lv : Levels
    i : int
    allowed : names of effects
    held : (F,) array
        Shape of the spectrum that causes found already make.
    free : bool
        Whether the level is a cause already, and so anything.
    filtered : bool
        Whether a filter is a cause already: a second one is not looked for.
    """
    keep, pieces = lv.keep[i], float(lv.pieces[i])
    if pieces == 0 or keep.sum() < 8:
        return []
    ratio = lv.ratio[i, keep] / held[keep]
    bins = len(ratio)
    weight = pieces * bins
    name = gyro_name(i)

    def best_log(r: Array) -> Array:
        """Ln likelihood (..., F) at the best level."""
        mean = np.mean(r, axis=-1)
        return -weight * (np.log(mean) + 1.0)

    null_spread = np.array([2.0 if free else LEVEL_DOUBT])
    nothing = float(best_log(ratio)) + float(_profile(np.mean(ratio), weight, null_spread)[0])
    out: list[Finding] = []

    def add(
        effect: str,
        log_z: float,
        snr2: float,
        parameters: dict[str, tuple[float, float]],
        feature: str,
        stage: str,
        degrees: int = 1,
    ) -> None:
        out.append(
            Finding(
                effect,
                (name,),
                ("*",),
                log_z - nothing,
                snr2,
                parameters,
                1.0 / lv.ratio.shape[0],
                "level",
                stage,
                feature,
                degrees,
            )
        )

    mean = float(np.mean(ratio))
    found, error = 0.5 * np.log(mean), 0.5 / np.sqrt(weight)
    level_snr2 = found**2 / (LEVEL_DOUBT**2 + error**2)
    if not free:
        anything = float(best_log(ratio)) + float(log_mean_exp(_profile(np.mean(ratio), weight, _LEVELS)))
        value = lv.stated[i] * np.exp(found)
        if "angle_random_walk" in allowed:
            std = value * error
            add("angle_random_walk", anything, level_snr2, {"deg_sqrt_h": (value, std)}, "white", "noise")
        else:
            add("unknown", anything, level_snr2, {}, "white", "noise")
    if not filtered:
        gains = _gains(lv.rate_hz, len(lv.frequency), lv.frequency.tobytes())[:, keep]
        under = ratio / gains
        logs = best_log(under) - pieces * np.log(gains).sum(axis=1)
        logs = logs + _profile(np.mean(under, axis=1), weight, null_spread)[:, 0]
        tau, std = _peak(_TAUS_MS, logs)
        snr2 = 2.0 * max(float(logs.max()) - nothing, 0.0)
        log_z = float(log_mean_exp(logs))
        if "low_pass" in allowed:
            add("low_pass", log_z, snr2, {"time_constant_ms": (tau, std)}, "band", "electronics")
        else:
            add("unknown", log_z, snr2, {}, "band", "noise")
    q = _bands(ratio, pieces)
    logs = log_bayes(q, 1)
    best = float(q.max()) if q.size else 0.0
    # the level is that outside the band: as free as it is for nothing wrong
    add("unknown", nothing + float(log_mean_exp(logs)), best, {}, "band", "noise", 3)
    return out


def _bands(ratio: Array, pieces: float) -> Array:
    """Twice the gain in ln likelihood of each band with a level of its own."""
    edges = np.unique(np.linspace(0, len(ratio), _EDGES + 1).astype(int))
    sums = np.concatenate(([0.0], np.cumsum(ratio)))
    low, high = np.array(list(combinations(edges.tolist(), 2))).T
    inside = high - low
    some = inside < len(ratio)
    low, high, inside = low[some], high[some], inside[some]
    within = sums[high] - sums[low]
    outside = len(ratio) - inside
    q: Array = (
        2.0
        * pieces
        * (
            len(ratio) * np.log(sums[-1] / len(ratio))
            - inside * np.log(within / inside)
            - outside * np.log((sums[-1] - within) / outside)
        )
    )
    return np.maximum(q, 0.0)


def _peak(grid: Array, logs: Array) -> tuple[float, float]:
    """Where ln likelihood is highest, and its width, from a parabola in ln grid."""
    k = int(np.clip(np.argmax(logs), 1, len(grid) - 2))
    x = np.log(grid[k - 1 : k + 2])
    a, b, _ = np.polyfit(x - x[1], logs[k - 1 : k + 2] - logs[k], 2)
    if a >= 0.0:
        return float(grid[int(np.argmax(logs))]), float(grid[k])
    shift = float(np.clip(-b / (2.0 * a), x[0] - x[1], x[2] - x[1]))
    value = float(np.exp(x[1] + shift))
    return value, value / np.sqrt(-2.0 * a)


def correlation_findings(lv: Levels, allowed: frozenset[str]) -> Iterator[Finding]:
    """White noise that gyros share: one correlation for a group of gyros, or any for any pair."""
    n = len(lv.correlation)
    if n < 2 or lv.dof == 0:
        return
    if "common_noise" in allowed and "common_noise" in EFFECTS:
        for size in range(n, 1, -1):
            groups = list(combinations(range(n), size))
            for group in groups:
                share = 0.7 if size == n else 0.3 / (n - 2) / len(groups)
                if n == 2:
                    share = 1.0
                yield _shared(lv, group, share)
    for i, j in combinations(range(n), 2):
        q = lv.dof * 2.0 * float(np.arctanh(np.clip(lv.correlation[i, j], -0.999999, 0.999999))) ** 2
        pair = (gyro_name(i), gyro_name(j))
        log_b = float(log_bayes(np.array(q), 1))
        yield Finding(
            "unknown", pair, ("*",), log_b, q, {}, 2.0 / n / (n - 1), "correlation", "noise", "correlation"
        )


def _shared(lv: Levels, group: tuple[int, ...], share: float) -> Finding:
    part = lv.correlation[np.ix_(group, group)]
    size = len(group)
    mean = (part.sum() - size) / (size * (size - 1))
    fine = np.linspace(mean - 0.02, mean + 0.02, 41)
    lowest = -1.0 / (size - 1)
    values = np.concatenate([_CORRELATIONS, -_CORRELATIONS, fine])
    logs = np.full(len(values), -np.inf)
    for k, rho in enumerate(values.tolist()):
        if lowest < rho < 1.0:
            # of (1 - r) 1 + r J: eigenvalues 1 - r, and 1 + (m - 1) r once
            own, whole = 1.0 - rho, 1.0 + (size - 1) * rho
            trace = (size - part.sum() / size) / own + part.sum() / size / whole
            logs[k] = -lv.dof * ((size - 1) * np.log(own) + np.log(whole) + trace - size)
    coarse = logs[: 2 * len(_CORRELATIONS)]
    best = int(np.argmax(logs))
    # the true value lies between points of the coarse grid: its peak is the fine grid's, as wide as a cell
    # allows
    std = float(1.0 / np.sqrt(2.0 * lv.dof * size * (size - 1) / 2.0))
    spacing = 0.5 * abs(float(values[best]))
    peak = float(logs[best]) + np.log(min(2.5 * std / max(spacing, std), 1.0)) - np.log(len(coarse))
    log_b = max(float(log_mean_exp(coarse)), peak)
    return Finding(
        "common_noise",
        tuple(gyro_name(i) for i in group),
        ("*",),
        log_b,
        2.0 * float(logs[best]),
        {"correlation": (float(values[best]), std)},
        share,
        "correlation",
        "noise",
        "correlation",
    )
