"""Spectra of runs of one sample rate over the noise near each of their lines, as lines are taken out of the
samples.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from fogreduce.diagnosis.observe.full_rate import ASLEEP
from fogreduce.diagnosis.which.full_rate.streams import LEAST_HZ, Stream, noise_floor
from fogreduce.metadata.facts import RunFacts

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

_NEAR = 4.0  # resolved lines on either side of a line taken that went with it
#: A real line's amplitude and phase wander: what stands beside one taken, d resolved lines away, is its own
#: doing up to this share of it over d.
SKIRT = 0.1
_RINGS = (2.0, 4.0, 8.0, 16.0, 32.0, 64.0, 128.0)  # resolved lines beside one taken, of one noise each
_USUAL = 4.0  # standard deviations of a quadrature within which a spectrum is noise
_CLEAR = 6.0  # standard deviations from which on gyros' noises are correlated
_TURNS = 41  # frequencies tried about a line, within a resolved line


@dataclass
class Spectra:
    """Spectra of runs of one sample rate.

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
    def of(cls, residuals: Sequence[Array], facts: Sequence[RunFacts]) -> Spectra | None:
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

    def count(self, i: int) -> float:
        """Independent frequencies."""
        return max(float(self.free[i].sum()) / 2.0, 1.0)

    @property
    def duration_s(self) -> float:
        """Of the longest run."""
        return max(len(row[0].residual) for row in self.streams) / self.facts[0].sample_rate_hz

    def error(self, index: int) -> Array:
        """Standard deviation (R, n) [deg/h] of either part of an amplitude."""
        counted = np.array([[max(stream.samples, 1.0) for stream in row] for row in self.streams])
        result: Array = np.sqrt(self.floors[:, :, index]) * np.sqrt(2.0 / counted)
        return result

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

    def refined(self, hz: float, gyros: Sequence[int] | range) -> float:
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

    def measure_apart(self) -> None:
        """How gyros' noises are made independent, (n, n): C^(-1/2) of their correlation C."""
        usual = np.all(np.abs(self.lines) < _USUAL, axis=1)
        z = np.swapaxes(self.lines, 0, 1)[:, usual]
        size = np.sqrt(np.mean(np.abs(z) ** 2, axis=1))
        together = np.real(z @ z.conj().T) / max(z.shape[1], 1) / np.outer(size, size)
        if np.max(np.abs(together - np.eye(self.n))) > _CLEAR / np.sqrt(max(z.shape[1], 1)):
            values, vectors = np.linalg.eigh(together)
            self.apart = (vectors / np.sqrt(np.maximum(values, 1e-3))) @ vectors.T

    def without(self, hz: float, gyros: Sequence[int]) -> Complex:
        """Take a line out of some gyros' samples, its skirt out of what may still be found; its amplitudes
        (R, gyros) [deg/h].
        """
        step = self.hz[1] - self.hz[0]
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
            skirt = SKIRT**2 * power.max(where=apart < 2.0, initial=0.0) / np.maximum(apart, 1.0) ** 2
            self.free[i] &= (np.sum(np.abs(self.lines[:, i]) ** 2, axis=0) > skirt) | (skirt < 1.0)
        return size
