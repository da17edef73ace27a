"""A campaign's metadata as values: unit (calibration record), runs; to and from the contract's YAML."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from withheld import yaml12
from withheld.arrays import Array
from withheld.errors import BadInput

Vector = tuple[float, ...]


@dataclass(frozen=True)
class Unit:
    """A calibration record; every tuple has one number a gyro.

    Parameters
    ----------
    H : tuple of 3 tuples of n
        gyro rates -> unit-frame rates.
    scale_factor : [V/(deg/s)]
    bias : [V]
    scale_factor_rel, bias_sd [V], axis_rad, turn_on_deg_h : stated uncertainties, 1 sigma
    arw_deg_sqrt_h, instability_deg_h, rrw_deg_h_sqrt_h : nominal noise, IEEE 952 terms
    """

    name: str
    version: str
    H: tuple[Vector, Vector, Vector]
    scale_factor: Vector
    bias: Vector
    scale_factor_rel: Vector
    bias_sd: Vector
    axis_rad: Vector
    turn_on_deg_h: Vector
    arw_deg_sqrt_h: Vector
    instability_deg_h: Vector
    rrw_deg_h_sqrt_h: Vector

    @property
    def n(self) -> int:
        """Number of gyros."""
        return len(self.scale_factor)

    @property
    def axes(self) -> Array:
        """Directions of the gyros in the unit frame, (n, 3): the pseudo-inverse of H."""
        return np.linalg.pinv(np.array(self.H))

    def white_deg_s(self, rate_hz: float) -> Array:
        """Standard deviation of a sample's white noise, (n,) [deg/s]: N / 60 sqrt(rate)."""
        result: Array = np.array(self.arw_deg_sqrt_h) / 60.0 * np.sqrt(rate_hz)
        return result


@dataclass(frozen=True)
class Run:
    """What run.yaml says of one run.  `profile` holds (rate [deg/s], duration [s]) in order."""

    run_id: str
    started_at: str
    latitude_deg: float
    axis: tuple[float, float, float]
    profile: tuple[tuple[float, float], ...]
    orientation: tuple[tuple[str, str], tuple[str, str]]
    azimuth_deg: float
    polarity: tuple[int, ...]
    frame_signs: tuple[int, int, int] = (1, 1, 1)
    sample_rate_hz: float = 128.0
    volts_per_count: float = 1e-7
    rate_uncertainty_ppm: float = 5.0
    azimuth_uncertainty_deg: float = 0.05
    latitude_uncertainty_deg: float = 0.001
    temperature: bool = True
    table_log: bool = False

    @property
    def duration_s(self) -> float:
        """Length of the commanded profile [s]."""
        return float(sum(duration for _, duration in self.profile))

    @property
    def samples(self) -> int:
        """Records of a whole capture: round(duration x rate)."""
        return int(np.rint(self.duration_s * self.sample_rate_hz))


@dataclass(frozen=True)
class Campaign:
    """A unit and the runs made with it."""

    name: str
    unit: Unit
    runs: tuple[Run, ...]


_AXES = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}


def run_document(run: Run, unit: Unit) -> dict[str, Any]:
    """run.yaml as the contract has it; uncertainties that equal the contract's defaults are left out."""
    letter = next((name for name, axis in _AXES.items() if axis == run.axis), None)
    table: dict[str, Any] = {"axis": letter or list(run.axis)}
    table["profile"] = [{"rate_deg_s": rate, "duration_s": duration} for rate, duration in run.profile]
    if run.rate_uncertainty_ppm != 5.0:
        table["rate_uncertainty_ppm"] = run.rate_uncertainty_ppm
    site = {"latitude_deg": run.latitude_deg}
    if run.latitude_uncertainty_deg != 0.001:
        site["latitude_uncertainty_deg"] = run.latitude_uncertainty_deg
    document: dict[str, Any] = {
        "schema": "fogreduce/run/1", "run_id": run.run_id, "unit": unit.name, "started_at": run.started_at,
        "site": site, "table": table, "orientation": dict(run.orientation), "azimuth_deg": run.azimuth_deg,
    }  # fmt: skip
    if run.azimuth_uncertainty_deg != 0.05:
        document["azimuth_uncertainty_deg"] = run.azimuth_uncertainty_deg
    document["frame_signs"] = list(run.frame_signs)
    document["capture"] = {
        "file": "capture.fogcap", "format": "fogcap-1", "sample_rate_hz": run.sample_rate_hz,
        "volts_per_count": run.volts_per_count, "polarity": list(run.polarity),
    }  # fmt: skip
    document["calibration"] = f"{unit.name}@{unit.version}"
    if run.temperature:
        document["temperature"] = "temperature.csv"
    if run.table_log:
        document["table_log"] = "table.csv"
    return document


