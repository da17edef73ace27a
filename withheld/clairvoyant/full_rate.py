"""Signal-to-noise ratios of effects that only the full-rate stream shows.

Where an effect shifts means, SNR^2 = 2 E[ln likelihood ratio of truth against nominal], the expectation under
the truth.  The same definition is used for everything here: SNR^2 = 2 x Kullback-Leibler divergence of the
record's distribution with the effect from that without it.  For each effect its docstring says which
statistic carries it.  Three things that the contract leaves open are set by the study's protocol and passed
in: how well a record's white noise level is known, and how often a healthy link loses or spoils a sample.
"""

from collections import Counter
from dataclasses import dataclass, replace

import numpy as np

from withheld.arrays import Array
from withheld.chain.campaign import Run, Unit
from withheld.chain.electronics import volts
from withheld.chain.injector import World
from withheld.chain.link import stamps_us
from withheld.chain.readings import readings
from withheld.clairvoyant.blocks import block_count, noise_terms
from withheld.clairvoyant.covariance import block_covariance, flicker_lags, walk
from withheld.effects.entry import Entry

STAMP_ERROR_US = 1.0 / np.sqrt(12.0)


@dataclass(frozen=True)
class Healthy:
    """What a healthy unit is allowed: relative 1-sigma doubt of a white noise level, and the chance that a
    sample is lost or spoiled.
    """

    noise_level_rel: float = 0.02
    link_fault: float = 1e-6


def _runs(world: World, entry: Entry) -> list[Run]:
    return [run for run in world.campaign.runs if entry.acts_in(run.run_id)]


def bernoulli_divergence(p: float, q: float) -> float:
    """Kullback-Leibler divergence of one trial of chance p from one of chance q."""
    rest = (1.0 - p) * np.log((1.0 - p) / (1.0 - q)) if p < 1.0 else 0.0
    return float((p * np.log(p / q) if p > 0.0 else 0.0) + rest)


def white_level(world: World, entry: Entry, healthy: Healthy) -> float:
    """angle_random_walk: the logarithm of the sample variance's root, known to 1/sqrt(2 samples) and to the
    doubt of the record's own level, both together.
    """
    samples, total = sum(run.samples for run in _runs(world, entry)), 0.0
    for i in entry.gyros():
        nominal = world.campaign.unit.arw_deg_sqrt_h[i]
        change = np.log(entry.number("deg_sqrt_h") / nominal)
        total += change**2 / (1.0 / (2.0 * samples) + healthy.noise_level_rel**2)
    return float(np.sqrt(total))


def correlation(world: World, entry: Entry, healthy: Healthy) -> float:
    """common_noise: 2 KL = -ln det R a sample, R the correlation matrix of the gyros that share it."""
    size, rho = len(entry.gyros()), entry.number("correlation")
    matrix = np.full((size, size), rho) + (1.0 - rho) * np.eye(size)
    samples = sum(run.samples for run in _runs(world, entry))
    return float(np.sqrt(-samples * np.linalg.slogdet(matrix)[1]))


def slow_process(world: World, entry: Entry, healthy: Healthy) -> float:
    """bias_instability, rate_random_walk: 2 KL = tr(S0^-1 S1) - n - ln det(S0^-1 S1) of block means, S0 with
    the turn-on bias in it; other nuisances, common to the runs, are left out: they are constants in each run.
    """
    total = 0.0
    for (blocks, length), number in Counter(block_count(run) for run in _runs(world, entry)).items():
        for i in entry.gyros():
            before = block_covariance(blocks, length, *noise_terms(world.campaign, i))
            total += number * _divergence(before + _process(entry, blocks, length), before)
    return float(np.sqrt(total))


def _divergence(truth: Array, model: Array) -> float:
    """Twice the divergence of one centred Gaussian, of covariance `truth`, from another."""
    ratio = np.linalg.solve(model, truth)
    return float(np.trace(ratio) - len(truth) - np.linalg.slogdet(ratio)[1])


