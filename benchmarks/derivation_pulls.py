"""Pulls of derived calibrations: `python benchmarks/derivation_pulls.py [CAMPAIGNS]` (200 by default).

Campaigns of several designs are simulated with every stated uncertainty drawn; each derived parameter less
the truth, in its standard error, is a pull. The whole vector of a campaign, brought to independent values by
its covariance, tests the off-diagonals too. Kolmogorov's test says whether they are standard normal.
"""

from __future__ import annotations

import sys
import tempfile
from collections import defaultdict
from contextlib import redirect_stdout
from io import StringIO
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from scipy.stats import kstest

from fogreduce.calibrate.derive import Derivation, derive
from fogreduce.calibrate.record import candidate
from fogreduce.cli.main import main as fogreduce

SECONDS_PER_HOUR = 3600.0
UP = {
    "x": {"x": "up", "z": "north"},
    "y": {"y": "up", "x": "north"},
    "z": {"z": "up", "y": "north"},
    "-x": {"x": "down", "z": "north"},
    "-y": {"y": "down", "x": "north"},
    "-z": {"z": "down", "y": "north"},
}
#: Design -> runs: orientation, axis of the table, profile of (rate deg/s, seconds).
DESIGNS: dict[str, list[tuple[str, str, list[tuple[float, float]]]]] = {
    "a run each sense, slow, still": [
        *[(axis, axis, [(sign * 10.0, 72.0)]) for axis in "xyz" for sign in (1, -1)],
        ("x", "x", [(0.5, 72.0)]),
        ("x", "x", [(0.0, 72.0)]),
    ],
    "both senses and still in a run, twice": [
        (axis, axis, [(10.0, 30.0), (-10.0, 30.0), (0.0, 30.0)]) for axis in "xyzxyz"
    ],
    "six rests and three turns": [
        *[(up, up[-1], [(0.0, 72.0)]) for up in UP],
        *[(axis, axis, [(20.0, 36.0), (-20.0, 36.0)]) for axis in "xyz"],
    ],
    "several rates": [
        (axis, axis, [(rate, 24.0) for rate in (30.0, 10.0, -10.0, -30.0)]) for axis in "xyz" for _ in (0, 1)
    ],
}
RECORD: dict[str, Any] = {
    "schema": "fogreduce/calibration/1",
    "unit": "UNIT",
    "version": "a",
    "valid_from": "2010-01-01T00:00:00Z",
    "procedure": "made for a benchmark",
    "H": [[0.29, 0.29, 0.29, 0.5], [0.0, 0.705, -0.705, 0.0], [0.815, -0.41, -0.41, 0.0]],
    "scale_factor_V_per_deg_s": [0.075, 0.09, -0.092, 0.0746],
    "bias_V": [0.00019, 0.00064, 0.00017, -0.00042],
    "uncertainty": {
        "scale_factor_rel": [2e-4] * 4,
        "bias_V": [2e-5] * 4,
        "axis_rad": [3e-4] * 4,
        "turn_on_bias_deg_h": [0.3, 0.2, 0.5, 0.1],
    },
    "noise": {
        "angle_random_walk_deg_sqrt_h": [0.002] * 4,
        "bias_instability_deg_h": [0.03] * 4,
        "rate_random_walk_deg_h_sqrt_h": [0.0] * 4,
    },
}


def plan(folder: Path, design: str) -> Path:
    """The runs of a design, without captures."""
    for k, (up, axis, profile) in enumerate(DESIGNS[design]):
        run = {
            "schema": "fogreduce/run/1",
            "run_id": f"r{k}",
            "unit": "UNIT",
            "started_at": "2014-05-12T13:00:00Z",
            "site": {"latitude_deg": 48.0},
            "table": {
                "axis": axis,
                "profile": [{"rate_deg_s": rate, "duration_s": seconds} for rate, seconds in profile],
            },
            "orientation": UP[up],
            "capture": {
                "file": "capture.fogcap",
                "format": "fogcap-1",
                "sample_rate_hz": 16,
                "volts_per_count": 1e-7,
                "polarity": [1, -1, 1, 1],
            },
            "calibration": "UNIT@a",
        }
        place = folder / "plan" / "runs" / f"r{k}"
        place.mkdir(parents=True)
        (place / "run.yaml").write_text(yaml.safe_dump(run))
    return folder / "plan"


def made(folder: Path, design: str, seed: int) -> tuple[Path, Path, list[dict[str, Any]]]:
    """A campaign with captures, the calibrations, and what was drawn."""
    calibrations = folder / "calibrations"
    (calibrations / "UNIT").mkdir(parents=True)
    (calibrations / "UNIT" / "a.yaml").write_text(yaml.safe_dump(RECORD))
    words = ["simulate", str(plan(folder, design)), "--calibrations", str(calibrations)]
    with redirect_stdout(StringIO()):
        status = fogreduce(
            [*words, "--out", str(folder / "made"), "--draw-uncertainties", "--seed", str(seed)]
        )
    assert status == 0
    drawn = yaml.safe_load((folder / "made.injected.yaml").read_text())["drawn"]
    return folder / "made", calibrations, drawn


def errors(found: Derivation, drawn: list[dict[str, Any]]) -> np.ndarray:
    """Derived less true, in the order of the covariance: bias, scale factor, axis (2) of each gyro."""
    facts, parameters = found.readings[0].facts, found.parameters
    out = []
    for i in range(facts.n_gyros):
        of = {one["effect"]: one["parameters"] for one in drawn if one["channels"] == [f"gyro{i + 1}"]}
        s = (1 + of["scale_factor_error"]["ppm"] * 1e-6) * (
            facts.axes[i] + np.array(of["axis_misalignment"]["mrad"]) * 1e-3
        )
        length = float(np.linalg.norm(s))
        raw_deg_h = facts.bias[i] / facts.scale_factor[i] * SECONDS_PER_HOUR + of["bias_offset"]["deg_h"]
        axis = parameters.across[i] @ (parameters.axes[i] - s / length)
        out += [parameters.bias_deg_h[i] - raw_deg_h / length, parameters.scale_ratio[i] / length - 1, *axis]
    return np.array(out)


def main() -> None:
    """Print the table."""
    number = int(sys.argv[1]) if len(sys.argv) > 1 else 200
    pulls: dict[str, list[float]] = defaultdict(list)
    for k in range(number):
        design = list(DESIGNS)[k % len(DESIGNS)]
        with tempfile.TemporaryDirectory() as name:
            campaign, calibrations, drawn = made(Path(name), design, 5000 + k)
            found = derive(campaign, calibrations)
            assert not found.undetermined
            candidate(found, campaign, "b")
            left, covariance = errors(found, drawn), found.parameters.covariance
        # Of one gyro a campaign: what the table's rate is off by moves the scale factors of all.
        each = (left / np.sqrt(np.diag(covariance))).reshape(-1, 4)[k // len(DESIGNS) % 4]
        for what, value in zip(("bias", "scale factor", "axis, first", "axis, second"), each, strict=True):
            pulls[what].append(float(value))
        whitened = np.linalg.solve(np.linalg.cholesky(covariance), left)
        pulls["all, with off-diagonals"] += whitened.tolist()
        pulls[design] += whitened.tolist()
    print(f"{number} campaigns")
    for what, values in pulls.items():
        p = kstest(values, "norm").pvalue
        print(f"{what:38} {len(values):5} mean {np.mean(values):+.3f} std {np.std(values):.3f} p {p:.3g}")


if __name__ == "__main__":
    main()
