"""What a derivation found, as a document (derivation.json) and as a few lines for the console."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from fogreduce.calibrate.coefficients import Coefficients
from fogreduce.calibrate.derive import Derivation
from fogreduce.calibrate.solution import Solution
from fogreduce.constants import SECONDS_PER_HOUR
from fogreduce.pages.numbers import plus_minus, signed
from fogreduce.physics.redundancy import projection
from fogreduce.physics.special import log_chi2_tail

SCHEMA = "fogreduce/derivation/1"

#: What the console says of a gyro's change: key, words, unit.
_SUMMARY = (
    ("bias_deg_h", "bias", "deg/h"),
    ("scale_factor_ppm", "scale factor", "ppm"),
    ("axis1_mrad", "axis", "mrad"),
    ("axis2_mrad", "and", "mrad"),
)


def document(derivation: Derivation, campaign: Path, candidate: str | None) -> dict[str, Any]:
    """The document.

    Parameters
    ----------
    derivation : Derivation
    campaign : Path
    candidate : str or None
        Id of the record that was written; None where something is undetermined.
    """
    solution, found = derivation.solution, derivation.parameters
    facts = derivation.readings[0].facts
    runs = [one.facts.run_id for one in derivation.readings]
    motion = solution.layout.motion(0)
    white = [noise.white_deg_sqrt_h for noise in derivation.noise]
    return {
        "schema": SCHEMA,
        "campaign": campaign.resolve().name,
        "runs": runs,
        "started_from": derivation.readings[0].record.record_id,
        "candidate": candidate,
        "chi2": {
            "value": solution.chi2,
            "degrees_of_freedom": solution.freedom,
            "p_value": math.exp(log_chi2_tail(solution.chi2, round(solution.freedom))),
        },
        "gyros": [_gyro(derivation, i) for i in range(facts.n_gyros)],
        "H_pseudo_inverse": projection(found.axes).tolist() if facts.n_gyros >= 3 else None,
        "H_by_noise": projection(found.axes, white).tolist()
        if facts.n_gyros >= 3 and min(white) > 0
        else None,
        "motion": {
            "unit": "stated standard deviations",
            "azimuth": {run: _estimate(solution, solution.layout.motion(k)[0]) for k, run in enumerate(runs)},
            "latitude": _estimate(solution, motion[1]),
            "table_rate": _estimate(solution, motion[2]),
        },
        "turn_on": [
            {
                "run": runs[one.run],
                "gyro": f"gyro{one.gyro + 1}",
                "deg_h": one.deg_h,
                "std_deg_h": one.std_deg_h,
                "chi2": one.chi2,
                "degrees_of_freedom": one.freedom,
            }
            for one in derivation.turn_on
        ],
        "departures": [
            {"shape": one.name, "gyro": f"gyro{one.gyro + 1}", "value": one.value, "std": one.std}
            | {"unit": one.unit}
            for one in derivation.shapes
        ],
        "undetermined": [
            {"parameters": one.words, "open_directions": one.directions, "of": one.parameters}
            for one in derivation.undetermined
        ],
        "next_run": derivation.next_run,
    }


def _gyro(derivation: Derivation, i: int) -> dict[str, Any]:
    """Bias, scale factor and axis of a gyro beside the present record's, with the difference in sigma."""
    found, one = derivation.parameters, derivation.readings[0]
    facts, noise = one.facts, derivation.noise[i]
    raw = facts.raw_unit
    errors = found.standard_errors[i]
    stated = one.record.stated_uncertainty
    ignorance = derivation.ignorance
    present = Coefficients.of(one.record)
    tipped = found.across[i] @ (found.axes[i] - present.axes[i])
    scale = float(facts.scale_factor[i] * found.scale_ratio[i])
    scale_ppm = (scale / present.scale_factor[i] - 1) * 1e6
    bias = found.bias_deg_h[i] - present.bias_deg_h[i]
    stated_bias = present.bias_std_deg_h[i]
    mrad = stated.axis_rad[i] * 1e3, float(ignorance.axis_rad[i]) * 1e3
    return {
        "gyro": f"gyro{i + 1}",
        raw.scale_factor_key: scale,
        raw.bias_key: float(found.bias_deg_h[i] / SECONDS_PER_HOUR * scale),
        "axis": found.axes[i].tolist(),
        "change_from_present": {
            "bias_deg_h": _change(bias, errors[0], stated_bias, float(ignorance.bias_deg_h[i])),
            "scale_factor_ppm": _change(
                scale_ppm,
                errors[1] * 1e6,
                stated.scale_factor_rel[i] * 1e6,
                float(ignorance.scale_factor_rel[i]) * 1e6,
            ),
            "axis1_mrad": _change(tipped[0] * 1e3, errors[2] * 1e3, *mrad),
            "axis2_mrad": _change(tipped[1] * 1e3, errors[3] * 1e3, *mrad),
        },
        "turn_on_bias_deg_h": {
            "value": float(derivation.solution.turn_on_deg_h[i]),
            "std_of_logarithm": float(derivation.solution.turn_on_log_std[i]),
        },
        "noise": {
            "angle_random_walk_deg_sqrt_h": noise.white_deg_sqrt_h,
            "bias_instability_deg_h": noise.flicker_deg_h,
            "rate_random_walk_deg_h_sqrt_h": noise.walk_deg_h_sqrt_h,
            "flicker_and_walk_from": "calibration record" if noise.stated else "readings",
        },
    }


def _change(value: float, std: float, stated_std: float, ignorance: float) -> dict[str, Any]:
    """A change from the present record, its error, and how far it is beyond both errors."""
    both = math.hypot(std, stated_std)
    return {
        "determined": bool(std < ignorance / 2),
        "value": float(value),
        "std": float(std),
        "stated_std": float(stated_std),
        "sigma": float(abs(value) / both) if both > 0 else 0.0,
    }


def _estimate(solution: Solution, where: int) -> dict[str, float]:
    """An unknown of the solution and its standard error."""
    return {
        "value": float(solution.values[where]),
        "std": float(np.sqrt(solution.covariance[where, where])),
    }


def summary(data: Mapping[str, Any]) -> str:
    """The document in a few lines."""
    chi2 = data["chi2"]
    lines = [
        f"{data['campaign']}: {len(data['runs'])} runs, chi-square {chi2['value']:.0f} for "
        f"{chi2['degrees_of_freedom']:.0f} degrees of freedom"
    ]
    for gyro in data["gyros"]:
        change = gyro["change_from_present"]
        words = ", ".join(
            f"{words} {signed(plus_minus(change[key]['value'], change[key]['std'], unit))}"
            for key, words, unit in _SUMMARY
            if change[key]["determined"]
        )
        lines.append(f"{gyro['gyro']}: {words or 'nothing'} from {data['started_from']}")
    for one in data["undetermined"]:
        ways = (
            "" if one["open_directions"] == one["of"] else f" ({one['open_directions']} of {one['of']} ways)"
        )
        lines.append(f"not determined: {one['parameters']}{ways}")
    if data["undetermined"]:
        lines.append("no candidate record is written, since something is not determined")
    return "\n".join(lines)
