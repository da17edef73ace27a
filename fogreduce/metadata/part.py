"""A part file (schema fogreduce/part/1): what a data sheet says of a class of gyros, each with its meaning.

It fills in what a calibration record does not state, and gives a diagnosis the sizes that units of the class
show. What the record states stands.
"""

from __future__ import annotations

import os
from pathlib import Path
from typing import Annotated, Literal

from pydantic import Field

from fogreduce.errors import BadInput
from fogreduce.metadata.assumed import Assumed
from fogreduce.metadata.base import Model
from fogreduce.metadata.calibration import CalibrationRecord, Noise
from fogreduce.physics.low_pass import bandwidth_hz
from fogreduce.physics.noise import flicker_allan

#: Parts that come with the package, by name.
BUNDLED = {path.stem: path for path in sorted((Path(__file__).parent / "parts").glob("*.yaml"))}

#: A maximum of a data sheet is taken as so many standard deviations: what nearly every unit keeps.
MAXIMUM_SIGMAS = 3.0
#: The flat of the Allan deviation over the coefficient B of flicker (IEEE Std 952, annex C).
ALLAN_FLAT = flicker_allan(1.0)
#: Sizes that units of a class show: from and to so many of the sheet's standard deviations.
_SHOWN = (0.1, 3.0)

Size = Annotated[float, Field(gt=0, le=1e9)]


class Figure(Model):
    """One figure of a data sheet."""

    value: Size = Field(description="the figure, in the unit that its key names")
    meaning: Literal["one_sigma", "rms", "typical", "maximum", "allan_minimum"] = Field(
        description="one standard deviation, root mean square, typical, what no unit exceeds, or the flat of "
        "the Allan deviation"
    )

    @property
    def sigma(self) -> float:
        """As a standard deviation."""
        return self.value / MAXIMUM_SIGMAS if self.meaning == "maximum" else self.value

    @property
    def level(self) -> float:
        """As the level of a noise: a maximum is the level to be reckoned with."""
        return self.value / ALLAN_FLAT if self.meaning == "allan_minimum" else self.value


def _figure(text: str) -> Figure | None:
    field: Figure | None = Field(default=None, description=text)
    return field


class Part(Model):
    """A class of gyros, as its data sheet has it."""

    schema_id: Literal["fogreduce/part/1"] = Field(alias="schema", description="format of this file")
    product: str = Field(min_length=1, description="manufacturer and product")
    source: str = Field(min_length=1, description="the document that the figures are from")
    notes: str | None = Field(default=None, description="free text")
    bias_repeatability_deg_h: Figure | None = _figure("of the bias from one switching on to the next [deg/h]")
    scale_factor_ppm: Figure | None = _figure("of the scale factor [ppm]")
    misalignment_mrad: Figure | None = _figure("of an input axis' direction [mrad]")
    angle_random_walk_deg_sqrt_h: Figure | None = _figure("white noise [deg/sqrt(h)]")
    bias_instability_deg_h: Figure | None = _figure("flicker [deg/h]")
    rate_random_walk_deg_h_sqrt_h: Figure | None = _figure("random walk of the rate [deg/h/sqrt(h)]")
    scale_factor_nonlinearity_ppm: Figure | None = _figure("at 10 deg/s [ppm]")
    bias_temperature_deg_h_per_degC: Figure | None = _figure("of the bias to temperature [deg/h/degC]")
    bias_temperature_rate_deg_h_per_degC_per_min: Figure | None = _figure(
        "of the bias to how fast the temperature changes [deg/h/(degC/min)]"
    )
    scale_factor_temperature_ppm_per_degC: Figure | None = _figure("of the scale factor [ppm/degC]")
    acceleration_deg_h_per_g: Figure | None = _figure("of the bias to acceleration [deg/h/g]")
    bandwidth_hz: Size | None = Field(default=None, description="at -3 dB [Hz]")

    @classmethod
    def named(cls, name: str | os.PathLike[str]) -> Part:
        """A bundled part by its name, or one from a file."""
        path = Path(name)
        if not path.exists() and str(name) in BUNDLED:
            return cls.from_yaml(BUNDLED[str(name)])
        if not path.exists():
            names = ", ".join(BUNDLED)
            raise BadInput.at("--part", "", found=str(name), expected=f"a part file, or one of {names}")
        return cls.from_yaml(path)

    def filled(
        self, record: CalibrationRecord, white_noise: bool = True
    ) -> tuple[CalibrationRecord, list[Assumed]]:
        """A record with what it does not state, as far as the sheet has it, and what that was.

        Parameters
        ----------
        record : CalibrationRecord
        white_noise : bool
            Whether white noise is filled in too: a diagnosis takes it from the captures.

        Returns
        -------
        record : CalibrationRecord
        assumed : list of Assumed
        """
        found: list[Assumed] = []

        def of(block: str, key: str, figure: Figure | None, value: float) -> None:
            if figure is not None:
                meaning = figure.meaning.replace("_", " ")
                said = f"data sheet of {self.product}: {figure.value:g} ({meaning})"
                found.append(Assumed(record.record_id, f"{block}.{key}", value, said))

        uncertainty, noise = record.uncertainty, record.noise or Noise()
        spread = {
            "scale_factor_rel": (self.scale_factor_ppm, 1e-6),
            "axis_rad": (self.misalignment_mrad, 1e-3),
            "turn_on_bias_deg_h": (self.bias_repeatability_deg_h, 1.0),
        }
        sizes: dict[str, tuple[float, ...]] = {}
        for key, (figure, unit) in spread.items():
            if getattr(uncertainty, key) is None and figure is not None:
                sizes[key] = (figure.sigma * unit,) * record.n
                of("uncertainty", key, figure, figure.sigma * unit)
        repeats = self.bias_repeatability_deg_h
        if uncertainty.bias is None and repeats is not None:
            # one calibration knows a bias no better than it repeats
            sizes["bias"] = tuple(repeats.sigma / 3600.0 * abs(scale) for scale in record.scale_factor)
            of("uncertainty", record.raw_unit.bias_key, repeats, repeats.sigma)
        levels: dict[str, tuple[float, ...]] = {}
        for key in type(noise).model_fields:
            figure = getattr(self, key)
            white = key == "angle_random_walk_deg_sqrt_h"
            if getattr(noise, key) is None and figure is not None and (white_noise or not white):
                levels[key] = (figure.level,) * record.n
                of("noise", key, figure, figure.level)
        if not found:
            return record, []
        changed: dict[str, object] = {"uncertainty": uncertainty.model_copy(update=sizes)}
        if levels:
            changed["noise"] = noise.model_copy(update=levels)
        return record.model_copy(update=changed), found

    def realistic(self) -> dict[str, tuple[float, float]]:
        """Key -> sizes that units of the class show, in its unit (bandwidth: ms); what the sheet has."""
        out: dict[str, tuple[float, float]] = {}
        for key in type(self).model_fields:
            figure = getattr(self, key)
            if isinstance(figure, Figure):
                out[key] = (_SHOWN[0] * figure.sigma, _SHOWN[1] * figure.sigma)
        if self.bandwidth_hz is not None:
            # of a filter of one pole, its time constant [ms]
            time_constant = 1e3 * bandwidth_hz(self.bandwidth_hz)
            out["bandwidth_hz"] = (_SHOWN[0] * time_constant, _SHOWN[1] * time_constant)
        return out
