"""The quantity that a unit's raw readings are: one entry a unit of run.yaml's `capture.raw_unit`.

Angle increments (deg, rad) are divided by the sample's interval when a capture is read; from there on the
unit in use is that of the rate. All other units are in use as they are captured.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal, get_args

RawUnitName = Literal["V", "count", "deg/s", "deg/h", "rad/s", "deg", "rad"]


@dataclass(frozen=True)
class RawUnit:
    """A unit of raw readings, as it is in use after a capture has been read.

    Attributes
    ----------
    name : str
        As run.yaml has it, and figures and pages name it.
    suffix, slope_suffix : str
        In names of columns and keys: of a reading, and of a reading a second.
    quantity : str
        What is read, in words.
    variable, cf : str
        Name of the raw readings in datasets, and their unit there (CF conventions, UDUNITS).
    per_deg_s : float or None
        How many are 1 deg/s, the scale factor of an ideal digital unit; None where only a calibration tells.
    """

    name: RawUnitName
    suffix: str
    slope_suffix: str
    quantity: str
    variable: str
    cf: str
    per_deg_s: float | None

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
        RawUnit("V", "V", "V_s", "volts", "volts", "V", None),
        RawUnit("count", "count", "count_s", "counts", "raw", "1", None),
        RawUnit("deg/s", "deg_s", "deg_s2", "rate", "raw", "degree s-1", 1.0),
        RawUnit("deg/h", "deg_h", "deg_h_s", "rate", "raw", "degree hour-1", 3600.0),
        RawUnit("rad/s", "rad_s", "rad_s2", "rate", "raw", "radian s-1", math.radians(1.0)),
    )
}
#: Unit of an angle increment over a sample -> unit in use.
INCREMENTS: dict[RawUnitName, RawUnitName] = {"deg": "deg/s", "rad": "rad/s"}

RAW_UNITS: tuple[RawUnitName, ...] = get_args(RawUnitName)


def unit_in_use(name: RawUnitName) -> RawUnit:
    """The unit in which readings captured in `name` are used, and stated by a calibration record."""
    return UNITS_IN_USE[INCREMENTS.get(name, name)]
