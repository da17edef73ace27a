"""Lines in the full-rate stream: on one gyro, or of a motion that all gyros feel.

The strongest is found in the spectra, its frequency told from all runs together, and it is taken out of the
samples; then the next. So each is found once, whatever its leakage, and everything else is read from what is
left. Amplitude is the same in every run; the phase is another one in each, or one for all.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from fogreduce.diagnosis import priors
from fogreduce.diagnosis.which.full_rate.line import Line, frequency_std, measured
from fogreduce.diagnosis.which.full_rate.line_candidates import Candidate, best_lines, gyro_logs, motion_logs
from fogreduce.diagnosis.which.full_rate.line_spectra import SKIRT, Spectra
from fogreduce.diagnosis.which.full_rate.mixing import mixed
from fogreduce.diagnosis.which.full_rate.same_line import once_each
from fogreduce.effects.gyro_names import gyro_name
from fogreduce.metadata.facts import RunFacts

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

_BEYOND = 5.0  # ln evidence of what two lines make together, before they are called a mixture
_MOST = 60  # lines of one sample rate: a bound on a loop that ends by itself


def without_lines(
    residuals: Sequence[Array], facts: Sequence[RunFacts]
) -> tuple[list[Array], tuple[Line, ...]]:
    """Residuals less the lines in them, and the lines: looked for in runs of one sample rate at a time.

    A line above half the sample rate shows elsewhere at another rate; one below it is the same in all.

    Parameters
    ----------
    residuals : (n, N) arrays
        Of each run [deg/h]; NaN where a sample does not count.
    facts : RunFacts of each run
    """
    rates = [one.sample_rate_hz for one in facts]
    out, lines = list(residuals), []
    for rate in sorted(set(rates)):
        here = [r for r, other in enumerate(rates) if other == rate]
        spectra = Spectra.of([residuals[r] for r in here], [facts[r] for r in here])
        if spectra is None:
            continue
        runs = tuple(facts[r].run_id for r in here)
        found = _found(spectra)
        lines += [replace(line, runs=runs, share=line.share / len(set(rates))) for line in found]
        for r, streams in zip(here, spectra.streams, strict=True):
            if any(line.taken for line in found):
                out[r] = np.array([stream.residual for stream in streams])
    return out, tuple(once_each(lines, [one.run_id for one in facts]))


def _found(spectra: Spectra) -> list[Line]:
    """Every line that the odds are for, taken out as it is found; then the best that they are against."""
    found: list[Line] = []
    peaks: list[tuple[int, int, Complex]] = []
    best = best_lines(spectra)
    for _ in range(_MOST):
        strongest = max(best.values(), key=lambda c: c.score(spectra.n), default=None)
        if strongest is None or strongest.score(spectra.n) <= 0.0:
            break
        before = spectra.lines[:, :, strongest.index].copy()
        found += (lines := _taken(spectra, strongest))
        gyros = {g for line in lines for g in _gyros(spectra, line)}
        peaks += [(i, strongest.index, before[:, i]) for i in sorted(gyros)]
        best = best_lines(spectra, gyros, best)
    found = _with_mixtures(spectra, found, peaks)
    return found + [_seen(spectra, c) for c in best.values()]


def _gyros(spectra: Spectra, line: Line) -> list[int]:
    """Indices of the gyros that show a line."""
    return [i for i in range(spectra.n) if line.channels in (("table",), (gyro_name(i),))]


def _taken(spectra: Spectra, one: Candidate) -> list[Line]:
    """A candidate's lines, taken out: of one gyro, of a motion, or of several gyros at one frequency."""
    near = np.unique(np.clip(one.index + np.arange(-2, 3), 0, len(spectra.hz) - 1))
    each = [Candidate(i, *_at(spectra, gyro_logs(spectra, i, near), near, i)) for i in range(spectra.n)]
    apart = [c for c in each if c.score(spectra.n) > 0.0 and spectra.free[c.gyro, one.index]]
    motion = None
    if spectra.n > 1 and spectra.awake.all() and spectra.free[:, one.index].all():
        # as if the gyros' noises were independent, as for the lines of each
        motion = Candidate(-1, *_at(spectra, motion_logs(spectra, near, np.eye(spectra.n)), near, 0))
        score = motion.score(spectra.n)
        several = sum(c.score(spectra.n) for c in apart)
        # a real motion is a little another one at each gyro: that share of it is no second line
        missed = max(sum(c.gain for c in apart) - motion.gain, 0.0)
        score += min(missed, (SKIRT * SKIRT) * motion.gain)
        if several >= score:
            motion = None
    chosen = [motion] if motion is not None else apart or [one]
    return [_taken_out(spectra, c) for c in chosen]


def _at(
    spectra: Spectra, logs: tuple[Array, Array], near: NDArray[np.intp], i: int
) -> tuple[int, float, float]:
    k = int(np.argmax(logs[0]))
    return int(near[k]), float(logs[0][k]) - np.log(2.0 * spectra.count(i)), float(logs[1][k])


def _taken_out(spectra: Spectra, one: Candidate) -> Line:
    """A line out of the samples, with its numbers from all runs together, over the noise that is left."""
    gyros = list(range(spectra.n)) if one.gyro < 0 else [one.gyro]
    hz = spectra.refined(float(spectra.hz[one.index]), gyros)
    size = spectra.without(hz, gyros)
    line, log_b, gain = measured(spectra, one, hz, size)
    return replace(line, log_b=log_b, gain=gain, hz_std=frequency_std(spectra.duration_s, gain), taken=True)


def _seen(spectra: Spectra, one: Candidate) -> Line:
    """A candidate's numbers as the spectra have them."""
    gyros = slice(None) if one.gyro < 0 else slice(one.gyro, one.gyro + 1)
    size = (spectra.lines * spectra.error(one.index)[:, :, None])[:, gyros, one.index]
    return measured(spectra, one, float(spectra.hz[one.index]), size)[0]


def _with_mixtures(
    spectra: Spectra, found: list[Line], peaks: Sequence[tuple[int, int, Complex]]
) -> list[Line]:
    """Lines of one gyro of which one is the sum or the difference of two others are of no catalogue.

    `peaks`: gyro, place in the spectrum and amplitudes (R,) of each line taken, so that mixtures are
    looked for in what is left and these, leakage gone.
    """
    out, first, free = list(found), spectra.lines.copy(), spectra.free.copy()
    for i, index, z in peaks:
        first[:, i, index], free[i, index] = z, True
    for i in range(spectra.n):
        mine = [line for line in found if line.channels == (gyro_name(i),)]
        heard = spectra.awake[:, i]
        parts = [z for z, there in zip(first[:, i], heard, strict=True) if there]
        if not parts:
            continue
        mix = mixed(parts, spectra.hz, free[i], spectra.count(i))
        if mix is None:
            continue
        own = [x for x in mine if any(abs(x.hz - f) < 6.0 * (spectra.hz[1] - spectra.hz[0]) for f in mix.hz)]
        alone = sum(x.log_b + priors.A_LINE - np.log(spectra.n) for x in own)
        if len(own) > 1 and mix.product < _BEYOND:
            continue  # two lines, and nothing where they would mix
        if mix.log_b + priors.A_MIXTURE - np.log(spectra.n) > alone:
            out = [x for x in out if x not in own]
            two = _seen(spectra, Candidate(i, mix.index, mix.log_b, mix.gain))
            out.append(replace(two, catalogued=False, degrees=2, taken=bool(own)))
    return out
