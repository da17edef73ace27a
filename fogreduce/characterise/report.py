"""The test report of a unit as a document: every quantity of a campaign, and what was checked beside them."""

from __future__ import annotations

import math
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from fogreduce.calibrate.derive import Derivation, derive
from fogreduce.calibrate.readings import residual_rates
from fogreduce.calibrate.swings import read_swings
from fogreduce.characterise.axes import same_turns
from fogreduce.characterise.bandwidth import Swung, response_lines, swung_gyros
from fogreduce.characterise.definitions import DEFINITIONS, Definitions
from fogreduce.characterise.left_out import each_left_out
from fogreduce.characterise.limits import Limits, verdict
from fogreduce.characterise.parity import Alarm, check_campaign
from fogreduce.characterise.quantities import quantities_of
from fogreduce.characterise.quantity import Quantity
from fogreduce.characterise.temperature import steady_windows
from fogreduce.provenance.digest import file_digest

SCHEMA = "fogreduce/report/1"


def report(
    campaign: Path, calibrations: Path, only: list[str], choices: Definitions, limits: Limits | None
) -> dict[str, Any]:
    """The document of a campaign's report.

    Parameters
    ----------
    campaign, calibrations : Path
    only : list of str
        Runs; empty: all.
    choices : Definitions
    limits : Limits or None

    Raises
    ------
    BadInput
        With every fault of the runs.
    """
    found = derive(campaign, calibrations, only)
    facts = found.readings[0].facts
    swings = read_swings(campaign, calibrations, only)
    swung, needs = swung_gyros(swings)
    quantities = quantities_of(found, choices, swung, needs)
    steady = {one.facts.run_id for one in found.readings}
    runs = [*found.readings, *(one for one in swings if one.facts.run_id not in steady)]
    document = {
        "schema": SCHEMA,
        "campaign": campaign.resolve().name,
        "unit": facts.unit,
        "calibration": found.readings[0].record.record_id,
        "runs": [_run(one, campaign) for one in runs],
        "definitions": choices.model_dump(mode="json"),
        "limits": None if limits is None else limits.model_dump(mode="json", exclude_none=True),
        "quantities": [_quantity(one, limits) for one in quantities],
        "response": [line for one in swung for line in _response(one)],
        "left_out": _left_out(found),
        "parity": _parity(found, choices),
        "same_turn": _same_turn(found),
        "windows": _windows(found),
    }
    return {key: _plain(value) for key, value in document.items()}


def _run(one: Any, campaign: Path) -> dict[str, Any]:
    return {
        "run": one.facts.run_id,
        "started_at": one.run.started_at.isoformat(),
        "duration_s": one.facts.profile.end_s,
        "rates_deg_s": sorted(set(one.facts.profile.rate_deg_s.tolist())),
        "capture_sha256": file_digest(campaign / "runs" / one.facts.run_id / one.run.capture.file),
    }


def _quantity(one: Quantity, limits: Limits | None) -> dict[str, Any]:
    definition = DEFINITIONS[one.name]
    outcome = None if limits is None else verdict(one, limits)
    return {
        "quantity": one.name,
        "of": one.of,
        "unit": one.unit,
        "determined": one.value is not None,
        "value": one.value,
        "std": one.std,
        "low_95": one.low,
        "high_95": one.high,
        "note": one.note,
        "needs": one.needs,
        "definition": definition.formula,
        "source": definition.source,
        "verdict": None if outcome is None else outcome[0],
        "conformance_probability": None if outcome is None else outcome[1],
    }


def _response(one: Swung) -> list[dict[str, Any]]:
    """Of a gyro to a swing."""
    return [
        {
            "run": one.run.facts.run_id,
            "gyro": f"gyro{one.gyro + 1}",
            **asdict(line),
        }
        for line in response_lines(one)
    ]


def _left_out(found: Derivation) -> list[dict[str, Any]]:
    """Each gyro left out, in the run with the longest segment."""
    if found.readings[0].facts.n_gyros < 4:
        return []
    longest = max(found.readings, key=lambda one: float(one.facts.profile.duration_s.max()))
    return [
        {
            "run": longest.facts.run_id,
            "segment": one.segment,
            "without": "none" if one.gyro is None else f"gyro{one.gyro + 1}",
            "variance_trace": one.trace,
            "noise_deg_sqrt_h": one.noise_deg_sqrt_h,
            "drift_deg_h": one.drift_deg_h,
            "drift_err_deg_h": one.drift_err_deg_h,
        }
        for one in each_left_out(longest, found.noise)
    ]


def _parity(found: Derivation, choices: Definitions) -> dict[str, Any]:
    hours = math.fsum(one.facts.profile.end_s for one in found.readings) / 3600
    alarms = check_campaign(found.readings, found.noise, choices.false_alarms_per_hour)
    return {
        "checked": found.readings[0].facts.n_gyros >= 4,
        "hours": hours,
        "false_alarms_expected": hours * choices.false_alarms_per_hour,
        "alarms": [_alarm(alarm) for alarm in alarms],
    }


def _alarm(alarm: Alarm) -> dict[str, Any]:
    return {
        "run": alarm.run,
        "check": alarm.check,
        "what": alarm.what,
        "since_s": alarm.since_s,
        "alarm_s": alarm.alarm_s,
        "size": alarm.size,
        "gyro": None if alarm.gyro is None else f"gyro{alarm.gyro + 1}",
        "isolated_by": alarm.isolated_by,
        "evidence": [asdict(one) for one in alarm.evidence],
    }


def _same_turn(found: Derivation) -> list[dict[str, Any]]:
    if found.readings[0].facts.n_gyros < 3:
        return []
    whole = [each_left_out(one, found.noise)[0] for one in found.readings]
    return [
        {
            "profile": one.profile,
            "runs": [
                {"run": run, "about": about, "drift_deg_h": drift, "drift_err_deg_h": error}
                for run, about, drift, error in zip(one.runs, one.about, one.drift, one.error, strict=True)
            ],
            "effects": [
                {"part": part.words, "deg_h": part.value, "std_deg_h": part.error} for part in one.effects
            ],
            "chi2": one.chi2,
            "degrees_of_freedom": one.freedom,
        }
        for one in same_turns(found.readings, whole)
        if len(one.runs) > 1
    ]


def _windows(found: Derivation) -> dict[str, Any] | None:
    """Of the longest run: drift of each gyro against start and length of the window."""
    longest = max(found.readings, key=lambda one: float(one.time_s[-1] - one.time_s[0]))
    residual = residual_rates(longest)
    gyros = []
    for i, values in enumerate(residual):
        if np.count_nonzero(np.isfinite(values)) < 16:
            continue
        seen = steady_windows(longest, values, found.noise[i].white_deg_sqrt_h)
        gyros.append(
            {
                "gyro": f"gyro{i + 1}",
                "start_s": seen.start_s,
                "length_s": seen.length_s,
                "drift_deg_h_per_h": seen.drift_deg_h_per_h,
                "error": seen.error,
                "steadiest": None
                if seen.steadiest is None
                else {"start_s": seen.steadiest[0], "length_s": seen.steadiest[1]},
            }
        )
    return {"run": longest.facts.run_id, "gyros": gyros} if gyros else None


def _plain(value: Any) -> Any:
    """Arrays as lists; a number that is none as None."""
    if isinstance(value, dict):
        return {key: _plain(one) for key, one in value.items()}
    if isinstance(value, list | np.ndarray):
        return [_plain(one) for one in value]
    if isinstance(value, np.generic):
        return _plain(value.item())
    return None if isinstance(value, float) and not math.isfinite(value) else value
