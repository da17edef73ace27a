"""The laboratory whose files are spoilt: one run of twenty seconds with logs, reduced once."""

from __future__ import annotations

import math
import shutil
from pathlib import Path
from typing import Any

from attempt import attempt
from small_lab import RECORD, RUN, START_US, VOLTS_PER_COUNT, SmallLab, csv_lines, header, records

from fogreduce.metadata.yaml12 import dump_yaml

COUNT = 320
RATE_HZ = 16.0
GYROS = 4
FOGCAP = {"n": GYROS, "rate": RATE_HZ, "volts": VOLTS_PER_COUNT, "start_us": START_US, "unit": "TETRA-01"}

RUN_DATA: dict[str, Any] = {
    **RUN,
    "site": {"latitude_deg": -23.2, "longitude_deg": -45.9, "name": "a", "latitude_uncertainty_deg": 0.001},
    "table": {
        "axis": [0.0, 0.6, 0.8],
        "profile": [{"rate_deg_s": 10.0, "duration_s": 12.0}, {"rate_deg_s": 0.0, "duration_s": 8.0}],
        "rate_uncertainty_ppm": 5.0,
    },
    "azimuth_deg": 3.0,
    "azimuth_uncertainty_deg": 0.05,
    "frame_signs": [1, 1, -1],
    "temperature": "temperature.csv",
    "table_log": "table.csv",
    "notes": "a note",
}  # fmt: skip
RECORD_DATA: dict[str, Any] = {
    **RECORD,
    "valid_until": "2020-01-01T00:00:00Z",
    "uncertainty": {"scale_factor_rel": [1e-4] * 4, "axis_rad": [1e-4] * 4, "turn_on_bias_deg_h": [1.0] * 4},
    "noise": {"angle_random_walk_deg_sqrt_h": [0.05] * 4, "bias_instability_deg_h": [0.1] * 4},
}
CAMPAIGN_DATA: dict[str, Any] = {
    "schema": "fogreduce/campaign/1",
    "title": "fuzzed",
    "operator": "nobody",
    "calibration": "TETRA-01@2012a",
    "captures_from": {"simulate": {"seed": 3}},
    "label": "made up",
    "diagnose": False,
}
EFFECTS_DATA: dict[str, Any] = {
    "schema": "fogreduce/effects/1",
    "effects": [
        {"effect": "table_rate_error", "channels": ["table"], "runs": ["*"], "parameters": {"ppm": 35}},
        {"effect": "bias_ramp", "channels": ["gyro2"], "runs": ["r1"], "parameters": {"deg_h_per_h": 1.2}},
        {"effect": "mount_rotation", "channels": ["table"], "parameters": {"mrad": [0.1, 0.2, 0.3]}},
        {"effect": "dead_zone", "channels": ["gyro1"], "parameters": {"deg_h": 2.0, "kind": "threshold"}},
        {"effect": "spikes", "channels": ["gyro3"], "parameters": {"fraction": 0.01}},
        {"effect": "lost_bits", "channels": ["gyro4"], "parameters": {"bits": 2}},
        {"effect": "crosstalk", "channels": ["gyro1"], "parameters": {"ppm": 5.0, "source": "gyro2"}},
        {"effect": "channel_swap", "channels": ["gyro3"], "parameters": {"with": "gyro4"}},
        {"effect": "clock_error", "channels": ["clock"], "parameters": {"ppm": 3.0}},
        {"effect": "polarity_error", "channels": ["gyro2"]},
    ],
}


class FuzzLab(SmallLab):
    """A campaign of one run whose every file is there and good, and its results in `reduced`."""

    def __init__(self, root: Path) -> None:
        super().__init__(root)
        self.reduced = root / "reduced"
        self.effects = root / "effects.yaml"
        self.csv = self.run / "capture.csv"
        self.good = {
            self.capture: header() + records(COUNT).tobytes(),
            self.csv: ("\n".join(csv_lines(COUNT)) + "\n").encode(),
            self.yaml: dump_yaml(RUN_DATA).encode(),
            self.record: dump_yaml(RECORD_DATA).encode(),
            self.campaign / "campaign.yaml": dump_yaml(CAMPAIGN_DATA).encode(),
            self.effects: dump_yaml(EFFECTS_DATA).encode(),
            self.run / "temperature.csv": _temperatures().encode(),
            self.run / "table.csv": _angles().encode(),
        }
        for path in self.good:
            self.mend(path)
        done = attempt([*self.reduce()[:-1], str(self.reduced)])
        assert done.status == 0, done.err
        for path in sorted(self.reduced.rglob("*")):
            if path.is_file():
                self.good[path] = path.read_bytes()

    def mend(self, path: Path) -> None:
        """The good file again."""
        path.write_bytes(self.good[path])

    def use_csv(self) -> None:
        """run.yaml names the CSV capture."""
        capture = {**RUN_DATA["capture"], "file": "capture.csv", "format": "csv-1"}
        self.good[self.yaml] = dump_yaml({**RUN_DATA, "capture": capture}).encode()
        self.mend(self.yaml)

    def listing(self) -> dict[Path, int]:
        """Every file below the laboratory with its size."""
        return {path: path.stat().st_size for path in sorted(self.root.rglob("*")) if path.is_file()}

    def check(self, what: Path) -> list[str]:
        """Arguments that check a file or folder."""
        return ["check", str(what), "--calibrations", str(self.calibrations)]

    def simulate(self, *more: object) -> list[str]:
        """Arguments that simulate the campaign."""
        places = ["--calibrations", str(self.calibrations), "--out", str(self.out)]
        return ["simulate", str(self.campaign), *places, *map(str, more)]

    def stage(self, name: str, *, run: bool = False) -> list[str]:
        """Arguments that run one stage on the results."""
        return ["stage", name, "--out", str(self.reduced), *(["--run", str(self.run)] if run else [])]

    def tidy(self, before: dict[Path, int]) -> None:
        """Take away what a command wrote, and mend what it wrote over."""
        shutil.rmtree(self.out, ignore_errors=True)
        self.out.with_name("out.injected.yaml").unlink(missing_ok=True)
        for path in self.listing():
            if path not in before:
                path.unlink()
        for path, data in self.good.items():
            if path.is_relative_to(self.reduced) and path.read_bytes() != data:
                path.write_bytes(data)


def _temperatures() -> str:
    rows = [f"{k},{20 + 0.01 * k:.4f},{21 + 0.02 * k:.4f}" for k in range(21)]
    return "\n".join(["time_s,electronics_degC,sensor_degC", *rows]) + "\n"


def _angles() -> str:
    """The commanded angle with a ripple, ten times a second."""
    rows = [f"{k / 10:.1f},{min(k / 10, 12.0) * 10 + 0.001 * math.sin(k):.6f}" for k in range(200)]
    return "\n".join(["time_s,angle_deg", *rows]) + "\n"
