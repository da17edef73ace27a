"""run.yaml: the metadata of one run, as the capture contract has it (schema fogreduce/run/1)."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BeforeValidator, ConfigDict, Field, Strict, WithJsonSchema

from fogreduce.metadata.base import FileName, Model, Name, NotNegative, Sign, Triple
from fogreduce.metadata.capture import CaptureInfo
from fogreduce.metadata.faults import unexpected
from fogreduce.metadata.instant import Instant
from fogreduce.metadata.patterns import CALIBRATION_PATTERN
from fogreduce.units import microseconds_since_1970

#: Longest profile [s], some thirty years: beyond it a sum of seconds is no longer exact to the microsecond.
LONGEST_S = 1e9
FASTEST_DEG_S = 1e6

AxisName = Literal["x", "y", "z"]
Direction = Literal["up", "down", "north", "south", "east", "west"]

_AXES: dict[object, tuple[float, float, float]] = {
    "x": (1.0, 0.0, 0.0),
    "y": (0.0, 1.0, 0.0),
    "z": (0.0, 0.0, 1.0),
}
_LINE_OF = {"up": 2, "down": 2, "north": 1, "south": 1, "east": 0, "west": 0}


def _axis(value: object) -> object:
    """x, y, z as vectors; whatever else goes on to be validated as three numbers."""
    if isinstance(value, str):
        if value not in _AXES:
            raise unexpected("x, y, z or three numbers [ux, uy, uz]")
        return _AXES[value]
    if not isinstance(value, Iterable):
        raise unexpected("x, y, z or three numbers [ux, uy, uz]")
    return value


def _normalised(vector: tuple[float, float, float]) -> tuple[float, float, float]:
    length = math.hypot(*vector)
    if not 1e-150 < length < 1e150:
        raise unexpected("a vector with a direction")
    x, y, z = (part / length for part in vector)
    return x, y, z


def _perpendicular(orientation: dict[str, str]) -> dict[str, str]:
    first, second = orientation.values()
    if _LINE_OF[first] == _LINE_OF[second]:
        raise unexpected("two directions at right angles", found=f"{first} and {second}")
    return orientation


Axis = Annotated[
    Triple,
    AfterValidator(_normalised),
    BeforeValidator(_axis),
    WithJsonSchema(
        {
            "anyOf": [
                {"enum": ["x", "y", "z"]},
                {"type": "array", "items": {"type": "number"}, "minItems": 3, "maxItems": 3},
            ]
        }
    ),
]
Orientation = Annotated[
    dict[AxisName, Direction], Field(min_length=2, max_length=2), AfterValidator(_perpendicular)
]


class Site(Model):
    """Where the table stands."""

    latitude_deg: float = Field(ge=-90, le=90, description="geodetic latitude [deg], signed, north positive")
    longitude_deg: float | None = Field(
        default=None, ge=-180, le=360, description="longitude [deg], east positive"
    )
    height_m: float | None = Field(default=None, ge=-10_000, le=100_000, description="height [m]")
    name: str | None = Field(default=None, description="the site's name")
    latitude_uncertainty_deg: NotNegative = Field(
        default=0.001, description="standard deviation of the latitude [deg]"
    )
    magnetic_field_uT: Triple | None = Field(
        default=None,
        description="magnetic field at the unit [uT] along east, north, up: Earth's, a coil's with it",
    )


class ProfileStep(Model):
    """One commanded rate and how long it holds."""

    rate_deg_s: float = Field(
        ge=-FASTEST_DEG_S, le=FASTEST_DEG_S, description="commanded rate about the axis [deg/s], right-handed"
    )
    duration_s: float = Field(gt=0, le=LONGEST_S, description="how long the rate holds [s]")


class Table(Model):
    """The rate table: the axis that it turns the unit about, and the commanded rates."""

    axis: Axis = Field(
        description="x, y, z of the unit frame, or [ux, uy, uz], made a unit vector on reading"
    )
    profile: Annotated[tuple[ProfileStep, ...], Strict(False)] = Field(
        min_length=1, description="commanded rate, piecewise constant, in order"
    )
    rate_uncertainty_ppm: NotNegative = Field(
        default=5.0, description="standard deviation of the table's rate [ppm]"
    )


def _calibration_may_come_from_campaign(schema: dict[str, Any]) -> None:
    schema["required"] = [key for key in schema["required"] if key != "calibration"]


class Run(Model):
    """One run of a campaign (run.yaml)."""

    model_config = ConfigDict(json_schema_extra=_calibration_may_come_from_campaign)

    schema_id: Literal["fogreduce/run/1"] = Field(alias="schema", description="format of this file")
    run_id: Name = Field(description="the run's name, equal to its folder's")
    unit: Name = Field(description="the unit under test")
    started_at: Instant = Field(description="start of the record and of the profile, with zone")
    site: Site = Field(description="where the table stands")
    table: Table = Field(description="axis and commanded rates")
    orientation: Orientation = Field(
        description="two unit axes at t = 0, each one of up, down, north, south, east, west; "
        "the third completes a right-handed triad"
    )
    azimuth_deg: float = Field(
        default=0.0,
        ge=-3600,
        le=3600,
        description="the unit then turned about local up by this much [deg], clockwise seen from above",
    )
    azimuth_uncertainty_deg: NotNegative = Field(
        default=0.05, description="standard deviation of the azimuth [deg]"
    )
    frame_signs: Annotated[tuple[Sign, Sign, Sign], Strict(False)] = Field(
        default=(1, 1, 1), description="sign with which each projected axis x, y, z reads a positive rotation"
    )
    capture: CaptureInfo = Field(description="the raw capture")
    calibration: str = Field(
        pattern=CALIBRATION_PATTERN,
        description="calibration record, <unit>@<version>; may be left out where campaign.yaml gives one",
    )
    temperature: FileName | None = Field(
        default=None, description="temperature log (CSV), in the run's own folder"
    )
    table_log: FileName | None = Field(
        default=None, description="table encoder log (CSV), in the run's own folder"
    )
    notes: str | None = Field(default=None, description="free text")

    @property
    def start_us(self) -> int:
        """Start of the run, whole microseconds since 1970-01-01T00:00:00Z."""
        return microseconds_since_1970(self.started_at)

    @property
    def duration_s(self) -> float:
        """Length of the whole profile [s]."""
        return math.fsum(step.duration_s for step in self.table.profile)

    @property
    def n_expected(self) -> int:
        """Records that a complete capture holds: round(duration x rate)."""
        return round(self.duration_s * self.capture.sample_rate_hz)
