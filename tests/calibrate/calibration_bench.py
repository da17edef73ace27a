"""A bench of short runs about three axes, both senses and at rest, simulated with what a test asks for.

Also used by `benchmarks/derivation_pulls.py`.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from numpy.typing import NDArray

from fogreduce.calibrate.derive import Derivation
from fogreduce.calibrate.readings import Readings
from fogreduce.characterise.plan import drawn_readings
from fogreduce.cli.main import main
from fogreduce.constants import SECONDS_PER_HOUR
from fogreduce.metadata.calibration import CalibrationRecord
from fogreduce.metadata.run import Run

_RECORD: dict[str, Any] = {
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
#: What stands up -> the unit's orientation.
UP = {
    "x": {"x": "up", "z": "north"},
    "y": {"y": "up", "x": "north"},
    "z": {"z": "up", "y": "north"},
    "-x": {"x": "down", "z": "north"},
    "-y": {"y": "down", "x": "north"},
    "-z": {"z": "down", "y": "north"},
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


@dataclass(frozen=True)
class BenchRun:
    """A run: what stands up (a key of `UP`; the table turns about it), rates [deg/s] and durations [s]."""

    run_id: str
    up: str
    profile: Sequence[tuple[float, float]]
    started_at: str = "2014-05-12T13:00:00Z"
    #: Of the site, besides its latitude.
    site: Mapping[str, Any] = field(default_factory=dict)
    sample_rate_hz: float = 16

    def metadata(self) -> dict[str, Any]:
        """Its run.yaml."""
        return {
            "schema": "fogreduce/run/1",
            "run_id": self.run_id,
            "unit": "UNIT",
            "started_at": self.started_at,
            "site": {"latitude_deg": 48.0, **self.site},
            "table": {
                "axis": self.up[-1],
                "profile": [{"rate_deg_s": rate, "duration_s": seconds} for rate, seconds in self.profile],
            },
            "orientation": UP[self.up],
            "capture": {
                "file": "capture.fogcap",
                "format": "fogcap-1",
                "sample_rate_hz": self.sample_rate_hz,
                "volts_per_count": 1e-7,
                "polarity": [1, -1, 1, 1],
            },
            "calibration": "UNIT@a",
        }

    def drawn(self, record: CalibrationRecord, generator: np.random.Generator) -> Readings:
        """Its bins, drawn from a calibration record."""
        return drawn_readings(Run.from_data(self.metadata(), "run.yaml"), record, generator)


def write_plan(folder: Path, runs: Iterable[BenchRun]) -> None:
    """The run.yaml of each run, without captures."""
    for one in runs:
        (folder / "runs" / one.run_id).mkdir(parents=True)
        (folder / "runs" / one.run_id / "run.yaml").write_text(yaml.safe_dump(one.metadata()))


def drawn_in(campaign: Path) -> list[dict[str, Any]]:
    """What the simulator drew for a campaign."""
    drawn: list[dict[str, Any]] = yaml.safe_load(
        campaign.with_name(f"{campaign.name}.injected.yaml").read_text()
    )["drawn"]
    return drawn


def errors(found: Derivation, drawn: Sequence[dict[str, Any]]) -> NDArray[np.float64]:
    """Derived less true (4 n,), in the order of the covariance: bias, scale factor, axis (2) of each gyro."""
    facts, parameters = found.readings[0].facts, found.parameters
    out: list[float] = []
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


class Bench:
    """Folders of calibration records and campaigns; `simulate` makes a campaign with captures."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.calibrations = folder / "calibrations"
        (self.calibrations / "UNIT").mkdir(parents=True)
        (self.calibrations / "UNIT" / "a.yaml").write_text(yaml.safe_dump(_RECORD))

    def record(self, **noise: list[float]) -> CalibrationRecord:
        """The record, its noise changed."""
        data = {**_RECORD, "noise": {**_RECORD["noise"], **noise}}
        return CalibrationRecord.from_data(data, "a.yaml")

    def simulate(
        self,
        effects: Sequence[dict[str, Any]] = (),
        runs: Sequence[str | BenchRun] = tuple(DESIGN),
        options: Sequence[str] = (),
    ) -> Path:
        """The folder of a campaign, made from runs of the bench's design by their names or from any other."""
        plan = self.folder / f"plan{len(list(self.folder.iterdir()))}"
        write_plan(plan, (_named(run) if isinstance(run, str) else run for run in runs))
        return self.make(plan, plan.with_name(f"{plan.name}-made"), effects, options)

    def make(
        self, plan: Path, out: Path, effects: Sequence[dict[str, Any]] = (), options: Sequence[str] = ()
    ) -> Path:
        """A campaign with captures, made from one without."""
        words = ["simulate", str(plan), "--calibrations", str(self.calibrations), *options]
        if effects:
            file = out.with_name(f"{out.name}.effects.yaml")
            file.write_text(yaml.safe_dump({"schema": "fogreduce/effects/1", "effects": list(effects)}))
            words += ["--effects", str(file)]
        assert main([*words, "--out", str(out)]) == 0
        return out


def _named(name: str) -> BenchRun:
    axis, *rates = {**DESIGN, **STEPS}[name]
    return BenchRun(name, axis, [(one, 72.0 / len(rates)) for one in rates])
