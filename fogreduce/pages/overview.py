"""A run in some thirty numbers: what its page begins with, and what pages over many runs compare.

The run's page writes them to ``reports/overview.json``, so that a page over a thousand runs reads a thousand
small files and not every table, fit and log again.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from fogreduce.archive.records import read_manifest, read_record
from fogreduce.constants import SECONDS_PER_HOUR
from fogreduce.errors import BadInput
from fogreduce.estimate.mean_curve import integral_terms
from fogreduce.physics.raw_quantity import unit_of_capture
from fogreduce.stages.read_tables import COLUMNS, Row, read_rows

OVERVIEW = "reports/overview.json"
SCHEMA = "fogreduce/overview/1"


def overview(folder: Path) -> dict[str, Any]:
    """The overview of a reduced run.

    Parameters
    ----------
    folder : Path
        Its results.

    Returns
    -------
    dict
        Plain data. ``drift``, ``offset`` (mean rate less commanded): axis -> ``value``, ``error`` (standard
        error of the noise that the residuals show), ``stated`` [deg/h]. ``noise``: gyro -> angle random walk
        [deg/sqrt(h)]. ``temperature``: of the sensors, ``mean``, ``low``, ``high`` [degC]; None: no log.
        ``flagged``: kind -> number, none of them 0. ``assumed``: values that nobody stated.

    Raises
    ------
    BadInput
        A table or report is missing or of another version than the manifest.
    """
    manifest = read_manifest(folder)
    version, run = manifest.version_id, manifest.run
    fit = report(folder, "fit", version)
    ingest = report(folder, "ingest", version)
    profile = run["table"]["profile"]
    raw_unit = unit_of_capture(run["capture"])
    flagged = {name: int(ingest[name] or 0) for name in ("lost", "torn_bytes")}
    flagged |= {name: int(value) for name, value in ingest["flagged"].items()}
    flagged["unstable_intervals"] = len(fit["unstable"])
    drift = {name: read_rows(folder, name, version, raw_unit) for name in COLUMNS}["drift"]
    return {
        "schema": SCHEMA,
        "version_id": version,
        "campaign": manifest.campaign,
        "run_id": manifest.run_id,
        "label": _label(folder),
        "unit": str(run["unit"]),
        "started_at": str(run["started_at"]),
        "calibration": manifest.calibration.id,
        "software": str(manifest.software.get("fogreduce", "")),
        "code": str(manifest.software.get("code_sha256", ""))[:16],
        "axis": axis_text(run["table"]["axis"]),
        "rates_deg_s": [step["rate_deg_s"] for step in profile],
        "duration_s": math.fsum(step["duration_s"] for step in profile),
        "records": int(ingest["records"]),
        "expected": int(ingest["expected"]),
        "flagged": {name: value for name, value in flagged.items() if value},
        "drift": _drift(drift),
        "offset": _offset(fit, drift),
        "noise": _noise(fit, manifest.calibration_record[raw_unit.scale_factor_key]),
        "temperature": _temperature(folder),
        "assumed": [item.model_dump() for item in manifest.assumed],
    }


def kept_overview(folder: Path) -> dict[str, Any]:
    """The overview that the run's page wrote, where it is of the manifest's version; else anew."""
    try:
        kept = json.loads((folder / OVERVIEW).read_bytes())
        version = json.loads((folder / "manifest.json").read_bytes())["version_id"]
    except (OSError, ValueError, KeyError, TypeError, RecursionError):
        return overview(folder)
    same = isinstance(kept, dict) and (kept.get("schema"), kept.get("version_id")) == (SCHEMA, version)
    if same and (folder / "tables" / "drift.csv").is_file():
        return dict(kept)
    return overview(folder)


def report(folder: Path, name: str, version: str) -> dict[str, Any]:
    """One of the run's reports."""
    path = folder / "reports" / f"{name}.json"
    data = read_record(path, "a report of the reduction")
    _same_version(path, data.get("version_id"), version)
    return data


def _same_version(path: Path, found: object, version: str) -> None:
    if found != version:
        expected = f"{version}, as the manifest has it"
        raise BadInput.at(path, "version_id", found=found, expected=expected)


def _label(folder: Path) -> str:
    return str(read_record(folder / "manifest.json", "the run's manifest").get("label") or "")


