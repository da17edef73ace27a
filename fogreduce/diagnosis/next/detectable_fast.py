"""Effects that show at the full rate: what a planned campaign would show of them, from their statistics."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.special import chndtrinc, gammaincinv, ndtri

from fogreduce.constants import SECONDS_PER_HOUR
from fogreduce.diagnosis.inference.findings import Finding
from fogreduce.diagnosis.next.detectable_row import SEPARATED_SIGMA, Row, crossing, threshold
from fogreduce.diagnosis.observe.capture import RunInput
from fogreduce.diagnosis.observe.full_rate import FIRST_LINE, PIECE
from fogreduce.diagnosis.which.full_rate.converter import WAVES
from fogreduce.diagnosis.which.full_rate.correlation import correlation_findings
from fogreduce.diagnosis.which.full_rate.line_evidence import sizes_log
from fogreduce.diagnosis.which.full_rate.link import HEALTHY_FAULT, share_evidence
from fogreduce.diagnosis.which.full_rate.spectrum import Levels, level_findings
from fogreduce.diagnosis.which.full_rate.stamps import clock_evidence, stamps
from fogreduce.diagnosis.which.full_rate.streams import LEAST_HZ
from fogreduce.effects.gyro_names import gyro_name
from fogreduce.physics.noise import white_sigma

Array = NDArray[np.float64]

_LEAST_SAMPLES = 32
_KEPT = 0.95  # of a line's amplitude that the nearest line of the spectrum shows, on average
_ADDED_US = np.geomspace(0.01, 100.0, 61).tolist()  # what a wrong clock adds up to in the longest run


def fast_rows(inputs: Sequence[RunInput], allowed: frozenset[str], probability: float) -> Iterator[Row]:
    """Rows of every effect that shows at the full rate.

    Parameters
    ----------
    inputs : runs, with or without captures
    allowed : names of effects
    probability : float
    """
    for rows in (_levels, _lines, _links, _converter, _clock):
        yield from (row for row in rows(inputs, probability) if row.effect in allowed)


def _least(expected: Callable[[float], Finding], low: float, high: float, probability: float) -> float | None:
    """The size at which a finding, at the expected data, has what is needed; `share` is the finding's own."""

    def excess(size: float) -> float:
        found = expected(size)
        return found.log_b - threshold(found.share)

    even = crossing(excess, low, high)
    if even is None:
        return None
    wanted = np.sqrt(expected(even).snr2) + float(ndtri(probability))
    return crossing(lambda size: float(np.sqrt(expected(size).snr2)) - wanted, even, high)


# ---------------------------------------------------------------------------------------- spectra


