"""What a campaign cannot determine: directions among the unknowns, in words, and the run that would.

The unknowns of the gyros are scaled by what would be no calibration (`Ignorance`), azimuth, latitude and
table rate known as stated. A direction in which the campaign does not at least halve that is not determined:
Earth's rate alone tells a little of everything, and would else make a record of a campaign about one axis.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse.csgraph import connected_components

from fogreduce.calibrate.coefficients import Coefficients
from fogreduce.calibrate.readings import Readings
from fogreduce.calibrate.solution import Layout, Solution
from fogreduce.constants import SECONDS_PER_HOUR
from fogreduce.estimate.uncertainty import axis_rates
from fogreduce.metadata.calibration import DEFAULT_UNCERTAINTY, CalibrationRecord
from fogreduce.physics.frames import across, unit_from_enu
from fogreduce.physics.table_motion import Profile

Array = NDArray[np.float64]

_TIMES = 10.0  # what is known ten times less well than usual is not calibrated
_HALVED = 4.0  # information, in units of 1 / ignorance^2, that halves a standard deviation
_PART = 0.02  # of the projector on what is open, from which on two parameters move together
_RUN_S, _RATE_DEG_S = 300.0, 10.0  # a run that is proposed
_STEPS = 200

#: What the parameters of a gyro are called, by its number from 1.
BIAS, SCALE_FACTOR = "gyro{}'s bias", "gyro{}'s scale factor"


def axis_words(gyro: int, direction: Array) -> str:
    """What a gyro's axis towards a direction (3,) across it is called; `gyro` from 0."""
    x, y, z = np.round(direction, 2) + 0.0  # no sign of a zero
    return f"gyro{gyro + 1}'s axis towards [{x:.2f}, {y:.2f}, {z:.2f}]"


@dataclass(frozen=True)
class Ignorance:
    """Standard deviations (n,) that would be no calibration; of the axis in each of two directions."""

    bias_deg_h: Array
    scale_factor_rel: Array
    axis_rad: Array

    @classmethod
    def of(cls, record: CalibrationRecord) -> Ignorance:
        """Ten times what the record states, or the project's default of a tactical-grade unit, if more."""
        stated = Coefficients.of(record)
        bias = np.maximum(stated.bias_std_deg_h, stated.turn_on_bias_deg_h)
        return cls(
            *(
                _TIMES * np.maximum(values, DEFAULT_UNCERTAINTY[key].value)
                for key, values in (
                    ("bias_deg_h", bias),
                    ("scale_factor_rel", stated.scale_factor_std_rel),
                    ("axis_rad", stated.axis_std_rad),
                )
            )
        )


@dataclass(frozen=True)
class Undetermined:
    """Parameters that the campaign leaves open together.

    Attributes
    ----------
    words : str
        The parameters.
    directions : int
        In how many ways they may move without the campaign's notice: as many as parameters, or fewer.
    parameters : int
        How many they are.
    """

    words: str
    directions: int
    parameters: int


def undetermined(solution: Solution, axes: Array, ignorance: Ignorance) -> list[Undetermined]:
    """What the campaign does not determine: sets of parameters that move together; `axes` (n, 3)."""
    basis, names = _scaled(solution.layout, axes, ignorance)
    values, vectors = np.linalg.eigh(basis.T @ _of_gyros(solution.information, solution.layout) @ basis)
    open_ways = vectors[:, values < _HALVED]
    projector = open_ways @ open_ways.T
    _, label = connected_components(np.abs(projector) > _PART, directed=False)
    found = []
    for k in dict.fromkeys(label.tolist()):
        inside = np.flatnonzero(label == k)
        directions = round(float(np.trace(projector[np.ix_(inside, inside)])))
        if directions:
            words = _joined([names[j] for j in inside])
            found.append(Undetermined(words, directions, inside.size))
    return found


def _of_gyros(information: Array, layout: Layout) -> Array:
    """Information of the gyros' unknowns, the motion's (last) eliminated."""
    k = layout.gyros * layout.per_gyro
    mixed = information[:k, k:]
    eliminated: Array = information[:k, :k] - mixed @ np.linalg.solve(information[k:, k:], mixed.T)
    return eliminated


