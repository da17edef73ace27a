"""How far a real effect may be from the catalogue's shape of it, as columns beside a fitted cause.

A real effect is not quite its name's formula: its size wanders slowly by some per cent, and a coil follows
its temperature sensor late and not in full. Each departure is a change of block means, one standard
deviation; what they do to fitted parameters belongs to the parameters' errors, and closure looks where they
would show.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from fogreduce.datasets.logs import TemperatureLog
from fogreduce.diagnosis.inference.noise_model import Rows
from fogreduce.diagnosis.observe.capture import RunInput
from fogreduce.effects.selection import Action
from fogreduce.effects.table import EFFECTS

Array = NDArray[np.float64]

#: Root mean square by which an effect's size wanders in a run, relative.
WANDERS = 0.025
#: A coil's temperature: how late it follows its sensor [s], and how far its swing is from the sensor's.
LATE_S, SWING = 8.0, 0.02
#: Periods of the wandering, in lengths of a run.
_PERIODS = (0.5, 1.0, 2.0)


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
        columns.append(np.column_stack([_late(inputs, actions, here, rows), SWING * change]))
    return np.column_stack(columns)


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


def _late(inputs: Sequence[RunInput], actions: Sequence[Action], here: Sequence[Array], rows: Rows) -> Array:
    """What it adds that a coil is late, (rows,); `here`: block means when it is not."""
    late = []
    for one in inputs:
        log = one.scene.temperature
        scene = one.scene if log is None else replace(one.scene, temperature=_later(log))
        late.append(scene.block_means(actions))
    return rows.stacked([m - p for m, p in zip(late, here, strict=True)])


def _later(log: TemperatureLog) -> TemperatureLog:
    """The log as a coil would follow it that is `LATE_S` behind; before its start as steadily as later."""
    time = log.time_s
    slope = (log.sensor_degC[-1] - log.sensor_degC[0]) / max(float(time[-1] - time[0]), 1e-9)
    early = log.sensor_degC[0] + slope * (time - LATE_S - time[0])
    seen = np.where(time - LATE_S >= time[0], log.sensor_at(time - LATE_S), early)
    return replace(log, sensor_degC=seen)


def doubted(effect: str, name: str, value: float, std: float) -> float:
    """A full-rate effect's standard deviation with its departures in it; `name`: of the parameter."""
    if name != EFFECTS[effect].parameters[0].name:
        return std
    real = EFFECTS[effect].departures
    return float(np.hypot(std * real.bursts, real.relative * value))
