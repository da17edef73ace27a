"""One effect at one place, as columns: what it would change in block means."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
EVERY = ("*",)
_FEW_PAIRS = 9


@dataclass(frozen=True)
class Candidate:
    """One effect at one place.

    Attributes
    ----------
    effect : str
    channels, runs : tuples of str
        As an effects file has them; runs ``("*",)`` for all.
    rows : slice
        The rows that it touches.
    columns : (rows, J, k) array
        Whitened; k columns a point of the grid.
    grid : tuple of mappings
        Parameters at each point, those that scale left out.
    scales : tuple of str
        What the k columns scale: parameter names, a component of a vector as ``mrad[0]``.
    steps : (J, k) array
        What a coefficient of one means in the parameter.
    fixed : bool
        Exact differences of a given size.
    positive : bool
        Its amplitude cannot be negative.
    share : float
        Prior share of the effect's name that this place has.
    catalogued : bool
        False for what no effect of the catalogue does: a family of the unknown.
    realistic : (float, float) or None
        Sizes that units of the class show, where a data sheet has them; None: those that the effect states.
    weights : (J,) array or None
        Prior shares of the points of the grid; None: all are alike.
    feature, stage : str
        For a family of the unknown: the contract's words for where it shows.
    """

    effect: str
    channels: tuple[str, ...]
    runs: tuple[str, ...]
    rows: slice
    columns: Array
    grid: tuple[Mapping[str, Any], ...]
    scales: tuple[str, ...]
    steps: Array
    fixed: bool = False
    positive: bool = False
    share: float = 1.0
    catalogued: bool = True
    feature: str = ""
    stage: str = "gyro"
    extra: Mapping[str, Any] = field(default_factory=dict)
    realistic: tuple[float, float] | None = None
    weights: Array | None = None

    @property
    def key(self) -> tuple[str, tuple[str, ...], tuple[str, ...], str]:
        """Effect, channels, runs, and the other gyro of a pair."""
        return (
            self.effect,
            self.channels,
            self.runs,
            str(self.extra.get("source", self.extra.get("with", ""))),
        )

    @property
    def log_weights(self) -> Array:
        """Ln of the prior shares of the points of the grid, (J,)."""
        points = self.columns.shape[1]
        return np.log(np.full(points, 1.0 / points) if self.weights is None else self.weights)

    @cached_property
    def flat(self) -> Array:
        """Columns as one matrix, (rows, J k)."""
        return self.columns.reshape(len(self.columns), -1)

    @cached_property
    def gram(self) -> Array:
        """Inner products of the columns at each point of the grid, (J, k, k)."""
        return pairs(self.columns, self.columns)


def pairs(x: Array, y: Array) -> Array:
    """Inner products over the first axis of (m, J, k) and (m, J, l), point by point: (J, k, l)."""
    j, k, columns = x.shape[1], x.shape[2], y.shape[2]
    if j == 1:
        return (x[:, 0].T @ y[:, 0])[None]
    out = np.empty((j, k, columns))
    if k * columns > _FEW_PAIRS:
        for point in range(j):
            out[point] = x[:, point].T @ y[:, point]
        return out
    for a in range(k):
        for b in range(columns):
            np.einsum("mj,mj->j", x[:, :, a], y[:, :, b], out=out[:, a, b])
    return out
