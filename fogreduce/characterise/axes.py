"""The same turn about other axes: drift by axis and run, what is common, what follows the axis.

Drift of x, y, z in runs of the same profile. The two-way table of run and axis is split into what is common
to all, what belongs to an axis of the unit whichever it turns about, and what belongs to the axis that the
table turns (its own scale factor and the table's rate act there).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fogreduce.calibrate.readings import Readings
from fogreduce.characterise.left_out import LeftOut
from fogreduce.physics.frames import AXES

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Effect:
    """A part of the drift [deg/h] and its standard error by noise."""

    words: str
    value: float
    error: float


@dataclass(frozen=True)
class SameTurn:
    """Runs of one profile about several axes.

    Attributes
    ----------
    profile : str
    runs : list of str
    about : list of str
        Axis of the table in each.
    drift, error : (runs, 3) arrays
        [deg/h]
    effects : list of Effect
        Empty where the runs turn about one axis only.
    chi2, freedom : float, int
        Of what is left, by the errors of noise.
    """

    profile: str
    runs: list[str]
    about: list[str]
    drift: Array
    error: Array
    effects: list[Effect]
    chi2: float
    freedom: int


def same_turns(readings: Sequence[Readings], whole: Sequence[LeftOut]) -> list[SameTurn]:
    """Groups of runs with the same rates and durations, those about several axes first.

    Parameters
    ----------
    readings : sequence of Readings
    whole : sequence of LeftOut
        Of each run with all gyros.
    """
    groups: dict[str, list[int]] = {}
    for k, one in enumerate(readings):
        profile = one.facts.profile
        steps = zip(profile.rate_deg_s.tolist(), profile.duration_s.tolist(), strict=True)
        groups.setdefault(", ".join(f"{rate:g} deg/s for {length:g} s" for rate, length in steps), []).append(
            k
        )
    found = [_group(profile, rows, readings, whole) for profile, rows in groups.items()]
    return sorted(found, key=lambda one: -len(set(one.about)))


def _group(profile: str, rows: list[int], readings: Sequence[Readings], whole: Sequence[LeftOut]) -> SameTurn:
    about = [_axis_name(readings[k].facts.table_axis) for k in rows]
    drift = np.array([whole[k].drift_deg_h for k in rows])
    error = np.array([whole[k].drift_err_deg_h for k in rows])
    effects: list[Effect] = []
    chi2, freedom = 0.0, 0
    if len({name for name in about if name in AXES}) > 1:
        effects, chi2, freedom = _split(about, drift, error)
    return SameTurn(
        profile, [readings[k].facts.run_id for k in rows], about, drift, error, effects, chi2, freedom
    )


def _split(about: list[str], drift: Array, error: Array) -> tuple[list[Effect], float, int]:
    """Least squares: common; each axis less the common; the turning axis less the others."""
    columns, values, errors = [], [], []
    for k, name in enumerate(about):
        for axis in range(3):
            if np.isfinite(drift[k, axis]) and error[k, axis] > 0:
                # Axes sum to nothing: two columns for three.
                part = [[1.0, 0.0], [0.0, 1.0], [-1.0, -1.0]][axis]
                columns.append([1.0, *part, float(name == AXES[axis])])
                values.append(drift[k, axis])
                errors.append(error[k, axis])
    if len(values) < 5:
        return [], 0.0, 0
    weight = 1 / np.array(errors)
    matrix = np.array(columns) * weight[:, None]
    target = np.array(values) * weight
    solved, *_ = np.linalg.lstsq(matrix, target, rcond=None)
    covariance = np.linalg.pinv(matrix.T @ matrix)
    to = np.array([[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, -1, -1, 0], [0, 0, 0, 1]], dtype=np.float64)
    words = (
        "common to all",
        *(f"{axis} less the common" for axis in AXES),
        "the axis that turns, beyond that",
    )
    effects = [
        Effect(word, float(row @ solved), float(np.sqrt(row @ covariance @ row)))
        for word, row in zip(words, to, strict=True)
    ]
    left = target - matrix @ solved
    return effects, float(left @ left), len(values) - 4


def _axis_name(axis: Array) -> str:
    largest = int(np.argmax(np.abs(axis)))
    if abs(axis[largest]) > 1 - 1e-9:
        return ("" if axis[largest] > 0 else "-") + AXES[largest]
    return "[" + ", ".join(f"{part:.3g}" for part in axis) + "]"