def unit_document(unit: Unit) -> dict[str, Any]:
    """The calibration record as the contract has it."""
    return {
        "schema": "fogreduce/calibration/1", "unit": unit.name, "version": unit.version,
        "valid_from": "2012-06-01T00:00:00Z", "procedure": "withheld bench, a made-up unit",
        "H": [list(row) for row in unit.H],
        "scale_factor_V_per_deg_s": list(unit.scale_factor), "bias_V": list(unit.bias),
        "uncertainty": {
            "scale_factor_rel": list(unit.scale_factor_rel), "bias_V": list(unit.bias_sd),
            "axis_rad": list(unit.axis_rad), "turn_on_bias_deg_h": list(unit.turn_on_deg_h),
        },
        "noise": {
            "angle_random_walk_deg_sqrt_h": list(unit.arw_deg_sqrt_h),
            "bias_instability_deg_h": list(unit.instability_deg_h),
            "rate_random_walk_deg_h_sqrt_h": list(unit.rrw_deg_h_sqrt_h),
        },
    }  # fmt: skip


def run_from(document: Mapping[str, Any]) -> Run:
    """A run from run.yaml as the contract has it."""
    axis = document["table"]["axis"]
    direction = np.array(_AXES[axis] if isinstance(axis, str) else axis, dtype=float)
    x, y, z = (direction / np.linalg.norm(direction)).tolist()
    first, second = (document["orientation"]).items()
    capture, site, table = document["capture"], document["site"], document["table"]
    return Run(
        run_id=document["run_id"], started_at=document["started_at"],
        latitude_deg=float(site["latitude_deg"]), axis=(x, y, z),
        profile=tuple((float(p["rate_deg_s"]), float(p["duration_s"])) for p in table["profile"]),
        orientation=(first, second), azimuth_deg=float(document.get("azimuth_deg", 0.0)),
        polarity=tuple(capture["polarity"]), frame_signs=tuple(document.get("frame_signs", (1, 1, 1))),
        sample_rate_hz=float(capture["sample_rate_hz"]), volts_per_count=float(capture["volts_per_count"]),
        rate_uncertainty_ppm=float(table.get("rate_uncertainty_ppm", 5.0)),
        azimuth_uncertainty_deg=float(document.get("azimuth_uncertainty_deg", 0.05)),
        latitude_uncertainty_deg=float(site.get("latitude_uncertainty_deg", 0.001)),
        temperature="temperature" in document, table_log="table_log" in document,
    )  # fmt: skip


def unit_from(record: Mapping[str, Any]) -> Unit:
    """A unit from a calibration record that has `H`, uncertainties and noise."""
    stated, noise = record["uncertainty"], record["noise"]
    rows = [tuple(float(v) for v in row) for row in record["H"]]
    return Unit(
        name=record["unit"], version=record["version"], H=(rows[0], rows[1], rows[2]),
        scale_factor=tuple(record["scale_factor_V_per_deg_s"]), bias=tuple(record["bias_V"]),
        scale_factor_rel=tuple(stated["scale_factor_rel"]), bias_sd=tuple(stated["bias_V"]),
        axis_rad=tuple(stated["axis_rad"]), turn_on_deg_h=tuple(stated["turn_on_bias_deg_h"]),
        arw_deg_sqrt_h=tuple(noise["angle_random_walk_deg_sqrt_h"]),
        instability_deg_h=tuple(noise["bias_instability_deg_h"]),
        rrw_deg_h_sqrt_h=tuple(noise["rate_random_walk_deg_h_sqrt_h"]),
    )  # fmt: skip


def read_campaign(folder: Path, calibrations: Path) -> Campaign:
    """A campaign folder's metadata and its one unit; captures are not touched.

    This reads what the bench itself writes, and the like of it: a record with `H`, uncertainties and noise.
    """
    paths = sorted((folder / "runs").glob("*/run.yaml"))
    if not paths:
        raise BadInput(f"{folder}: no runs/*/run.yaml in it; a campaign folder was expected")
    documents = [yaml12.load(path) for path in paths]
    name, _, version = str(documents[0].get("calibration", "")).partition("@")
    record = yaml12.load(calibrations / name / f"{version}.yaml")
    try:
        runs = tuple(run_from(document) for document in documents)
        return Campaign(folder.name, unit_from(record), runs)
    except (KeyError, TypeError, ValueError) as error:
        raise BadInput(f"{folder}: metadata that the bench cannot read ({error!r})") from error
