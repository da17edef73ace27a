"""White noise of a run's own: what a filter that all runs share makes of spectra is none."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from bench_lab import RECORD, lab, simulated

from fogreduce.diagnosis.observe.data import read_data


def filtered(ms: float) -> list[dict]:
    parameters = {"time_constant_ms": ms}
    return [{"effect": "low_pass", "channels": ["gyro2"], "runs": ["*"], "parameters": parameters}]


@pytest.mark.parametrize(("ms", "seed"), [(30.0, 3), (30.0, 7), (200.0, 3)])
def test_runs_of_one_filter_are_alike(tmp_path: Path, ms: float, seed: int) -> None:
    """In these the median line of one run is 10 to 16 % off the others' in level: a steep spectrum's."""
    lab(tmp_path, rate_hz=100.0, duration_s=60.0)
    campaign = simulated(tmp_path, filtered(ms), seed=seed)
    np.testing.assert_array_equal(read_data(campaign, tmp_path / "cal").run_level, 1.0)


def test_a_run_noisier_than_the_others_stands_out_beside_a_filter(tmp_path: Path) -> None:
    lab(tmp_path, rate_hz=100.0, duration_s=60.0)
    stated = RECORD["noise"]["angle_random_walk_deg_sqrt_h"][1]
    louder = {
        "effect": "angle_random_walk",
        "channels": ["gyro2"],
        "runs": ["r3"],
        "parameters": {"deg_sqrt_h": 1.5 * stated},
    }
    campaign = simulated(tmp_path, [*filtered(100.0), louder])
    own = read_data(campaign, tmp_path / "cal").run_level
    assert np.argwhere(own != 1.0).tolist() == [[3, 1]]
    assert own[3, 1] == pytest.approx(1.5, rel=0.06)