def _process(entry: Entry, blocks: int, length: float) -> Array:
    """Covariance of block means that the further process adds, (deg/h)^2."""
    if entry.effect == "rate_random_walk":
        return entry.number("deg_h_sqrt_h") ** 2 * walk(blocks, length)
    index = np.arange(blocks)
    lags = flicker_lags(blocks, length)[np.abs(index[:, None] - index)]
    return np.asarray(entry.number("deg_h") ** 2 * lags)


def coloured(world: World, entry: Entry, healthy: Healthy) -> float:
    """low_pass (as it filters the noise) and band_limited_noise: 2 KL = sum over the spectrum's lines of
    r - 1 - ln r, r the ratio of densities; the level's doubt takes away the part that a mere level explains.
    """
    return _coloured(world, entry, healthy.noise_level_rel)


def level_free(world: World, entry: Entry) -> float:
    """`coloured` with the white level quite free: the separation from angle_random_walk."""
    return _coloured(world, entry, 1e9)


def _coloured(world: World, entry: Entry, noise_level_rel: float) -> float:
    total = 0.0
    for i in entry.gyros():
        samples, ratios = 0, []
        for run in _runs(world, entry):
            frequency = np.linspace(0.0, run.sample_rate_hz / 2.0, 4097)[1:-1]
            ratios.append((run.samples, _ratio(world, entry, run, i, frequency)))
            samples += run.samples
        whole = sum(k * float(np.mean(r - 1.0 - np.log(r))) for k, r in ratios)
        level = sum(k * float(np.mean(r - 1.0)) for k, r in ratios) / samples
        level_only = samples * (level - np.log1p(level))
        doubt = 1.0 / (1.0 + 2.0 * samples * noise_level_rel**2)
        total += whole - level_only * (1.0 - doubt)
    return float(np.sqrt(max(total, 0.0)))


def _ratio(world: World, entry: Entry, run: Run, i: int, frequency: Array) -> Array:
    """Spectral density of gyro i's white noise with the effect over that without it."""
    if entry.effect == "low_pass":
        step = 1.0 / run.sample_rate_hz
        ratio = np.ones_like(frequency)
        tau = entry.number("time_constant_ms") * 1e-3
        for pole in (tau, tau * entry.departure.get("second_pole", 0.0)):
            if pole > 0.0:
                q = np.exp(-step / pole)
                g = (1.0 - q) * pole / step
                z = np.exp(-2j * np.pi * frequency * step)
                ratio = ratio * np.abs((1.0 - g + (g - q) * z) / (1.0 - q * z)) ** 2
        return ratio
    low, high = entry.number("low_hz"), entry.number("high_hz")
    white = world.campaign.unit.white_deg_s(run.sample_rate_hz)[i] * 3600.0
    inside = (frequency >= low) & (frequency <= high)
    excess = (entry.number("deg_h") / white) ** 2 / max(float(inside.mean()), 1e-9)
    result: Array = 1.0 + excess * inside
    return result


def bits(world: World, entry: Entry, healthy: Healthy) -> float:
    """lost_bits: all counts multiples of 2^m, else a chance of 2^-m a sample: 2 KL = 2 n m ln 2."""
    samples = sum(run.samples for run in _runs(world, entry)) * len(entry.gyros())
    return float(np.sqrt(2.0 * samples * entry.parameters["bits"] * np.log(2.0)))