def _scaled(layout: Layout, axes: Array, ignorance: Ignorance) -> tuple[Array, list[str]]:
    """Columns: each parameter's unit of ignorance in the gyros' unknowns; and its name."""
    columns, names = [], []

    def add(where: slice | int, value: Array | float, name: str) -> None:
        column = np.zeros(layout.gyros * layout.per_gyro)
        column[where] = value
        columns.append(column)
        names.append(name)

    for i in range(layout.gyros):
        add(layout.gyro(i).start, float(ignorance.bias_deg_h[i]), BIAS.format(i + 1))
        along = SECONDS_PER_HOUR * ignorance.scale_factor_rel[i] * axes[i]
        add(layout.vector(i), along, SCALE_FACTOR.format(i + 1))
        for direction in across(axes[i]):
            size = SECONDS_PER_HOUR * ignorance.axis_rad[i] * direction
            add(layout.vector(i), size, axis_words(i, direction))
    return np.array(columns).T, names


def _joined(names: list[str]) -> str:
    return names[0] if len(names) == 1 else ", ".join(names[:-1]) + " and " + names[-1]


def run_that_determines(
    found: Sequence[Undetermined],
    solution: Solution,
    axes: Array,
    ignorance: Ignorance,
    readings: Sequence[Readings],
) -> dict[str, Any] | None:
    """The run, of turns both ways and a standstill about x, y or z, that leaves least of it open.

    `axes` (n, 3): input axes by the present record.

    Returns
    -------
    dict or None
        ``table`` and ``orientation`` as run.yaml has them; None where nothing is open, or no run helps.
    """
    if not found:
        return None
    layout = solution.layout
    basis, _ = _scaled(layout, axes, ignorance)
    scaled = basis.T @ _of_gyros(solution.information, layout) @ basis
    best, least = None, np.count_nonzero(np.linalg.eigvalsh(scaled) < _HALVED)
    for axis, orientation in (
        ("x", {"x": "up", "z": "north"}),
        ("y", {"y": "up", "x": "north"}),
        ("z", {"z": "up", "y": "north"}),
    ):
        for rates in ((0.0,), (_RATE_DEG_S, -_RATE_DEG_S, 0.0)):
            more = _information(readings[0], solution, axis, orientation, rates)
            values = np.linalg.eigvalsh(scaled + basis.T @ more @ basis)
            left = np.count_nonzero(values < _HALVED)
            if left < least:
                least = left
                profile = [{"rate_deg_s": r, "duration_s": _RUN_S / len(rates)} for r in rates]
                best = {"table": {"axis": axis, "profile": profile}, "orientation": orientation}
    return best


def _information(
    one: Readings, solution: Solution, axis: str, orientation: dict[str, str], rates: tuple[float, ...]
) -> Array:
    """What a further run would add, its azimuth known: turn-on bias as the only error that counts."""
    layout = solution.layout
    profile = Profile(np.array(rates), np.full(len(rates), _RUN_S / len(rates)))
    facts = replace(
        one.facts,
        profile=profile,
        table_axis=np.eye(3)["xyz".index(axis)],
        unit_from_enu=unit_from_enu(orientation, 0.0),
    )
    time_s: Array = (np.arange(_STEPS, dtype=np.float64) + 0.5) * (_RUN_S / _STEPS)
    motion = axis_rates(facts, time_s)
    size = layout.gyros * layout.per_gyro
    information = np.zeros((size, size))
    for i in range(layout.gyros):
        columns = np.vstack((np.ones(_STEPS), motion))
        variance = solution.turn_on_deg_h[i] ** 2 + 1e-12
        where = np.arange(layout.gyro(i).start, layout.gyro(i).start + 4)
        # Each of the steps as exact as the turn-on bias: a run's mean cannot be better.
        information[np.ix_(where, where)] += columns @ columns.T / (variance * _STEPS)
    return information
