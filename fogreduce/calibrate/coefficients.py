"""What a calibration record says of each gyro in units that compare: deg/h, ppm, mrad; and how two differ."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fogreduce.constants import SECONDS_PER_HOUR
from fogreduce.metadata.calibration import CalibrationRecord
from fogreduce.physics.alignment import gyro_axes
from fogreduce.physics.frames import across

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Coefficients:
    """Bias, scale factor and axis of n gyros, each with one standard deviation.

    An axis of a record with H need not be of length 1: what counts is its length times the scale factor.

    Attributes
    ----------
    bias_deg_h, bias_std_deg_h : (n,) arrays
        By the record's own scale factor.
    scale_factor : (n,) array
        C times the axis' length [raw unit/(deg/s)].
    scale_factor_std_rel : (n,) array
        Relative.
    axes : (n, 3) array
        Unit vectors.
    axis_std_rad : (n,) array
        In each of two directions at right angles to the axis.
    turn_on_bias_deg_h : (n,) array
    stated : frozenset of str
        Of `bias`, `scale_factor_rel`, `axis_rad`, `turn_on_bias_deg_h`: which standard deviations the record
        states; the others are the project's defaults.
    """

    bias_deg_h: Array
    bias_std_deg_h: Array
    scale_factor: Array
    scale_factor_std_rel: Array
    axes: Array
    axis_std_rad: Array
    turn_on_bias_deg_h: Array
    stated: frozenset[str]

    @classmethod
    def of(cls, record: CalibrationRecord) -> Coefficients:
        """Those of a record."""
        axes = np.array(record.axes, float) if record.H is None else gyro_axes(np.array(record.H, float))
        lengths = np.linalg.norm(axes, axis=1)
        stated = record.stated_uncertainty
        scale = np.array(record.scale_factor) * lengths
        deg_h_per_raw = SECONDS_PER_HOUR / scale
        return cls(
            bias_deg_h=np.array(record.bias) * deg_h_per_raw,
            bias_std_deg_h=np.array(stated.bias) * np.abs(deg_h_per_raw),
            scale_factor=scale,
            scale_factor_std_rel=np.array(stated.scale_factor_rel),
            axes=axes / lengths[:, None],
            axis_std_rad=np.array(stated.axis_rad),
            turn_on_bias_deg_h=np.array(stated.turn_on_bias_deg_h),
            stated=frozenset(
                key.replace(record.raw_unit.bias_key, "bias")
                for key in record.uncertainty.model_dump(exclude_none=True)
            ),
        )


@dataclass(frozen=True)
class Change:
    """How much one coefficient of one gyro differs between two records.

    Attributes
    ----------
    gyro : int
        From 0.
    name, unit : str
    value, std : float
        Later less earlier; both records' standard deviations together, taken as independent.
    """

    gyro: int
    name: str
    unit: str
    value: float
    std: float

    @property
    def sigma(self) -> float:
        """The change in its standard deviations; 0 where neither record leaves anything open."""
        return abs(self.value) / self.std if self.std > 0 else 0.0


#: Coefficients that records are compared in, with their units.
NAMES = {"bias": "deg/h", "scale factor": "ppm", "axis, first": "mrad", "axis, second": "mrad"}


def changes(earlier: Coefficients, later: Coefficients) -> list[Change]:
    """Every coefficient's change, gyro after gyro; of records with the same number of gyros.

    The axis moves in two directions at right angles to the earlier one (`fogreduce.physics.frames.across`).
    """
    found = []
    for i in range(len(earlier.bias_deg_h)):
        tipped = np.array(across(earlier.axes[i])) @ (later.axes[i] - earlier.axes[i])
        axis_std = float(np.hypot(earlier.axis_std_rad[i], later.axis_std_rad[i])) * 1e3
        scale_std = np.hypot(earlier.scale_factor_std_rel[i], later.scale_factor_std_rel[i])
        values = (
            (
                later.bias_deg_h[i] - earlier.bias_deg_h[i],
                np.hypot(earlier.bias_std_deg_h[i], later.bias_std_deg_h[i]),
            ),
            ((later.scale_factor[i] / earlier.scale_factor[i] - 1) * 1e6, scale_std * 1e6),
            (tipped[0] * 1e3, axis_std),
            (tipped[1] * 1e3, axis_std),
        )
        found += [
            Change(i, name, unit, float(value), float(std))
            for (name, unit), (value, std) in zip(NAMES.items(), values, strict=True)
        ]
    return found
