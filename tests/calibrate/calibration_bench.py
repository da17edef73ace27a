"""A bench of short runs about three axes, both senses and at rest, simulated with what a test asks for."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import yaml

from fogreduce.cli.main import main

_RECORD = {
    "schema": "fogreduce/calibration/1",
    "unit": "UNIT",
    "version": "a",
    "valid_from": "2010-01-01T00:00:00Z",
    "procedure": "made for a test",
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
_UP = {
    "x": {"x": "up", "z": "north"},
    "y": {"y": "up", "x": "north"},
    "z": {"z": "up", "y": "north"},
}
#: Run -> axis and rate of the table [deg/s].
DESIGN: dict[str, tuple[Any, ...]] = {
    "1-xp": ("x", 10.0),
    "2-xm": ("x", -10.0),
    "3-yp": ("y", 10.0),
    "4-ym": ("y", -10.0),
    "5-zp": ("z", 10.0),
    "6-zm": ("z", -10.0),
    "7-st": ("x", 0.0),
}
#: Further runs, of several rates each.
STEPS: dict[str, tuple[Any, ...]] = {f"{axis}-steps": (axis, 30.0, 10.0, -10.0, -30.0) for axis in "xyz"}


class Bench:
    """Folders of calibration records and campaigns; `simulate` makes a campaign with captures."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.calibrations = folder / "calibrations"
        (self.calibrations / "UNIT").mkdir(parents=True)
        (self.calibrations / "UNIT" / "a.yaml").write_text(yaml.safe_dump(_RECORD))

    def simulate(
        self,
        effects: Sequence[dict[str, Any]] = (),
        runs: Sequence[str] = tuple(DESIGN),
        options: Sequence[str] = (),
    ) -> Path:
        plan = self.folder / f"plan{len(list(self.folder.iterdir()))}"
        for name in runs:
            axis, *rates = {**DESIGN, **STEPS}[name]
            run = {
                "schema": "fogreduce/run/1",
                "run_id": name,
                "unit": "UNIT",
                "started_at": "2014-05-12T13:00:00Z",
                "site": {"latitude_deg": 48.0},
                "table": {
                    "axis": axis,
                    "profile": [{"rate_deg_s": one, "duration_s": 72.0 / len(rates)} for one in rates],
                },
                "orientation": _UP[axis],
                "capture": {
                    "file": "capture.fogcap",
                    "format": "fogcap-1",
                    "sample_rate_hz": 16,
                    "volts_per_count": 1e-7,
                    "polarity": [1, -1, 1, 1],
                },
                "calibration": "UNIT@a",
            }
            (plan / "runs" / name).mkdir(parents=True)
            (plan / "runs" / name / "run.yaml").write_text(yaml.safe_dump(run))
        words = ["simulate", str(plan), "--calibrations", str(self.calibrations), *options]
        if effects:
            file = plan / "effects.yaml"
            file.write_text(yaml.safe_dump({"schema": "fogreduce/effects/1", "effects": list(effects)}))
            words += ["--effects", str(file)]
        out = plan.with_name(f"{plan.name}-made")
        assert main([*words, "--out", str(out)]) == 0
        return out
