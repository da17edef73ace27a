"""Which stages a table comes from, and what each of them goes by."""

from __future__ import annotations

from dataclasses import dataclass

from fogreduce.physics.raw_quantity import UNITS_IN_USE


@dataclass(frozen=True)
class StageFacts:
    """A stage of the reduction, as a record of provenance has it.

    Attributes
    ----------
    reads, writes : tuple of str
        Files of the run's results; ``inputs`` stands for the run's own.
    parameters : tuple of str
        Of the manifest's `parameters`.
    run, calibration : tuple of str
        Keys of run.yaml and of the calibration record that its numbers depend on.
    """

    reads: tuple[str, ...]
    writes: tuple[str, ...]
    parameters: tuple[str, ...]
    run: tuple[str, ...] = ()
    calibration: tuple[str, ...] = ()


#: Whatever unit the record is in.
_SCALE_FACTORS = tuple(unit.scale_factor_key for unit in UNITS_IN_USE.values())
_BIASES = tuple(unit.bias_key for unit in UNITS_IN_USE.values())

STAGES = {
    "ingest": StageFacts(
        ("inputs",),
        (
            "datasets/ingest.nc",
            "reports/ingest.json",
            "tables/quality.csv",
            "tables/encoder.csv",
            "tables/warnings.csv",
        ),
        ("block_records", "outliers"),
        ("capture", "table"),
        (*_SCALE_FACTORS, *_BIASES, "H", "axes", "noise"),
    ),
    "calibrate": StageFacts(
        ("datasets/ingest.nc",),
        ("datasets/calibrate.nc",),
        ("block_records",),
        ("capture",),
        (*_SCALE_FACTORS, *_BIASES),
    ),
    "project": StageFacts(
        ("datasets/calibrate.nc",),
        ("datasets/project.nc",),
        ("block_records", "complete_records"),
        (),
        ("H", "axes", "noise"),
    ),
    "remove_earth": StageFacts(
        ("datasets/project.nc",),
        ("datasets/remove_earth.nc",),
        ("alpha_source", "block_records"),
        ("site", "table", "orientation", "azimuth_deg", "frame_signs"),
    ),
    "fit": StageFacts(
        ("datasets/ingest.nc", "datasets/remove_earth.nc"),
        (
            "datasets/bins.nc",
            "reports/fit.json",
            "tables/gyro_fit.csv",
            "tables/rate_fit.csv",
            "tables/unstable.csv",
        ),
        ("block_records", "complete_records", "edge_guard_s", "unstable"),
        ("table", "site", "orientation", "azimuth_deg", "azimuth_uncertainty_deg"),
        (*_SCALE_FACTORS, "H", "axes", "uncertainty", "covariance", "noise"),
    ),
    "drift": StageFacts(
        ("reports/fit.json",),
        (
            "tables/drift.csv",
            "tables/rates.csv",
            "tables/drift_by_records.csv",
            "tables/budget.csv",
            "tables/correlations.csv",
            "datasets/budget.nc",
        ),
        ("complete_records",),
        ("table", "frame_signs", "site", "orientation", "azimuth_deg", "azimuth_uncertainty_deg", "capture"),
        (*_SCALE_FACTORS, *_BIASES, "H", "axes", "uncertainty", "covariance"),
    ),
}

#: Tables that leave out stages: fits to raw volts do not see the calibration.
_WITHOUT = {
    "quality.csv": ("calibrate", "project", "remove_earth", "fit", "drift"),
    "encoder.csv": ("calibrate", "project", "remove_earth", "fit", "drift"),
    "warnings.csv": ("calibrate", "project", "remove_earth", "fit", "drift"),
    "gyro_fit.csv": ("calibrate", "project", "remove_earth", "drift"),
    "unstable.csv": ("calibrate", "project", "remove_earth", "drift"),
    "rate_fit.csv": ("drift",),
    "drift.csv": (),
    "rates.csv": (),
    "drift_by_records.csv": (),
    "budget.csv": (),
    "correlations.csv": (),
}


def stages_of(table: str) -> list[str]:
    """The stages that a table comes from, the first of the flow first; all of them for an unknown table."""
    return [stage for stage in STAGES if stage not in _WITHOUT.get(table, ())]
