"""Closure: what was not fitted, predicted by what was."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from bench_lab import diagnosed, lab, simulated

from fogreduce.diagnosis.how_far.closure import Closure


def test_a_gap_that_closes_to_its_expectation_is_closed() -> None:
    assert Closure("", "", 1000.0, 20.0, 20.0).fraction == pytest.approx(1.0)
    assert Closure("", "", 1000.0, 1000.0, 20.0).fraction == pytest.approx(0.0)
    assert Closure("", "", 10.0, 5.0, 20.0).fraction == 0.0


def test_the_standard_deviation_is_that_of_two_folds_that_share_their_errors() -> None:
    """Each fold: a closed gap in ten features, chi-square of ten degrees; the same noise in both."""
    generator = np.random.default_rng(3)
    fold = np.sum(generator.standard_normal((4000, 10)) ** 2, axis=1)
    fractions = [Closure("", "", 1020.0, 2.0 * chi2, 20.0).fraction for chi2 in fold]
    assert Closure("", "", 1020.0, 20.0, 20.0).std == pytest.approx(np.std(fractions), rel=0.06)


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
