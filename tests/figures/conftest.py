"""Small runs, simulated and reduced once: with spikes and logs, of several rates, of one and two gyros."""

from __future__ import annotations

import struct
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from fogreduce.cli.main import main
from fogreduce.figures.results import Results

ROOT = Path(__file__).parents[2]
LABEL = "made up for a test"
RATE_HZ = 16.0

#: Record, gyro (from 0) and added counts of the spikes in the run `spiked`.
SPIKES = ((700, 1, 40_000_000), (4000, 1, 90_000_000), (6001, 1, -50_000_000), (9000, 3, 30_000_000))


def _run_yaml(run_id: str, unit: str, steps: list[tuple[float, float]], **more: Any) -> dict[str, Any]:
    n = {"TETRA-01": 4, "ONE": 1, "TWO": 2}[unit]
    return {
        "schema": "fogreduce/run/1",
        "run_id": run_id,
        "unit": unit,
        "started_at": "2014-05-12T13:00:00Z",
        "site": {"latitude_deg": -23.2},
        "table": {
            "axis": "x",
            "profile": [{"rate_deg_s": rate, "duration_s": duration} for rate, duration in steps],
        },
        "orientation": {"x": "up", "z": "north"},
        "capture": {
            "file": "capture.fogcap",
            "format": "fogcap-1",
            "sample_rate_hz": RATE_HZ,
            "volts_per_count": 1e-7,
            "polarity": [1, -1, 1, 1][:n],
        },
        "calibration": "TETRA-01@2012a" if unit == "TETRA-01" else f"{unit}@a",
        **more,
    }


def _small_unit(unit: str, n: int) -> dict[str, Any]:
    return {
        "schema": "fogreduce/calibration/1",
        "unit": unit,
        "version": "a",
        "valid_from": "2012-06-01T00:00:00Z",
        "procedure": "made up",
        "axes": [[1, 0, 0], [0, 0.6, 0.8]][:n],
        "scale_factor_V_per_deg_s": [0.075, 0.08][:n],
        "bias_V": [1e-4, -2e-4][:n],
    }


def _write_source(source: Path, calibrations: Path) -> None:
    """The campaign's run.yaml files and logs, and the calibration records."""
    record = ROOT / "calibrations" / "TETRA-01" / "2012a.yaml"
    (calibrations / "TETRA-01").mkdir(parents=True)
    (calibrations / "TETRA-01" / "2012a.yaml").write_bytes(record.read_bytes())
    for unit, n in (("ONE", 1), ("TWO", 2)):
        (calibrations / unit).mkdir()
        (calibrations / unit / "a.yaml").write_text(yaml.safe_dump(_small_unit(unit, n)))
    runs = [
        _run_yaml("spiked", "TETRA-01", [(0.6, 600.0)], temperature="temperature.csv", table_log="table.csv"),
        _run_yaml("steps", "TETRA-01", [(0.0, 60.0), (5.0, 120.0), (-2.0, 90.0)], frame_signs=[-1, 1, 1]),
        _run_yaml("one", "ONE", [(0.6, 120.0)]),
        _run_yaml("two", "TWO", [(0.6, 120.0)]),
    ]
    for run in runs:
        folder = source / "runs" / run["run_id"]
        folder.mkdir(parents=True)
        (folder / "run.yaml").write_text(yaml.safe_dump(run))
    campaign = {"schema": "fogreduce/campaign/1", "title": "test", "label": LABEL}
    (source / "campaign.yaml").write_text(yaml.safe_dump(campaign))
    time = np.arange(0.0, 601.0)
    spiked = source / "runs" / "spiked"
    rows = "".join(f"{t:g},{30 + t / 600:.4f},{25 + t / 1200:.4f}\n" for t in time)
    (spiked / "temperature.csv").write_text("time_s,electronics_degC,sensor_degC\n" + rows)
    rows = "".join(f"{t:g},{7 + 0.6 * t + 0.002 * np.sin(t / 9):.9f}\n" for t in time)
    (spiked / "table.csv").write_text("time_s,angle_deg\n" + rows)


def _spoil(capture: Path) -> None:
    data = bytearray(capture.read_bytes())
    for record, gyro, counts in SPIKES:
        place = 64 + record * (12 + 4 * 4) + 12 + 4 * gyro
        (value,) = struct.unpack_from("<i", data, place)
        struct.pack_into("<i", data, place, value + counts)
    capture.write_bytes(data)


@pytest.fixture(scope="session")
def campaign(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with `source`, `calibrations`, the simulated `campaign` and `results/<run>`."""
    root = tmp_path_factory.mktemp("figures")
    calibrations = root / "calibrations"
    _write_source(root / "source", calibrations)
    options = ["--calibrations", str(calibrations), "--out"]
    assert main(["simulate", str(root / "source"), *options, str(root / "campaign")]) == 0
    _spoil(root / "campaign" / "runs" / "spiked" / "capture.fogcap")
    for run in ("spiked", "steps", "one", "two"):
        folder = root / "campaign" / "runs" / run
        assert main(["reduce", str(folder), *options, str(root / "results" / run)]) == 0
    return root


@pytest.fixture(scope="session")
def results(campaign: Path) -> Callable[[str], Results]:
    """Results of one of the runs, by name."""
    read: dict[str, Results] = {}

    def get(run: str) -> Results:
        if run not in read:
            read[run] = Results.read(campaign / "results" / run)
        return read[run]

    return get
