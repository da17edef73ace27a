"""What candidates are built with: the simulator's own chain with effects in it, and the filter that whitens.

Columns are finite differences of the chain about one that may have effects in it already.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from fogreduce.diagnosis.inference.candidate import EVERY, Array, Candidate
from fogreduce.diagnosis.inference.noise_model import Whitener
from fogreduce.diagnosis.observe.capture import RunInput
from fogreduce.effects.gyro_names import gyro_name
from fogreduce.effects.selection import Action, action


class Builder:
    """Builds candidates about a chain that may have effects in it already.

    Parameters
    ----------
    inputs : runs
    whiten : Whitener
    base : actions
        In the chain already.
    allowed : names of effects
    rails : mapping
        Gyro -> volts at which its converter seems to rest.
    former : Builder or None
        One of the same runs: what does not go with the whitening is taken from it.

    Attributes
    ----------
    of_volts : dict
        (effect, gyro) -> raw readings, and what a function of them adds, unwhitened: of the last chain.
    """

    def __init__(
        self,
        inputs: Sequence[RunInput],
        whiten: Whitener,
        base: Sequence[Action],
        allowed: frozenset[str],
        rails: Mapping[int, float],
        former: Builder | None = None,
    ) -> None:
        self.inputs, self.whiten, self.base = inputs, whiten, list(base)
        self.allowed, self.rails = allowed, rails
        self.n = inputs[0].facts.n_gyros
        self.ids = [one.facts.run_id for one in inputs]
        self.plain = [one.scene.block_means(base) for one in inputs]
        self.warm = all(one.scene.temperature is not None for one in inputs)
        self.turning = [bool(np.any(one.facts.profile.rate_deg_s != 0.0)) for one in inputs]
        self.names = [gyro_name(i) for i in range(self.n)]
        alike = former is not None and former.base == self.base
        self._changes: dict[str, Array] = former._changes if former is not None and alike else {}
        self.of_volts: dict[tuple[str, int], tuple[Array, Array]] = {} if former is None else former.of_volts
        self.longest_s = max(one.scene.blocks.count * one.scene.blocks.length_s for one in inputs)

    def difference(self, specs: Sequence[tuple[str, Sequence[str], Mapping[str, Any]]]) -> Array:
        """What effects (name, channels, parameters) together change, unwhitened: (rows,) [deg/h]."""
        key = repr(specs)
        if key not in self._changes:
            actions = [
                action(effect, channels, self.ids, parameters, self.n)
                for effect, channels, parameters in specs
            ]
            changed = [
                one.scene.block_means([*self.base, *actions]) - before
                for one, before in zip(self.inputs, self.plain, strict=True)
            ]
            self._changes[key] = self.whiten.rows.stacked(changed)
        return self._changes[key]

    def per_gyro(self, effect: str, parameters: Mapping[str, Any]) -> Array:
        """What an effect alike at every gyro changes, unwhitened: (rows,) [deg/h]."""
        return self.difference([(effect, self.names, parameters)])

    def gyro_columns(self, i: int, columns: Sequence[Array], run: int | None = None) -> Array:
        """Whitened rows of gyro i of unwhitened columns (rows,): (rows of i, number of columns)."""
        part = self.whiten.rows.of(i, run)
        return self.whiten(np.column_stack([column[part] for column in columns]), part)

    def at_gyro(self, effect: str, i: int, columns: Array, **others: Any) -> Candidate:
        """A candidate at gyro i from whitened columns (rows of i, J, k)."""
        given: dict[str, Any] = {
            "effect": effect,
            "channels": (self.names[i],),
            "runs": EVERY,
            "rows": self.whiten.rows.of(i),
            "columns": columns,
            "grid": ({},) * columns.shape[1],
            "scales": (),
            "steps": np.ones(columns.shape[1:]),
            "share": 1.0 / self.n,
        }
        return Candidate(**{**given, **others})

    def of_table(
        self,
        effect: str,
        columns: Sequence[Array],
        k: int,
        grid: Sequence[Mapping[str, Any]],
        scales: tuple[str, ...],
        steps: Array,
        **others: Any,
    ) -> Candidate:
        """A candidate of the table from unwhitened columns, k for each point of the grid."""
        white = self.whiten(np.column_stack(columns)).reshape(-1, len(grid), k)
        rows = slice(0, self.whiten.rows.total)
        return Candidate(
            effect, ("table",), EVERY, rows, white, tuple(grid), scales, steps, stage="table", **others
        )
