"""Random processes of a gyro, by the IEEE 952 terms as the contract defines them, [deg/s]."""

from functools import lru_cache

import numpy as np
from scipy import fft

from withheld.arrays import Array
from withheld.chain.campaign import Run, Unit
from withheld.chain.truth import Truth
from withheld.effects.entry import Entry, select
from withheld.streams import stream

LOWEST_HZ = 1e-5


@lru_cache(maxsize=4)
def _slow_basis(samples: int, rate_hz: float, edges: tuple[float, ...]) -> Array:
    """Cosines and sines below the transform's first line, (samples, 2 k), one pair a band of frequencies."""
    centre = np.sqrt(np.array(edges[:-1]) * np.array(edges[1:]))
    turn = 2 * np.pi * np.outer(np.arange(samples) / rate_hz, centre)
    return np.concatenate([np.cos(turn), np.sin(turn)], axis=1)


def flicker(samples: int, rate_hz: float, rng: np.random.Generator) -> Array:
    """Flicker noise of one-sided density 1 / (pi f) from 1e-5 Hz to half the sample rate, (samples,).

    Above the first line of a transform four times as long as the run: random lines, one a bin.  Below it:
    random cosines in narrow bands, each with its band's power.  Multiply by the bias instability B.
    """
    length = fft.next_fast_len(4 * samples, real=True)
    step = rate_hz / length
    lines = length // 2
    spectrum = np.zeros(lines + 1, dtype=complex)
    parts = rng.standard_normal((2, lines))
    frequency = step * np.arange(1, lines + 1)
    # A line of power P has an amplitude of variance P in each of its two quadratures.
    spectrum[1:] = (parts[0] + 1j * parts[1]) * (np.sqrt(step / (np.pi * frequency)) * length / 2.0)
    noise = fft.irfft(spectrum, length)[:samples]
    if step / 2.0 > LOWEST_HZ:
        bands = int(np.ceil(4 * np.log2(step / 2.0 / LOWEST_HZ)))
        edges = tuple(np.geomspace(LOWEST_HZ, step / 2.0, bands + 1).tolist())
        power = np.log(edges[1] / edges[0]) / np.pi
        noise = noise + _slow_basis(samples, rate_hz, edges) @ (
            rng.standard_normal(2 * bands) * np.sqrt(power)
        )
    result: Array = noise
    return result


def random_walk(samples: int, rate_hz: float, rng: np.random.Generator) -> Array:
    """Rate random walk of K = 1 deg/h/sqrt(h), from 0 at the start, (samples,) [deg/h]."""
    steps = rng.standard_normal(samples) / (60.0 * np.sqrt(rate_hz))
    steps[0] = 0.0
    return np.cumsum(steps)


def band_limited(samples: int, rate_hz: float, low: float, high: float, rng: np.random.Generator) -> Array:
    """Gaussian noise of unit variance between two frequencies [Hz], (samples,)."""
    spectrum = fft.rfft(rng.standard_normal(samples))
    frequency = fft.rfftfreq(samples, 1.0 / rate_hz)
    kept = (frequency >= low) & (frequency <= high)
    spectrum[~kept] = 0.0
    result: Array = fft.irfft(spectrum, samples) * np.sqrt(frequency.size / max(int(kept.sum()), 1))
    return result


def _white(
    run: Run, unit: Unit, truth: Truth, entries: tuple[Entry, ...], seed: int, words: tuple[str, ...]
) -> Array:
    """White noise, (k, n) [deg/s]; `angle_random_walk` replaces the level, `common_noise` correlates."""
    unitless = np.column_stack(
        [stream(seed, *words, f"gyro{i + 1}", "white").standard_normal(run.samples) for i in range(unit.n)]
    )
    for entry in select(entries, run.run_id, "common_noise"):
        shared = stream(seed, *words, "common").standard_normal(run.samples)
        rho = entry.number("correlation")
        for i in entry.gyros():
            unitless[:, i] = np.sqrt(1.0 - rho) * unitless[:, i] + np.sqrt(rho) * shared
    level = np.array(unit.arw_deg_sqrt_h) * truth.noise_level
    for entry in select(entries, run.run_id, "angle_random_walk"):
        for i in entry.gyros():
            level[i] = entry.number("deg_sqrt_h")
    result: Array = unitless * (level / 60.0 * np.sqrt(run.sample_rate_hz))
    return result


def noise(run: Run, unit: Unit, truth: Truth, entries: tuple[Entry, ...], seed: int, campaign: str) -> Array:
    """All noise of one run, (k, n) [deg/s]; every gyro, run and process has its own stream."""
    words = (campaign, "noise", run.run_id)
    k, rate = run.samples, run.sample_rate_hz
    total = _white(run, unit, truth, entries, seed, words)
    for i in range(unit.n):
        gyro = f"gyro{i + 1}"
        if unit.instability_deg_h[i] > 0.0:
            total[:, i] += (
                unit.instability_deg_h[i] / 3600.0 * flicker(k, rate, stream(seed, *words, gyro, "flicker"))
            )
        if unit.rrw_deg_h_sqrt_h[i] > 0.0:
            total[:, i] += (
                unit.rrw_deg_h_sqrt_h[i] / 3600.0 * random_walk(k, rate, stream(seed, *words, gyro, "walk"))
            )
    for number, entry in enumerate(entries):
        if not entry.acts_in(run.run_id):
            continue
        for i in entry.gyros():
            rng = stream(seed, *words, f"gyro{i + 1}", "further", entry.effect, str(number))
            if entry.effect == "bias_instability":
                total[:, i] += entry.number("deg_h") / 3600.0 * flicker(k, rate, rng)
            elif entry.effect == "rate_random_walk":
                total[:, i] += entry.number("deg_h_sqrt_h") / 3600.0 * random_walk(k, rate, rng)
            elif entry.effect == "band_limited_noise":
                low, high = entry.number("low_hz"), entry.number("high_hz")
                total[:, i] += entry.number("deg_h") / 3600.0 * band_limited(k, rate, low, high, rng)
    return total