def _expected_levels(inputs: Sequence[RunInput]) -> Levels | None:
    """Averaged spectra of white noise as the record states it; None where runs are too short."""
    n, facts = inputs[0].facts.n_gyros, inputs[0].facts
    length = min(PIECE, min(one.facts.n_expected for one in inputs) // 4)
    if length < 16:
        return None
    pieces = float(sum(one.facts.n_expected // length for one in inputs))
    frequency = np.asarray(np.fft.rfftfreq(length)[min(FIRST_LINE, length // 8) : -1], np.float64)
    return Levels(
        np.ones((n, len(frequency))),
        np.full((n, len(frequency)), pieces),
        frequency,
        np.ones((n, len(frequency)), bool),
        np.eye(n),
        pieces * len(frequency),
        _stated(inputs),
        np.full(len(frequency), facts.sample_rate_hz),
        np.ones((n, len(frequency))),
        np.zeros((n, len(frequency))),
        np.zeros((n, len(frequency))),
    )


def _stated(inputs: Sequence[RunInput]) -> Array:
    return np.array(inputs[0].record.stated_noise.angle_random_walk_deg_sqrt_h)


def _with(levels: Levels, ratio: Array | None = None, correlation: Array | None = None) -> Levels:
    return replace(
        levels,
        ratio=levels.ratio if ratio is None else ratio,
        correlation=levels.correlation if correlation is None else correlation,
    )


def _levels(inputs: Sequence[RunInput], probability: float) -> Iterator[Row]:
    levels = _expected_levels(inputs)
    if levels is None:
        return
    n, flat = len(levels.ratio), np.ones(levels.ratio.shape[1])
    white, filtered = frozenset({"angle_random_walk"}), frozenset({"low_pass", "angle_random_walk"})

    def louder(more: float) -> Finding:
        found = level_findings(_with(levels, levels.ratio * (1.0 + more) ** 2), 0, white, flat, False)
        return next(f for f in found if f.effect == "angle_random_walk")

    def slower(tau_ms: float) -> Finding:
        gain = levels.low_passes(np.array([tau_ms]), 0)[0, 0]
        found = level_findings(_with(levels, levels.ratio * gain), 0, filtered, flat, False)
        return next(f for f in found if f.effect == "low_pass")

    def shared(correlation: float) -> Finding:
        matrix = np.where(np.eye(n) > 0, 1.0, correlation)
        found = correlation_findings(_with(levels, correlation=matrix), frozenset({"common_noise"}))
        return next(f for f in found if f.effect == "common_noise" and len(f.channels) == n)

    more = _least(louder, 1e-4, 100.0, probability)
    tau = _least(slower, 1e-2, 200.0, probability)
    for i in range(n):
        level = None if more is None else float(levels.stated[i]) * (1.0 + more)
        at = {} if more is None else {"stated_deg_sqrt_h": float(levels.stated[i])}
        yield Row("angle_random_walk", (gyro_name(i),), ("*",), "deg_sqrt_h", level, more is not None, at)
        yield Row("low_pass", (gyro_name(i),), ("*",), "time_constant_ms", tau, tau is not None)
    if n > 1:
        value = _least(shared, 1e-5, 0.95, probability)
        names = tuple(gyro_name(i) for i in range(n))
        yield Row("common_noise", names, ("*",), "correlation", value, value is not None)


def _moduli(runs: int, more: float, probability: float) -> float | None:
    """Smallest amplitude of a line in each run, in standard deviations of a quadrature; `more`: ln B."""

    def excess(size: float) -> float:
        mean, _ = sizes_log(np.full((1, runs), np.sqrt(size**2 + 2.0)))
        return float(mean[0]) - more

    even = crossing(excess, 1e-2, 1e6)
    if even is None:
        return None
    power = runs * (even**2 + 2.0)
    return float(np.sqrt(chndtrinc(power, 2.0 * runs, 1.0 - probability) / runs))


def _lines(inputs: Sequence[RunInput], probability: float) -> Iterator[Row]:
    facts, n = inputs[0].facts, inputs[0].facts.n_gyros
    rate = facts.sample_rate_hz
    samples = max(one.facts.n_expected for one in inputs)
    runs = sum(one.facts.n_expected == samples for one in inputs)
    band = 0.49 * rate - LEAST_HZ
    if band <= 0.0 or samples < 64:
        return
    padded = 2 ** np.ceil(np.log2(2.0 * samples))
    count = max(band / rate * padded / 2.0, 1.0)
    white = np.array([float(white_sigma(s, rate)) for s in _stated(inputs)]) * SECONDS_PER_HOUR
    # amplitude of one standard deviation of a quadrature [deg/h], for a line somewhere between two of them
    unit = white * np.sqrt(2.0 / samples) / _KEPT
    more = np.log(2.0 * count)
    at = {"frequency_hz": f"any from {LEAST_HZ:g} to {0.49 * rate:g}"}
    least = _moduli(runs, threshold(1.0 / n) + more, probability)
    seen = facts.axes * facts.frame_signs / unit[:, None]
    for i in range(n):
        left = 1.0
        if n > 1:
            basis = np.linalg.qr(seen)[0]
            left = float(np.sqrt(max(1.0 - np.sum(basis[i] ** 2), 0.0)))
        rivals = () if left * 10.0 >= SEPARATED_SIGMA and n > 1 else ("base_motion table",)
        amplitude = None if least is None else least * float(unit[i])
        yield Row(
            "periodic_interference",
            (gyro_name(i),),
            ("*",),
            "deg_h",
            amplitude,
            least is not None,
            at,
            rivals,
        )
    if n < 2:
        return
    # of the directions that a motion may have, only so many would do as well
    total = _moduli(runs, threshold(1.0) + more, probability)
    if total is not None:
        chance = np.log(max(0.5 * runs * total**2, 1.0)) if n > 2 else 0.0
        total = _moduli(runs, threshold(1.0) + more + chance, probability)
    for k, axis in enumerate(np.eye(3)):
        strength = float(np.linalg.norm(seen[:, k]))
        there = total is not None and strength > 0.0
        amplitude = total / strength if total is not None and strength > 0.0 else None
        yield Row("base_motion", ("table",), ("*",), "deg_h", amplitude, there, {**at, "axis": axis.tolist()})


# ------------------------------------------------------------------------------------ link, codes


def _hits(trials: float, chance: float, probability: float, share: float) -> float | None:
    """Smallest share of hits of so many trials that is seen."""
    low, high = int(np.floor(trials * chance)), int(0.5 * trials)
    if high <= low or share_evidence(high, trials, chance)[0] < threshold(share):
        return None
    while high - low > 1:
        middle = (low + high) // 2
        enough = share_evidence(middle, trials, chance)[0] >= threshold(share)
        low, high = (low, middle) if enough else (middle, high)
    expected = float(gammaincinv(high, probability))
    return max(expected / trials - chance, 0.0) or None


def _links(inputs: Sequence[RunInput], probability: float) -> Iterator[Row]:
    facts, n = inputs[0].facts, inputs[0].facts.n_gyros
    trials = float(sum(one.facts.n_expected for one in inputs))
    rate = facts.sample_rate_hz
    white = np.array([float(white_sigma(s, rate)) for s in _stated(inputs)])
    counts = white * np.abs(facts.scale_factor) / facts.least_count
    for i in range(n):
        # two neighbours of white noise are equal by chance
        equal = min(1.0 / (2.0 * max(float(counts[i]), 0.3) * np.sqrt(np.pi)), 0.5)
        for effect, chance in (
            ("dropouts", HEALTHY_FAULT),
            ("spikes", HEALTHY_FAULT),
            ("stuck_samples", equal),
        ):
            value = _hits(trials, chance, probability, 1.0 / n)
            yield Row(effect, (gyro_name(i),), ("*",), "fraction", value, value is not None)
        yield Row("lost_bits", (gyro_name(i),), ("*",), "bits", 1.0, trials >= _LEAST_SAMPLES)


def _converter(inputs: Sequence[RunInput], probability: float) -> Iterator[Row]:
    """A converter's error whose period is 2 pi times the noise: what repeats faster shows better."""
    facts, n = inputs[0].facts, inputs[0].facts.n_gyros
    sigma = np.array([float(white_sigma(s, facts.sample_rate_hz)) for s in _stated(inputs)])
    sigma = sigma * np.abs(facts.scale_factor)
    samples = float(np.median([one.facts.n_expected for one in inputs]))
    if samples < 1000:
        return
    for i in range(n):
        least = _moduli(len(inputs), threshold(1.0 / n) + np.log(len(WAVES)), probability)
        kappa = 1.0 / sigma[i]
        # what the error does to each second's mean is taken for something slow
        lost = np.exp(-((kappa * sigma[i]) ** 2)) / sigma[i] ** 2
        information = samples * (kappa**2 + 1.0 / sigma[i] ** 2 - lost)
        amplitude = None if least is None else least / float(np.sqrt(information / 2.0))
        at = {"period_volts": float(2.0 * np.pi * sigma[i])}
        yield Row("adc_nonlinearity", (gyro_name(i),), ("*",), "volts", amplitude, least is not None, at)


def _clock(inputs: Sequence[RunInput], probability: float) -> Iterator[Row]:
    """The error whose whole microseconds, which are no noise, say enough; any `probability`."""
    facts = [one.facts for one in inputs if one.facts.n_expected >= 8]
    every = [(one.n_expected, one.sample_rate_hz) for one in facts]
    sizes = set(every)
    if not sizes:
        return
    longest = max(n / rate for n, rate in sizes)

    def seen(ppm: float) -> bool:
        made = {}
        for n, rate in sizes:
            time_s = np.arange(n) / rate
            made[n, rate] = stamps(np.round(time_s / (1.0 + 1e-6 * ppm) * 1e6) / 1e6, rate)
        runs = [
            made[key] for one in inputs if (key := (one.facts.n_expected, one.facts.sample_rate_hz)) in made
        ]
        return clock_evidence(runs)[1] > threshold(1.0)

    # of an error that adds up to so many microseconds
    tried = [us / longest for us in _ADDED_US]
    enough = [seen(ppm) for ppm in tried]
    sure = [ppm for k, ppm in enumerate(tried) if all(enough[k:])]
    yield Row("clock_error", ("clock",), ("*",), "ppm", sure[0] if sure else None, bool(sure))
