"""Candidates held against a residual together: most have one point and few columns, and what costs is the
number of calls.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from fogreduce.diagnosis.inference.candidate import Candidate
from fogreduce.diagnosis.inference.evidence import Fit, WhitenedResidual


class Candidates:
    """Candidates of one problem, ready to be fitted all at once.

    Those of one point that touch the same rows and have as many columns stand side by side as the
    points of one grid.

    Parameters
    ----------
    candidates : sequence of Candidate
    """

    def __init__(self, candidates: Sequence[Candidate]) -> None:
        self.candidates = list(candidates)
        together: dict[tuple[object, ...], list[int]] = {}
        for at, c in enumerate(self.candidates):
            _, points, k = c.columns.shape
            is_single = points > 1 or c.fixed or c.positive
            key = (at,) if is_single else ("rows", c.rows.start, c.rows.stop, k)
            together.setdefault(key, []).append(at)
        self._groups = [(self._joined(members), members) for members in together.values()]

    def __iter__(self) -> Iterator[Candidate]:
        return iter(self.candidates)

    def _joined(self, members: Sequence[int]) -> Candidate:
        first = self.candidates[members[0]]
        if len(members) == 1:
            return first
        return replace(first, columns=np.concatenate([self.candidates[at].columns for at in members], axis=1))

    def fits(self, residual: WhitenedResidual) -> list[Fit]:
        """The fit of every candidate, in their order: what `WhitenedResidual.fit` gives for each."""
        out: dict[int, Fit] = {}
        for joined, members in self._groups:
            if len(members) == 1:
                out[members[0]] = residual.fit(joined)
            else:
                found = residual.points(joined)
                for point, at in enumerate(members):
                    out[at] = found.one(self.candidates[at], point)
        return [out[at] for at in range(len(self.candidates))]
