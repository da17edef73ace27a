"""Closure: what was not fitted, predicted by what was."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from bench_lab import diagnosed, lab, simulated

from fogreduce.diagnosis.how_far.closure import Closure, Sum
from fogreduce.diagnosis.how_far.measure import Deviates


def test_a_gap_that_closes_to_its_expectation_is_closed() -> None:
    assert Closure("", "", 1000.0, 20.0, 20.0).fraction == pytest.approx(1.0)
    assert Closure("", "", 1000.0, 1000.0, 20.0).fraction == pytest.approx(0.0)
    assert Closure("", "", 10.0, 5.0, 20.0).fraction == 0.0


class _Plain:
    """Deviates of ten features that count as they are."""

    spread = np.eye(10)
    std = Deviates.std

    def of(self, y: np.ndarray) -> np.ndarray:
        return y


def test_the_standard_deviation_is_that_of_two_folds_that_share_their_errors() -> None:
    """Each fold: a closed gap in ten features, chi-square of ten degrees; the same noise in both."""
    generator = np.random.default_rng(3)
    found = []
    for _ in range(4000):
        noise, after = generator.standard_normal(10), Sum()
        for _ in range(2):
            after.add_fold(_Plain(), noise)  # type: ignore[arg-type]
        found.append(Closure("", "", 1020.0, after.value, 20.0, 0.0, after.std))
    stds = [one.std for one in found]
    assert np.sqrt(np.mean(np.square(stds))) == pytest.approx(np.std([c.fraction for c in found]), rel=0.2)


def test_statistics_of_the_full_rate_have_errors_of_their_own() -> None:
    both = Sum()
    both.add(1.0)
    both.add(101.0)
    assert both.value == 102.0
    assert both.std == pytest.approx(np.sqrt(2.0 + 2.0 + 400.0))


def test_a_link_that_loses_readings_closes_its_own_part_beside_an_offset(tmp_path: Path) -> None:
    """Parts in the ratio of what each gains in ln likelihood over all runs, not over half of them."""
    lab(tmp_path)
    put = [
        {"effect": "bias_offset", "channels": ["gyro2"], "runs": ["*"], "parameters": {"deg_h": 0.8}},
        {"effect": "dropouts", "channels": ["gyro3"], "runs": ["*"], "parameters": {"fraction": 6e-4}},
    ]
    out = diagnosed(tmp_path, simulated(tmp_path, put))
    part = {c["effect"]: c["closure"]["alone"] for c in out["causes"]}
    shares = {w["feature"]: w["share"] for w in out["where"]}
    assert part["bias_offset"] + part["dropouts"] == pytest.approx(1.0, abs=0.05)
    assert part["dropouts"] == pytest.approx(shares["missing"], abs=0.05)
    assert 0.1 < part["dropouts"] < 0.9


def test_a_step_closes_though_neither_fold_holds_its_instant_alone(tmp_path: Path) -> None:
    lab(tmp_path)
    step = {
        "effect": "bias_step",
        "channels": ["gyro2"],
        "runs": ["r1"],
        "parameters": {"deg_h": 3.0, "time_s": 61.3},
    }
    out = diagnosed(tmp_path, simulated(tmp_path, [step]))
    assert [c["effect"] for c in out["causes"]] == ["bias_step"]
    assert out["closure"]["fraction"] == pytest.approx(1.0, abs=0.03)
    assert abs(out["closure"]["placebo_fraction"]) < 0.1
