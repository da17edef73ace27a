"""The tables of one run, as the contract has them: CSV, one header line, 15 significant digits."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from fogreduce.datasets.atomic import write_text
from fogreduce.estimate.mean_curve import amplitude_and_phase
from fogreduce.estimate.propagation import correlations, standard_uncertainties
from fogreduce.physics.raw_quantity import RawUnit

_FIT = "a_{u},a_err_{u},b_{u},b_err_{u},c_rad_s,d_rad,d_err_rad,e_{ut},e_err_{ut},sigma_{u},records"
#: Further columns: errors by other accounts, and where the row belongs.
_FURTHER = "a_err_{by}_{u},b_err_{by}_{u},d_err_{by}_rad,e_err_{by}_{ut}"
#: The sine as p = b sin d and q = b cos d, with their combined covariance.
_SINE = "p_{u},p_err_combined_{u},q_{u},q_err_combined_{u},pq_correlation"
_PLACE = "segment,start_s,stop_s,table_rate_deg_s,version_id,undetermined"


def _fit_columns(channel: str, u: str, ut: str, accounts: Sequence[str]) -> list[str]:
    """Columns of a table of mean curves: of values in a unit `u`, of their slopes in `ut`."""
    parts = [channel, _FIT.format(u=u, ut=ut)]
    parts += [_FURTHER.format(by=account, u=u, ut=ut) for account in accounts]
    return ",".join([*parts, _PLACE, _SINE.format(u=u), _FURTHER.format(by="combined", u=u, ut=ut)]).split(
        ","
    )


def gyro_fit_columns(raw_unit: RawUnit) -> list[str]:
    """Columns of gyro_fit.csv, whose curves are fitted to raw readings."""
    return _fit_columns("gyro", raw_unit.suffix, raw_unit.slope_suffix, ["coloured"])


RATE_FIT_COLUMNS = _fit_columns("axis", "deg_s", "deg_s2", ["coloured", "stated"])

Cell = str | int | float | None


def write_table(path: Path, columns: Sequence[str], rows: Iterable[Sequence[Cell]]) -> None:
    """Write a table, whole or not at all; None and NaN become empty fields."""
    lines = [",".join(columns)]
    for row in rows:
        assert len(row) == len(columns)
        lines.append(",".join(map(cell_text, row)))
    write_text(path, "\n".join(lines) + "\n")


def cell_text(cell: Cell) -> str:
    """A field of a table."""
    if cell is None or (isinstance(cell, float) and math.isnan(cell)):
        return ""
    if isinstance(cell, float):
        return f"{cell:.15g}"
    return str(cell)


def fit_rows(
    fits: Mapping[str, Any], names: Sequence[str], accounts: Sequence[str], version_id: str
) -> list[list[Cell]]:
    """Rows of gyro_fit.csv or rate_fit.csv from the fits (`fogreduce.stages.fit_report.as_plain`).

    Errors are one standard deviation. `*_err_*` is that of white noise alone, as the paper's. Of the further
    accounts, ``coloured`` is that of white noise, flicker and random walk, averaged over all sizes of them
    that residuals and calibration record allow; ``combined`` has everything in it; and
    ``stated`` is what calibration record and run.yaml state as uncertain (scale factor, bias, axes, turn-on
    bias, azimuth, latitude, table rate), noise not in it. Parameters that the record does not determine are
    empty, and `undetermined` says why.
    """
    rows: list[list[Cell]] = []
    for segment in fits["segments"]:
        found = {item["channel"]: item for item in segment["channels"] if item is not None}
        place = [segment[key] for key in ("segment", "start_s", "stop_s", "rate_deg_s")]
        for name in names:
            item = found.get(name)
            cells = [None] * 10 + [0] if item is None else _fit_cells(item)
            further = [cell for account in accounts for cell in _errors(item, f"{account}_covariance")]
            undetermined = "all: too few usable records" if item is None else item["undetermined"]
            sine, combined = _combined_cells(item)
            rows.append([name, *cells, *further, *place, version_id, undetermined, *sine, *combined])
    return rows


def _combined_cells(item: Mapping[str, Any] | None) -> tuple[list[Cell], list[Cell]]:
    """P and q with errors and correlation, and the errors of a, b, d, e, by noise and what is stated."""
    if item is None:
        return [None] * 5, [None] * 4
    covariance = np.array(item["coloured_covariance"] or item["covariance"])
    if item["stated_covariance"] is not None:
        covariance = covariance + np.array(item["stated_covariance"])
    errors = _errors({**item, "combined": covariance}, "combined")
    if not item["has_sine"]:
        return [None] * 5, errors
    (p, q), part = item["theta"][1:3], covariance[1:3, 1:3]
    p_err, q_err = standard_uncertainties(part).tolist()
    return [p, p_err, q, q_err, float(correlations(part)[0, 1])], errors


def _fit_cells(item: Mapping[str, Any]) -> list[Cell]:
    a, _, _, e = item["theta"]
    a_err, b_err, d_err, e_err = _errors(item, "covariance")
    sine: list[Cell] = [None] * 5
    if item["has_sine"]:
        b, _, d, _ = amplitude_and_phase(np.array(item["theta"]), np.array(item["covariance"]))
        sine = [b, b_err, item["rate_rad_s"], d if item["has_phase"] else None, d_err]
    slope = [e, e_err] if item["has_slope"] else [None, None]
    return [a, a_err, *sine, *slope, item["sigma"], item["records"]]


def _errors(item: Mapping[str, Any] | None, key: str) -> list[Cell]:
    """Standard errors of a, b, d and e by one covariance; None where there is none."""
    if item is None or item[key] is None:
        return [None] * 4
    covariance = np.array(item[key])
    e_err = math.sqrt(covariance[3, 3]) if item["has_slope"] else None
    errors: list[Cell] = [math.sqrt(covariance[0, 0]), None, None, e_err]
    if item["has_sine"]:
        _, errors[1], _, d_err = amplitude_and_phase(np.array(item["theta"]), covariance)
        errors[2] = d_err if item["has_phase"] else None
    return errors
