"""Lines in the full-rate spectrum: on one gyro, or of a motion that all gyros feel.

Amplitude is the same in every run, phase another one. With z the amplitude found in a run (unit variance in
each
quadrature) and s the one expected, ``ln L = ln I0(s |z|) - s^2 / 2``.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from fogreduce.constants import SECONDS_PER_HOUR
from fogreduce.diagnosis.inference.evidence import log_mean_exp
from fogreduce.diagnosis.inference.findings import Finding
from fogreduce.diagnosis.observe.full_rate import LEAST_LINE_HZ, FullRate
from fogreduce.diagnosis.which.full_rate.line_evidence import best_of, leading, sizes_log
from fogreduce.diagnosis.which.full_rate.mixing import unknown_lines
from fogreduce.effects.gyro_names import gyro_name
from fogreduce.metadata.facts import RunFacts
from fogreduce.physics.noise import white_sigma

Array = NDArray[np.float64]

_LOCKED = 0.3  # prior share of lines that start anew with each run, and of lines that mix
_DRIFTS = 0.05  # of a spectrum's resolution: a real line is not quite steady


def line_findings(
    runs: Sequence[FullRate],
    facts: Sequence[RunFacts],
    white: Array,
    allowed: frozenset[str],
    taken: Sequence[Finding],
) -> list[Finding]:
    """Lines of each gyro and of a motion, in the longest runs of each sample rate.

    A line above half the sample rate shows elsewhere at another rate: runs of one rate have their own lines.

    Parameters
    ----------
    runs : statistics
    facts : RunFacts of each run
    white : (R, n) array
        White noise of a sample in each run [deg/sqrt(h)], rounding in it.
    allowed : names of effects
    taken : findings
        Lines that are causes already: they and their neighbours are passed over.
    """
    rates = np.array([one.sample_rate_hz for one in facts])
    longest = {
        rate: max(len(run.line_hz) for run, f in zip(runs, facts, strict=True) if f.sample_rate_hz == rate)
        for rate in rates.tolist()
    }
    out: list[Finding] = []
    for rate, lines in longest.items():
        here = [
            r for r, run in enumerate(runs) if rates[r] == rate and len(run.line_hz) == lines and lines > 0
        ]
        if not here:
            continue
        ids = (
            ("*",)
            if len(longest) == 1
            else tuple(run.run_id for run, other in zip(runs, rates.tolist(), strict=True) if other == rate)
        )
        hz = [float(f.parameters["frequency_hz"][0]) for f in taken if f.runs in (ids, ("*",))]
        for f in _lines_at_one_rate([runs[r] for r in here], facts[here[0]], white[here], allowed, hz):
            out.append(replace(f, runs=ids, share=f.share / len(longest), domain=_domain(ids)))
    return out


def _domain(runs: tuple[str, ...]) -> str:
    """The statistic that lines of some runs are found in."""
    return "lines" if runs == ("*",) else "lines of " + " ".join(runs)


def _lines_at_one_rate(
    usable: Sequence[FullRate],
    facts: RunFacts,
    noise: Array,
    allowed: frozenset[str],
    taken_hz: Sequence[float],
) -> list[Finding]:
    """Lines in runs of one rate and length; `noise`: white noise of each run (R, n) [deg/sqrt(h)]."""
    hz, n, longest = usable[0].line_hz, facts.n_gyros, len(usable[0].line_hz)
    each = np.asarray(white_sigma(noise, facts.sample_rate_hz) * SECONDS_PER_HOUR, np.float64)
    white = np.median(each, axis=0)
    usable = [
        run if np.all(one == white) else replace(run, lines=run.lines * (white / one)[:, None])
        for run, one in zip(usable, each, strict=True)
    ]
    awake = ~np.array([run.at_rest for run in usable])  # (R, n)
    # |z|^2 of each gyro, summed over runs: (n, L)
    power = np.zeros((n, longest))
    for run, here in zip(usable, awake, strict=True):
        power[here] += run.lines.real[here] ** 2 + run.lines.imag[here] ** 2
    power /= white[:, None] ** 2
    free = np.ones(longest, bool)
    step = hz[1] - hz[0] if longest > 1 else 1.0
    for line in taken_hz:
        free &= np.abs(hz - line) > 12.0 * step
    count = max(float(free.sum()) / 2.0, 1.0)  # lines that are independent
    samples = max(float(run.samples.max()) for run in usable)
    duration = samples / facts.sample_rate_hz
    out: list[Finding] = []
    for i in range(n):
        heard = [run for run, there in zip(usable, awake[:, i], strict=True) if there]
        if not heard:
            continue
        leaders = leading(power[i], free)
        leaders = leaders[power[i, leaders] > 0.0]
        if not leaders.size:
            continue
        moduli = np.abs(np.array([run.lines[i, leaders] for run in heard]).T) / white[i]
        best, log_sum, top = best_of(moduli)
        k = int(leaders[best])
        log_b = log_sum - np.log(count)
        amplitude = float(
            np.sqrt(max(np.mean(moduli[best] ** 2) - 2.0, 0.1)) * white[i] * np.sqrt(2.0 / samples)
        )
        std = float(white[i] * np.sqrt(2.0 / samples / len(heard)))
        peak = _peak_hz(hz, power[i], k)
        kept = _kept(peak, float(hz[k]), duration, facts.sample_rate_hz)
        parameters = {
            "deg_h": (amplitude / kept, std / kept),
            "frequency_hz": (peak, _hz_std(duration, top)),
        }
        effect = "periodic_interference" if "periodic_interference" in allowed else "unknown"
        out.append(
            Finding(
                effect,
                (gyro_name(i),),
                ("*",),
                log_b,
                2.0 * top,
                parameters,
                1.0 / n,
                "lines",
                "noise",
                "line",
                max(2 * len(heard), 2),
            )
        )
        strong = [run.lines[i] / white[i] for run in heard]
        for log_b, gain, k in unknown_lines(strong, power[i], hz, free, count):
            out.append(
                Finding(
                    "unknown",
                    (gyro_name(i),),
                    ("*",),
                    log_b,
                    2.0 * gain,
                    {"frequency_hz": (float(hz[k]), None)},
                    _LOCKED / n,
                    "lines",
                    "noise",
                    "line",
                    2,
                )
            )
    out += _motion(usable, hz, free, count, facts, white, allowed, samples)
    return out


def _kept(peak_hz: float, line_hz: float, duration_s: float, rate_hz: float) -> float:
    """Share of a line's amplitude that its nearest line of the spectrum shows.

    Some falls between lines; some went with the straight line that was taken off each short piece.
    """
    piece = max(int(rate_hz / LEAST_LINE_HZ), 2) / rate_hz
    x = np.pi * peak_hz * piece
    mean = np.sin(x) / x
    slope = (mean - np.cos(x)) / x
    kept = np.sinc((peak_hz - line_hz) * duration_s) * (1.0 - mean**2 - 3.0 * slope**2)
    return float(max(kept, 0.5))


def _hz_std(duration_s: float, gain: float) -> float:
    """Of a line's frequency: Cramer and Rao's bound ``sqrt(12) / (2 pi S T)``, and what a drifting line
    adds.
    """
    bound = np.sqrt(12.0) / (2.0 * np.pi * np.sqrt(max(2.0 * gain, 1.0)))
    return float(np.hypot(bound, _DRIFTS) / duration_s)


def _peak_hz(hz: Array, power: Array, k: int) -> float:
    """Where the power is highest, between the lines: a parabola through its logarithm."""
    if not 0 < k < len(hz) - 1:
        return float(hz[k])
    left, middle, right = np.log(np.maximum(power[k - 1 : k + 2], 1e-12))
    bend = left - 2.0 * middle + right
    shift = float(np.clip(0.5 * (left - right) / bend, -0.5, 0.5)) if bend < 0.0 else 0.0
    return float(hz[k] + shift * (hz[1] - hz[0]))


def _motion(
    runs: Sequence[FullRate],
    hz: Array,
    free: NDArray[np.bool_],
    count: float,
    facts: RunFacts,
    white: Array,
    allowed: frozenset[str],
    samples: float,
) -> list[Finding]:
    """A motion along one direction: amplitudes over the gyros are G u, with one phase a run."""
    duration = samples / facts.sample_rate_hz
    if facts.n_gyros < 2 or any(run.at_rest.any() for run in runs):
        return []
    seen = facts.axes * facts.frame_signs / white[:, None]
    basis, r_factor = np.linalg.qr(seen)
    project = (basis / white[:, None]).T  # (d, n)
    power = np.zeros(len(hz))
    for run in runs:
        for part in (run.lines.real, run.lines.imag):
            power += np.sum((project @ part) ** 2, axis=0)
    leaders = leading(power, free)
    y = np.array([project @ run.lines[:, leaders] for run in runs])  # (R, d, leaders)
    cov = np.einsum("rdl,rel->lde", y.real, y.real) + np.einsum("rdl,rel->lde", y.imag, y.imag)
    _, vectors = np.linalg.eigh(cov)
    direction = vectors[:, :, -1]  # (leaders, d)
    moduli = np.abs(np.einsum("rdl,ld->lr", y, direction))
    mean, top = sizes_log(moduli)
    gain2 = np.maximum(np.sum(moduli**2, axis=1) - 2.0 * len(runs), 1.0)
    # the direction was chosen: the share of all directions that would have done as well
    mean = mean + np.log(np.minimum(2.0 / gain2, 1.0) if basis.shape[1] == 3 else 1.0)
    k = int(np.argmax(mean))
    log_b = float(log_mean_exp(mean) + np.log(len(mean))) - np.log(2.0) - np.log(count)
    at = int(leaders[k])
    rate = np.linalg.solve(r_factor, direction[k]) if basis.shape[1] == 3 else direction[k]
    size = float(np.sqrt(max(np.mean(moduli[k] ** 2) - 2.0, 0.1)) * np.sqrt(2.0 / samples))
    length = float(np.linalg.norm(rate))
    axis = [round(float(v), 6) for v in (rate / length).tolist()] if len(rate) == 3 else [1.0, 0.0, 0.0]
    peak = _peak_hz(hz, power, at)
    length = length / _kept(peak, float(hz[at]), duration, facts.sample_rate_hz)
    std = float(length * np.sqrt(2.0 / samples / len(runs)))
    parameters = {
        "deg_h": (size * length, std),
        "frequency_hz": (peak, _hz_std(duration, float(top[k]))),
        "axis": (axis, None),
    }
    effect = "base_motion" if "base_motion" in allowed else "unknown"
    return [
        Finding(
            effect,
            ("table",),
            ("*",),
            log_b,
            2.0 * float(top[k]),
            parameters,
            1.0,
            "lines",
            "table",
            "line",
            2 * len(runs),
        )
    ]
