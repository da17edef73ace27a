"""A run with each gyro left out."""

from __future__ import annotations

import numpy as np
import pytest

from fogreduce.calibrate.noise import gyro_noise
from fogreduce.calibrate.readings import read_campaign
from fogreduce.characterise.left_out import each_left_out


def test_each_gyro_left_out_gives_the_same_drift_at_its_price(bench) -> None:
    readings = read_campaign(bench.simulate([], ("1-xp",)), bench.calibrations)
    found = each_left_out(readings[0], [gyro_noise(readings, i) for i in range(4)])
    assert [one.gyro for one in found] == [None, 0, 1, 2, 3]
    # Gyro 4 costs little, another more than twice as much: an orthogonal triad and its diagonal.
    assert found[4].trace == pytest.approx(3.0, abs=0.1)
    assert all(one.trace > 2.5 * found[0].trace for one in found[1:4])
    for one in found:
        assert (np.abs(one.drift_deg_h) < 5 * one.drift_err_deg_h).all()
        assert (one.noise_deg_sqrt_h >= found[0].noise_deg_sqrt_h - 1e-9).all()


def test_the_drift_with_all_gyros_is_the_reductions(bench, reduce, tmp_path) -> None:
    """Of equal noise in all gyros the projection is H: as in drift.csv, to what bins lose of a turn."""
    campaign = bench.simulate([], ("7-st",))
    run = campaign / "runs" / "7-st"
    rows = reduce(run, bench.calibrations, tmp_path / "out").table("drift")
    readings = read_campaign(campaign, bench.calibrations)
    noise = [gyro_noise(readings, 0)] * 4
    found = each_left_out(readings[0], noise)[0]
    expected = [float(row["drift_deg_h"]) for row in rows]
    assert found.drift_deg_h == pytest.approx(expected, abs=0.2 * found.drift_err_deg_h.max())
