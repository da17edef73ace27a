"""A calibration record (schema fogreduce/calibration/1): immutable, chosen by id and validity.

Scale factors and biases stand in the unit of the raw readings, which their keys name: `bias_V`, `bias_deg_s`.
In the models they are `scale_factor` and `bias`; `record_in` makes the model of the records in one unit.
"""

from __future__ import annotations

import math
import os
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime
from functools import cache
from typing import Annotated, ClassVar, Literal, Self

from pydantic import Field, Strict, create_model, model_validator

from fogreduce.metadata.base import Model, Name, NotNegatives, Reals, Triple
from fogreduce.metadata.faults import contradictions
from fogreduce.metadata.instant import Instant, instant_text
from fogreduce.metadata.patterns import CALIBRATION_PATTERN
from fogreduce.metadata.pedigree import Covariance, Pedigree
from fogreduce.physics.raw_quantity import UNITS_IN_USE, RawUnit, RawUnitName


@dataclass(frozen=True)
class Default:
    """A value that stands in, for every gyro, where a record states none; and why that value."""

    value: float
    reason: str


#: Standard deviations where a record states none: those of a tactical-grade fibre-optic gyro (IEEE 952
#: terms). A record that states its own always wins.
DEFAULT_UNCERTAINTY = {
    "scale_factor_rel": Default(1e-4, "100 ppm: the usual scale-factor accuracy of a tactical-grade unit"),
    "bias_deg_h": Default(1.0, "1 deg/h: one calibration knows a bias no better than it repeats"),
    "axis_rad": Default(1e-4, "0.1 mrad (20 arcsec): what a unit's mounting face lets a table resolve"),
    "turn_on_bias_deg_h": Default(1.0, "1 deg/h: the usual turn-on repeatability of a tactical-grade unit"),
}

#: Noise where a record states none, of the same grade.
DEFAULT_NOISE = {
    "angle_random_walk_deg_sqrt_h": Default(
        0.05, "0.05 deg/sqrt(h): the middle of tactical-grade data sheets"
    ),
    "bias_instability_deg_h": Default(0.1, "0.1 deg/h: a tenth of the turn-on bias"),
    "rate_random_walk_deg_h_sqrt_h": Default(0.0, "none: data sheets rarely state one"),
}


class Uncertainty(Model):
    """Standard deviations, one a gyro."""

    scale_factor_rel: NotNegatives | None = Field(
        default=None, description="of the scale factors, relative (1 = 100 %)"
    )
    bias: NotNegatives | None = Field(default=None, description="of the biases [raw unit in use]")
    axis_rad: NotNegatives | None = Field(
        default=None,
        description="of each gyro axis' pointing, in each of two directions at right angles to it [rad]",
    )
    turn_on_bias_deg_h: NotNegatives | None = Field(
        default=None,
        description="how far a gyro's bias moves from one power-on, so one run, to the next [deg/h]",
    )


class Noise(Model):
    """What the unit is known to do when nothing is wrong (IEEE 952 terms), one value a gyro."""

    angle_random_walk_deg_sqrt_h: NotNegatives | None = Field(
        default=None, description="white noise [deg/sqrt(h)]"
    )
    bias_instability_deg_h: NotNegatives | None = Field(
        default=None,
        description="flicker: the flat of the Allan deviation divided by sqrt(2 ln 2 / pi) [deg/h]",
    )
    rate_random_walk_deg_h_sqrt_h: NotNegatives | None = Field(
        default=None, description="random walk of the rate [deg/h/sqrt(h)]"
    )


class StatedUncertainty(Model):
    """`Uncertainty` with the project's defaults where the record is silent."""

    scale_factor_rel: NotNegatives
    bias: NotNegatives
    axis_rad: NotNegatives
    turn_on_bias_deg_h: NotNegatives


class StatedNoise(Model):
    """`Noise` with the project's defaults where the record is silent."""

    angle_random_walk_deg_sqrt_h: NotNegatives
    bias_instability_deg_h: NotNegatives
    rate_random_walk_deg_h_sqrt_h: NotNegatives


