"""Noise levels, their colour and their sharing among gyros, from averaged spectra (Whittle's likelihood).

A mean power P of K pieces about an expectation S has ``ln L = -K (ln S + P / S)`` in every line.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import combinations, pairwise

import numpy as np
from numpy.typing import NDArray

from fogreduce.constants import SECONDS_PER_HOUR
from fogreduce.diagnosis.inference.evidence import log_bayes, log_mean_exp
from fogreduce.diagnosis.inference.findings import Finding
from fogreduce.diagnosis.observe.full_rate import FullRate
from fogreduce.diagnosis.which.full_rate.low_pass import filter_evidence, filter_logs
from fogreduce.diagnosis.which.full_rate.pieces import filter_gains, shown_drift
from fogreduce.diagnosis.which.full_rate.whittle import level_profile, mean_ratio, peak
from fogreduce.effects.gyro_names import gyro_name
from fogreduce.effects.table import EFFECTS
from fogreduce.metadata.facts import RunFacts
from fogreduce.physics.noise import white_sigma

Array = NDArray[np.float64]

#: How well a record's white noise is taken to be known, relative: the contract does not state it.
LEVEL_DOUBT = 0.02
_LEVELS = LEVEL_DOUBT * np.array([3.0, 6.0, 12.0, 25.0, 60.0])
_EDGES = 14
_DRIFT_POWERS = np.geomspace(0.03, 3e5, 60)  # of a drift in the lowest line, over what the record states
#: Effects whose spectrum falls with frequency: kind of process and parameter.
DRIFTS = {name: effect.process for name, effect in EFFECTS.items() if effect.process is not None}


@dataclass(frozen=True)
class Levels:
    """Averaged spectra of a campaign's runs, one row a gyro, as ratios to what the record states.

    Attributes
    ----------
    ratio : (n, F) array
        Power over that of the stated white noise, rounding in it.
    pieces : (n, F) array
        How many spectra were averaged in each line.
    frequency : (F,) array
        As fractions of the sample rate; runs of one rate and piece after those of another.
    keep : (n, F) array of bool
        Lines that no spectral line spoils.
    correlation : (n, n) array
        Of the gyros' noises; its diagonal is 1.
    dof : float
        Independent pairs of numbers behind it.
    stated : (n,) array
        N of the record [deg/sqrt(h)].
    rate_hz : (F,) array
        Sample rate of the runs that each line comes from.
    expected : (n, F) array
        Power that the record states [(deg/h)^2], rounding in it.
    rounding, drift : (n, F) arrays
        The parts of it that rounding to counts and what the record states as slow make.
    """

    ratio: Array
    pieces: Array
    frequency: Array
    keep: NDArray[np.bool_]
    correlation: Array
    dof: float
    stated: Array
    rate_hz: Array
    expected: Array
    rounding: Array
    drift: Array

    @property
    def lowest(self) -> NDArray[np.bool_]:
        """Which lines are the lowest quarter of their runs' spectra, (F,)."""
        starts = np.flatnonzero(np.diff(self.frequency, prepend=np.inf) < 0.0)
        out = np.zeros(len(self.frequency), bool)
        for first, stop in pairwise([*starts.tolist(), len(out)]):
            out[first : min(first + max((stop - first) // 4, 4), stop)] = True
        return out

    def low_passed(self, tau_ms: float, i: int) -> Array:
        """Shape (F,) that the low pass of that time constant for which gyro i's spectrum speaks gives it."""
        keep = self.keep[i] & (self.pieces[i] > 0.0)
        gains = self.low_passes(np.array([tau_ms]), i)
        logs = filter_logs(self.ratio[i, keep], self.pieces[i, keep], gains[..., keep], LEVEL_DOUBT)
        result: Array = gains[int(np.argmax(logs)), 0]
        return result

    def low_passes(self, taus_ms: Array, i: int) -> Array:
        """Shapes (3, taus, F) that low passes of each time constant, of each kind (`filter_gains`), give the
        spectrum of gyro i: its converter's rounding comes after them.
        """
        gains = np.empty((3, len(taus_ms), len(self.frequency)))
        for rate in np.unique(self.rate_hz).tolist():
            lines = self.frequency[self.rate_hz == rate]
            gains[..., self.rate_hz == rate] = filter_gains(taus_ms, rate, lines)
        rounded = self.rounding[i] / self.expected[i]
        result: Array = rounded + (1.0 - rounded) * gains
        return result

    def white_level(self, mean: float, i: int, which: NDArray[np.bool_]) -> float:
        """N [deg/sqrt(h)] of gyro i whose power in some lines is `mean` times the expected one.

        Rounding and drift go off once, whatever the level: they are no part of N.
        """
        weight = self.pieces[i, which]
        share = (self.rounding[i, which] + self.drift[i, which]) / self.expected[i, which]
        settled = float(weight @ share / weight.sum())
        return float(self.stated[i] * np.sqrt(max(mean - settled, 1e-12) / max(1.0 - settled, 1e-12)))

    def less_drift(self, ratio: Array, i: int) -> Array:
        """Ratios (F,) of gyro i to the expected power as those to the part of it that is no drift."""
        share = self.drift[i] / self.expected[i]
        result: Array = (ratio - share) / (1.0 - share)
        return result

    def with_process(self, kind: str, size: float, i: int) -> Array:
        """Shape (F,) that a further process gives the spectrum of gyro i; a smooth one does not show."""
        if kind not in ("flicker", "walk"):
            return np.ones(len(self.frequency))
        sizes = {"flicker": 0.0, "walk": 0.0, kind: size}
        added = np.empty(len(self.frequency))
        for rate in np.unique(self.rate_hz).tolist():
            here = self.rate_hz == rate
            added[here] = shown_drift(rate, self.frequency[here], **sizes)
        result: Array = 1.0 + added / self.expected[i]
        return result


def levels(
    runs: Sequence[FullRate],
    facts: Sequence[RunFacts],
    stated: Array,
    spoiled_hz: Sequence[Sequence[float]],
    bits: Array,
    colour: tuple[Array, Array],
    own: Array,
) -> Levels | None:
    """Averages over runs of one rate and piece, one such group after another; None where all are too short.

    Parameters
    ----------
    runs : statistics of each run
    facts : RunFacts of each run
    stated : (n,) array
        N of the record [deg/sqrt(h)].
    spoiled_hz : for each gyro
        Frequencies of lines, to be left out.
    bits : (n,) array
        Bits that are always 0, whose rounding adds noise.
    colour : two (n,) arrays
        B [deg/h] and K [deg/h/sqrt(h)] of the record.
    own : (R, n) array
        Noise of each run over that of the gyro's others, to be divided out.
    """
    groups: dict[tuple[float, int], list[int]] = {}
    for r, run in enumerate(runs):
        if run.pieces > 0:
            groups.setdefault((facts[r].sample_rate_hz, len(run.frequency)), []).append(r)
    if not groups:
        return None
    parts = [
        _group([runs[r] for r in members], facts[members[0]], stated, spoiled_hz, bits, colour, own[members])
        for members in groups.values()
    ]
    total = np.sum([products / (1.0 if len(parts) == 1 else size) for _, products, size in parts], axis=0)
    scale = np.sqrt(np.maximum(np.diag(total), 1e-300))
    correlation = total / np.outer(scale, scale)
    np.fill_diagonal(correlation, 1.0)  # also of a gyro that rests in every run
    each = [part for part, _, _ in parts]
    return Levels(
        ratio=np.hstack([part.ratio for part in each]),
        pieces=np.hstack([part.pieces for part in each]),
        frequency=np.concatenate([part.frequency for part in each]),
        keep=np.hstack([part.keep for part in each]),
        correlation=correlation,
        dof=sum(part.dof for part in each),
        stated=stated,
        rate_hz=np.concatenate([part.rate_hz for part in each]),
        expected=np.hstack([part.expected for part in each]),
        rounding=np.hstack([part.rounding for part in each]),
        drift=np.hstack([part.drift for part in each]),
    )


def _group(
    runs: Sequence[FullRate],
    facts: RunFacts,
    stated: Array,
    spoiled_hz: Sequence[Sequence[float]],
    bits: Array,
    colour: tuple[Array, Array],
    own: Array,
) -> tuple[Levels, Array, Array]:
    """Averages over runs of one rate and piece; sums of the gyros' products, and the size of noise's."""
    frequency, n, rate = runs[0].frequency, facts.n_gyros, facts.sample_rate_hz
    white = np.array([float(white_sigma(s, rate)) for s in stated]) * SECONDS_PER_HOUR
    rounding = rounding_variance(facts, bits)
    # what the record states as slow adds to the lowest lines; white noise of variance s^2 has s^2 in each
    drift = shown_drift(rate, frequency, *colour)
    expected = (white**2 + rounding)[:, None] + drift
    power, pieces = np.zeros((n, len(frequency))), np.zeros(n)
    cross = np.zeros((len(frequency), n, n))
    for run, size in zip(runs, own, strict=True):
        awake = ~run.at_rest
        power[awake] += run.pieces * run.power[awake] / size[awake, None] ** 2
        pieces += run.pieces * awake
        cross += run.pieces * run.cross * (np.outer(awake, awake) / np.outer(size, size))
    keep = np.ones((n, len(frequency)), bool)
    width = 1.6 * (frequency[1] - frequency[0])
    for i, lines in enumerate(spoiled_hz):
        for hz in lines:
            keep[i] &= np.abs(frequency - hz / rate) > width
    clean = keep.all(axis=0)
    part = Levels(
        ratio=power / np.maximum(pieces, 1.0)[:, None] / expected,
        pieces=np.repeat(pieces[:, None], len(frequency), axis=1),
        frequency=frequency,
        keep=keep,
        correlation=np.eye(n),
        dof=float(sum(run.pieces for run in runs)) * float(clean.sum()),
        stated=stated,
        rate_hz=np.full(len(frequency), rate),
        expected=expected,
        rounding=np.repeat(rounding[:, None], len(frequency), axis=1),
        drift=drift,
    )
    return part, cross[clean].sum(axis=0), np.sqrt(np.outer(white**2 + rounding, white**2 + rounding))


def rounding_variance(facts: RunFacts, bits: Array) -> Array:
    """Variance [(deg/h)^2] that rounding to counts adds to each gyro's samples, (n,): a step's square / 12.

    Parameters
    ----------
    facts : RunFacts
    bits : (n,) array
        Lowest bits that are always 0: the step is so much wider.
    """
    step = facts.least_count / np.abs(facts.scale_factor) * SECONDS_PER_HOUR * 2.0**bits
    return np.asarray(step**2 / 12.0, np.float64)


def level_evidence(ratio: float, weight: float) -> tuple[float, float]:
    """Ln B of a level that is none of the record's, and twice the gain in ln likelihood.

    Parameters
    ----------
    ratio : float
        Power found over power expected.
    weight : float
        How many exponential deviates it is the mean of.
    """
    nothing = float(level_profile(np.array(ratio), weight, np.array([LEVEL_DOUBT]))[0])
    anything = float(log_mean_exp(level_profile(np.array(ratio), weight, _LEVELS)))
    return anything - nothing, (0.5 * np.log(ratio)) ** 2 / (LEVEL_DOUBT**2 + 0.25 / weight)


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
    keep = lv.keep[i] & (lv.pieces[i] > 0.0)
    if keep.sum() < 8:
        return []
    ratio, pieces = lv.ratio[i, keep] / held[keep], lv.pieces[i, keep]
    weight = float(pieces.sum())
    name = gyro_name(i)

    def best_log(r: Array) -> Array:
        """Ln likelihood (..., F) at the best level."""
        return -weight * (np.log(mean_ratio(r, pieces)) + 1.0)

    null_spread = np.array([2.0 if free else LEVEL_DOUBT])
    mean = float(mean_ratio(ratio, pieces))
    nothing = float(best_log(ratio)) + float(level_profile(np.array(mean), weight, null_spread)[0])
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

    found, error = 0.5 * np.log(mean), 0.5 / np.sqrt(weight)
    level_snr2 = found**2 / (LEVEL_DOUBT**2 + error**2)
    if not free:
        anything = float(best_log(ratio)) + float(
            log_mean_exp(level_profile(np.array(mean), weight, _LEVELS))
        )
        if "angle_random_walk" in allowed:
            value = lv.white_level(mean, i, keep)
            # of the whole power, whose part that is no white noise is exact
            std = (
                error * mean * (lv.white_level(2.0, i, keep) ** 2 - lv.white_level(1.0, i, keep) ** 2) / value
            )
            add("angle_random_walk", anything, level_snr2, {"deg_sqrt_h": (value, std)}, "white", "noise")
        else:
            add("unknown", anything, level_snr2, {}, "white", "noise")
    if not filtered:
        log_z, top, tau, std = filter_evidence(
            ratio, pieces, lambda taus: lv.low_passes(taus, i)[..., keep], float(null_spread[0]), nothing
        )
        snr2 = 2.0 * max(top - nothing, 0.0)
        if "low_pass" in allowed:
            add("low_pass", log_z, snr2, {"time_constant_ms": (tau, std)}, "band", "electronics")
        else:
            add("unknown", log_z, snr2, {}, "band", "noise")
    for effect, (kind, parameter) in DRIFTS.items():
        shape = (lv.with_process(kind, 1.0, i) - 1.0)[keep]
        sizes = np.sqrt(_DRIFT_POWERS / max(float(shape.max()), 1e-300))
        gains = 1.0 + sizes[:, None] ** 2 * shape
        under = ratio / gains
        logs = best_log(under) - np.log(gains) @ pieces
        logs = logs + level_profile(mean_ratio(under, pieces), weight, null_spread)[:, 0]
        value, std = peak(sizes, logs)
        snr2 = 2.0 * max(float(logs.max()) - nothing, 0.0)
        if effect in allowed:
            add(effect, float(log_mean_exp(logs)), snr2, {parameter: (value, std)}, "low_frequency", "noise")
            out[-1] = replace(out[-1], domain="process", process=(kind, value))
    order = np.argsort((lv.frequency * lv.rate_hz)[keep], kind="stable")
    q = _bands(ratio[order], pieces[order])
    logs = log_bayes(q, 1)
    best = float(q.max()) if q.size else 0.0
    # the level is that outside the band: as free as it is for nothing wrong
    add("unknown", nothing + float(log_mean_exp(logs)), best, {}, "band", "noise", 3)
    return out


def _bands(ratio: Array, pieces: Array) -> Array:
    """Twice the gain in ln likelihood of each band with a level of its own; lines in order of frequency."""
    edges = np.unique(np.linspace(0, len(ratio), _EDGES + 1).astype(int))
    sums = np.concatenate(([0.0], np.cumsum(pieces * ratio)))
    weights = np.concatenate(([0.0], np.cumsum(pieces)))
    low, high = np.array(list(combinations(edges.tolist(), 2))).T
    some = high - low < len(ratio)
    low, high = low[some], high[some]
    within, inside = sums[high] - sums[low], weights[high] - weights[low]
    outside = weights[-1] - inside
    q: Array = 2.0 * (
        weights[-1] * np.log(sums[-1] / weights[-1])
        - inside * np.log(within / inside)
        - outside * np.log((sums[-1] - within) / outside)
    )
    return np.maximum(q, 0.0)
