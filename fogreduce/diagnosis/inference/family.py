"""A family of the unknown: a candidate without a name, and shapes that many of them have."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from fogreduce.diagnosis.inference.candidate import EVERY, Candidate
from fogreduce.diagnosis.observe.capture import RunInput

Array = NDArray[np.float64]

HARMONICS = tuple(range(1, 17))
_DOUBLE = 0.05  # prior of a family that an effect of the catalogue does already


def modes(count: int, first: int, number: int) -> Array:
    """Cosine modes `first` to `first + number - 1` over a run's blocks, (blocks, number)."""
    t = (np.arange(count) + 0.5) / count
    return np.cos(np.pi * np.outer(t, np.arange(first, first + number)))


def family(
    name: tuple[str, ...],
    rows: slice,
    columns: Array,
    feature: str,
    stage: str,
    runs: tuple[str, ...] = EVERY,
    share: float = 1.0,
) -> Candidate:
    """A candidate of no effect, from whitened columns (rows, J, k): J points of a grid, k columns at each."""
    j, k = columns.shape[1:]
    return Candidate(
        "unknown",
        name,
        runs,
        rows,
        columns,
        ({},) * j,
        ("",) * k,
        np.ones((j, k)),
        share=share,
        catalogued=False,
        feature=feature,
        stage=stage,
    )


def lessened(effect: str, allowed: frozenset[str]) -> float:
    """Share of its prior that a family keeps beside the effect that does the same."""
    return _DOUBLE if effect in allowed else 1.0


def waves_of_angle(one: RunInput, turns: bool) -> Array:
    """Cosine and sine of each harmonic of alpha in block means, (blocks, 2 harmonics); none where it
    stands.
    """
    blocks = one.scene.blocks
    if not turns:
        return np.zeros((blocks.count, 2 * len(HARMONICS)))
    alpha = one.facts.profile.angle_at(blocks.time_s.copy())
    pairs = [f(n * alpha) for n in HARMONICS for f in (np.cos, np.sin)]
    return blocks.means(np.array(pairs)).T


def diagonal(parts: Sequence[Array]) -> Array:
    """Columns of each run by themselves: a block-diagonal matrix."""
    out = np.zeros((sum(len(p) for p in parts), sum(p.shape[1] for p in parts)))
    row = column = 0
    for part in parts:
        out[row : row + len(part), column : column + part.shape[1]] = part
        row, column = row + len(part), column + part.shape[1]
    return out
