"""Runs and calibrations for the simulator's tests, built from plain data (nothing from disk)."""

from __future__ import annotations

from typing import Any

import numpy as np

from fogreduce.datasets.logs import TemperatureLog
from fogreduce.metadata.facts import RunFacts

H = [
    [2.891714702786278e-01, 2.892335095117639e-01, 2.876136426324943e-01, 5.017305804843861e-01],
    [-4.639681532136366e-03, 7.052669198527741e-01, -7.041214018909228e-01, -1.744579996672102e-03],
    [8.144462476125298e-01, -4.097230037870795e-01, -4.108263813061506e-01, -8.696722162293962e-04],
]  # the paper's Table 1
SCALE = [7.522908422043020e-02, 8.964439238881419e-02, 9.189284391406990e-02, 7.455121778844402e-02]
BIAS = [1.906346716594093e-04, 6.398748539807179e-04, 1.716324447569210e-04, -4.157957857055158e-04]


def run_data(**changes: Any) -> dict[str, Any]:
    """run.yaml as plain data: 10 deg/s about vertical x for 300 s, unless changed."""
    data: dict[str, Any] = {
        "schema": "fogreduce/run/1",
        "run_id": "a",
        "unit": "TETRA-01",
        "started_at": "2014-05-12T13:00:00Z",
        "site": {"latitude_deg": -23.21132308},
        "table": {"axis": [1.0, 0.0, 0.0], "profile": [{"rate_deg_s": 10.0, "duration_s": 300.0}]},
        "orientation": {"x": "up", "z": "north"},
        "azimuth_deg": 30.0,
        "frame_signs": [1, 1, 1],
        "capture": {
            "file": "capture.fogcap",
            "format": "fogcap-1",
            "sample_rate_hz": 128.0,
            "volts_per_count": 1e-7,
            "polarity": [1, -1, 1, 1],
        },
        "calibration": "TETRA-01@2012a",
    }
    capture = changes.pop("capture", {})
    data.update(changes)
    data["capture"] = {**data["capture"], **capture}
    return data


def calibration_data(**changes: Any) -> dict[str, Any]:
    """A calibration record as plain data: the paper's Tables 1 to 3."""
    return {"H": H, "scale_factor_V_per_deg_s": SCALE, "bias_V": BIAS, **changes}


def facts(**changes: Any) -> RunFacts:
    """Numbers of `run_data` with the paper's calibration."""
    return RunFacts.of(run_data(**changes), calibration_data())


def profile(*steps: tuple[float, float]) -> list[dict[str, float]]:
    """(rate, duration) pairs as run.yaml has them."""
    return [{"rate_deg_s": rate, "duration_s": duration} for rate, duration in steps]


def ramp_log(duration_s: float = 300.0, per_s: float = 0.01, start: float = 25.0) -> TemperatureLog:
    """A straight rise, a row a second."""
    time = np.arange(0.0, duration_s + 1.0)
    return TemperatureLog(time, start + 6.0 + per_s * time, start + per_s * time)
