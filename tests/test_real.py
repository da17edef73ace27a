"""A real recording: a ring laser gyro of three axes at 64 Hz, standing still with x up and x down."""

from __future__ import annotations

import math

import numpy as np
import pytest

UP, DOWN = "x-up", "x-down"

#: Mean rates [deg/h] straight from the recordings, from their README.
MEANS = {UP: (11.479, 9.187, 1.250), DOWN: (-11.986, 9.125, -0.726)}
HALF_DIFFERENCE = 11.732  # deg/h; 15.041 sin(latitude) at 51.26 degrees north


@pytest.fixture(scope="module")
def reductions(shared, reduce, tmp_path_factory) -> dict:
    """Both recordings, reduced."""
    root, out = shared / "real", tmp_path_factory.mktemp("real")
    return {
        run_id: reduce(root / "campaigns/ln100/runs" / run_id, root / "calibrations", out / run_id)
        for run_id in (UP, DOWN)
    }


def mean_rate(reduced, channel: str) -> tuple[float, float]:
    """Mean of the fitted line over the run, and its coloured standard error."""
    item = reduced.channel(channel)
    stop = reduced.setup.facts.profile.end_s
    terms = np.array([1.0, 0.0, 0.0, stop / 2])  # a straight line: its middle
    covariance = np.array(item["coloured_covariance"])
    return float(terms @ np.array(item["theta"])), math.sqrt(terms @ covariance @ terms)


@pytest.mark.parametrize("run_id", [UP, DOWN])
def test_mean_rates_of_the_gyros_are_the_recordings(reductions, run_id: str) -> None:
    """One volt is one deg/s there. The README's means are rounded to 1e-3 deg/h; the noise is 160 to 200
    deg/h a sample, so that the few samples left out as spurious, if any, could move a mean by hundredths."""
    for k, expected in enumerate(MEANS[run_id]):
        rate, _ = mean_rate(reductions[run_id], f"gyro{k + 1}")
        assert 3600 * rate == pytest.approx(expected, abs=2e-3)


def test_half_the_difference_of_x(reductions) -> None:
    """Earth's vertical part, 11.73 deg/h: bias drops out of half the difference. Within its stated error,
    and that error is small enough to mean something (a tenth of a deg/h).

    run.yaml's latitude of 51 degrees is a placeholder: what the reduction takes away is put back.
    """
    rates, errors = [], []
    for run_id, sign in ((UP, 1.0), (DOWN, -1.0)):
        rate, error = mean_rate(reductions[run_id], "x")
        removed = reductions[run_id].setup.facts.earth.at(np.zeros(1))[0, 0]
        assert sign * removed > 0
        rates.append(rate + removed)
        errors.append(error)
    half = 3600 * (rates[0] - rates[1]) / 2
    stated = 3600 * math.hypot(*errors) / 2
    assert stated < 0.2
    assert abs(half - HALF_DIFFERENCE) < stated
    latitude = math.degrees(math.asin(half / 15.041067))
    assert latitude == pytest.approx(51.26, abs=math.degrees(stated / (15.041 * math.cos(math.radians(51)))))


@pytest.mark.parametrize("run_id", [UP, DOWN])
def test_all_stages_on_three_gyros_at_64_hz(reductions, run_id: str) -> None:
    reduced = reductions[run_id]
    counts = {row["what"]: int(row["count"]) for row in reduced.table("quality")}
    assert counts["records"] == counts["expected"] == pytest.approx(300 * 64, rel=2e-3)
    assert counts["lost"] == counts["bad_stamp"] == counts["repeated"] == 0
    assert [row["gyro"] for row in reduced.table("gyro_fit")] == ["gyro1", "gyro2", "gyro3"]
    for row in reduced.table("rate_fit"):
        assert row["b_deg_s"] == row["c_rad_s"] == row["d_rad"] == ""  # a standstill
        assert 120 < 3600 * float(row["sigma_deg_s"]) < 240  # README: 158 to 198 deg/h a sample
    for row in reduced.table("drift"):
        assert float(row["nominal_deg"]) == 0.0
        assert math.isfinite(float(row["drift_err_coloured_deg_h"]))
    for stage in ("ingest", "calibrate", "project", "remove_earth", "bins"):
        assert reduced.dataset(stage).is_file()
