"""Candidates as options of a regression: of few points whole, of long grids by their best points."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from fogreduce.diagnosis import priors
from fogreduce.diagnosis.inference.candidate import EVERY, Candidate
from fogreduce.diagnosis.inference.evidence import WhitenedResidual
from fogreduce.diagnosis.inference.hierarchy import Kind
from fogreduce.diagnosis.inference.noise_model import Metric
from fogreduce.diagnosis.inference.regression import Entry, Member, Option, Regression
from fogreduce.diagnosis.inference.sizes import size_parameter, size_scales

Array = NDArray[np.float64]

#: Grids of more columns than this enter the regression by their best points alone.
_WHOLE = 40
#: Effects whose block means only echo what the full rate shows: that is where they are looked for.
OF_FULL_RATE = frozenset({"low_pass"})


class Library:
    """Options that grow as points of long grids prove worth a look.

    Parameters
    ----------
    candidates : sequence of Candidate
    rows : int
    """

    def __init__(self, candidates: Sequence[Candidate], rows: int) -> None:
        self.candidates = [c for c in candidates if c.effect not in OF_FULL_RATE]
        self.rows = rows
        places = Counter((c.effect, _common(c)) for c in self.candidates)
        self.entries: list[Entry] = []
        self._entry: dict[tuple[object, ...], int] = {}
        for c in self.candidates:
            if c.key not in self._entry:
                self._entry[c.key] = len(self.entries)
                self.entries.append(Entry(_kind(c, places[c.effect, _common(c)]), c.key))
        self.options: list[Option] = []
        self._columns: list[Array] = []
        self._count = 0
        self._taken: set[tuple[int, int]] = set()
        self._long: list[tuple[int, Candidate]] = []
        for number, c in enumerate(self.candidates):
            points, k = c.columns.shape[1:]
            if points * k > _WHOLE:
                self._long.append((number, c))
                continue
            for point in range(points):
                self._add(number, c, point, float(c.log_weights[point]))

    def _add(self, number: int, c: Candidate, point: int, log_weight: float) -> None:
        """Take in one point of a candidate's grid."""
        self._taken.add((number, point))
        self._append(self._entry[c.key], c, point, log_weight)

    def _append(self, entry: int, c: Candidate, point: int, log_weight: float) -> None:
        block = np.zeros((self.rows, c.columns.shape[2]))
        block[c.rows] = c.columns[:, point]
        index = np.arange(self._count, self._count + block.shape[1])
        self._count += block.shape[1]
        self._columns.append(block)
        if c.fixed:
            variances, logs = np.ones((1, 1)), np.zeros(1)
        else:
            realistic = c.realistic or size_parameter(c).realistic
            assert realistic is not None, f"{c.effect}: an amplitude needs a realistic range"
            scales, logs = size_scales(realistic)
            variances = (scales[:, None] / np.abs(c.steps[point])[None, :]) ** 2
        self.options.append(Option(entry, c, point, index, log_weight, variances, logs))

    def settled(
        self, c: Candidate, log_weight: float, columns: Array, steps: Array, shape: Mapping[str, object]
    ) -> int:
        """Take in a candidate at parameters as they were fitted; the number of the option that it makes.

        Parameters
        ----------
        c : Candidate
            At the point of its grid that it was.
        log_weight : float
            Ln share of its entry's prior that the point has.
        columns : (rows, k) array
            Whitened.
        steps : (k,) array
            What a coefficient of one means.
        shape : mapping
            Parameters that no column scales.
        """
        settled = replace(
            c, columns=columns[c.rows][:, None, :], grid=(shape,), steps=steps[None, :], weights=None
        )
        self._append(self._entry[c.key], settled, 0, log_weight)
        return len(self.options) - 1

    def member(self, number: int, sizes: Array) -> Member:
        """An option with the scale of its size that is nearest to amplitudes (k,)."""
        off = np.abs(np.log(self.options[number].variances[:, 0]) - 2.0 * np.log(np.abs(sizes[0]) + 1e-300))
        return Member(number, int(np.argmin(off)))

    def regression(self, metric: Metric, y: Array) -> Regression:
        """The options so far, held against a whitened residual."""
        return Regression.of(metric, y, self.columns, tuple(self.options), tuple(self.entries))

    @property
    def columns(self) -> Array:
        """All options' columns (rows, P)."""
        return np.column_stack(self._columns)

    def widened(self, residual: WhitenedResidual) -> bool:
        """Take in the best point of each long grid that gains anything in a residual; whether any was new."""
        new = False
        for number, c in self._long:
            fit = residual.fit(c)
            if fit.log_b <= 0.0 or (number, fit.best) in self._taken:
                continue
            # neighbours of the best point do nearly as well: their part of the grid is the point's weight
            there = residual.fit(at_point(c, fit.best)).log_b
            self._add(
                number, c, fit.best, float(np.clip(fit.log_b - there, -np.log(c.columns.shape[1]), 0.0))
            )
            new = True
        return new


def at_point(c: Candidate, point: int) -> Candidate:
    """A candidate at one point of its grid."""
    part = slice(point, point + 1)
    return replace(c, columns=c.columns[:, part], grid=c.grid[part], steps=c.steps[part], weights=None)


def _common(c: Candidate) -> bool:
    """Whether it is one amount that all gyros share."""
    return len(c.channels) > 1


def _kind(c: Candidate, places: int) -> Kind:
    every = c.runs == EVERY and not c.extra.get("source") and not c.extra.get("with")
    return Kind(c.effect, places, every, priors.COMMON if _common(c) else 1.0)