def converter(world: World, entry: Entry, healthy: Healthy) -> float:
    """adc_nonlinearity, v + g(v): to first order the density of v changes by s = -g' + g (v - mu) / sigma^2
    relative, and 2 KL = the sum over samples of E[s^2], the expectation over the noise by 41 Gauss-Hermite
    nodes.

    A departure's second harmonic is in g.  The reading mu is taken at every 64th sample.  The part of the
    mean shift that a bias could imitate is not taken away.
    """
    nodes, weights = np.polynomial.hermite_e.hermegauss(41)
    weights = weights / weights.sum()
    total = 0.0
    lacking = replace(world, entries=tuple(e for e in world.entries if e is not entry))
    for run in _runs(world, entry):
        unit = world.campaign.unit
        t = np.arange(0, run.samples, 64) / run.sample_rate_hz
        m = readings(run, unit, world.truth, lacking.entries, world.heat[run.run_id], t)
        v = volts(run, unit, world.truth, m)
        for i in entry.gyros():
            sigma = unit.white_deg_s(run.sample_rate_hz)[i] * unit.scale_factor[i]
            x = v[:, i, None] + sigma * nodes
            turn, size = 2 * np.pi / entry.number("period_volts"), entry.number("volts")
            second = entry.departure.get("second_harmonic", 0.0)
            g = size * (np.sin(turn * x) + second * np.sin(2 * turn * x))
            slope = size * turn * (np.cos(turn * x) + 2 * second * np.cos(2 * turn * x))
            score = -slope + g * nodes / sigma
            total += run.samples * float(((score**2) @ weights).mean())
    return float(np.sqrt(total))


def stamps(world: World, entry: Entry, healthy: Healthy) -> float:
    """clock_error: stamps against the pulses' true times, each known to the rounding of a microsecond."""
    total = 0.0
    for run in _runs(world, entry):
        stated = np.arange(run.samples) / run.sample_rate_hz * 1e6
        total += float(np.sum(((stamps_us(run, (entry,)) - stated) / STAMP_ERROR_US) ** 2))
    return float(np.sqrt(total))


def faults(world: World, entry: Entry, healthy: Healthy) -> float:
    """dropouts, spikes: the number of samples struck, against the chance that a healthy link gives."""
    samples = sum(run.samples for run in _runs(world, entry)) * len(entry.gyros())
    struck = min(entry.number("fraction") + healthy.link_fault, 1.0)
    return float(np.sqrt(2.0 * samples * bernoulli_divergence(struck, healthy.link_fault)))


def equal_by_chance(unit: Unit, run: Run, i: int) -> float:
    """Chance that neighbours of gyro i are equal in white noise of sigma counts: 1 / (2 sigma sqrt(pi))."""
    sigma = unit.white_deg_s(run.sample_rate_hz)[i] * unit.scale_factor[i] / run.volts_per_count
    return float(min(1.0 / (2.0 * sigma * np.sqrt(np.pi)), 0.5))


def repeats(world: World, entry: Entry, healthy: Healthy) -> float:
    """stuck_samples: the number of equal neighbours, against their chance in white noise."""
    total = 0.0
    for run in _runs(world, entry):
        for i in entry.gyros():
            chance = equal_by_chance(world.campaign.unit, run, i)
            fraction = entry.number("fraction")
            total += 2.0 * run.samples * bernoulli_divergence(fraction + (1 - fraction) * chance, chance)
    return float(np.sqrt(total))


STATISTICS = {
    "angle_random_walk": white_level,
    "common_noise": correlation,
    "bias_instability": slow_process,
    "rate_random_walk": slow_process,
    "low_pass": coloured,
    "band_limited_noise": coloured,
    "lost_bits": bits,
    "adc_nonlinearity": converter,
    "clock_error": stamps,
    "dropouts": faults,
    "spikes": faults,
    "stuck_samples": repeats,
}


def process_separation(world: World, entry: Entry, rival: str) -> float:
    """How far the best amplitude of one further random process falls short of another: bias_instability and
    rate_random_walk against each other, sqrt of twice the least divergence over a grid of amplitudes.
    """
    parameter = {"bias_instability": "deg_h", "rate_random_walk": "deg_h_sqrt_h"}[rival]
    best = np.inf
    sizes = Counter(block_count(run) for run in _runs(world, entry))
    for amplitude in np.geomspace(1e-2, 1e2, 33):
        other, total = Entry(rival, entry.channels, entry.runs, {parameter: float(amplitude)}), 0.0
        for (blocks, length), number in sizes.items():
            for i in entry.gyros():
                base = block_covariance(blocks, length, *noise_terms(world.campaign, i))
                truth, model = base + _process(entry, blocks, length), base + _process(other, blocks, length)
                total += number * _divergence(truth, model)
        best = min(best, total)
    return float(np.sqrt(max(best, 0.0)))
