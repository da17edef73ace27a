"""Closure: what was not fitted, predicted by what was."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from bench_lab import diagnosed, lab, simulated

from fogreduce.diagnosis.how_far.closure import Closure, Sum, few_columned, scatter
from fogreduce.diagnosis.inference.candidate import Candidate
from fogreduce.diagnosis.where.places import Place


def test_a_gap_that_closes_to_its_expectation_is_closed() -> None:
    assert Closure("", "", 1000.0, 20.0, 20.0).fraction == pytest.approx(1.0)
    assert Closure("", "", 1000.0, 1000.0, 20.0).fraction == pytest.approx(0.0)
    assert Closure("", "", 10.0, 5.0, 20.0).fraction == 0.0


class _Plain:
    """Deviates of ten features that count as they are."""

    spread = np.eye(10)

    def of(self, y: np.ndarray) -> np.ndarray:
        return y


def both(*deviates: np.ndarray) -> Sum:
    out = Sum()
    for one in deviates:
        out.add_fold(_Plain(), one)  # type: ignore[arg-type]
    return out


@pytest.mark.parametrize("closed", [0.0, 0.3, 1.0])
def test_the_standard_deviation_is_that_of_two_folds_that_share_their_errors(closed: float) -> None:
    """Ten features, the same noise in both folds, before and after: what a cause leaves alone, it does not
    make uncertain.
    """
    generator = np.random.default_rng(3)
    gap = np.zeros(10)
    gap[:2] = np.sqrt(500.0 * np.array([closed, 1.0 - closed]))
    rest = gap * np.array([0.0, *np.ones(9)])
    found, stds = [], []
    for _ in range(3000):
        noise = generator.standard_normal(10)
        before, after = both(gap + noise, gap + noise), both(rest + noise, rest + noise)
        found.append(Closure("", "", before.value, after.value, 20.0).fraction)
        stds.append(scatter(before, after, 20.0))
    assert np.mean(found) == pytest.approx(closed, abs=0.01)
    assert np.sqrt(np.mean(np.square(stds))) == pytest.approx(np.std(found), rel=0.2, abs=1e-9)


def test_statistics_of_the_full_rate_have_errors_of_their_own() -> None:
    before, after = Sum(), Sum()
    for value, left in ((101.0, 1.0), (901.0, 901.0)):
        before.add(value)
        after.add(left)
    # a tenth closes, of deviates 10 and 30: 2 (0.9 10) and 2 (0.1 30) of 1000
    assert scatter(before, after, 2.0) == pytest.approx(2.0 * np.hypot(9.0, 3.0) / 1000.0, rel=0.1)


def place(channel: str, columns: int) -> Place:
    steps, whole = np.ones((1, columns)), np.zeros((9, 1, columns))
    family = Candidate("unknown", (channel,), ("*",), slice(0, 9), whole, ({},), ("",) * columns, steps)
    return Place("gyro", (channel,), ("r1",), "low_frequency", 9.0, 90.0, columns, family)


def test_a_gap_of_many_shapes_is_no_feature() -> None:
    """Its noise would hide it: a process that alone shows there closes what it gains in ln likelihood."""
    modes, mean = place("gyro2", 80), place("gyro3", 1)
    assert few_columned([modes, mean]) == [mean.family]


@pytest.mark.parametrize(
    ("effect", "feature", "parameters"),
    [("dropouts", "missing", {"fraction": 6e-4}), ("angle_random_walk", "white", {"deg_sqrt_h": 3.2e-3})],
)
def test_what_the_full_rate_shows_closes_its_own_part_beside_an_offset(
    tmp_path: Path, effect: str, feature: str, parameters: dict
) -> None:
    """Parts in the ratio of what each gains in ln likelihood over all runs, not over half of them: halves
    share the doubt of a record's white noise.
    """
    lab(tmp_path)
    put = [
        {"effect": "bias_offset", "channels": ["gyro2"], "runs": ["*"], "parameters": {"deg_h": 0.8}},
        {"effect": effect, "channels": ["gyro3"], "runs": ["*"], "parameters": parameters},
    ]
    out = diagnosed(tmp_path, simulated(tmp_path, put))
    part = {c["effect"]: c["closure"]["alone"] for c in out["causes"]}
    shares = {w["feature"]: w["share"] for w in out["where"]}
    assert part["bias_offset"] + part[effect] == pytest.approx(1.0, abs=0.05)
    assert part[effect] == pytest.approx(shares[feature], abs=0.05)
    assert 0.1 < part[effect] < 0.9


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


def test_what_shows_no_gap_adds_no_noise_to_it(tmp_path: Path) -> None:
    """An offset is one number: its departures do not show, and neither does anything beside it."""
    lab(tmp_path)
    put = [{"effect": "bias_offset", "channels": ["gyro2"], "runs": ["*"], "parameters": {"deg_h": 0.35}}]
    out = diagnosed(tmp_path, simulated(tmp_path, put))
    assert [c["effect"] for c in out["causes"]] == ["bias_offset"]
    assert out["closure"]["expected_if_closed"] < 3.0
    assert out["closure"]["fraction"] == pytest.approx(1.0, abs=0.05)


def test_a_wrong_sense_that_no_number_scales_closes(tmp_path: Path) -> None:
    lab(tmp_path)
    put = [{"effect": "polarity_error", "channels": ["gyro2"], "runs": ["*"], "parameters": {}}]
    out = diagnosed(tmp_path, simulated(tmp_path, put))
    assert out["verdict"] == "explained"
    assert out["closure"]["fraction"] == pytest.approx(1.0, abs=0.03)
