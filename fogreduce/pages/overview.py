"""A run in some thirty numbers: what its page begins with, and what pages over many runs compare.

The run's page writes them to ``reports/overview.json``, so that a page over a thousand runs reads a thousand
small files and not every table, fit and log again.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import h5py

from fogreduce.constants import SECONDS_PER_HOUR
from fogreduce.errors import BadInput
from fogreduce.pages.attention import attention
from fogreduce.physics.raw_quantity import unit_of_capture
from fogreduce.provenance.manifest_file import MANIFEST, read_record
from fogreduce.provenance.records import read_manifest
from fogreduce.stages.read_table import Row
from fogreduce.stages.read_tables import COLUMNS, read_rows

OVERVIEW = "reports/overview.json"
SCHEMA = "fogreduce/overview/2"


def overview(folder: Path) -> dict[str, Any]:
    """The overview of a reduced run.

    Parameters
    ----------
    folder : Path
        Its results.

    Returns
    -------
    dict
        Plain data. ``drift``, ``offset`` (mean rate less commanded): axis, or gyro where there are no axes ->
        ``value``, ``error`` (standard error of the noise that the residuals show), ``stated`` [deg/h].
        ``noise``: gyro -> angle random walk [deg/sqrt(h)]. ``temperature``: of the sensors, ``mean``,
        ``low``, ``high`` [degC]; None: no log. ``flagged``: kind -> number, none of them 0. ``attention``:
        what stands at the top of pages. ``assumed``: values that nobody stated.

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
    tables = {name: read_rows(folder, name, version, raw_unit) for name in COLUMNS}
    flagged = {name: value for name, value in flagged.items() if value}
    expected = int(ingest["expected"])
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
        "expected": expected,
        "flagged": flagged,
        "attention": attention(tables["rates"], tables["warnings"], flagged, expected),
        "drift": _drift(tables["drift"]),
        "offset": _offset(tables["rates"]),
        "noise": _noise(fit, manifest.calibration_record[raw_unit.scale_factor_key]),
        "temperature": _temperature(folder),
        "assumed": [item.model_dump() for item in manifest.assumed],
    }


def kept_overview(folder: Path) -> dict[str, Any]:
    """The overview that the run's page wrote, where it is of the manifest's version; else anew."""
    try:
        kept = json.loads((folder / OVERVIEW).read_bytes())
        version = read_record(folder / MANIFEST, "the run's manifest").get("version_id")
    except (OSError, ValueError, RecursionError, BadInput):
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
    return str(read_record(folder / MANIFEST, "the run's manifest").get("label") or "")


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


def error_of(row: Row, before: str, after: str) -> float | None:
    """The coloured standard error of a value; where there is none, that by white noise.

    Parameters
    ----------
    row : Row
    before, after : str
        Of the columns' names, before and after ``err_`` and ``err_coloured_``: ``drift_``, ``deg_h``.
    """
    coloured = real(row[f"{before}err_coloured_{after}"])
    return real(row[f"{before}err_{after}"]) if coloured is None else coloured


def whole_run(rows: Sequence[Row]) -> str:
    """What ``segment`` says in rows of the whole run: ``all``, or ``1`` where there is no other segment."""
    return "1" if {row["segment"] for row in rows} <= {"1"} else "all"


def _drift(rows: list[Row]) -> dict[str, dict[str, float | None]]:
    """Of the whole run: its only segment, or the rows over all."""
    whole = whole_run(rows)
    return {
        row["axis"]: {
            "value": real(row["drift_deg_h"]),
            "error": error_of(row, "drift_", "deg_h"),
            "stated": real(row["drift_err_stated_deg_h"]),
        }
        for row in rows
        if row["segment"] == whole
    }


def _offset(rows: list[Row]) -> dict[str, dict[str, float | None]]:
    """Mean rate less the commanded one of the whole run [deg/h]."""
    whole = whole_run(rows)
    found = {}
    for row in rows:
        value = real(row["difference_deg_h"])
        if row["segment"] == whole and value is not None:
            noise, stated = (real(row[f"difference_err_{of}_deg_s"]) for of in ("noise", "stated"))
            found[row["axis"]] = {"value": value, "error": _per_hour(noise), "stated": _per_hour(stated)}
    return found


def _per_hour(rate_deg_s: float | None) -> float | None:
    return None if rate_deg_s is None else rate_deg_s * SECONDS_PER_HOUR


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
