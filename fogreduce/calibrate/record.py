"""The candidate record: what a derivation found, as a calibration record with covariance and pedigree."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

import fogreduce
from fogreduce.calibrate.derive import Derivation
from fogreduce.constants import SECONDS_PER_HOUR
from fogreduce.metadata.calibration import record_in
from fogreduce.metadata.instant import instant_text
from fogreduce.physics.redundancy import projection
from fogreduce.provenance.code import code_digest
from fogreduce.provenance.digest import file_digest

#: Parameters of a gyro in the covariance, in the order of `parameters.NAMES`.
_PARAMETERS = ("bias_deg_h", "scale_factor_rel", "axis1_rad", "axis2_rad")


def candidate(derivation: Derivation, campaign: Path, version: str) -> dict[str, Any]:
    """The record as plain data in the contract's form, valid.

    The pointing error of an axis is the root mean square of its errors in the two directions. Flicker and
    random walk are the present record's where it states them, else what the readings show.

    Parameters
    ----------
    derivation : Derivation
        One that determines everything.
    campaign : Path
        The campaign's folder.
    version : str
        The new record's version.
    """
    one, found = derivation.readings[0], derivation.parameters
    present, facts = one.record, one.facts
    raw = facts.raw_unit
    errors = found.standard_errors
    scale = facts.scale_factor * found.scale_ratio
    geometry = {"H": projection(found.axes).tolist()} if facts.n_gyros >= 3 else {"axes": found.axes.tolist()}
    data: dict[str, Any] = {
        "schema": "fogreduce/calibration/1",
        "unit": present.unit,
        "version": version,
        "valid_from": min(instant_text(reading.run.started_at) for reading in derivation.readings),
        "procedure": f"derived from campaign {campaign.resolve().name} by fogreduce derive-calibration",
        **geometry,
        raw.scale_factor_key: scale.tolist(),
        raw.bias_key: (found.bias_deg_h / SECONDS_PER_HOUR * scale).tolist(),
        "uncertainty": {
            "scale_factor_rel": errors[:, 1].tolist(),
            raw.bias_key: (errors[:, 0] / SECONDS_PER_HOUR * np.abs(scale)).tolist(),
            "axis_rad": np.sqrt((errors[:, 2] ** 2 + errors[:, 3] ** 2) / 2).tolist(),
            "turn_on_bias_deg_h": derivation.solution.turn_on_deg_h.tolist(),
        },
        "noise": {
            "angle_random_walk_deg_sqrt_h": [noise.white_deg_sqrt_h for noise in derivation.noise],
            "bias_instability_deg_h": [noise.flicker_deg_h for noise in derivation.noise],
            "rate_random_walk_deg_h_sqrt_h": [noise.walk_deg_h_sqrt_h for noise in derivation.noise],
        },
        "supersedes": present.record_id,
        "pedigree": _pedigree(derivation, campaign),
        "covariance": {
            "parameters": [f"gyro{i + 1}.{name}" for i in range(facts.n_gyros) for name in _PARAMETERS],
            "axis_directions": found.across.reshape(-1, 3).tolist(),
            "matrix": found.covariance.tolist(),
        },
    }
    record_in(raw.name).from_data(data, f"{version}.yaml")
    return data


def _pedigree(derivation: Derivation, campaign: Path) -> dict[str, Any]:
    folder = campaign / "runs"
    return {
        "campaign": campaign.resolve().name,
        "runs": [
            {
                "run_id": one.run.run_id,
                "run_yaml_sha256": file_digest(folder / one.run.run_id / "run.yaml"),
                "capture_sha256": file_digest(folder / one.run.run_id / one.run.capture.file),
            }
            for one in derivation.readings
        ],
        "started_from": derivation.readings[0].record.record_id,
        "fogreduce": fogreduce.__version__,
        "code_sha256": code_digest("fogreduce.calibrate.record"),
        "chi2": derivation.solution.chi2,
        "degrees_of_freedom": derivation.solution.freedom,
    }
