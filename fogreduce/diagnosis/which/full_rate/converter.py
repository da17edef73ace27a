"""A converter whose error repeats with the voltage: what it does to the codes within the noise.

An error ``g = A sin(kappa v)`` changes the density of a noisy voltage v = mu + e by the score
``-g' + g e / sigma^2``.
Summed over samples, with a free phase in each run,

    S(kappa) = sum (e / sigma^2 - i kappa) exp(i kappa v),

has the variance ``N (kappa^2 + 1 / sigma^2)`` in its two parts together when nothing is wrong.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from fogreduce.diagnosis.inference.evidence import log_mean_exp
from fogreduce.diagnosis.inference.findings import Finding
from fogreduce.diagnosis.which.full_rate.line_evidence import sizes_log
from fogreduce.effects.gyro_names import gyro_name

Array = NDArray[np.float64]

_BINS = 8.0  # a standard deviation of the noise
_MOST_BINS = 20_000
WAVES = np.arange(0.45, 3.6, 0.05)  # kappa sigma
_FINE = 6000
_STRETCH = 200  # neighbouring kappa whose waves are made from one
_NOT_NOISE = 1.1
_WANDERS = 4.0  # standard deviations of a mean square
#: In a run longer than this [s] a gyro drifts in more ways than `slow` has; within so many seconds, hardly.
_LONG, _DRIFTS = 600, 20.0
_LAGS, _CLEAR = 100, 4.0
_APART = 4.0  # waves farther apart than this, times sigma, are none of each other's in noise


@dataclass(frozen=True)
class Codes:
    """Voltages of one gyro in one run, in cells of an eighth of their noise.

    Attributes
    ----------
    volts, number, noise : (B,) arrays
        A cell's middle [V], its samples, the sum of their departures e [V]: where the gyro drifts, from the
        line of their second.
    sigma : float
        Standard deviation of e [V].
    whole : (B,) array
        Sum of the departures with what is slow of them [V]: an error found is told more of by that.
    correlation : (K,) array
        Of the noise with itself, one sample later and so on, as far as it shows.
    """

    volts: Array
    number: Array
    noise: Array
    sigma: float
    whole: Array
    correlation: Array

    def score(self, kappa: Array) -> NDArray[np.complex128]:
        """S at each kappa [1/V], in standard deviations of one of its two parts."""
        wave = np.exp(1j * np.outer(kappa, self.volts))
        total = wave @ (self.noise / self.sigma**2) - 1j * kappa * (wave @ self.number)
        return np.asarray(total * np.sqrt(2.0 / self.variance(kappa)))

    def scores(self, first: float, step: float, count: int) -> NDArray[np.complex128]:
        """`score` at evenly spaced kappa; a wave is that of its stretch's start turned on by some steps."""
        stretches = -(-count // _STRETCH)
        turned = np.exp(1j * np.outer(np.arange(_STRETCH) * step, self.volts))
        starts = np.exp(1j * np.outer(first + np.arange(stretches) * (_STRETCH * step), self.volts))
        noise = (turned @ (starts * (self.noise / self.sigma**2)).T).T.ravel()[:count]
        number = (turned @ (starts * self.number).T).T.ravel()[:count]
        kappa: Array = first + np.arange(count, dtype=np.float64) * step
        return np.asarray((noise - 1j * kappa * number) * np.sqrt(2.0 / self.variance(kappa)))

    def information(self, kappa: Array) -> Array:
        """What S comes to for an error of A = 2; the variance of S, both parts, for white noise."""
        return float(self.number.sum()) * (kappa**2 + 1.0 / self.sigma**2)

    def variance(self, kappa: Array) -> Array:
        """Variance of S, both parts, for noise of this correlation.

        Of two samples with the correlation r, whose terms of S have, by integration by parts, the covariance
        ``r (1 / sigma^2 + kappa^2 r) exp(-(kappa sigma)^2 (1 - r))``.
        """
        turn2 = (np.atleast_1d(kappa) * self.sigma)[:, None] ** 2
        r = self.correlation
        more = np.sum(r * (1.0 + turn2 * r) * np.exp(-turn2 * (1.0 - r)), axis=1) / (1.0 + turn2[:, 0])
        return self.information(kappa) * np.maximum(1.0 + 2.0 * more, 0.1)


def codes(volts: Array, departure: Array, second: int, slow: Array) -> Codes | None:
    """Cells of the voltages that count; None where there are too few or they spread too far.

    Parameters
    ----------
    volts : (N,) array
        As they arrived [V].
    departure : (N,) array
        From what was predicted [V]; NaN where a sample does not count. Where it is not white noise alone,
        each second's straight line is taken off.
    second : int
        Samples of a second or so.
    slow : (seconds, k) array
        What each second's mean may follow without being the converter's doing.
    """
    whole = len(volts) // second * second
    if whole < 8 * second:
        return None
    v, e = volts[:whole].reshape(-1, second), departure[:whole].reshape(-1, second)
    there = np.isfinite(e)
    e = np.where(there, e, 0.0)
    means = e.sum(axis=1) / np.maximum(there.sum(axis=1), 1)
    seen = there.sum(axis=1) > second // 2
    if seen.sum() > 2 * slow.shape[1]:
        size = np.linalg.lstsq(slow[: len(e)][seen], means[seen], rcond=1e-8)[0]
        follows = slow[: len(e)] @ size
        if len(e) > _LONG:
            near = np.exp(-0.5 * (np.arange(-3.0 * _DRIFTS, 3.0 * _DRIFTS + 1.0) / _DRIFTS) ** 2)
            drift, weight = (np.convolve(x, near, "same") for x in ((means - follows) * seen, seen))
            follows = follows + drift / np.maximum(weight, 1.0)
        e = np.where(there, e - follows[:, None], 0.0)
    t = np.arange(second) - (second - 1) / 2.0
    fast = e - e.mean(axis=1, keepdims=True)
    fast = fast - (fast @ t / (t @ t))[:, None] * t
    power = np.mean(fast**2, axis=1)
    usable = there & (power < 4.0 * np.median(power))[:, None]
    if usable.sum() < 1000:
        return None
    sigma = float(np.std(fast[usable]))
    if sigma <= 0.0:
        return None
    if float(np.std(e[usable])) > _NOT_NOISE * sigma:
        e = fast
    swept = fast if _wanders(e, usable, sigma) else e
    x, e, swept = v[usable], e[usable], swept[usable]
    cell = np.floor((x - x.min()) / sigma * _BINS).astype(np.int64)
    if cell.max() > 50 * _MOST_BINS:
        return None
    count = np.bincount(cell).astype(np.float64)
    some = np.flatnonzero(count)
    if some.size > _MOST_BINS or _in_steps(count):
        return None
    middle = np.bincount(cell, x)[some] / count[some]
    noise, slowly = (np.bincount(cell, one)[some].astype(np.float64) for one in (swept, e))
    return Codes(
        middle, count[some].astype(np.float64), noise, float(np.std(swept)), slowly, _correlation(fast)
    )


def _in_steps(count: Array) -> bool:
    """Whether most samples lie in cells without neighbours: steps far wider than the converter's make these,
    as a ring laser's pulses do, and what they do within the noise is no error of its codes.
    """
    beside = np.pad(count, 1)
    lonely = (beside[:-2] == 0.0) & (beside[2:] == 0.0)
    return bool(count[lonely].sum() > 0.5 * count.sum())


def _correlation(fast: Array) -> Array:
    """Of noise (seconds, samples) with itself some samples later, as far as it stands clear of chance."""
    flat = fast.ravel()
    power = float(flat @ flat)
    out: list[float] = []
    for lag in range(1, _LAGS):
        r = float(flat[lag:] @ flat[:-lag]) / power
        if abs(r) < _CLEAR / np.sqrt(flat.size):
            break
        out.append(r)
    return np.array(out)


def _wanders(e: Array, usable: NDArray[np.bool_], sigma: float) -> bool:
    """Whether the seconds' means depart from zero by more than white noise of sigma makes them."""
    count = usable.sum(axis=1)
    means = np.where(usable, e, 0.0).sum(axis=1)[count > 0] / np.sqrt(count[count > 0])
    spread = float(np.mean(means**2)) / sigma**2
    return spread > 1.0 + _WANDERS * np.sqrt(2.0 / len(means))


def converter_findings(
    runs: Sequence[Sequence[Codes | None]], n: int, allowed: frozenset[str], step: Array
) -> Iterator[Finding]:
    """Findings at each gyro; `runs`: codes of each gyro in each run, `step` (n,): its converter's widest."""
    for i in range(n):
        here = [c for c in (run[i] for run in runs) if c is not None]
        if not here:
            continue
        sigma = float(np.median([c.sigma for c in here]))
        alike = [c for c in here if 0.7 * sigma < c.sigma < 1.4 * sigma]
        if not alike:
            # between two kinds of runs lies none: the quieter one, in which steps show best
            sigma = max(c.sigma for c in here if c.sigma <= sigma)
            alike = [c for c in here if 0.7 * sigma < c.sigma < 1.4 * sigma]
        here = alike
        # a voltage in steps shows its own waves again about those that belong to the steps
        kappa = WAVES[2.0 * np.pi * sigma / step[i] - WAVES > _APART] / sigma
        if kappa.size < 2:
            continue
        z = np.array([c.score(kappa) for c in here])
        mean, top = sizes_log(np.abs(z).T)
        best = int(np.argmax(mean))
        log_b, gain = float(log_mean_exp(mean)), float(top[best])
        effect = "adc_nonlinearity" if "adc_nonlinearity" in allowed else "unknown"
        parameters = {}
        if effect != "unknown" and log_b > 0.0:
            parameters = _refined(here, float(kappa[best]), float(kappa[1] - kappa[0]))
        elif effect != "unknown":
            parameters = {"volts": (0.0, sigma), "period_volts": (2.0 * np.pi / float(kappa[best]), sigma)}
        yield Finding(
            effect,
            (gyro_name(i),),
            ("*",),
            log_b,
            2.0 * gain,
            parameters,
            1.0 / n,
            "converter",
            "electronics",
            "codes",
            2 * len(here),
        )


def _refined(here: Sequence[Codes], kappa: float, step: float) -> dict[str, tuple[float, float]]:
    """Amplitude and period with the phase that the contract gives the error, the same in all runs."""
    here = [replace(c, noise=c.whole) for c in here]
    widest = max(float(np.ptp(c.volts)) for c in here)
    fine = kappa + np.linspace(-step, step, _FINE)
    size = np.zeros(_FINE)
    information, variance = np.zeros(_FINE), np.zeros(_FINE)
    for c in here:
        scores = c.scores(float(fine[0]), float(fine[1] - fine[0]), _FINE)
        size += scores.imag * np.sqrt(c.variance(fine) / 2.0)
        information += c.information(fine) / 2.0
        variance += c.variance(fine) / 2.0
    gain = size**2 / variance
    k = int(np.argmax(gain))
    volts, error = float(size[k] / information[k]), float(np.sqrt(variance[k]) / information[k])
    snr = max(abs(volts) / error, 1.0)
    # neighbouring waves may fit nearly as well: within two standard deviations all of them count
    near = float(np.max(np.abs(fine[gain > gain[k] - 4.0] - fine[k])))
    resolved = max(1.0 / (widest * snr), 0.5 * near, float(fine[1] - fine[0]))
    period = 2.0 * np.pi / float(fine[k])
    # what is slow of the error went with the slow part of the residual: its size is known to a half or so
    error = float(np.hypot(error, 0.5 * volts))
    return {"volts": (volts, error), "period_volts": (period, period * resolved / float(fine[k]))}