def axis_text(axis: Any) -> str:
    """The table's axis in the unit's frame: a letter where it is one of them."""
    names = {(1.0, 0.0, 0.0): "x", (0.0, 1.0, 0.0): "y", (0.0, 0.0, 1.0): "z"}
    vector = [float(part) for part in axis]
    x, y, z = vector
    return names.get((x, y, z)) or "(" + ", ".join(f"{part:.4g}" for part in vector) + ")"


def real(text: str | None) -> float | None:
    """A number out of a table; None where there is none."""
    try:
        value = float(text or "nan")
    except ValueError:
        return None
    return value if math.isfinite(value) else None


def _drift(rows: list[Row]) -> dict[str, dict[str, float | None]]:
    """Of the whole run: its only segment, or the rows over all."""
    whole = "all" if any(row["segment"] == "all" for row in rows) else "1"
    return {
        row["axis"]: {
            "value": real(row["drift_deg_h"]),
            "error": _first(real(row["drift_err_coloured_deg_h"]), real(row["drift_err_deg_h"])),
            "stated": real(row["drift_err_stated_deg_h"]),
        }
        for row in rows
        if row["segment"] == whole
    }


def _first(*values: float | None) -> float | None:
    return next((value for value in values if value is not None), None)


def _offset(fit: Mapping[str, Any], drift: list[Row]) -> dict[str, dict[str, float | None]]:
    """Mean of the fitted curve less the commanded rate, over all segments [deg/h]."""
    commanded = {
        (row["segment"], row["axis"]): float(row["nominal_deg"]) / float(row["duration_s"])
        for row in drift
        if row["segment"] != "all"
    }
    sums: dict[str, list[float]] = {}
    for segment in fit["segments"]:
        start, stop = segment["start_s"], segment["stop_s"]
        for item in segment["channels"]:
            key = (str(segment["segment"]), item["channel"]) if item else None
            if key not in commanded:
                continue
            terms = integral_terms(np.array([start, stop]), item["rate_rad_s"]) @ np.array([-1.0, 1.0])
            angle = float(terms @ np.array(item["theta"])) - commanded[key] * (stop - start)
            noise, stated = (
                _deviation(terms, item[name] if item[name] is not None else item["covariance"])
                for name in ("coloured_covariance", "stated_covariance")
            )
            entry = sums.setdefault(item["channel"], [0.0, 0.0, 0.0, 0.0])
            entry[0] += stop - start
            entry[1] += angle
            entry[2] = math.hypot(entry[2], noise)
            entry[3] += stated if item["stated_covariance"] is not None else math.nan
    return {
        axis: {
            "value": angle / whole * SECONDS_PER_HOUR,
            "error": real(str(noise / whole * SECONDS_PER_HOUR)),
            "stated": real(str(stated / whole * SECONDS_PER_HOUR)),
        }
        for axis, (whole, angle, noise, stated) in sums.items()
    }


def _deviation(terms: Any, covariance: Any) -> float:
    if covariance is None:
        return math.nan
    return math.sqrt(max(0.0, float(terms @ np.array(covariance) @ terms)))


def _noise(fit: Mapping[str, Any], scale_factors: list[float]) -> dict[str, float]:
    """Angle random walk of each gyro from its residual's Allan variance, all segments [deg/sqrt(h)]."""
    sums: dict[str, list[float]] = {}
    for segment in fit["segments"]:
        weight = segment["stop_s"] - segment["start_s"]
        for item in segment["channels"]:
            if item is not None and item["channel"].startswith("gyro") and item.get("noise"):
                entry = sums.setdefault(item["channel"], [0.0, 0.0])
                entry[0] += weight
                entry[1] += weight * item["noise"]["white"]
    out = {}
    for gyro, (weight, white) in sums.items():
        scale = abs(scale_factors[int(gyro.removeprefix("gyro")) - 1])
        out[gyro] = math.sqrt(white / weight) / scale * math.sqrt(SECONDS_PER_HOUR)
    return out


def _temperature(folder: Path) -> dict[str, float] | None:
    """Of the sensors, from the log that ingest keeps; None where there is none."""
    import h5py

    path = folder / "datasets" / "ingest.nc"
    try:
        with h5py.File(path, "r") as file:
            log = file.get("sensor_temperature")
            values = None if log is None else log[()]
    except OSError:
        return None
    if values is None or not values.size:
        return None
    return {"mean": float(values.mean()), "low": float(values.min()), "high": float(values.max())}
