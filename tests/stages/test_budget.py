"""Budgets: parts and sums by hand, a source that moves axes and segments together, columns of the tables."""

from __future__ import annotations

import math

import numpy as np
import pytest

PARTS = ("u_noise", "u_calibration_record", "u_turn_on", "u_azimuth", "u_latitude", "u_table_rate")


def budget(reduced, quantity: str, channel: str, segment: str = "1") -> dict[str, float]:
    """A row of budget.csv as numbers."""
    rows = [
        row
        for row in reduced.table("budget")
        if (row["quantity"], row["channel"], row["segment"]) == (quantity, channel, segment)
    ]
    assert len(rows) == 1
    numbers = {name for name in rows[0] if name.startswith("u_")} | {"value", "coverage_factor"}
    return {name: float(rows[0][name]) for name in numbers}


@pytest.fixture
def two_turns(bench):
    """A turn in each sense, which a source moves by opposite signs or by the same."""
    return bench.reduce(bench.run(n=4, profile=((1.2, 300.0), (-1.2, 300.0)), sample_rate_hz=16.0))


def test_every_value_of_the_tables_has_its_budget(two_turns) -> None:
    """Drift, integral, mean rate, curve of each axis: same value, combined error; parts in squares."""
    for row in two_turns.table("drift"):
        for column, quantity in (
            ("drift_deg_h", "drift"),
            ("accumulated_error_deg", "accumulated_error"),
            ("integral_deg", "integral"),
        ):
            parts = budget(two_turns, quantity, row["axis"], row["segment"])
            assert parts["value"] == pytest.approx(float(row[column]), rel=1e-12)
            assert math.hypot(*(parts[name] for name in PARTS)) == pytest.approx(
                parts["u_combined"], rel=1e-12
            )
        drift = budget(two_turns, "drift", row["axis"], row["segment"])
        assert drift["u_combined"] == pytest.approx(float(row["drift_err_combined_deg_h"]), rel=1e-12)
        assert drift["u_expanded"] == pytest.approx(float(row["drift_err_expanded_deg_h"]), rel=1e-12)
        assert 1.959 < drift["coverage_factor"] < 2.01
    for row in two_turns.table("rates"):
        mean = budget(two_turns, "mean_rate", row["axis"], row["segment"])
        assert mean["u_combined"] == pytest.approx(float(row["difference_err_deg_s"]), rel=1e-9)
        assert mean["u_noise"] == pytest.approx(float(row["difference_err_noise_deg_s"]), rel=1e-9)
    for row in two_turns.table("rate_fit"):
        for quantity, of in (("a", "deg_s"), ("p", "deg_s"), ("q", "deg_s"), ("b", "deg_s"), ("e", "deg_s2")):
            parts = budget(two_turns, quantity, row["axis"], row["segment"])
            combined = float(row[f"{quantity}_err_combined_{of}"])
            assert parts["u_combined"] == pytest.approx(combined, rel=1e-9)
    for row in two_turns.table("gyro_fit"):
        parts = budget(two_turns, "a", row["gyro"], row["segment"])
        assert parts["u_combined"] == parts["u_noise"] == pytest.approx(float(row["a_err_coloured_V"]))


def test_a_source_moves_both_segments_with_its_sign(two_turns) -> None:
    """The table's rate, 5 ppm: 1.2 deg/s is 6e-6 deg/s off in one sense and -6e-6 in the other, so that the
    whole run's angle has none of it; the turn-on bias is the same in both, so that it adds up."""
    one, other = (budget(two_turns, "mean_rate", "x", segment) for segment in "12")
    assert one["u_table_rate"] == pytest.approx(6e-6, rel=0.02)
    assert other["u_table_rate"] == pytest.approx(6e-6, rel=0.02)
    whole = budget(two_turns, "mean_rate", "x", "all")
    assert whole["u_table_rate"] < 1e-9
    assert whole["u_turn_on"] == pytest.approx(one["u_turn_on"], rel=1e-3)
    assert whole["u_noise"] < math.hypot(one["u_noise"], other["u_noise"])


def test_axes_share_gyros_and_sources(two_turns) -> None:
    """The correlation by noise is that of H H' where the gyros are alike; a correlation is one at most."""
    rows = [row for row in two_turns.table("correlations") if row["segment"] == "1"]
    h = two_turns.setup.facts.projection
    shared = h @ h.T
    for row in rows:
        assert abs(float(row["correlation"])) <= 1.0
        if row["quantity"] == "drift":
            i, j = ("xyz".index(row[name]) for name in ("channel_1", "channel_2"))
            noise = [budget(two_turns, "drift", "xyz"[k])["u_noise"] for k in (i, j)]
            expected = shared[i, j] / np.sqrt(shared[i, i] * shared[j, j])
            found = float(row["covariance_noise"]) / (noise[0] * noise[1])
            assert found == pytest.approx(expected, abs=0.1)
    assert {row["quantity"] for row in rows} >= {"a", "p", "q", "e", "drift", "integral", "mean_rate"}


def test_the_azimuth_moves_two_axes_of_the_published_run_as_one(published) -> None:
    """One turn about vertical x: the azimuth's error adds a cosine to y and a sine to z; by hand 0.05 deg of
    Earth's horizontal rate is 0.0121 deg/h, all of it in y's drift, whose offset the rule moves."""
    parts = budget(published.reduced, "drift", "y")
    horizontal = 15.041067 * math.cos(math.radians(23.21132308))
    assert parts["u_azimuth"] == pytest.approx(horizontal * math.radians(0.05), rel=0.01)
    assert parts["u_azimuth"] > 0.9 * math.hypot(*(parts[name] for name in PARTS[1:]))


def test_a_unit_of_two_gyros_has_its_mean_rates(bench) -> None:
    reduced = bench.reduce(bench.run(n=2, profile=((1.2, 60.0), (0.0, 60.0)), sample_rate_hz=16.0))
    for row in reduced.table("rates"):
        mean = budget(reduced, "mean_rate", row["axis"], row["segment"])
        assert mean["value"] == pytest.approx(float(row["measured_deg_s"]), rel=1e-12)
        assert mean["u_combined"] == pytest.approx(float(row["difference_err_deg_s"]), rel=1e-9)
    assert reduced.table("correlations") == []
