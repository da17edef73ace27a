"""How far a real effect may be from the catalogue's shape of it, as columns beside a fitted cause.

A real effect is not quite its name's formula: its size wanders slowly by some per cent, and a coil
follows its temperature sensor late and not in full. Each departure is a change of block means, one
standard deviation; what they do to fitted parameters belongs to the parameters' errors, and closure looks
where they would show.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fogreduce.datasets.logs import TemperatureLog
from fogreduce.diagnosis.inference.noise_model import Rows
from fogreduce.diagnosis.observe.capture import RunInput
from fogreduce.effects.selection import Action
from fogreduce.effects.table import EFFECTS
from fogreduce.estimate.smooth import smoothed

Array = NDArray[np.float64]

#: Root mean square by which an effect's size wanders in a run, relative.
WANDERS = 0.025
#: A coil's temperature: how late it follows its sensor [s], and how far its swing is from the sensor's.
LATE_S, SWING = 8.0, 0.02
#: What a log begins with, from which it is followed back [s].
_BEGINS_S = 10.0
#: Periods of the wandering, in lengths of a run.
_PERIODS = (0.4, 0.5, 2.0 / 3.0, 1.0, 2.0)
#: A second, slower decay: how much slower, and its share. A step's rise [s].
SLOWER, SLOW_SHARE, RISES_S = 3.0, 0.05, (2.0, 4.0)


def departures(inputs: Sequence[RunInput], actions: Sequence[Action], which: int, rows: Rows) -> Array:
    """Columns (rows, d) [deg/h], one standard deviation each, of one of the effects in the chain.

    Parameters
    ----------
    inputs : runs
    actions : effects in the chain
    which : int
        The one of them that is looked at.
    rows : Rows
    """
    effect = actions[which].effect
    if not effect.departures.wanders:
        return np.zeros((rows.total, 0))
    here = [one.scene.block_means(actions) for one in inputs]
    others = [a for k, a in enumerate(actions) if k != which]
    without = [one.scene.block_means(others) for one in inputs]
    change = rows.stacked([h - w for h, w in zip(here, without, strict=True)])
    if effect.departures.knee:
        return effect.departures.knee * change[:, None]
    columns = [wandering(inputs, change, rows)]
    if effect.needs_temperature:
        quiet = _felt(inputs, actions, here, _without_noise)
        late, later = (
            [felt - q for felt, q in zip(_felt(inputs, actions, here, way), quiet, strict=True)]
            for way in (_later, partial(_later, by_s=2.0 * LATE_S))
        )
        # a lateness squared: what follows how fast a temperature changes bends within it
        bent = [two - 2.0 * one for one, two in zip(late, later, strict=True)]
        for changes in (quiet, late, bent, _felt(inputs, actions, here, _at_start)):
            columns += _each_run(changes, rows)
        columns.append(SWING * change[:, None])
    for moved, share in _moved(actions, which):
        there = rows.stacked([one.scene.block_means(moved) for one in inputs])
        columns.append(share * (there - rows.stacked(here))[:, None])
    return np.column_stack(columns)


def lateness(inputs: Sequence[RunInput], actions: Sequence[Action], rows: Rows) -> tuple[Array, Array]:
    """What it adds that a coil follows its sensor late, (rows,) [deg/h]; and that each run counts from
    another temperature at its start, (rows, R).
    """
    here = [one.scene.block_means(actions) for one in inputs]
    late, start = (_felt(inputs, actions, here, felt) for felt in (_later, _at_start))
    return rows.stacked(late), np.column_stack(_each_run(start, rows))


def _moved(actions: Sequence[Action], which: int) -> list[tuple[list[Action], float]]:
    """The chain with the effect's decay slower, or its instant later, and how much of that there may be."""
    one, out = actions[which], []
    parameters = dict(one.parameters)
    changes: list[tuple[dict[str, Any], float]] = []
    if "tau_s" in parameters:
        changes.append(({"tau_s": SLOWER * parameters["tau_s"]}, SLOW_SHARE))
    if "time_s" in parameters:
        changes += [({"time_s": parameters["time_s"] + rise}, 1.0) for rise in RISES_S]
    for change, share in changes:
        moved = replace(one, parameters=parameters | change)
        out.append(([*actions[:which], moved, *actions[which + 1 :]], share))
    return out


def wandering(inputs: Sequence[RunInput], change: Array, rows: Rows) -> Array:
    """What an effect's change (rows,) [deg/h] adds when its size wanders, (rows, 2 x periods)."""
    columns = []
    for period in _PERIODS:
        for wave in (np.sin, np.cos):
            parts = []
            for one in inputs:
                blocks = one.scene.blocks
                turn = 2.0 * np.pi * blocks.centre_s / (period * blocks.count * blocks.length_s)
                parts.append(np.broadcast_to(wave(turn), (rows.n, blocks.count)))
            columns.append(rows.stacked(parts) * change)
    return np.column_stack(columns) * (WANDERS / np.sqrt(len(_PERIODS)))


def _each_run(changes: Sequence[Array], rows: Rows) -> list[Array]:
    """Changes (n, blocks) of each run as a column (rows, 1) of each."""
    nothing = [np.zeros_like(one) for one in changes]
    return [rows.stacked([*nothing[:r], one, *nothing[r + 1 :]])[:, None] for r, one in enumerate(changes)]


def _felt(
    inputs: Sequence[RunInput],
    actions: Sequence[Action],
    here: Sequence[Array],
    felt: Callable[[TemperatureLog], TemperatureLog],
) -> list[Array]:
    """What another temperature than the log's adds, (n, blocks) of each run; `here`: block means with the
    log.
    """
    out = []
    for one, before in zip(inputs, here, strict=True):
        log = one.scene.temperature
        scene = one.scene if log is None else replace(one.scene, temperature=felt(log))
        out.append(scene.block_means(actions) - before)
    return out


def _at_start(log: TemperatureLog) -> TemperatureLog:
    """The log with its first reading off, from which all others count: by noise, and by how far a late coil
    is from its sensor.
    """
    sensor, later = log.sensor_degC.copy(), log.sensor_at(log.time_s + LATE_S)
    inside = log.time_s + LATE_S <= log.time_s[-1]
    if inside.any():
        sensor[0] += np.sqrt(np.mean((later - sensor)[inside] ** 2))
    return replace(log, sensor_degC=sensor)


def _without_noise(log: TemperatureLog) -> TemperatureLog:
    """The log less the white noise of its readings, which a coil does not feel."""
    return replace(log, sensor_degC=smoothed(log.sensor_degC))


def _later(log: TemperatureLog, by_s: float = LATE_S) -> TemperatureLog:
    """The log, its noise gone, as a coil would follow it that is behind; before its start as it begins."""
    log = _without_noise(log)
    time, sensor = log.time_s, log.sensor_degC
    begins = time <= time[0] + _BEGINS_S
    slope = np.polyfit(time[begins] - time[0], sensor[begins], 1)[0] if begins.sum() > 1 else 0.0
    early = sensor[0] + slope * (time - by_s - time[0])
    return replace(log, sensor_degC=np.where(time - by_s >= time[0], log.sensor_at(time - by_s), early))


def doubted(effect: str, name: str, value: float, std: float) -> float:
    """A full-rate effect's standard deviation with its departures in it; `name`: of the parameter."""
    if name != EFFECTS[effect].parameters[0].name:
        return std
    real = EFFECTS[effect].departures
    return float(np.hypot(std * real.bursts, real.relative * value))
