"""Stage 6, drift: the paper's offset rule, and the integration of what is left; the plain integral beside it.

The rate curve's offset is moved so that the curve starts at the commanded rate (0 on the other axes); it
is then integrated over the segment. Accumulated error = integral of the curve - commanded angle;
drift = accumulated error / duration. The offset itself, a bias, does not count: the rule is for turns at a
constant rate. The plain integral is that of the curve as it was measured, its offset in it. Both are linear
in the curve's coefficients, so their errors follow from the covariance exactly.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fogreduce.constants import SECONDS_PER_HOUR
from fogreduce.estimate.curve_terms import drift_terms, plain_terms
from fogreduce.estimate.mean_curve import curve
from fogreduce.metadata.facts import RunFacts
from fogreduce.stages.budget import Budget, Value
from fogreduce.stages.tables import Cell

NAME = "drift"

Array = NDArray[np.float64]

DRIFT = "axis,duration_s,nominal_deg,final_angle_deg,accumulated_error_deg,drift_deg_h"
DRIFT_COLUMNS = (
    f"{DRIFT},drift_err_deg_h,drift_err_coloured_deg_h,accumulated_err_deg,accumulated_err_coloured_deg,"
    "drift_err_stated_deg_h,accumulated_err_stated_deg,segment,version_id,"
    "integral_deg,integral_err_deg,integral_err_coloured_deg,integral_err_stated_deg,integral_less_commanded_deg,"
    "drift_err_combined_deg_h,accumulated_err_combined_deg,integral_err_combined_deg,"
    "drift_coverage_factor,drift_err_expanded_deg_h,integral_coverage_factor,integral_err_expanded_deg"
).split(",")

#: Of drift_by_records.csv: by complete records and, where `complete_records` is false, by every record of
#: three gyros or more; errors of white noise.
RULE_COLUMNS = ["axis", "segment", "rule", "records", "drift_deg_h", "drift_err_deg_h", "version_id"]


@dataclass(frozen=True)
class Angle:
    """An angle [deg] over a segment and its standard errors [deg].

    `white` is that of white noise, `coloured` that of all noise, `stated` what calibration record and
    run.yaml state as uncertain, noise not in it. NaN: not known.
    """

    value: float = math.nan
    white: float = math.nan
    coloured: float = math.nan
    stated: float = math.nan


def angle_of(terms: Array, item: Mapping[str, Any]) -> Angle:
    """What `terms` times the coefficients of a fitted curve are."""

    def error(key: str) -> float:
        covariance = item[key]
        return math.nan if covariance is None else math.sqrt(max(0.0, terms @ np.array(covariance) @ terms))

    return Angle(
        float(terms @ np.array(item["theta"])),
        error("covariance"),
        error("coloured_covariance"),
        error("stated_covariance"),
    )


def accumulated_error(segment: Mapping[str, Any], item: Mapping[str, Any]) -> Angle:
    """Accumulated error of an axis over a segment, by the offset rule; unknown without a slope."""
    if not item["has_slope"]:
        return Angle()
    return angle_of(drift_terms(segment["start_s"], segment["stop_s"], item["rate_rad_s"]), item)


def plain_integral(segment: Mapping[str, Any], item: Mapping[str, Any]) -> Angle:
    """Plain integral of an axis over a segment, Earth's part taken away."""
    return angle_of(plain_terms(segment["start_s"], segment["stop_s"], item["rate_rad_s"]), item)


def over_segments(parts: Sequence[Angle], whole: Value | None) -> Angle:
    """The sum over segments; its errors by coloured noise and what is stated are those of the budget."""
    return Angle(
        math.fsum(part.value for part in parts),
        math.hypot(*(part.white for part in parts)),
        math.nan if whole is None or any(math.isnan(part.coloured) for part in parts) else whole.noise,
        math.nan if whole is None else whole.stated,
    )


def adjusted_curve(
    segment: Mapping[str, Any], item: Mapping[str, Any], commanded: float, time_s: Array
) -> Array:
    """The curve with its offset moved so that it starts at the commanded rate [deg/s]."""
    theta = np.append(item["theta"], item["rate_rad_s"])
    start = curve(np.array([segment["start_s"]]), theta)[0]
    return curve(time_s, theta) - start + commanded