class CalibrationRecord(Model):
    """One calibration of one unit of n >= 1 gyros; its models proper are those of `record_in`."""

    raw_unit: ClassVar[RawUnit]  #: Of the raw readings in use, which the record's keys name.

    schema_id: Literal["fogreduce/calibration/1"] = Field(alias="schema", description="format of this file")
    unit: Name = Field(description="the calibrated unit, equal to the folder's name")
    version: Name = Field(description="the record's version, equal to the file's name")
    valid_from: Instant = Field(description="from when on the record holds, with zone")
    valid_until: Instant | None = Field(default=None, description="until when it holds, with zone")
    procedure: str = Field(description="reference or certificate id")
    H: Annotated[tuple[Reals, Reals, Reals], Strict(False)] | None = Field(
        default=None,
        description="3 x n, gyro rates [deg/s] -> unit-frame rates [deg/s]; for three gyros or more",
    )
    axes: Annotated[tuple[Triple, ...], Strict(False)] | None = Field(
        default=None, description="n x 3 unit vectors in the unit frame, in place of H; for one or two gyros"
    )
    scale_factor: Reals = Field(description="C, per gyro [raw unit in use/(deg/s)], not zero")
    bias: Reals = Field(description="B, per gyro [raw unit in use]")
    uncertainty: Uncertainty = Field(default=Uncertainty(), description="standard deviations, per gyro")
    noise: Noise | None = Field(
        default=None, description="what the unit is known to do when nothing is wrong, per gyro"
    )
    supersedes: str | None = Field(
        default=None, pattern=CALIBRATION_PATTERN, description="the record that it takes the place of"
    )
    pedigree: Pedigree | None = Field(default=None, description="of a derived record: what it comes from")
    covariance: Covariance | None = Field(
        default=None, description="of a derived record: covariance of bias, scale factor and axes"
    )

    @classmethod
    def from_data(cls, data: object, file: str | os.PathLike[str]) -> CalibrationRecord:
        """Validate plain data read from `file`, in the unit that its keys name; BadInput with every fault."""
        if cls is not CalibrationRecord:
            return super().from_data(data, file)
        return record_in(_unit_named_by(data)).from_data(data, file)

    @property
    def n(self) -> int:
        """Number of gyros."""
        return len(self.scale_factor)

    @property
    def record_id(self) -> str:
        """``<unit>@<version>``."""
        return f"{self.unit}@{self.version}"

    @property
    def stated_uncertainty(self) -> StatedUncertainty:
        """Standard deviations, defaults filled in; the bias's default is a rate, carried through C."""
        defaults = {key: (default.value,) * self.n for key, default in DEFAULT_UNCERTAINTY.items()}
        rates = defaults.pop("bias_deg_h")
        defaults[self.raw_unit.bias_key] = tuple(
            rate / 3600.0 * abs(scale) for rate, scale in zip(rates, self.scale_factor, strict=True)
        )
        return _stated_in(self.raw_unit)(**(defaults | _stated(self.uncertainty)))

    @property
    def stated_noise(self) -> StatedNoise:
        """Noise, defaults filled in."""
        defaults = {key: (default.value,) * self.n for key, default in DEFAULT_NOISE.items()}
        return StatedNoise(**(defaults | _stated(self.noise)))

    def is_valid_at(self, instant: datetime) -> bool:
        """Whether the record holds at `instant`: from valid_from on, up to valid_until, both included."""
        return self.valid_from <= instant and (self.valid_until is None or instant <= self.valid_until)

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        if wrong := self._contradictions():
            raise contradictions(wrong)
        return self

    def _contradictions(self) -> list[tuple[str, str, str]]:
        """What does not fit together: (key, found, expected)."""
        n, wrong = self.n, []
        scale_factor_key = self.raw_unit.scale_factor_key
        lists = {self.raw_unit.bias_key: self.bias}
        for block in ("uncertainty", "noise"):
            for key, values in _stated(getattr(self, block)).items():
                lists[f"{block}.{key}"] = values
        for row, values in enumerate(self.H or ()):
            lists[f"H[{row}]"] = values
        for key, values in lists.items():
            if len(values) != n:
                wrong.append((key, f"{len(values)} values", f"{n}, as many as {scale_factor_key}"))
        for k, scale in enumerate(self.scale_factor):
            if scale == 0.0:
                wrong.append((f"{scale_factor_key}[{k}]", "0", "a scale factor other than zero"))
        if self.valid_until is not None and self.valid_until < self.valid_from:
            later = f"an instant after valid_from ({instant_text(self.valid_from)})"
            wrong.append(("valid_until", instant_text(self.valid_until), later))
        return wrong + (self._wrong_projection() if n >= 3 else self._wrong_axes())

    def _wrong_projection(self) -> list[tuple[str, str, str]]:
        """Faults of the geometry of three gyros or more."""
        wrong = []
        if self.axes is not None:
            wrong.append(("axes", "axes", f"H in place of axes, for a unit of {self.n} gyros"))
        if self.H is None:
            wrong.append(("H", "nothing", f"a matrix of 3 x {self.n}"))
        elif len({len(row) for row in self.H}) == 1 and not _independent(self.H):
            wrong.append(("H", "rows that depend on each other", "a matrix of rank 3"))
        return wrong

    def _wrong_axes(self) -> list[tuple[str, str, str]]:
        """Faults of the geometry of one or two gyros."""
        wrong = []
        if self.H is not None:
            wrong.append(("H", "H", f"axes in place of H, for a unit of {self.n} gyros (or 3 gyros or more)"))
        if self.axes is None:
            wrong.append(("axes", "nothing", f"{self.n} unit vectors"))
            return wrong
        if len(self.axes) != self.n:
            as_many = f"{self.n}, as many as {self.raw_unit.scale_factor_key}"
            wrong.append(("axes", f"{len(self.axes)} vectors", as_many))
        for k, axis in enumerate(self.axes):
            if abs(math.hypot(*axis) - 1.0) > 1e-6:
                wrong.append((f"axes[{k}]", f"a vector of length {math.hypot(*axis):.7g}", "one of length 1"))
        return wrong


