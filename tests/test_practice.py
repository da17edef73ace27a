"""Practice campaigns 1 and 4, from an independent simulator: mean rates against stated uncertainties.

Campaign 1 has nothing wrong, campaign 4 spurious counts on one gyro; noise and every stated uncertainty were
drawn. Nothing here is tuned on them.
"""

from __future__ import annotations

import json
import math

import numpy as np
import pytest

from fogreduce.estimate.curve_terms import mean_rate_terms
from fogreduce.estimate.uncertainty import StatedErrors, stated_covariance
from fogreduce.metadata.folder import load_calibration, load_run

RUNS = ["1-xp", "2-xm", "3-yp", "4-ym", "5-zp", "6-zm", "7-xs", "8-st"]
CAMPAIGNS = ["practice-1", "practice-4"]


@pytest.fixture(scope="module")
def reductions(shared, reduce, tmp_path_factory) -> dict:
    """Every run of both campaigns, reduced (0.1 s a run)."""
    root = shared / "practice"
    out = tmp_path_factory.mktemp("practice")
    return {
        (campaign, run_id): reduce(
            root / "campaigns" / campaign / "runs" / run_id, root / "calibrations", out / campaign / run_id
        )
        for campaign in CAMPAIGNS
        for run_id in RUNS
    }


def departures(shared, reductions, campaign: str, run_id: str) -> np.ndarray:
    """Mean rate about x, y, z less the commanded one, in standard errors: noise (coloured) and stated
    ones."""
    reduced = reductions[campaign, run_id]
    run = load_run(shared / "practice" / "campaigns" / campaign / "runs" / run_id)
    record, _ = load_calibration(shared / "practice" / "calibrations", run.calibration)
    facts = reduced.setup.facts
    covariance = stated_covariance(facts, StatedErrors.of(run, record), 1)
    found = []
    for k, axis in enumerate("xyz"):
        item = reduced.channel(axis)
        terms = mean_rate_terms(0.0, facts.profile.end_s, item["rate_rad_s"])
        whole = covariance[k] + np.array(item["coloured_covariance"])
        commanded = facts.commanded_signs[k] * facts.profile.rate_deg_s[0]
        found.append((terms @ np.array(item["theta"]) - commanded) / math.sqrt(terms @ whole @ terms))
    return np.array(found)


@pytest.mark.parametrize("run_id", RUNS)
@pytest.mark.parametrize("campaign", CAMPAIGNS)
def test_mean_rates_are_within_five_standard_errors(shared, reductions, campaign: str, run_id: str) -> None:
    assert np.abs(departures(shared, reductions, campaign, run_id)).max() < 5


@pytest.mark.parametrize("campaign", CAMPAIGNS)
def test_the_errors_are_neither_boasted_nor_padded(shared, reductions, campaign: str) -> None:
    """24 departures in standard errors scatter by about 1. Runs share scale factors and axes, so only some
    fourteen are independent: 1 / sqrt(28) = 0.19, three of that on either side."""
    every = np.array([departures(shared, reductions, campaign, run_id) for run_id in RUNS])
    assert 0.43 < np.sqrt(np.mean(every**2)) < 1.57


@pytest.mark.parametrize("run_id", RUNS)
def test_spurious_counts_are_found_where_they_are(shared, reductions, run_id: str) -> None:
    """practice-4: a fraction of 2e-4 of gyro 4's counts, says answers.json; nothing on the others, nothing in
    practice-1 (chance makes a count beyond eight standard deviations once in 10^15)."""
    (answer,) = json.loads((shared / "practice" / "answers.json").read_text())["practice-4"]
    assert (answer["effect"], answer["channels"]) == ("spikes", ["gyro4"])
    expected = answer["parameters"]["fraction"] * 38_400
    for campaign in CAMPAIGNS:
        counts = {row["what"]: int(row["count"]) for row in reductions[campaign, run_id].table("quality")}
        assert counts["records"] == counts["expected"] == 38_400
        spurious = [counts[f"spurious_gyro{i}"] for i in range(1, 5)]
        assert spurious[:3] == [0, 0, 0]
        if campaign == "practice-4":
            assert abs(spurious[3] - expected) < 5 * math.sqrt(expected)
        else:
            assert spurious[3] == 0
