"""A small laboratory for diagnoses: six runs of a made-up unit, simulated and diagnosed."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path

import small_unit

from fogreduce.cli.main import main
from fogreduce.metadata.yaml12 import dump_yaml

#: Both senses about x and about y, slowly about z, and still [deg/s].
RATES = (10.0, -10.0, 10.0, -10.0, 0.5, 0.0)
AXES = {"x": {"x": "up", "z": "north"}, "y": {"y": "up", "x": "north"}, "z": {"z": "up", "y": "north"}}
RECORD = {
    **small_unit.RECORD,
    "unit": "U",
    "version": "1",
    "procedure": "made up",
    "uncertainty": {
        "scale_factor_rel": [2e-5] * 4,
        "bias_V": [1e-9] * 4,
        "axis_rad": [2e-5] * 4,
        "turn_on_bias_deg_h": [0.05] * 4,
    },
    "noise": {
        "angle_random_walk_deg_sqrt_h": [2e-3] * 4,
        "bias_instability_deg_h": [0.03] * 4,
        "rate_random_walk_deg_h_sqrt_h": [0.0] * 4,
    },
}
ONE_GYRO = {
    **{k: v for k, v in RECORD.items() if k not in ("H", "uncertainty", "noise")},
    "axes": [[1.0, 0.0, 0.0]],
    "scale_factor_V_per_deg_s": [0.075],
    "bias_V": [1e-4],
}


def write_run(
    root: Path,
    run_id: str,
    axis: str,
    profile: Sequence[tuple[float, float]],
    gyros: int,
    rate_hz: float,
    format_name: str = "fogcap-1",
    volts_per_count: float = 1e-7,
) -> None:
    """A run's run.yaml without its capture; `profile` is (rate [deg/s], duration [s]) in turn."""
    folder = root / "plan" / "runs" / run_id
    folder.mkdir(parents=True)
    run = {
        "schema": "fogreduce/run/1",
        "run_id": run_id,
        "unit": "U",
        "started_at": "2014-05-12T13:00:00Z",
        "site": {"latitude_deg": -23.2},
        "table": {
            "axis": axis,
            "profile": [{"rate_deg_s": rate, "duration_s": seconds} for rate, seconds in profile],
        },
        "orientation": AXES[axis],
        "capture": {
            "file": {"fogcap-1": "capture.fogcap", "csv-1": "capture.csv"}[format_name],
            "format": format_name,
            "sample_rate_hz": rate_hz,
            "volts_per_count": volts_per_count,
            "polarity": [1] * gyros,
        },
        "calibration": "U@1",
    }
    (folder / "run.yaml").write_text(dump_yaml(run))


def write_record(root: Path, record: dict) -> None:
    """The calibration record of the unit."""
    (root / "cal" / "U").mkdir(parents=True)
    (root / "cal" / "U" / "1.yaml").write_text(dump_yaml(record))


def lab(
    root: Path,
    record: dict = RECORD,
    rate_hz: float = 64.0,
    duration_s: float = 120.0,
    rates: Sequence[float] = RATES,
) -> None:
    """Six runs without captures, two about x, two about y, one about z, one about x, at `rates` [deg/s]."""
    write_record(root, record)
    for k, (axis, rate) in enumerate(zip("xxyyzx", rates, strict=True)):
        write_run(root, f"r{k}", axis, [(rate, duration_s)], len(record["bias_V"]), rate_hz)


def simulated(root: Path, effects: list[dict], name: str = "bench", seed: int = 5) -> Path:
    """A campaign made by the simulator with effects in it and the stated uncertainties drawn."""
    path = root / f"{name}.yaml"
    path.parent.mkdir(exist_ok=True)
    path.write_text(dump_yaml({"schema": "fogreduce/effects/1", "effects": effects}))
    arguments = [
        "simulate",
        str(root / "plan"),
        "--calibrations",
        str(root / "cal"),
        "--out",
        str(root / name),
    ]
    assert main([*arguments, "--effects", str(path), "--seed", str(seed), "--draw-uncertainties"]) == 0
    return root / name


def diagnosed(root: Path, campaign: Path, *more: str) -> dict:
    out = root / f"out-{campaign.name}"
    assert (
        main(["diagnose", str(campaign), "--calibrations", str(root / "cal"), "--out", str(out), *more]) == 0
    )
    return json.loads((out / "diagnosis.json").read_text())