def drift_rows(
    facts: RunFacts, fits: Mapping[str, Any], axes: list[str], budget: Budget, version_id: str
) -> list[list[Cell]]:
    """Rows of drift.csv: each segment, and the whole run where there are several; none without axes.

    Over the whole run flicker and random walk go on from segment to segment, and what is stated is common to
    all of them, with its sign.
    """
    rows: list[list[Cell]] = []
    errors: dict[str, list[Angle]] = {axis: [] for axis in axes}
    integrals: dict[str, list[Angle]] = {axis: [] for axis in axes}
    signs = dict(zip(axes, facts.commanded_signs.tolist(), strict=False))
    for segment in fits["segments"]:
        found = {item["channel"]: item for item in segment["channels"] if item is not None}
        duration = segment["stop_s"] - segment["start_s"]
        for axis in axes:
            nominal = signs[axis] * segment["rate_deg_s"] * duration
            item = found.get(axis)
            error, integral = (
                Angle() if item is None else of(segment, item) for of in (accumulated_error, plain_integral)
            )
            errors[axis].append(error)
            integrals[axis].append(integral)
            rows.append(
                _row(axis, duration, nominal, error, integral, budget, segment["segment"], version_id)
            )
    if len(fits["segments"]) > 1:
        turned = float(facts.profile.edge_angles_deg[-1])
        for axis in axes:
            error, integral = (
                over_segments(parts[axis], budget.values.get((quantity, axis, "all")))
                for quantity, parts in (("accumulated_error", errors), ("integral", integrals))
            )
            nominal = signs[axis] * turned
            rows.append(_row(axis, facts.profile.end_s, nominal, error, integral, budget, "all", version_id))
    return rows


def rule_rows(
    fits: Mapping[str, Any], axes: Sequence[str], complete_records: bool, version_id: str
) -> list[list[Cell]]:
    """Rows of drift_by_records.csv: the drift of each axis in each segment by either choice of records."""
    rows: list[list[Cell]] = []
    for segment in fits["segments"]:
        every = {item["channel"]: item for item in segment["channels"] if item is not None}
        duration = segment["stop_s"] - segment["start_s"]
        for axis, complete in zip(axes, segment["complete_records"], strict=False):
            rules = {"complete": every.get(axis) if complete_records else complete}
            if not complete_records:
                rules["every"] = every.get(axis)
            for rule, item in rules.items():
                error = Angle() if item is None else accumulated_error(segment, item)
                records = 0 if item is None else item["records"]
                per_hour = SECONDS_PER_HOUR / duration
                drift = [error.value * per_hour, error.white * per_hour]
                rows.append([axis, segment["segment"], rule, records, *drift, version_id])
    return rows


def _row(
    axis: str,
    duration: float,
    nominal: float,
    error: Angle,
    integral: Angle,
    budget: Budget,
    segment: int | str,
    version_id: str,
) -> list[Cell]:
    per_hour = SECONDS_PER_HOUR / duration
    of_drift, of_error, of_integral = (
        budget.values.get((quantity, axis, segment))
        for quantity in ("drift", "accumulated_error", "integral")
    )
    return [
        axis,
        duration,
        nominal + 0.0,
        nominal + error.value,
        error.value,
        error.value * per_hour,
        error.white * per_hour,
        error.coloured * per_hour,
        error.white,
        error.coloured,
        error.stated * per_hour,
        error.stated,
        segment,
        version_id,
        integral.value,
        integral.white,
        integral.coloured,
        integral.stated,
        integral.value - nominal,
        None if of_drift is None else of_drift.combined,
        None if of_error is None else of_error.combined,
        None if of_integral is None else of_integral.combined,
        *_expanded(of_drift),
        *_expanded(of_integral),
    ]


def _expanded(value: Value | None) -> list[Cell]:
    """Coverage factor and expanded uncertainty."""
    return [None, None] if value is None else [value.factor, value.factor * value.combined]