@cache
def record_in(name: RawUnitName) -> type[CalibrationRecord]:
    """The model of calibration records whose raw readings are in a unit in use: its keys name the unit."""
    unit = UNITS_IN_USE[name]
    biases = Field(default=None, alias=unit.bias_key, description=f"of the biases [{name}]")
    uncertainty = create_model(
        f"Uncertainty_{unit.suffix}", __base__=Uncertainty, bias=(NotNegatives | None, biases)
    )
    scales = Field(alias=unit.scale_factor_key, description=f"C, per gyro [{name}/(deg/s)], not zero")
    model = create_model(
        f"CalibrationRecord_{unit.suffix}",
        __base__=CalibrationRecord,
        scale_factor=(Reals, scales),
        bias=(Reals, Field(alias=unit.bias_key, description=f"B, per gyro [{name}]")),
        uncertainty=(uncertainty, Field(default=uncertainty(), description="standard deviations, per gyro")),
    )
    model.raw_unit = unit
    return model


@cache
def _stated_in(unit: RawUnit) -> type[StatedUncertainty]:
    """The model of stated uncertainties with the bias's in a unit."""
    return create_model(
        f"StatedUncertainty_{unit.suffix}",
        __base__=StatedUncertainty,
        bias=(NotNegatives, Field(alias=unit.bias_key)),
    )


def _unit_named_by(data: object) -> RawUnitName:
    """The unit that the keys of a record name, the scale factor's first; V where none does."""
    given = data if isinstance(data, dict) else {}
    by_scale_factor = {unit.scale_factor_key: unit.name for unit in UNITS_IN_USE.values()}
    by_bias = {unit.bias_key: unit.name for unit in UNITS_IN_USE.values()}
    return next((name for key, name in (by_scale_factor | by_bias).items() if key in given), "V")


def _stated(block: Uncertainty | Noise | None) -> dict[str, tuple[float, ...]]:
    """What a block of the record states, by key."""
    return block.model_dump(exclude_none=True) if block else {}


def _independent(rows: Sequence[Sequence[float]]) -> bool:
    """Whether the rows are linearly independent (Gram-Schmidt; a part in 1e9 counts as none)."""
    basis: list[list[float]] = []
    for row in rows:
        rest = list(row)
        for unit in basis:
            along = math.fsum(a * b for a, b in zip(rest, unit, strict=True))
            rest = [a - along * b for a, b in zip(rest, unit, strict=True)]
        length = math.hypot(*rest)
        if not length > 1e-9 * math.hypot(*row):
            return False
        basis.append([a / length for a in rest])
    return True
