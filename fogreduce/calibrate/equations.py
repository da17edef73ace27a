"""The normal equations of a campaign: each gyro of each run brought to a small matrix, once.

A gyro reads ``v = B + s . Omega + t + noise`` with ``s = C G`` (a vector along its axis as long as its scale
factor), t its turn-on bias of that run, and Omega the motion that table and Earth give the unit's axes. That
is linear in B and s. Azimuth, latitude and table rate move Omega; their columns are s times what one standard
deviation of each adds to it, so they follow from nine columns that do not depend on s.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fogreduce.calibrate.noise import GyroNoise, covariance
from fogreduce.calibrate.readings import Readings
from fogreduce.constants import SECONDS_PER_HOUR
from fogreduce.physics.frames import seen_by_unit, up_in_unit

Array = NDArray[np.float64]

_UT_PER_MT = 1e3

#: Departures from a linear scale factor and a constant bias, per gyro; M is the rate about its axis [deg/s].
SHAPES = (
    *("asymmetry", "quadratic", "cubic", "temperature_bias", "temperature_scale_factor"),
    *("electronics_bias", "warming_bias", "acceleration_x", "acceleration_y", "acceleration_z"),
    "magnetic",
)

#: Columns of a gyro in a run: 1; Omega; its nine departures (source, axis); the shapes; the reading, less
#: what the present record makes of it (products of whole readings, 36 000 deg/h, are rounded at 1e-6 deg/h).
ONE, MOTION, DEPARTURE = 0, slice(1, 4), slice(4, 13)
SHAPE, READING = slice(13, 13 + len(SHAPES)), 13 + len(SHAPES)


@dataclass(frozen=True)
class Product:
    """A gyro in a run: products of its whitened columns.

    Attributes
    ----------
    run, gyro : int
    gram : (k, k) array
        ``X' V^-1 X`` of the columns above, the reading among them; V is the noise within the run.
    log_det : float
        ln det V.
    bins : int
    """

    run: int
    gyro: int
    gram: Array
    log_det: float
    bins: int


def products(readings: Sequence[Readings], noise: Sequence[GyroNoise]) -> list[Product]:
    """Products of every gyro in every run; a gyro that gave nothing in a run is left out.

    Readings are in deg/h by the present scale factor (`deg_h_per_raw`).
    """
    found = []
    for k, one in enumerate(readings):
        for i in range(one.facts.n_gyros):
            there = np.isfinite(one.raw[i])
            if np.count_nonzero(there) < 2:
                continue
            lower = np.linalg.cholesky(covariance(one, i, noise[i]))
            whitened = np.linalg.solve(lower, columns(one, i, there))
            log_det = 2 * float(np.sum(np.log(np.diag(lower))))
            found.append(Product(k, i, whitened.T @ whitened, log_det, int(np.count_nonzero(there))))
    return found


def columns(one: Readings, gyro: int, there: NDArray[np.bool_]) -> Array:
    """The columns of a gyro in a run, (bins, k), at the bins `there` (m,).

    Readings in deg/h by the present scale factor, less the present record's bias and rate.
    """
    facts = one.facts
    motion = one.motion[:, there]
    rate = facts.axes[gyro] @ motion
    warmer, electronics, warming = (
        np.zeros(rate.size) if log is None else log[there]
        for log in (one.temperature, one.electronics, one.warming)
    )
    unit = deg_h_per_raw(one, gyro)
    reading = (one.raw[gyro, there] - facts.bias[gyro]) * unit - SECONDS_PER_HOUR * rate
    up = vertical(one)[:, there]
    magnetic = facts.axes[gyro] @ field(one)[:, there]
    shapes = (np.abs(rate), rate**2, rate**3, warmer, warmer * rate, electronics, warming, *up, magnetic)
    departure = one.departure[:, :, there].reshape(9, -1)
    return np.column_stack((np.ones(rate.size), *motion, *departure, *shapes, reading))


def vertical(one: Readings) -> Array:
    """Local vertical in the unit frame, (3, m): the acceleration that a unit at rest senses [g]."""
    facts = one.facts
    return seen_by_unit(facts.table_axis, up_in_unit(facts.unit_from_enu), facts.profile.angle_at(one.time_s))


def field(one: Readings) -> Array:
    """Magnetic field in the unit frame, (3, m) [mT]; 0 where run.yaml states none."""
    facts, stated = one.facts, one.run.site.magnetic_field_uT
    vector = facts.unit_from_enu @ np.array(stated or (0.0, 0.0, 0.0)) / _UT_PER_MT
    return seen_by_unit(facts.table_axis, vector, facts.profile.angle_at(one.time_s))


def deg_h_per_raw(one: Readings, gyro: int) -> float:
    """deg/h that one unit of the raw reading stands for, by the present record: the unit of the equations."""
    return float(SECONDS_PER_HOUR / one.facts.scale_factor[gyro])
