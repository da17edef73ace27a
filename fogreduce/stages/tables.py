"""The tables of one run, as the contract has them: CSV, one header line, 15 significant digits."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from fogreduce.datasets.atomic import write_text
from fogreduce.estimate.mean_curve import amplitude_and_phase

GYRO_FIT = "gyro,a_V,a_err_V,b_V,b_err_V,c_rad_s,d_rad,d_err_rad,e_V_s,e_err_V_s,sigma_V,records"
RATE_FIT = (
    "axis,a_deg_s,a_err_deg_s,b_deg_s,b_err_deg_s,c_rad_s,d_rad,d_err_rad,e_deg_s2,e_err_deg_s2,"
    "sigma_deg_s,records"
)
#: Further columns of both, `U` the unit of the channel: errors that allow for coloured residuals.
_COLOURED = "a_err_coloured_{u},b_err_coloured_{u},d_err_coloured_rad,e_err_coloured_{ut}"
_PLACE = "segment,start_s,stop_s,table_rate_deg_s,version_id"
GYRO_FIT_COLUMNS = f"{GYRO_FIT},{_COLOURED.format(u='V', ut='V_s')},{_PLACE}".split(",")
RATE_FIT_COLUMNS = f"{RATE_FIT},{_COLOURED.format(u='deg_s', ut='deg_s2')},{_PLACE}".split(",")

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


def fit_rows(fits: Mapping[str, Any], names: Sequence[str], version_id: str) -> list[list[Cell]]:
    """Rows of gyro_fit.csv or rate_fit.csv from the fits (`fogreduce.stages.fit.as_plain`).

    Errors are one standard deviation: `*_err_*` of white noise alone (as the paper's), `*_err_coloured_*`
    of the white noise, flicker and random walk that the residuals show. Neither includes the stated
    uncertainties of calibration and site.
    """
    rows: list[list[Cell]] = []
    for segment in fits["segments"]:
        found = {item["channel"]: item for item in segment["channels"] if item is not None}
        place: list[Cell] = [
            segment["segment"],
            segment["start_s"],
            segment["stop_s"],
            segment["rate_deg_s"],
            version_id,
        ]
        for name in names:
            cells = _fit_cells(found[name]) if name in found else [None] * 10 + [0] + [None] * 4
            rows.append([name, *cells, *place])
    return rows


def _fit_cells(item: Mapping[str, Any]) -> list[Cell]:
    theta, covariance = np.array(item["theta"]), np.array(item["covariance"])
    coloured = item["coloured_covariance"]
    a, e = float(theta[0]), float(theta[3])
    a_err, e_err = (math.sqrt(covariance[k, k]) for k in (0, 3))
    sine: list[Cell] = [None] * 5
    far: list[Cell] = [None] * 4
    if item["has_sine"]:
        b, b_err, d, d_err = amplitude_and_phase(theta, covariance)
        sine = [b, b_err, item["rate_rad_s"], d, d_err]
    if coloured is not None:
        wide = np.array(coloured)
        far = [math.sqrt(wide[0, 0]), None, None, math.sqrt(wide[3, 3])]
        if item["has_sine"]:
            _, far[1], _, far[2] = amplitude_and_phase(theta, wide)
    return [a, a_err, *sine, e, e_err, item["sigma"], item["records"], *far]
