"""What effects at a gyro would change in block means: in all runs, or in one of them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from fogreduce.diagnosis.inference.candidate import EVERY, Array, Candidate
from fogreduce.diagnosis.which.catalogue.builder import Builder
from fogreduce.effects.design import Design
from fogreduce.effects.model import Effect
from fogreduce.physics.frames import across

#: Prior share of an amount that all gyros have in common.
_ALIKE = 0.05
_QUARTER = np.pi / 2


def at_gyros(effect: Effect, design: Design, build: Builder) -> Iterator[Candidate]:
    """At each gyro, from each other one where it takes two, and of all of them alike."""
    for shift in range(1, build.n) if effect.other else (0,):
        others = [build.names[(i + shift) % build.n] for i in range(build.n)]
        grid = design.grid(build.longest_s)
        columns = [c for point in grid for c in _columns(effect, design, build, point, others)]
        if not any(np.any(np.abs(c) > design.least_deg_h) for c in columns):
            continue
        k = len(columns) // len(grid)
        scales = _scales(design, k)
        steps = np.full((len(grid), k), design.step)
        for i in range(build.n):
            white = build.gyro_columns(i, columns).reshape(-1, len(grid), k)
            given: dict[str, Any] = {}
            if effect.other:
                source = {effect.other: others[i]}
                points: tuple[Mapping[str, Any], ...] = tuple({**point, **source} for point in grid)
                given = {"share": 1.0 / build.n / (build.n - 1), "extra": source}
            else:
                points = grid
            if design.vector == "across":
                given["extra"] = {"tips": across(build.inputs[0].facts.axes[i])}
            given |= {"grid": points, "scales": scales, "steps": steps, "positive": design.positive}
            yield build.at_gyro(effect.name, i, white, **given)
        if design.alike and build.n > 1:
            yield _of_all(effect, design, build, columns[0])


def _columns(
    effect: Effect, design: Design, build: Builder, point: Mapping[str, Any], others: Sequence[str]
) -> list[Array]:
    """Differences of the chain at one point of the grid, every gyro with its own: (rows,) each."""
    name, scaled = design.like or (effect.name, design.scaled)
    if effect.other:
        own = [{scaled: design.step, effect.other: other, **point} for other in others]
        return [build.difference([(name, [g], p) for g, p in zip(build.names, own, strict=True)])]
    if design.vector == "across":
        tips = [across(axis) for axis in build.inputs[0].facts.axes]
        return [
            build.difference(
                [
                    (name, [gyro], {scaled: tuple((design.step * tip[k]).tolist()), **point})
                    for gyro, tip in zip(build.names, tips, strict=True)
                ]
            )
            for k in range(2)
        ]
    size = {scaled: design.step, **point}
    if design.vector == "room":
        size_along = [{**size, design.along: tuple(way)} for way in np.eye(3).tolist()]
        return [build.per_gyro(name, given) for given in size_along]
    if design.wave:
        return [build.per_gyro(name, {**size, design.wave: phase}) for phase in (0.0, _QUARTER)]
    return [build.per_gyro(name, size)]


def _scales(design: Design, k: int) -> tuple[str, ...]:
    """What the columns scale."""
    if design.wave:
        return ("cos", "sin")
    named = {"across": "tip", "room": "field"}.get(design.vector)
    return tuple(f"{named}[{j}]" for j in range(k)) if named else (design.scaled,)


def _of_all(effect: Effect, design: Design, build: Builder, column: Array) -> Candidate:
    """One amount that all gyros share."""
    return Candidate(
        effect.name,
        tuple(build.names),
        EVERY,
        slice(0, build.whiten.rows.total),
        build.whiten(column[:, None])[:, None, :],
        ({},),
        (design.scaled,),
        np.array([[design.step]]),
        share=_ALIKE,
    )


def in_single_runs(effect: Effect, design: Design, build: Builder) -> Iterator[Candidate]:
    """At each gyro in each run: a constant, from some instant on where it begins at one."""
    rows, runs = build.whiten.rows, len(build.ids)
    stepped: dict[int, Array] = {}
    for i in range(build.n):
        for r, run_id in enumerate(build.ids):
            matrix = build.whiten.filters[i, r]
            given: dict[str, Any] = {
                "runs": (run_id,),
                "rows": rows.of(i, r),
                "scales": (design.scaled,),
                "share": 1.0 / build.n / runs,
            }
            if not design.begins:
                yield build.at_gyro(effect.name, i, matrix.sum(axis=1)[:, None, None], **given)
            elif len(matrix) > 2:
                if id(matrix) not in stepped:
                    # a unit step at each block's start, whitened: sums of the filter's columns from there on
                    stepped[id(matrix)] = np.cumsum(matrix[:, ::-1], axis=1)[:, ::-1][:, 1:]
                length = build.inputs[r].scene.blocks.length_s
                times = ((np.arange(len(matrix) - 1) + 1) * length).tolist()
                given["grid"] = tuple({design.begins: time} for time in times)
                yield build.at_gyro(effect.name, i, stepped[id(matrix)][:, :, None], **given)
