"""Rate steps of a run: a gyro's mean reading in each segment, with the covariance of noise within the run."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fogreduce.calibrate.derive import Derivation
from fogreduce.calibrate.equations import deg_h_per_raw, field, vertical
from fogreduce.calibrate.noise import covariance
from fogreduce.calibrate.readings import Readings
from fogreduce.calibrate.shapes import ACCELERATION, MAGNETIC, Shape

Array = NDArray[np.float64]

#: A gyro whose axis lies farther across the table's than this cosine says nothing of rate steps.
LEAST_COSINE = 0.2


@dataclass(frozen=True)
class Steps:
    """A gyro in a run of J segments.

    Attributes
    ----------
    run : str
    axis : str
        Table axis as text, runs of the same text are about the same axis.
    rate : (J,) array
        Commanded [deg/s].
    approached : (J,) array of int
        1 where the rate before was lower, -1 where it was higher (the table stands before the first).
    expected : (J,) array
        What the solution makes of the motion, bias apart: K times the input [deg/h].
    reading : (J,) array
        [deg/h] by the present scale factor.
    covariance : (J, J) array
        [(deg/h)^2].
    """

    run: str
    axis: str
    rate: Array
    approached: NDArray[np.intp]
    expected: Array
    reading: Array
    covariance: Array

    @property
    def full_scale(self) -> float:
        """Largest expected reading [deg/h]."""
        return float(np.abs(self.expected).max())


def steps_of(found: Derivation, gyro: int, shapes: Sequence[Shape] = ()) -> list[Steps]:
    """The steps of a gyro in every run that turns about its axis.

    What attitude and field add to its bias, as far as they are fitted (`shapes`), is taken away: in a turn
    they make a wave that does not average out over a step.
    """
    vector = found.solution.values[found.solution.layout.vector(gyro)]
    axis = vector / np.linalg.norm(vector)
    out = []
    for one in found.readings:
        if abs(axis @ one.facts.commanded_signs) < LEAST_COSINE:
            continue
        there = np.isfinite(one.raw[gyro])
        segments = np.unique(one.segment[there])
        if there.sum() < 2 or segments.size < 2:
            continue
        segment = one.segment[there]
        mean = np.array([(segment == k) / np.sum(segment == k) for k in segments])
        reading = one.raw[gyro, there] * deg_h_per_raw(one, gyro) - _of_place(one, gyro, shapes)[there]
        rates = one.facts.profile.rate_deg_s
        before = np.concatenate(([0.0], rates))[segments]
        out.append(
            Steps(
                one.facts.run_id,
                " ".join(f"{part:.6f}" for part in one.facts.table_axis),
                rates[segments],
                np.sign(rates[segments] - before).astype(np.intp),
                mean @ (vector @ one.motion[:, there]),
                mean @ reading,
                mean @ covariance(one, gyro, found.noise[gyro]) @ mean.T,
            )
        )
    return out


def _of_place(one: Readings, gyro: int, shapes: Sequence[Shape]) -> Array:
    """What acceleration and magnetic field add to a gyro's reading, (m,) [deg/h]."""
    value = {shape.name: shape.value for shape in shapes if shape.gyro == gyro}
    by_acceleration = np.array([value.get(name, 0.0) for name in ACCELERATION]) @ vertical(one)
    added: Array = by_acceleration + value.get(MAGNETIC, 0.0) * (one.facts.axes[gyro] @ field(one))
    return added


def line(steps: Steps) -> tuple[Array, Array]:
    """Residuals of the readings from their least-squares straight line in the input, and their covariance.

    All points alike, as IEEE 952 has it.
    """
    columns = np.column_stack((np.ones(steps.rate.size), steps.expected / max(steps.full_scale, 1e-12)))
    project = np.eye(steps.rate.size) - columns @ np.linalg.pinv(columns)
    # Taken from what is expected, so that no digits are lost.
    residual = project @ (steps.reading - steps.expected)
    return residual, project @ steps.covariance @ project.T


def scale_factor_of(steps: Steps) -> tuple[float, float] | None:
    """Scale factor of a run over the solution's, less 1, and its standard deviation; None for one rate."""
    if np.ptp(steps.expected) < 1e-3 * max(steps.full_scale, 1e-12) or steps.full_scale == 0:
        return None
    columns = np.column_stack((np.ones(steps.rate.size), steps.expected))
    weight = np.linalg.inv(steps.covariance)
    inverse = np.linalg.inv(columns.T @ weight @ columns)
    slope = inverse @ columns.T @ weight @ (steps.reading - steps.expected)
    return float(slope[1]), float(np.sqrt(inverse[1, 1]))


def staircases(steps: Sequence[Steps], rates: int) -> list[Steps]:
    """Runs of at least so many different rates."""
    return [one for one in steps if np.unique(one.rate).size >= rates]
