"""Eigenvectors of random processes in block means, under the noise of a gyro in a run.

They hold for any residual under the same filter, and are found once.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from fogreduce.diagnosis.inference.noise_model import Whitener, process_covariance, relative
from fogreduce.diagnosis.observe.blocks import Blocks
from fogreduce.diagnosis.observe.capture import RunInput
from fogreduce.diagnosis.which.catalogue.unlogged import UNLOGGED
from fogreduce.diagnosis.which.processes.jumps import Background
from fogreduce.diagnosis.which.processes.sizes import SOME, smooth_modes

Array = NDArray[np.float64]

_SMOOTH = {kind.split()[-1] for kind in UNLOGGED.values()}
_STEADY = 0.02  # spread of a reading, relative to the largest, that counts as none
#: Readings that differ by less, relative to the largest, are alike to what goes with them.
_ALIKE = 0.05


@dataclass
class ProcessCache:
    """What was found under filters, by the filters' ids; these are kept too, so that no other has their ids.

    Attributes
    ----------
    eigen : mapping
        Eigenvectors and their variances of each process.
    inverses : mapping
        Inverses of the filters, and the background of which they are the inverse.
    readings : list
        Relative readings of runs [(n, blocks) arrays], those that differ.
    modes : mapping
        Of smooth processes, by kind and blocks.
    whitened : mapping
        The same whitened, with their inner products.
    """

    eigen: dict[tuple[object, ...], tuple[Array, Array, Array]] = field(default_factory=dict)
    inverses: dict[int, tuple[Array, Background, Array]] = field(default_factory=dict)
    readings: list[list[Array]] = field(default_factory=list)
    modes: dict[tuple[object, ...], Array] = field(default_factory=dict)
    whitened: dict[tuple[object, ...], tuple[Array, Array, Array]] = field(default_factory=dict)

    def alike(self, readings: list[Array]) -> list[Array]:
        """Readings seen before next to the same; these themselves where there are none."""
        for before in self.readings:
            if all(np.abs(a - b).max(initial=0.0) < _ALIKE for a, b in zip(before, readings, strict=True)):
                return before
        self.readings.append(readings)
        return readings


class Shapes:
    """Processes at every gyro in every run, whitened.

    Parameters
    ----------
    inputs : runs
    whiten : Whitener
    plain : (n, blocks) arrays
        Predicted readings in each run's blocks [deg/h].
    cache : ProcessCache
        What was found before, to which more is added.

    Attributes
    ----------
    reading : list of (n, blocks) arrays
        Readings relative to the largest of each gyro.
    """

    def __init__(
        self, inputs: Sequence[RunInput], whiten: Whitener, plain: Sequence[Array], cache: ProcessCache
    ) -> None:
        self.inputs, self.whiten, self._cache = inputs, whiten, cache
        self.reading = cache.alike(relative(plain))

    def inverse(self, i: int, r: int) -> tuple[Array, Background]:
        """What turns whitened rows of a gyro in a run back, and the background that it makes of them."""
        matrix = self.whiten.filters[i, r]
        if id(matrix) not in self._cache.inverses:
            inverse = np.asarray(np.linalg.inv(matrix), np.float64)
            middle = inverse[len(inverse) // 2]
            background = Background.of(inverse[len(inverse) // 2 :] @ middle)
            self._cache.inverses[id(matrix)] = (inverse, background, matrix)
        return self._cache.inverses[id(matrix)][:2]

    def modes(self, i: int, r: int, kind: str, factor: Array | None) -> tuple[Array, Array]:
        """Modes of a smooth process at gyro i in a run, whitened (blocks, m), and their inner products."""
        matrix, blocks = self.whiten.filters[i, r], self.inputs[r].scene.blocks
        at: tuple[object, ...] = (kind, blocks.count, blocks.length_s)
        if at not in self._cache.modes:
            self._cache.modes[at] = smooth_modes(kind, blocks)
        key = (id(matrix), *at, None if factor is None else factor.tobytes())
        if key not in self._cache.whitened:
            modes = self._cache.modes[at]
            modes = matrix @ (modes if factor is None else modes * factor[:, None])
            self._cache.whitened[key] = (modes, modes.T @ modes, matrix)
        return self._cache.whitened[key][:2]

    def of(self, i: int, r: int, kind: str) -> tuple[Array, Array]:
        """Eigenvectors (blocks, D) and variances (D,) of a process; ``gain K``: of K times the reading."""
        if not kind.startswith("gain"):
            return self.eigen(i, r, kind)
        reading, other = self.reading[r][i], kind.removeprefix("gain ")
        middle = float(np.mean(reading))
        if float(np.ptp(reading)) < _STEADY * max(abs(middle), _STEADY):
            vectors, d = self.eigen(i, r, other)
            return vectors, middle**2 * d
        return self.eigen(i, r, other, reading)

    def eigen(self, i: int, r: int, kind: str, factor: Array | None = None) -> tuple[Array, Array]:
        """The same of a process times a factor (blocks,); constants are projected out."""
        matrix, blocks = self.whiten.filters[i, r], self.inputs[r].scene.blocks
        if kind.startswith("forgets"):
            # means over blocks cannot tell times that are shorter than a block apart
            kind = f"forgets {max(float(kind.split()[1]), 1.2 * blocks.length_s)}"
        key = (id(matrix), kind, None if factor is None else factor.tobytes())
        if key not in self._cache.eigen:
            constant = matrix.sum(axis=1)
            constant = constant / np.linalg.norm(constant)
            if kind.split()[0] in _SMOOTH:
                # few modes: eigenvectors are sought among them
                modes, _ = self.modes(i, r, kind, factor)
                modes = modes - np.outer(constant, constant @ modes)
                values, turn = np.linalg.eigh(modes.T @ modes)
                some = values > SOME * values[-1]
                vectors = modes @ (turn[:, some] / np.sqrt(values[some]))
            else:
                covariance = _covariance(kind, blocks)
                if factor is not None:
                    covariance = covariance * np.outer(factor, factor)
                white = matrix @ covariance @ matrix.T
                part = white @ constant
                white = white - np.outer(constant, part) - np.outer(part, constant)
                white += np.outer(constant, constant) * float(constant @ part)
                values, vectors = np.linalg.eigh(white)
                some = values > SOME * values[-1]
                vectors = vectors[:, some]
            self._cache.eigen[key] = (vectors, values[some], matrix)
        return self._cache.eigen[key][:2]


def _covariance(kind: str, blocks: Blocks) -> Array:
    if not kind.startswith("forgets"):
        return process_covariance(kind, 1.0, blocks)
    time = float(kind.split()[1])
    return np.exp(-np.abs(np.subtract.outer(blocks.centre_s, blocks.centre_s)) / time)
