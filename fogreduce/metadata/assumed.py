"""What run.yaml and a calibration record leave unsaid, so that a default stands in: each with its reason."""

from __future__ import annotations

from dataclasses import dataclass

from fogreduce.metadata.calibration import DEFAULT_NOISE, DEFAULT_UNCERTAINTY, CalibrationRecord, Default
from fogreduce.metadata.run import Run

#: Standard deviations that a run.yaml may state: the block that holds each (none: the top), and its unit.
_OF_RUN = {
    "latitude_uncertainty_deg": ("site", "deg"),
    "rate_uncertainty_ppm": ("table", "ppm"),
    "azimuth_uncertainty_deg": ("", "deg"),
}


@dataclass(frozen=True)
class Assumed:
    """One default that stands in.

    Attributes
    ----------
    file : str
        Who is silent: ``run.yaml``, or the calibration record by its id.
    key : str
        The key that would state it.
    value : float
        What is assumed, of every gyro where it is a gyro's.
    said : str
        The value with its unit, and why that one.
    """

    file: str
    key: str
    value: float
    said: str

    def __str__(self) -> str:
        return f"{self.file} states no {self.key}; assumed {self.said}"


def assumed_of_run(run: Run) -> list[Assumed]:
    """The standard deviations that a run.yaml does not state."""
    found = []
    for key, (block, unit) in _OF_RUN.items():
        model = getattr(run, block) if block else run
        if key not in model.model_fields_set:
            value = getattr(model, key)
            found.append(Assumed("run.yaml", f"{block}.{key}" if block else key, value, f"{value:g} {unit}"))
    return found


def assumed_of_record(record: CalibrationRecord) -> list[Assumed]:
    """The standard deviations and the noise that a calibration record does not state."""
    bias_key = record.raw_unit.bias_key
    found = []
    for name, default in DEFAULT_UNCERTAINTY.items():
        field, key = ("bias", bias_key) if name == "bias_deg_h" else (name, name)
        if getattr(record.uncertainty, field) is None:
            found.append(_of(record, f"uncertainty.{key}", default, ""))
    for name, default in DEFAULT_NOISE.items():
        if record.noise is None or getattr(record.noise, name) is None:
            white = name == "angle_random_walk_deg_sqrt_h"
            more = "; diagnose estimates it from the captures" if white else ""
            found.append(_of(record, f"noise.{name}", default, more))
    return found


def _of(record: CalibrationRecord, key: str, default: Default, more: str) -> Assumed:
    return Assumed(record.record_id, key, default.value, default.reason + more)
