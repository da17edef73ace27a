"""Lines in the full-rate stream: on one gyro, or of a motion that all gyros feel.

The strongest is found in the spectra, its frequency told from all runs together, and it is taken out of the
samples; then the next. So each is found once, whatever its leakage, and everything else is read from what is
left. Amplitude is the same in every run; the phase is another one in each, or one for all.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from fogreduce.diagnosis import priors
from fogreduce.diagnosis.inference.evidence import log_mean_exp
from fogreduce.diagnosis.observe.full_rate import ASLEEP
from fogreduce.diagnosis.which.full_rate.line_evidence import leading, sizes_log
from fogreduce.diagnosis.which.full_rate.mixing import mixed
from fogreduce.diagnosis.which.full_rate.streams import LEAST_HZ, Stream, noise_floor
from fogreduce.effects.gyro_names import gyro_name
from fogreduce.metadata.facts import RunFacts

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

_LOCKED = 0.3  # prior share of lines that start anew with each run
_DRIFTS = 0.05  # of a spectrum's resolution: a real line is not quite steady
_BEYOND = 5.0  # ln evidence of what two lines make together, before they are called a mixture
_MOST = 60  # lines of one sample rate: a bound on a loop that ends by itself
_NEAR = 4.0  # resolved lines on either side of a line taken that went with it
#: A real line's amplitude and phase wander: what stands beside one taken, d resolved lines away, is its own
#: doing up to this share of it over d.
_SKIRT = 0.1
_RINGS = (2.0, 4.0, 8.0, 16.0, 32.0, 64.0, 128.0)  # resolved lines beside one taken, of one noise each
_USUAL = 4.0  # standard deviations of a quadrature within which a spectrum is noise
_CLEAR = 6.0  # standard deviations from which on gyros' noises are correlated
_TURNS = 41  # frequencies tried about a line, within a resolved line


@dataclass(frozen=True)
class Line:
    """A line found.

    Attributes
    ----------
    channels : tuple of str
        One gyro, or ``table``: a motion.
    runs : tuple of str
        Those of its sample rate; ``*`` where all are of one.
    hz, hz_std, deg_h, std : float
    axis : tuple of float or None
        Of a motion.
    log_b : float
        Ln evidence over that of noise alone, the look-elsewhere of all frequencies in it.
    gain : float
        Gain in ln likelihood.
    share : float
        Prior share of the effect's name.
    degrees : int
        Numbers that were free.
    taken : bool
        Whether the odds are for it, and it was taken out of the samples.
    known : bool
        Whether the catalogue has its like: not two lines and their mixture.
    by_run : mapping
        Run id -> (amplitude [deg/h], its standard deviation).
    """

    channels: tuple[str, ...]
    runs: tuple[str, ...]
    hz: float
    hz_std: float
    deg_h: float
    std: float
    axis: tuple[float, ...] | None
    log_b: float
    gain: float
    share: float
    degrees: int
    taken: bool
    known: bool = True
    by_run: dict[str, tuple[float, float]] = field(default_factory=dict)

    def of(self, run_ids: Sequence[str]) -> Line | None:
        """The line as some runs alone show it; None where they have it not."""
        here = [self.by_run[run] for run in run_ids if run in self.by_run]
        if not here:
            return None
        weights = np.array([std**-2.0 for _, std in here])
        squares = float(weights @ np.array([size**2 for size, _ in here])) / float(weights.sum())
        share = float(weights.sum()) / sum(std**-2.0 for _, std in self.by_run.values())
        std = float(weights.sum() ** -0.5)
        return replace(self, deg_h=float(np.sqrt(squares)), std=std, gain=self.gain * share)


def without_lines(
    residuals: Sequence[Array], facts: Sequence[RunFacts]
) -> tuple[list[Array], tuple[Line, ...]]:
    """Residuals less the lines in them, and the lines: runs of one sample rate have their own.

    A line above half the sample rate shows elsewhere at another rate.

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
        group = _Group.of([residuals[r] for r in here], [facts[r] for r in here])
        if group is None:
            continue
        runs = ("*",) if len(set(rates)) == 1 else tuple(facts[r].run_id for r in here)
        found = group.search()
        lines += [replace(line, runs=runs, share=line.share / len(set(rates))) for line in found]
        for r, streams in zip(here, group.streams, strict=True):
            if any(line.taken for line in found):
                out[r] = np.array([stream.residual for stream in streams])
    return out, tuple(lines)


