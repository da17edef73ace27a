"""What a record does not determine is empty, with the reason, and the curve does without it."""

from __future__ import annotations

import numpy as np
import pytest

from fogreduce.cli.main import main
from fogreduce.estimate.determined import why_undetermined
from fogreduce.estimate.mean_curve import CurveBasis, CurveSums

PARAMETERS = ("b_deg_s", "b_err_deg_s", "b_err_coloured_deg_s", "d_rad", "d_err_rad")


@pytest.mark.parametrize("turn_deg", [0.06, 0.6, 6.0, 20.0])
def test_a_turn_too_short_for_its_sine(bench, turn_deg: float) -> None:
    """In 120 s: b would be hundreds of deg/s, between errors as large. A straight line stands in."""
    reduced = bench.reduce(bench.run(n=3, profile=((turn_deg / 120, 120.0),), sample_rate_hz=16.0))
    for row in reduced.table("rate_fit") + reduced.table("gyro_fit"):
        assert {row.get(name, "") for name in PARAMETERS} == {""}
        assert row["undetermined"].startswith(f"b and d: {turn_deg:g} deg of turn")
    for row in reduced.table("rate_fit"):
        # What is left is as sharp as at a standstill: the bench's noise is 1.3e-4 deg/s a sample.
        assert float(row["a_err_deg_s"]) < 2 * 1.4e-4 / 1920**0.5 * 1.2
        assert abs(float(row["e_deg_s2"])) < 1e-5
    for row in reduced.table("drift"):
        assert float(row["drift_err_coloured_deg_h"]) < 1.0
        assert abs(float(row["drift_deg_h"])) < 4 * float(row["drift_err_coloured_deg_h"])


def test_the_page_says_so(bench) -> None:
    reduced = bench.reduce(bench.run(n=3, profile=((0.005, 120.0),), sample_rate_hz=16.0))
    assert main(["page", "run", str(reduced.out)]) == 0
    page = (reduced.out / "index.html").read_text()
    assert "Parameters that the record does not determine" in page
    assert "b and d: 0.6 deg of turn" in page


@pytest.mark.parametrize("turn_deg", [90.0, 360.0])
def test_turns_that_show_a_sine_keep_it(bench, turn_deg: float) -> None:
    reduced = bench.reduce(bench.run(n=3, profile=((turn_deg / 600, 600.0),), sample_rate_hz=16.0))
    for row in reduced.table("rate_fit"):
        assert row["b_deg_s"]
        assert row["e_deg_s2"]
        # Earth's part is taken away: b is noise, and has a phase only where noise rarely is so large
        has_phase = float(row["b_deg_s"]) > 2.4477 * float(row["b_err_combined_deg_s"])
        assert bool(row["d_rad"]) == bool(row["d_err_rad"]) == has_phase
        assert row["undetermined"] == ("" if has_phase else "d: b is no larger than its expanded error")
        assert np.hypot(float(row["p_deg_s"]), float(row["q_deg_s"])) == pytest.approx(float(row["b_deg_s"]))


def test_a_standstill_lacks_nothing(bench) -> None:
    """It has no sine by definition, as the contract has it; that is no lack."""
    rows = bench.reduce(bench.run(profile=((0.0, 60.0),), sample_rate_hz=16.0)).table("rate_fit")
    assert [row["undetermined"] for row in rows] == [""] * 3


def fitted(times: list[float], values: list[float], terms: int):
    """A straight line or constant through values of one channel, in a segment of 60 s at rest."""
    basis = CurveBasis.of(0.0, 60.0, 0.0)
    sums = CurveSums(basis, 1)
    sums.add(basis.columns(np.array(times)), np.array([values]), None)
    return sums.fit(0, terms)


def test_a_slope_from_few_records_is_not_determined() -> None:
    """Four records within a second: the slope times 60 s is unknown by 60 times their scatter and more."""
    times, values = [0.0, 0.3, 0.7, 1.0], [1.0, 1.2, 0.9, 1.1]
    line = fitted(times, values, 2)
    assert why_undetermined(line, line.covariance, 1.0, 0.0, 60.0).startswith("e: too few records")
    constant = fitted(times, values, 1)
    assert why_undetermined(constant, constant.covariance, 1.0, 0.0, 60.0) == ""
    assert constant.theta.tolist() == pytest.approx([1.05, 0.0, 0.0, 0.0])
    # The standard deviation of the mean: 0.129 / 2.
    assert constant.covariance[0, 0] ** 0.5 == pytest.approx(np.std(values, ddof=1) / 2)
    assert constant.scatter == pytest.approx(np.std(values, ddof=1))


def test_a_slope_over_the_whole_segment_is() -> None:
    times = np.linspace(0.0, 60.0, 40)
    line = fitted(times.tolist(), np.random.default_rng(2).normal(size=40).tolist(), 2)
    assert why_undetermined(line, line.covariance, 1.0, 0.0, 60.0) == ""


def test_one_record_gives_no_curve() -> None:
    assert fitted([3.0], [1.0], 1) is None
