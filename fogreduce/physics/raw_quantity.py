"""The quantity that a unit's raw readings are: one entry a unit of run.yaml's `capture.raw_unit`.

Angle increments (deg, rad) are divided by the sample's interval when a capture is read; from there on the
unit in use is that of the rate. All other units are in use as they are captured.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, get_args

if TYPE_CHECKING:  # who only reads metadata does not pay for numpy
    import numpy as np
    from numpy.typing import NDArray

RawUnitName = Literal["V", "count", "deg/s", "deg/h", "rad/s", "deg", "rad"]


@dataclass(frozen=True)
class RawUnit:
    """A unit of raw readings, as it is in use after a capture has been read.

    Attributes
    ----------
    name, slope_name : str
        As run.yaml, figures and pages have it; of a reading, and of a reading a second.
    slope_suffix : str
        The latter in names of columns; `suffix` is the former in names of columns and keys.
    quantity : str
        What is read, in words, as a plural.
    variable, cf : str
        Name of the raw readings in datasets, and their unit there (CF conventions, UDUNITS).
    per_deg_s : float or None
        How many are 1 deg/s, the scale factor of an ideal digital unit; None where only a calibration tells.
    """

    name: RawUnitName
    slope_name: str
    slope_suffix: str
    quantity: str
    variable: str
    cf: str
    per_deg_s: float | None

    @property
    def suffix(self) -> str:
        """The unit in names of columns and keys."""
        return suffix_of(self.name)

    @property
    def scale_factor_key(self) -> str:
        """Key of the scale factors in a calibration record."""
        return f"scale_factor_{self.suffix}_per_deg_s"

    @property
    def bias_key(self) -> str:
        """Key of the biases in a calibration record, and of their uncertainty."""
        return f"bias_{self.suffix}"


UNITS_IN_USE: dict[RawUnitName, RawUnit] = {
    unit.name: unit
    for unit in (
        RawUnit("V", "V/s", "V_s", "volts", "volts", "V", None),
        RawUnit("count", "count/s", "count_s", "counts", "raw", "1", None),
        RawUnit("deg/s", "deg/s²", "deg_s2", "rates", "raw", "degree s-1", 1.0),
        RawUnit("deg/h", "deg/h/s", "deg_h_s", "rates", "raw", "degree hour-1", 3600.0),
        RawUnit("rad/s", "rad/s²", "rad_s2", "rates", "raw", "radian s-1", math.radians(1.0)),
    )
}
#: Unit of an angle increment over a sample -> unit in use.
INCREMENTS: dict[RawUnitName, RawUnitName] = {"deg": "deg/s", "rad": "rad/s"}

RAW_UNITS: tuple[RawUnitName, ...] = get_args(RawUnitName)


def suffix_of(name: RawUnitName) -> str:
    """A unit, also one of increments, in names of columns and keys."""
    return name.replace("/", "_")


def rate_from_increment(increment: NDArray[np.float64], interval_s: float) -> NDArray[np.float64]:
    """Mean rates over samples [deg/s or rad/s] from angle increments over them [deg or rad].

    Parameters
    ----------
    increment : array
        NaN where a gyro did not answer.
    interval_s : float
        Between two samples [s]; a sample's increment is over its own, whatever was lost before it.
    """
    return increment / interval_s


def unit_of_capture(capture: Mapping[str, Any]) -> RawUnit:
    """The unit in use of a capture, from run.yaml's `capture` as plain, validated data."""
    return unit_in_use(capture.get("raw_unit", "V"))


def unit_in_use(name: RawUnitName) -> RawUnit:
    """The unit in which readings captured in `name` are used, and stated by a calibration record."""
    return UNITS_IN_USE[INCREMENTS.get(name, name)]
