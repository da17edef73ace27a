"""What effects of table, site and mounting would change in block means: the same motion at every gyro."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from fogreduce.diagnosis.inference.candidate import Candidate
from fogreduce.diagnosis.which.catalogue.builder import Builder
from fogreduce.effects.design import Design
from fogreduce.effects.model import Effect


def of_table(effect: Effect, design: Design, build: Builder) -> Iterator[Candidate]:
    """The effect at the table: a number, a vector, a wave, or a number in which it is not linear."""

    def column(**parameters: Any) -> Any:
        return build.difference([(effect.name, [effect.channels], parameters)])

    if design.steps:
        late = [column(**{design.scaled: size}) for size in design.steps]
        steps = np.array(design.steps)[:, None]
        others = np.full(len(late) - 1, design.rarer)
        weights = np.array([1.0 - others.sum(), *others]) if design.rarer else None
        points: list[dict[str, Any]] = [{} for _ in late]
        yield build.of_table(effect.name, late, 1, points, (design.scaled,), steps, weights=weights)
    elif design.vector:
        ways = [column(**{design.scaled: tuple(way)}) for way in (design.step * np.eye(3)).tolist()]
        names = tuple(f"{design.scaled}[{k}]" for k in range(3))
        yield build.of_table(effect.name, ways, 3, [{}], names, np.full((1, 3), design.step))
    else:
        grid = design.grid(build.longest_s)
        phases = [{design.wave: phase} for phase in (0.0, np.pi / 2)] if design.wave else [{}]
        columns = [
            column(**{design.scaled: design.step, **point, **phase}) for point in grid for phase in phases
        ]
        names = ("cos", "sin") if design.wave else (design.scaled,)
        steps = np.full((len(grid), len(phases)), design.step)
        yield build.of_table(effect.name, columns, len(phases), grid, names, steps)