@dataclass(frozen=True)
class _Candidate:
    """The best line of one gyro, or of a motion (-1): its place in the spectrum and its evidence."""

    gyro: int
    index: int
    log_b: float
    gain: float

    def score(self, n: int) -> float:
        """Ln posterior odds beside any other causes."""
        return self.log_b + priors.A_LINE - (np.log(n) if self.gyro >= 0 else 0.0)


@dataclass
class _Group:
    """Runs of one sample rate.

    Attributes
    ----------
    streams : lists of Stream
        Of each gyro in each run.
    hz : (L,) array
    lines : (R, n, L) array
        Spectra over their noise.
    apart : (n, n) array
        What makes the gyros' noises independent.
    out : lists of float
        Frequencies of the lines taken out of each gyro.
    free : (n, L) array of bool
        Which lines may still be found.
    """

    facts: Sequence[RunFacts]
    streams: list[list[Stream]]
    padded: int
    low: int
    hz: Array
    lines: Complex
    floors: Array
    free: NDArray[np.bool_]
    awake: NDArray[np.bool_]
    weights: Array
    apart: Array
    out: list[list[float]]

    @classmethod
    def of(cls, residuals: Sequence[Array], facts: Sequence[RunFacts]) -> _Group | None:
        """Spectra of runs, padded to one length: each line split so that none falls between."""
        rate, n = facts[0].sample_rate_hz, facts[0].n_gyros
        longest = max(r.shape[1] for r in residuals)
        padded = 1 << int(np.ceil(np.log2(max(2 * longest, 2))))
        low, high = int(np.ceil(LEAST_HZ * padded / rate)), int(0.49 * padded) + 1
        if high - low < 16:
            return None
        streams = [[Stream(rate, row.copy()) for row in r] for r in residuals]
        size = high - low
        group = cls(
            facts,
            streams,
            padded,
            low,
            (low + np.arange(size, dtype=np.float64)) * (rate / padded),
            np.zeros((len(facts), n, size), np.complex128),
            np.ones((len(facts), n, size)),
            np.ones((n, size), bool),
            np.ones((len(facts), n), bool),
            np.ones(len(facts)),
            np.eye(n),
            [[] for _ in range(n)],
        )
        for i in range(n):
            group.measure(i)
        levels = np.median(group.floors[:, :, : max(size // 8, 1)], axis=2)
        usual = [1.0 if one.white_noise is None else 60.0 * np.sqrt(rate) * one.white_noise for one in facts]
        group.awake = levels > np.maximum((ASLEEP * np.array(usual).reshape(len(facts), -1)) ** 2, 1e-20)
        group.lines *= group.awake[:, :, None]
        counted = np.array([max(s.samples for s in row) for row in streams])
        group.weights = np.sqrt(counted / max(float(counted.max()), 1.0))
        if counted.max() < 64:
            return None
        if n > 1 and group.awake.all():
            group.measure_apart()
        return group

    @property
    def n(self) -> int:
        """Gyros."""
        return len(self.free)

    def measure(self, i: int) -> None:
        """Spectra of a gyro as its samples are now."""
        for r, streams in enumerate(self.streams):
            stream = streams[i]
            lines = stream.spectrum(self.padded, self.low, self.low + len(self.hz))
            floor = noise_floor(lines, self.padded / max(len(stream.residual), 1))
            for hz in self.out[i]:
                self._lift(floor, lines, hz)
            self.floors[r, i] = floor
            self.lines[r, i] = lines / np.sqrt(np.maximum(floor, 1e-300)) * self.awake[r, i]

    def _lift(self, floor: Array, lines: Complex, hz: float) -> None:
        """Raise the noise beside a line taken to what stands on either side: a dithered one is broad."""
        step = self.hz[1] - self.hz[0]
        longest = max(len(row[0].residual) for row in self.streams)
        at, cell = round((hz - self.hz[0]) / step), self.padded / longest
        for inner, outer in pairwise(_RINGS):
            near, far = round(inner * cell), round(outer * cell)
            sides = [slice(max(at - far, 0), max(at - near, 0)), slice(max(at + near, 0), max(at + far, 0))]
            power = np.concatenate([0.5 * np.abs(lines[side]) ** 2 for side in sides])
            if power.size:
                for side in sides:
                    floor[side] = np.maximum(floor[side], float(np.median(power)) / np.log(2.0))

    def search(self) -> list[Line]:
        """Every line that the odds are for, taken out as it is found; then the best that they are against."""
        found: list[Line] = []
        peaks: list[tuple[int, int, Complex]] = []
        best = self.best()
        for _ in range(_MOST):
            strongest = max(best.values(), key=lambda c: c.score(self.n), default=None)
            if strongest is None or strongest.score(self.n) <= 0.0:
                break
            before = self.lines[:, :, strongest.index].copy()
            found += (lines := self.taken(strongest))
            gyros = {g for line in lines for g in self.gyros(line)}
            peaks += [(i, strongest.index, before[:, i]) for i in sorted(gyros)]
            best = self.best(gyros, best)
        found = self.mixtures(found, peaks)
        return found + [self.seen(c) for c in best.values()]

    def gyros(self, line: Line) -> list[int]:
        """Indices of the gyros that show a line."""
        return [i for i in range(self.n) if line.channels in (("table",), (gyro_name(i),))]

    # ---------------------------------------------------------------------------------- evidence

    def count(self, i: int) -> float:
        """Independent frequencies."""
        return max(float(self.free[i].sum()) / 2.0, 1.0)

    def best(
        self, gyros: set[int] | None = None, before: dict[int, _Candidate] | None = None
    ) -> dict[int, _Candidate]:
        """The best line of each gyro and of a motion; `before`: those known of gyros that did not change."""
        out = dict(before or {})
        for i in range(self.n) if gyros is None else sorted(gyros):
            out.pop(i, None)
            power = np.sum(np.abs(self.lines[:, i]) ** 2, axis=0)
            leaders = leading(power, self.free[i])
            leaders = leaders[(power[leaders] > 0.0) & self.free[i, leaders]]
            if leaders.size:
                out[i] = self._of_gyro(i, leaders)
        out.pop(-1, None)
        if self.n > 1 and self.awake.all():
            power = np.sum(
                np.abs(np.einsum("nd,rnl->rdl", self.basis(self.apart), self.lines)) ** 2, axis=(0, 1)
            )
            free = np.logical_and.reduce(self.free)
            leaders = leading(power, free)
            leaders = leaders[(power[leaders] > 0.0) & free[leaders]]
            if leaders.size:
                out[-1] = self._of_motion(leaders)
        return out

    def _of_gyro(self, i: int, leaders: NDArray[np.intp]) -> _Candidate:
        logs, tops = self.gyro_logs(i, leaders)
        k = int(np.argmax(logs))
        # neighbours of a line in a spectrum of split lines say the same again
        log_sum = float(log_mean_exp(logs) + np.log(len(logs))) - np.log(2.0)
        return _Candidate(i, int(leaders[k]), log_sum - np.log(self.count(i)), float(tops[k]))

    def gyro_logs(self, i: int, at: NDArray[np.intp]) -> tuple[Array, Array]:
        """Ln evidence and gain of lines of a gyro, of a phase in each run or of one for all."""
        heard = np.flatnonzero(self.awake[:, i])
        return self.shown_log(self.lines[heard[:, None], i, at[None, :]].T, self.weights[heard])

    def shown_log(self, z: Complex, weights: Array) -> tuple[Array, Array]:
        """The same from their amplitudes (lines, R) over their noise."""
        free, top = sizes_log(np.abs(z), weights)
        if len(weights) < 2:
            return free, top
        together = np.abs(z @ weights)[:, None] / np.sqrt(np.sum(weights**2))
        locked, _ = sizes_log(together)
        return np.logaddexp(free + np.log(1.0 - _LOCKED), locked + np.log(_LOCKED)), top

    def basis(self, apart: Array, at: NDArray[np.intp] | None = None) -> Array:
        """What a motion does to the gyros' spectra over their noise, as d sums of them (n, d) of independent
        noise: in the whole spectrum, or in some of its lines (lines, n, d). `apart`: as of the group.
        """
        seen = self.facts[0].axes * self.facts[0].frame_signs
        if at is None:
            noise = np.sqrt(np.median(self.floors, axis=(0, 2)))
            return np.asarray(apart @ np.linalg.qr(apart @ (seen / noise[:, None]))[0])
        noise = np.sqrt(np.mean(self.floors[:, :, at], axis=0)).T
        return np.asarray(apart @ np.linalg.qr(apart @ (seen / noise[:, :, None]))[0])

    def _of_motion(self, leaders: NDArray[np.intp]) -> _Candidate:
        logs, tops = self.motion_logs(leaders, self.apart)
        k = int(np.argmax(logs))
        log_sum = float(log_mean_exp(logs) + np.log(len(logs))) - np.log(2.0)
        count = min(self.count(i) for i in range(self.n))
        return _Candidate(-1, int(leaders[k]), log_sum - np.log(count), float(tops[k]))

    def motion_logs(self, at: NDArray[np.intp], apart: Array) -> tuple[Array, Array]:
        """Ln evidence and gain of motions along one direction, of one phase for all gyros in a run."""
        # over noise that is one for all runs: a strong line's skirt is another in each
        floors = self.floors[:, :, at]
        lines = self.lines[:, :, at] * np.sqrt(floors / np.mean(floors, axis=0))
        y = np.einsum("lnd,rnl->lrd", self.basis(apart, at), lines)
        weighed = y * self.weights[None, :, None]
        cov = np.real(np.einsum("lrd,lre->lde", weighed, weighed.conj()))
        direction = np.linalg.eigh(cov)[1][:, :, -1]
        return self.moved_log(np.abs(np.einsum("lrd,ld->lr", y, direction)))

    def moved_log(self, moduli: Array) -> tuple[Array, Array]:
        """Ln evidence and gain of motions from their amplitudes (lines, R) along the direction chosen."""
        mean, top = sizes_log(moduli, self.weights)
        gain2 = np.maximum(np.sum(moduli**2, axis=1) - 2.0 * len(self.facts), 1.0)
        # the direction was chosen: the share of all directions that would have done as well
        if self.facts[0].axes.shape[1] == 3 and self.n > 2:
            mean = mean + np.log(np.minimum(2.0 / gain2, 1.0))
        return mean, top

    def measure_apart(self) -> None:
        """How gyros' noises are made independent, (n, n): C^(-1/2) of their correlation C."""
        usual = np.all(np.abs(self.lines) < _USUAL, axis=1)
        z = np.swapaxes(self.lines, 0, 1)[:, usual]
        size = np.sqrt(np.mean(np.abs(z) ** 2, axis=1))
        together = np.real(z @ z.conj().T) / max(z.shape[1], 1) / np.outer(size, size)
        if np.max(np.abs(together - np.eye(self.n))) > _CLEAR / np.sqrt(max(z.shape[1], 1)):
            values, vectors = np.linalg.eigh(together)
            self.apart = (vectors / np.sqrt(np.maximum(values, 1e-3))) @ vectors.T

    # ------------------------------------------------------------------------------------- taking

    def taken(self, one: _Candidate) -> list[Line]:
        """A candidate's lines, taken out: of one gyro, of a motion, or of several gyros at one frequency."""
        near = np.unique(np.clip(one.index + np.arange(-2, 3), 0, len(self.hz) - 1))
        each = [_Candidate(i, *self._at(self.gyro_logs(i, near), near, i)) for i in range(self.n)]
        apart = [c for c in each if c.score(self.n) > 0.0 and self.free[c.gyro, one.index]]
        motion = None
        if self.n > 1 and self.awake.all() and self.free[:, one.index].all():
            # as if the gyros' noises were independent, as for the lines of each
            motion = _Candidate(-1, *self._at(self.motion_logs(near, np.eye(self.n)), near, 0))
            score = motion.score(self.n)
            several = sum(c.score(self.n) for c in apart)
            # a real motion is a little another one at each gyro: that share of it is no second line
            missed = max(sum(c.gain for c in apart) - motion.gain, 0.0)
            score += min(missed, (_SKIRT * _SKIRT) * motion.gain)
            if several >= score:
                motion = None
        chosen = [motion] if motion is not None else apart or [one]
        return [self._take_out(c) for c in chosen]

    def _at(self, logs: tuple[Array, Array], near: NDArray[np.intp], i: int) -> tuple[int, float, float]:
        k = int(np.argmax(logs[0]))
        return int(near[k]), float(logs[0][k]) - np.log(2.0 * self.count(i)), float(logs[1][k])

    def _take_out(self, one: _Candidate) -> Line:
        """A line out of the samples, with its numbers from all runs together, over the noise that is left."""
        step = self.hz[1] - self.hz[0]
        gyros = list(range(self.n)) if one.gyro < 0 else [one.gyro]
        hz = self._refined(float(self.hz[one.index]), gyros)
        size = np.zeros((len(self.facts), len(gyros)), np.complex128)
        for k, i in enumerate(gyros):
            power = np.sum(np.abs(self.lines[:, i]) ** 2, axis=0)
            for r, streams in enumerate(self.streams):
                streams[i], fitted = streams[i].without(hz)
                # what is steady of it, cosine less i times sine
                size[r, k] = complex(fitted[0, 0], -fitted[0, 1])
            self.out[i].append(hz)
            self.measure(i)
            longest = max(len(streams[i].residual) for streams in self.streams)
            apart = np.abs(self.hz - hz) / step * (longest / self.padded)  # in resolved lines
            self.free[i] &= apart > _NEAR
            skirt = _SKIRT**2 * power.max(where=apart < 2.0, initial=0.0) / np.maximum(apart, 1.0) ** 2
            self.free[i] &= (np.sum(np.abs(self.lines[:, i]) ** 2, axis=0) > skirt) | (skirt < 1.0)
        line, log_b, gain = self._line(one, hz, size)
        return replace(line, log_b=log_b, gain=gain, hz_std=_hz_std(self.duration_s, gain), taken=True)

    def seen(self, one: _Candidate) -> Line:
        """A candidate's numbers as the spectra have them."""
        gyros = slice(None) if one.gyro < 0 else slice(one.gyro, one.gyro + 1)
        size = (self.lines * self._error(one.index)[:, :, None])[:, gyros, one.index]
        return self._line(one, float(self.hz[one.index]), size)[0]

    @property
    def duration_s(self) -> float:
        """Of the longest run."""
        return max(len(row[0].residual) for row in self.streams) / self.facts[0].sample_rate_hz

    def _error(self, index: int) -> Array:
        """Standard deviation (R, n) [deg/h] of either part of an amplitude."""
        counted = np.array([[max(stream.samples, 1.0) for stream in row] for row in self.streams])
        result: Array = np.sqrt(self.floors[:, :, index]) * np.sqrt(2.0 / counted)
        return result

    def _line(self, one: _Candidate, hz: float, size: Complex) -> tuple[Line, float, float]:
        """Numbers of a line with amplitudes (R, gyros) [deg/h]; ln evidence and gain by these."""
        std, axis, share = self._error(one.index), None, 1.0 / self.n
        heard = np.ones(len(self.facts), bool) if one.gyro < 0 else self.awake[:, one.gyro]
        if one.gyro < 0:
            size, error, axis = self._along(size, std)
            share = 1.0
            logs, tops = self.moved_log(np.abs(size / error)[None])
        else:
            size, error = size[heard, 0], std[heard, one.gyro]
            logs, tops = self.shown_log((size / error)[None], self.weights[heard])
        weight = error**-2.0
        squares = float(weight @ (np.abs(size) ** 2 - 2.0 * error**2)) / float(weight.sum())
        whole = float(weight.sum() ** -0.5)
        runs = [facts.run_id for facts, there in zip(self.facts, heard, strict=True) if there]
        line = Line(
            channels=("table",) if one.gyro < 0 else (gyro_name(one.gyro),),
            runs=("*",),
            hz=hz,
            hz_std=_hz_std(self.duration_s, one.gain),
            deg_h=float(np.sqrt(max(squares, 0.05 * whole**2))),
            std=whole,
            axis=axis,
            log_b=one.log_b,
            gain=one.gain,
            share=share,
            degrees=max(2 * len(runs), 2),
            taken=False,
            by_run={run: (float(abs(z)), float(s)) for run, z, s in zip(runs, size, error, strict=True)},
        )
        return line, float(logs[0]) - np.log(2.0 * self.count(max(one.gyro, 0))), float(tops[0])

    def _along(self, size: Complex, std: Array) -> tuple[Complex, Array, tuple[float, ...]]:
        """Amplitudes (R,) of a motion along its axis, their standard deviations, and the axis."""
        seen = self.facts[0].axes * self.facts[0].frame_signs  # (n, 3)
        noise = np.sqrt(np.mean(std**2, axis=0))
        rates = np.linalg.lstsq(seen / noise[:, None], (size / noise).T, rcond=None)[0]  # (3, R)
        _, vectors = np.linalg.eigh(np.real(rates @ rates.conj().T))
        axis = vectors[:, -1]
        axis = axis * np.sign(axis[np.argmax(np.abs(axis))])
        strength = (seen @ axis / std) @ self.apart  # (R, n)
        error = np.sum(strength**2, axis=1) ** -0.5
        along = np.sum(strength * ((size / std) @ self.apart), axis=1) * error**2
        given = [round(float(v), 6) for v in axis.tolist()] if len(axis) == 3 else [1.0, 0.0, 0.0]
        return along, error, tuple(given)

    def _refined(self, hz: float, gyros: Sequence[int] | range) -> float:
        """Where the power of all runs together is highest, within a resolved line."""
        parts = []
        for r, row in enumerate(self.streams):
            for i in gyros:
                if self.awake[r, i]:
                    time_s, sums = row[i].turned(hz)
                    level = float(np.interp(hz, self.hz, self.floors[r, i]))
                    parts.append((time_s, sums / np.sqrt(max(level, 1e-300) * max(row[i].samples, 1.0))))
        longest = max(time_s[-1] for time_s, _ in parts)
        shift = np.linspace(-1.0, 1.0, _TURNS) / longest
        for _ in range(3):
            turn = -2j * np.pi * shift
            power = sum(np.abs(np.exp(np.outer(turn, t)) @ sums) ** 2 for t, sums in parts)
            k = int(np.clip(np.argmax(power), 1, len(shift) - 2))
            width = shift[1] - shift[0]
            left, middle, right = np.asarray(power)[k - 1 : k + 2]
            bend = left - 2.0 * middle + right
            best = shift[k] + (0.5 * (left - right) / bend * width if bend < 0.0 else 0.0)
            shift = best + np.linspace(-1.5, 1.5, 13) * width
        return float(hz + best)

    def mixtures(self, found: list[Line], peaks: Sequence[tuple[int, int, Complex]]) -> list[Line]:
        """Lines of one gyro of which one is the sum or the difference of two others are of no catalogue.

        `peaks`: gyro, place in the spectrum and amplitudes (R,) of each line taken, so that mixtures are
        looked for in what is left and these, leakage gone.
        """
        out, first, free = list(found), self.lines.copy(), self.free.copy()
        for i, index, z in peaks:
            first[:, i, index], free[i, index] = z, True
        for i in range(self.n):
            mine = [line for line in found if line.channels == (gyro_name(i),)]
            heard = self.awake[:, i]
            parts = [z for z, there in zip(first[:, i], heard, strict=True) if there]
            if not parts:
                continue
            mix = mixed(parts, self.hz, free[i], self.count(i))
            if mix is None:
                continue
            own = [x for x in mine if any(abs(x.hz - f) < 6.0 * (self.hz[1] - self.hz[0]) for f in mix.hz)]
            alone = sum(x.log_b + priors.A_LINE - np.log(self.n) for x in own)
            if len(own) > 1 and mix.product < _BEYOND:
                continue  # two lines, and nothing where they would mix
            if mix.log_b + priors.A_MIXTURE - np.log(self.n) > alone:
                out = [x for x in out if x not in own]
                two = self.seen(_Candidate(i, mix.index, mix.log_b, mix.gain))
                out.append(replace(two, known=False, degrees=2, taken=bool(own)))
        return out


def _hz_std(duration_s: float, gain: float) -> float:
    """Of a line's frequency: Cramer and Rao's bound ``sqrt(12) / (2 pi S T)``, and what a drifting line
    adds.
    """
    bound = np.sqrt(12.0) / (2.0 * np.pi * np.sqrt(max(2.0 * gain, 1.0)))
    return float(np.hypot(bound, _DRIFTS) / duration_s)
