"""What each number of a report means: its formula, its source, and the choices a definitions file makes."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from pydantic import Field

from fogreduce.metadata.base import Model


class Definitions(Model):
    """A definitions file (schema fogreduce/definitions/1): which of several usages a term has."""

    schema_id: Literal["fogreduce/definitions/1"] = Field(
        default="fogreduce/definitions/1", alias="schema", description="format of this file"
    )
    nonlinearity: Literal["full_scale", "reading"] = Field(
        default="full_scale", description="what the largest departure is divided by"
    )
    bias_stability_s: float = Field(
        default=10.0, gt=0, le=1e5, description="length of the means whose scatter is the bias stability [s]"
    )
    warm_up_band_deg_h: float = Field(
        default=0.1, gt=0, le=1e6, description="band within which the bias must stay after warm-up [deg/h]"
    )
    false_alarms_per_hour: float = Field(default=0.01, gt=0, le=1e3, description="of the parity checks")


@dataclass(frozen=True)
class Definition:
    """Title, formula and source of a quantity."""

    title: str
    formula: str
    source: str


DEFINITIONS = {
    "scale_factor": Definition(
        "Scale factor",
        "K: slope of output against input by weighted least squares over all runs; the table's stated "
        "uncertainty is in it",
        "IEEE 528, 952",
    ),
    "nonlinearity": Definition(
        "Scale factor nonlinearity",
        "max |v| / max |F|: v the departures of a run's rate steps from their straight line, F the output "
        "less bias; by choice |v / (K Omega)|. Interval simultaneous over the steps",
        "IEEE 952",
    ),
    "asymmetry": Definition(
        "Scale factor asymmetry", "2 (K+ - K-) / (K+ + K-), positive where K+ is the larger", "IEEE 952"
    ),
    "hysteresis": Definition(
        "Scale factor hysteresis",
        "max |F_up - F_down| / max |F|: the same rate reached from below and from above",
        "IEEE 952",
    ),
    "scale_factor_repeatability": Definition(
        "Scale factor repeatability",
        "standard deviation of K over mean K between power cycles, noise within runs taken away",
        "IEEE 952",
    ),
    "threshold": Definition(
        "Threshold", "least input [deg/h, Earth's part in it] that gives half of what is expected", "IEEE 528"
    ),
    "dead_band": Definition(
        "Dead band", "range of inputs about zero that give less than 10 % of what is expected", "IEEE 528"
    ),
    "bias": Definition(
        "Bias", "B: output at no input, over K; by weighted least squares over all runs", "IEEE 528, 952"
    ),
    "bias_repeatability": Definition(
        "Bias repeatability, run to run",
        "standard deviation of the bias between runs, noise within runs taken away (Q-profile)",
        "IEEE 952",
    ),
    "bias_repeatability_days": Definition(
        "Bias repeatability, day to day",
        "standard deviation of daily means of the bias beyond that of runs within a day",
        "IEEE 952",
    ),
    "bias_stability": Definition(
        "Bias stability within a run",
        "standard deviation of consecutive means of the stated length, in the longest stretch at one rate",
        "data-sheet usage; IEEE 952's bias instability stands under noise",
    ),
    "angle_random_walk": Definition(
        "Angle random walk N", "white noise: Allan deviation N / sqrt(tau)", "IEEE 952, annex C"
    ),
    "bias_instability": Definition(
        "Bias instability B", "flicker: flat of the Allan deviation over 0.664", "IEEE 952, annex C"
    ),
    "rate_random_walk": Definition(
        "Rate random walk K", "Allan deviation K sqrt(tau / 3)", "IEEE 952, annex C"
    ),
    "quantization": Definition("Quantization Q", "Allan deviation sqrt(3) Q / tau", "IEEE 952, annex C"),
    "rate_ramp": Definition("Rate ramp R", "Allan deviation R tau / sqrt(2)", "IEEE 952, annex C"),
    "misalignment": Definition(
        "Input axis misalignment",
        "axis less the present record's, along a direction across it: [F(+Omega) - F(-Omega)] / (2 K Omega) "
        "from mountings across, by least squares over all runs",
        "IEEE 952",
    ),
    "acceleration_sensitivity": Definition(
        "Acceleration sensitivity",
        "bias by 1 g along an axis of the unit, by least squares over attitudes",
        "IEEE 952",
    ),
    "magnetic_sensitivity": Definition(
        "Magnetic sensitivity",
        "bias by a field along the input axis, by least squares over attitudes, together with acceleration",
        "IEEE 952",
    ),
    "bias_temperature": Definition(
        "Bias against sensor temperature",
        "slope of the rate in the sensors' temperature less that at the run's start",
        "IEEE 952",
    ),
    "bias_electronics_temperature": Definition(
        "Bias against electronics temperature",
        "slope of the rate in the electronics' temperature less that at the run's start",
        "IEEE 952",
    ),
    "bias_warming": Definition(
        "Bias against rate of temperature",
        "slope of the rate in dT/dt of the sensors (straight line over 20 s)",
        "IEEE 952",
    ),
    "scale_factor_temperature": Definition(
        "Scale factor against sensor temperature", "relative slope of K in the temperature", "IEEE 952"
    ),
    "warm_up": Definition(
        "Warm-up time",
        "tau ln(|A| / band) of c + A exp(-t / tau) fitted to the longest run: the bias then stays within the "
        "band about its end value",
        "IEEE 952",
    ),
    "bandwidth": Definition(
        "Bandwidth",
        "frequency at which the response falls by 3 dB: 1 / (2 pi tau), tau the time constant of one pole "
        "fitted, with delay, scale factor and bias, to the samples of a swing",
        "IEEE 528, 952",
    ),
}


def read_definitions(path: Path | None) -> Definitions:
    """The definitions file, or IEEE's choices."""
    return Definitions() if path is None else Definitions.from_yaml(path)
