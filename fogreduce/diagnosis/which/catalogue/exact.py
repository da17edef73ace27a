"""Functions of a reading or voltage, and exact differences: a dead zone, a converter's error, clipping,
a wrong sense, a turned sign, exchanged gyros.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from itertools import groupby

import numpy as np

from fogreduce.constants import SECONDS_PER_HOUR
from fogreduce.diagnosis.inference.candidate import EVERY, Array, Candidate
from fogreduce.diagnosis.observe.capture import RunInput
from fogreduce.diagnosis.which.catalogue.builder import Builder
from fogreduce.effects.at import At, Place
from fogreduce.effects.design import Design
from fogreduce.effects.model import Effect, Stage
from fogreduce.simulate.forward import ForwardRun
from fogreduce.simulate.streams import stream

#: Levels that the raw reading has to take, apart by this share of the largest: amplitude and period are two.
_FEWEST_LEVELS, _APART = 4, 1.0 / 64.0


def of_reading(effect: Effect, design: Design, build: Builder) -> Iterator[Candidate]:
    """What a function of the reading alone does, of sizes up to the largest; each kind is a candidate."""
    grid = design.grid(max(float(np.abs(p).max()) for p in build.plain))
    kinds = [p.name for p in effect.parameters if p.kind == "choice"]
    every = [list(points) for _, points in groupby(grid, key=lambda point: [point[name] for name in kinds])]
    for points in every:
        parts = []
        for one in build.inputs:
            blocks, place = one.scene.blocks, Place("", 0, (), build.n, partial(stream, 0, "gap"))
            early = [a for a in build.base if a.effect.stage < effect.stage]
            forward = ForwardRun(one.facts, None, early, one.scene.temperature, turning=one.scene.turning)
            m = forward.readings(blocks.time_s)
            at = At(place, blocks.time_s, 1.0, forward.motion, forward.axes[0], None, m, m[0])
            changes = [blocks.means(effect.forward(m, point, at) - m) for point in points]
            parts.append(np.array(changes) * SECONDS_PER_HOUR)
        for i in range(build.n):
            columns = np.concatenate([part[:, i] for part in parts], axis=1).T
            if np.any(columns):
                white = build.whiten(columns, build.whiten.rows.of(i))[:, :, None]
                share = 1.0 / len(every) / build.n
                yield build.at_gyro(effect.name, i, white, grid=tuple(points), fixed=True, share=share)


def of_volts(effect: Effect, design: Design, build: Builder) -> Iterator[Candidate]:
    """What a function of the raw reading alone adds, scaled; its grid is in shares of the largest.

    Where the raw reading hardly takes more values than the function has numbers, it is any constant of them,
    and not looked for.
    """
    size, shape = design.scaled, next(name for name in design.grid(build.longest_s)[0])
    shares = [point[shape] for point in design.grid(build.longest_s)]
    volts = [_volts(effect, one, build) for one in build.inputs]
    for i in range(build.n):
        means = np.concatenate(
            [one.scene.blocks.means(v[i]) for one, v in zip(build.inputs, volts, strict=True)]
        )
        largest = float(np.abs(means).max())
        if _levels(np.abs(means) / largest) < _FEWEST_LEVELS:
            continue
        grid = tuple({shape: share * largest} for share in shares)
        points = [{size: design.step, **point} for point in grid]
        added = _added(effect, points, i, volts, build)
        white = build.whiten(added, build.whiten.rows.of(i))[:, :, None]
        steps = np.full((len(grid), 1), design.step)
        yield build.at_gyro(effect.name, i, white, grid=grid, scales=(size,), steps=steps)


def _added(
    effect: Effect, points: Sequence[Mapping[str, float]], i: int, volts: Sequence[Array], build: Builder
) -> Array:
    """What a function of the raw readings (n, samples) of each run adds at gyro i.

    Unwhitened, (rows of i, points) [deg/h]; worked out once for the same readings.
    """
    asked = np.concatenate([v[i] for v in volts])
    there = build.of_volts.get((effect.name, i))
    if there is not None and np.array_equal(there[0], asked):
        return there[1]
    parts = []
    for one, v in zip(build.inputs, volts, strict=True):
        place, motion = Place("", i, (), build.n, partial(stream, 0, "gap")), one.scene.turning.motion
        at = At(place, one.scene.blocks.time_s, 1.0, motion, one.facts.axes[i], None, v, v[i])
        # a table that stands or turns evenly gives few readings, many times over
        levels, back = np.unique(v[i], return_inverse=True)
        added = [effect.forward(levels, point, at) - levels for point in points]
        per_volt = SECONDS_PER_HOUR / float(one.facts.polarity[i] * one.facts.scale_factor[i])
        parts.append(one.scene.blocks.means(np.take(added, back, axis=1)).T * per_volt)
    build.of_volts[effect.name, i] = asked, np.concatenate(parts)
    return build.of_volts[effect.name, i][1]


def _volts(effect: Effect, one: RunInput, build: Builder) -> Array:
    """Raw readings (n, samples) that an effect is handed in a run, at the times its blocks are asked at."""
    early = [a for a in build.base if a.effect.stage < effect.stage and a.effect.stage != Stage.FILTER]
    forward = ForwardRun(one.facts, None, early, one.scene.temperature, turning=one.scene.turning)
    return forward.volts(forward.readings(one.scene.blocks.time_s))


def _levels(values: Array) -> int:
    """How many groups of values (N,), within 0 to 1, lie apart from each other."""
    return 1 + int(np.sum(np.diff(np.sort(values)) > _APART))


def of_range(effect: Effect, design: Design, build: Builder) -> Iterator[Candidate]:
    """A limit at each gyro: where its converter seems to rest, or at shares of its largest reading."""
    facts, name = build.inputs[0].facts, effect.parameters[0].name
    shares = [point[name] for point in design.grid(build.longest_s)]
    limits = []
    for i in range(build.n):
        largest = max(
            float(np.abs(p[i]).max()) / SECONDS_PER_HOUR * abs(facts.scale_factor[i]) for p in build.plain
        )
        limits.append([build.rails[i]] if i in build.rails else [share * largest for share in shares])
    # what clips one gyro changes no other: all are clipped at once
    columns = [
        build.difference(
            [
                (effect.name, [gyro], {name: own[min(k, len(own) - 1)]})
                for gyro, own in zip(build.names, limits, strict=True)
            ]
        )
        for k in range(max(len(own) for own in limits))
    ]
    for i, own in enumerate(limits):
        white = build.gyro_columns(i, columns[: len(own)])[:, :, None]
        yield build.at_gyro(effect.name, i, white, grid=tuple({name: v} for v in own), fixed=True)


def of_wiring(effect: Effect, design: Design, build: Builder) -> Iterator[Candidate]:
    """What is there or not: at the table, at each gyro, or between two of them."""
    if effect.channels != "gyro":
        yield _there(effect, build, effect.channels, 1.0, {})
        return
    for i, name in enumerate(build.names):
        if not effect.other:
            yield _there(effect, build, name, 1.0 / build.n, {})
            continue
        for other in build.names[i + 1 :]:
            yield _there(effect, build, name, 2.0 / build.n / (build.n - 1), {effect.other: other})


def _there(
    effect: Effect, build: Builder, channel: str, share: float, parameters: dict[str, str]
) -> Candidate:
    one = build.difference([(effect.name, [channel], parameters)])
    return Candidate(
        effect.name,
        (channel,),
        EVERY,
        slice(0, build.whiten.rows.total),
        build.whiten(one[:, None])[:, None, :],
        (parameters,),
        (),
        np.ones((1, 1)),
        fixed=True,
        share=share,
        stage="table" if channel == "table" else "link",
        extra=parameters,
    )
