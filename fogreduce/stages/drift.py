"""Stage 6, drift: the paper's offset rule, and the integration of what is left.

The rate curve's offset is moved so that the curve starts at the commanded rate (0 on the other axes); it
is then integrated over the segment. Accumulated error = integral of the curve - commanded angle;
drift = accumulated error / duration. The integral is linear in the curve's coefficients, so its error
follows from their covariance exactly. The offset itself, a bias, does not count.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fogreduce.constants import SECONDS_PER_HOUR
from fogreduce.estimate.mean_curve import curve, integral_terms
from fogreduce.metadata.facts import RunFacts
from fogreduce.stages.tables import Cell

NAME = "drift"

Array = NDArray[np.float64]

DRIFT = "axis,duration_s,nominal_deg,final_angle_deg,accumulated_error_deg,drift_deg_h"
DRIFT_COLUMNS = (
    f"{DRIFT},drift_err_deg_h,drift_err_coloured_deg_h,accumulated_err_deg,accumulated_err_coloured_deg,"
    "segment,version_id"
).split(",")


def drift_terms(start_s: float, stop_s: float, rate_rad_s: float) -> Array:
    """(4,): the accumulated error is these times theta = (a, p, q, e).

    Integral of ``p cos(ct) + q sin(ct) + e t`` over the segment, less the same at its start times the
    duration; a, the offset, does not count.
    """
    duration = stop_s - start_s
    whole = integral_terms(np.array([start_s, stop_s]), rate_rad_s) @ np.array([-1.0, 1.0])
    phase = rate_rad_s * start_s
    at_start = np.array([1.0, math.cos(phase), math.sin(phase), start_s])
    terms: Array = whole - duration * at_start
    terms[0] = 0.0
    return terms


def accumulated_error(segment: Mapping[str, Any], item: Mapping[str, Any]) -> tuple[float, float, float]:
    """Accumulated error of an axis over a segment [deg], its white and its coloured standard error."""
    terms = drift_terms(segment["start_s"], segment["stop_s"], item["rate_rad_s"])
    white = math.sqrt(terms @ np.array(item["covariance"]) @ terms)
    coloured = item["coloured_covariance"]
    wide = math.nan if coloured is None else math.sqrt(max(0.0, terms @ np.array(coloured) @ terms))
    return float(terms @ np.array(item["theta"])), white, wide


def adjusted_curve(
    segment: Mapping[str, Any], item: Mapping[str, Any], commanded: float, time_s: Array
) -> Array:
    """The curve with its offset moved so that it starts at the commanded rate [deg/s]."""
    theta = np.append(item["theta"], item["rate_rad_s"])
    start = curve(np.array([segment["start_s"]]), theta)[0]
    return curve(time_s, theta) - start + commanded


def drift_rows(
    facts: RunFacts, fits: Mapping[str, Any], axes: list[str], version_id: str
) -> list[list[Cell]]:
    """Rows of drift.csv: each segment, and the whole run where there are several; none without axes."""
    rows: list[list[Cell]] = []
    whole: dict[str, list[tuple[float, ...]]] = {axis: [] for axis in axes}
    for segment in fits["segments"]:
        found = {item["channel"]: item for item in segment["channels"] if item is not None}
        duration = segment["stop_s"] - segment["start_s"]
        for sign, axis in zip(facts.commanded_signs.tolist(), axes, strict=False):
            nominal = sign * segment["rate_deg_s"] * duration
            parts = accumulated_error(segment, found[axis]) if axis in found else (math.nan,) * 3
            whole[axis].append((nominal, *parts))
            rows.append(_row(axis, duration, nominal, *parts, segment["segment"], version_id))
    if len(fits["segments"]) > 1:
        duration = fits["segments"][-1]["stop_s"]
        for axis in axes:
            nominal, error, white, coloured = np.array(whole[axis]).T
            sums = float(error.sum()), float(np.hypot.reduce(white)), float(np.hypot.reduce(coloured))
            rows.append(_row(axis, duration, float(nominal.sum()), *sums, "all", version_id))
    return rows


def _row(
    axis: str,
    duration: float,
    nominal: float,
    error: float,
    white: float,
    coloured: float,
    segment: int | str,
    version_id: str,
) -> list[Cell]:
    per_hour = SECONDS_PER_HOUR / duration
    return [
        axis,
        duration,
        nominal + 0.0,
        nominal + error,
        error,
        error * per_hour,
        white * per_hour,
        coloured * per_hour,
        white,
        coloured,
        segment,
        version_id,
    ]
