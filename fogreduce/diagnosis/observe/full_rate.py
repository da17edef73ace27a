"""Statistics of one run's full-rate stream: what block means cannot show.

Lines are taken out of it before (`which.full_rate.lines`). Spectra are taken over short pieces, each less its
straight line and tapered to nothing at its ends, so that neither what is slow nor the strong lines of a steep
spectrum leak into all others at once: each line scatters by itself.
Samples that are missing or spurious are replaced by others of the same second: that keeps the noise white.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fogreduce.constants import MISSING_COUNT
from fogreduce.diagnosis.observe.capture import SLOWEST_HZ, Samples
from fogreduce.diagnosis.which.full_rate.stamps import Stamps, stamps
from fogreduce.metadata.facts import RunFacts

Array = NDArray[np.float64]

PIECE = 256  # samples of a piece of the averaged spectrum
FIRST_LINE = 4  # lines of a piece's spectrum below this are left out: trends leak there
MOST_BITS = 16
NORMAL = 1.4826  # standard deviation over median absolute deviation of normal deviates
ASLEEP = 0.1  # of the usual noise: a converter at its rail
#: In a slow log the lower half of a piece's lines is left out: block means of two samples show that.
_SLOW_PIECE, _SLOW_PIECES = 32, 16
#: A piece of more than so many times the usual power is an edge or a glitch, not noise; where a piece has few
#: lines, of more than noise reaches by so many standard deviations.
_CALM, _CALM_SIGMA = 2.0, 3.5


@dataclass(frozen=True)
class FullRate:
    """One run's statistics.

    Attributes
    ----------
    run_id : str
    samples, missing, spurious : (n,) arrays
        Samples that count, answers that did not come, counts out of all proportion.
    lost, expected : int
        Records that never arrived, of how many.
    spurious_counts : list of (k,) arrays
        The spurious counts of each gyro.
    pairs, repeats, scatter : (n,) arrays
        Neighbouring samples, those of them that are equal, and the standard deviation of the differences of
        the others [counts].
    ends : (n, MOST_BITS + 1) array
        How many counts end in at least m zero bits.
    at_rest : (n,) array of bool
        Whether the gyro's noise has all but gone: a converter at its rail.
    pieces : float
        Of the averaged spectrum: as many as pieces side by side, untapered, say as much of white noise.
    frequency : (F,) array
        Its lines as fractions of the sample rate, above 0.
    power : (n, F) array
        Mean power [(deg/h)^2]: white noise of variance s^2 has s^2 in every line.
    cross : (F, n, n) array
        Mean products of the gyros' spectra in each line, real parts [(deg/h)^2].
    stamps : Stamps
        Time stamps against pulses.
    """

    run_id: str
    samples: Array
    missing: Array
    spurious: Array
    lost: int
    expected: int
    spurious_counts: list[NDArray[np.int64]]
    pairs: Array
    repeats: Array
    scatter: Array
    ends: Array
    at_rest: NDArray[np.bool_]
    pieces: float
    frequency: Array
    power: Array
    cross: Array
    stamps: Stamps


def full_rate(samples: Samples, facts: RunFacts, generator: np.random.Generator) -> FullRate:
    """Statistics of a run.

    Parameters
    ----------
    samples : Samples
    facts : RunFacts
    generator : numpy.random.Generator
        Chooses the samples that stand in for those missing.
    """
    good = np.isfinite(samples.residual)
    filled = _filled(samples.residual, good, generator)
    pieces, frequency, power, cross = averaged_spectrum(filled, facts.sample_rate_hz)
    pairs, repeats, scatter = _repeats(samples.counts, good)
    stated = np.ones(len(good)) if facts.white_noise is None else facts.white_noise
    nominal = stated * 60.0 * np.sqrt(facts.sample_rate_hz)
    level = _low_level(power) if power.size else nominal
    return FullRate(
        run_id=facts.run_id,
        samples=good.sum(axis=1).astype(float),
        missing=samples.missing.sum(axis=1).astype(float),
        spurious=samples.spurious.sum(axis=1).astype(float),
        lost=samples.lost,
        expected=len(samples.stamp_s),
        spurious_counts=[c[s] for c, s in zip(samples.counts, samples.spurious, strict=True)],
        pairs=pairs,
        repeats=repeats,
        scatter=scatter,
        ends=_ends(samples.counts, good),
        at_rest=(level < ASLEEP * nominal) if facts.white_noise is not None else level <= 0.0,
        pieces=pieces,
        frequency=frequency,
        power=power,
        cross=cross,
        stamps=stamps(samples.stamp_s, facts.sample_rate_hz),
    )


def _filled(residual: Array, good: NDArray[np.bool_], generator: np.random.Generator) -> Array:
    """Each missing sample replaced by a good one of the same second or so."""
    filled = residual.copy()
    for row, there in zip(filled, good, strict=True):
        gaps = np.flatnonzero(~there)
        if not gaps.size:
            continue
        present = row.size - gaps.size
        if present < 2:
            row[:] = 0.0
            continue
        # samples that are present are counted by themselves: so many of them come before each gap
        before = gaps - np.arange(gaps.size)
        near = np.clip(before + generator.integers(-64, 65, gaps.size), 0, present - 1)
        row[gaps] = row[near + np.searchsorted(before, near, side="right")]
    return filled


def straightened(values: Array) -> Array:
    """Values (..., N) less the straight line that fits them best along the last axis."""
    t = np.arange(values.shape[-1]) - (values.shape[-1] - 1) / 2.0
    cut = values - values[..., :1]  # what does not change is nothing, to the last bit
    cut -= cut.mean(axis=-1, keepdims=True)
    cut -= (cut @ t / (t @ t))[..., None] * t
    return cut


def taper(length: int) -> Array:
    """What a piece's samples (length,) are multiplied by: half a sine, of mean square 1.

    Of all tapers the one of least bias (Riedel and Sidorenko 1995, IEEE Trans. Signal Process. 43, 188, the
    first of their sine tapers). Its squares, of pieces that overlap by half, add up to a constant: all
    samples count alike but those at a run's two ends.
    """
    result: Array = np.sqrt(2.0) * np.sin(np.pi * (np.arange(length) + 0.5) / length)
    return result


def averaged_spectrum(filled: Array, rate_hz: float) -> tuple[float, Array, Array, Array]:
    """Averaged spectrum of samples (n, N) [deg/h] of a run, in pieces that overlap by half.

    Returns
    -------
    pieces, frequency, power, cross : as `FullRate` has them
        None, and empty, where a run is too short.
    """
    n, size = filled.shape
    slow = rate_hz < SLOWEST_HZ
    length = _SLOW_PIECE if slow else min(PIECE, size // 4)
    length -= length % 2
    if length < 16 or (slow and size < _SLOW_PIECES * length):
        return 0.0, np.zeros(0), np.zeros((n, 0)), np.zeros((0, n, n))
    window = taper(length)
    cut = straightened(np.lib.stride_tricks.sliding_window_view(filled, length, axis=1)[:, :: length // 2])
    first = length // 4 if slow else min(FIRST_LINE, length // 8)
    lines = np.fft.rfft(cut * window, axis=2)[:, :, first:-1]
    parts = np.stack([lines.real, lines.imag], axis=1) / np.sqrt(length)  # (n, 2, pieces, F)
    # a piece with an edge of the profile that came late, or with a glitch, is no noise
    strength = np.sum(parts**2, axis=1)
    usual = np.median(
        strength, axis=1, keepdims=True
    )  # of each line: where few are strong, chance rules them
    strength = np.mean(strength / np.maximum(usual, 1e-300), axis=2)
    calm = np.all(strength <= _most(lines.shape[2]) * np.median(strength, axis=1, keepdims=True), axis=0)
    if calm.sum() < 4:
        calm[:] = True
    parts, pieces = parts[:, :, calm], int(calm.sum())
    cross = np.empty((parts.shape[3], n, n))
    for i in range(n):
        for j in range(i + 1):
            cross[:, i, j] = cross[:, j, i] = np.sum(parts[i] * parts[j], axis=(0, 1)) / pieces
    power: Array = np.diagonal(cross, axis1=1, axis2=2).T.copy()
    frequency = np.asarray(np.fft.rfftfreq(length)[first:-1], np.float64)
    return _side_by_side(calm, window), frequency, power, cross


def _most(lines: int) -> float:
    """Power of a piece over the usual, up to which it may be noise.

    That of so many lines has chi-squared's scatter, of 4/3 degrees a line: the taper makes neighbours alike.
    Wilson and Hilferty (1931, PNAS 17, 684): the cube root of chi-squared over its degrees n is normal about
    1 - 2 / 9 n, with that variance 2 / 9 n.
    """
    variance = 2.0 / (9.0 * lines * 4.0 / 3.0)
    return max(_CALM, float(1.0 + _CALM_SIGMA * np.sqrt(variance) / (1.0 - variance)) ** 3)


def _side_by_side(calm: NDArray[np.bool_], window: Array) -> float:
    """How many pieces side by side, untapered, tell white noise's level as well as these that overlap.

    Parameters
    ----------
    calm : (pieces,) array of bool
        Which of them are averaged.
    window : (length,) array
        Their taper. A sample counts as often as the squares over it add up to.
    """
    half = len(window) // 2
    weight = np.zeros((len(calm) + 1, half))
    weight[:-1] += calm[:, None] * window[:half] ** 2
    weight[1:] += calm[:, None] * window[half:] ** 2
    return float(weight.sum() ** 2 / np.sum(weight**2)) / len(window)


def _low_level(power: Array) -> Array:
    """Noise of a sample (n,) [deg/h] by its lowest lines, which a filter leaves as they are."""
    return np.sqrt(np.median(power[:, : max(power.shape[1] // 8, 1)], axis=1))


def _repeats(counts: NDArray[np.int64], good: NDArray[np.bool_]) -> tuple[Array, Array, Array]:
    both = good[:, 1:] & good[:, :-1]
    steps = np.abs(np.diff(counts, axis=1))
    same = both & (steps == 0)
    scatter = np.zeros(len(counts))
    for i, row in enumerate(steps):
        other = row[both[i] & ~same[i]]
        if other.size:
            # a step of m counts stands for any between m - 1/2 and m + 1/2: the median of grouped numbers
            middle = float(np.floor(np.median(other)))
            below, there = np.count_nonzero(other < middle), np.count_nonzero(other == middle)
            scatter[i] = NORMAL * (middle - 0.5 + (0.5 * other.size - below) / max(there, 1))
    return both.sum(axis=1).astype(float), same.sum(axis=1).astype(float), scatter


def _ends(counts: NDArray[np.int64], good: NDArray[np.bool_]) -> Array:
    ends = np.empty((len(counts), MOST_BITS + 1))
    for row, here, there in zip(ends, counts, good, strict=True):
        left = here[there & (here != MISSING_COUNT)]
        if left.size and np.all(left == left[0]):
            left = left[:0]  # one count all through says nothing of bits
        row[0] = left.size
        for m in range(1, MOST_BITS + 1):
            # those that end in m zeros are among those that end in fewer
            left = left[(left & ((1 << m) - 1)) == 0]
            row[m] = left.size
    return ends
