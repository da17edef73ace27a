"""Calibration records gone stale: every gyro is off in several ways at once."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from bench_lab import diagnosed, lab, simulated

from fogreduce.diagnosis.inference.outcome import Verdict
from fogreduce.diagnosis.inference.search import Search
from fogreduce.diagnosis.inference.verdict import verdict_of_sets
from fogreduce.diagnosis.observe.data import read_data
from fogreduce.effects.table import EFFECTS

GYROS = [f"gyro{i}" for i in range(1, 5)]


def one(effect: str, channel: str, **parameters: object) -> dict:
    return {"effect": effect, "channels": [channel], "parameters": parameters}


OFFSETS = [one("bias_offset", g, deg_h=v) for g, v in zip(GYROS, (0.6, -0.9, 1.2, -0.5), strict=True)]
SCALES = [
    one("scale_factor_error", g, ppm=v) for g, v in zip(GYROS, (300.0, -450.0, 200.0, 600.0), strict=True)
]
AXES = [
    one("axis_misalignment", g, mrad=v)
    for g, v in zip(
        GYROS, ([0.3, 0.5, -0.2], [0.4, -0.3, 0.3], [-0.5, 0.2, 0.4], [0.1, 0.4, -0.5]), strict=True
    )
]
RAMPS = [one("bias_ramp", g, deg_h_per_h=v) for g, v in zip(GYROS, (20.0, -35.0, 25.0, 50.0), strict=True)]


@pytest.fixture(scope="module")
def bench(tmp_path_factory) -> Path:
    root = tmp_path_factory.mktemp("stale")
    lab(root)
    return root


def judged(bench: Path, effects: list[dict], name: str) -> Verdict:
    data = read_data(simulated(bench, effects, name), bench / "cal")
    return verdict_of_sets(Search(data, frozenset(EFFECTS)))


def places(effects: list[dict]) -> set[tuple[str, str]]:
    return {(e["effect"], e["channels"][0]) for e in effects}


def test_offsets_of_every_gyro_are_named_on_each_and_close_the_gap(bench) -> None:
    document = diagnosed(bench, simulated(bench, OFFSETS, "offsets"))
    assert document["verdict"] == "explained"
    assert {(c["effect"], c["channels"][0]) for c in document["causes"]} == places(OFFSETS)
    assert document["closure"]["fraction"] == pytest.approx(1.0, abs=0.03)
    for cause in document["causes"]:
        truth = next(e for e in OFFSETS if e["channels"] == cause["channels"])["parameters"]["deg_h"]
        found = cause["parameters"]["deg_h"]
        assert abs(found["value"] - truth) < 4.0 * found["std"]
        assert cause["probability"] > 0.9


def test_twelve_entries_are_named_each_once(bench) -> None:
    truth = [*OFFSETS, *SCALES, *AXES]
    verdict = judged(bench, truth, "twelve")
    assert verdict.word == "explained"
    assert {(c.effect, c.channels[0]) for c in verdict.state.causes} == places(truth)
    assert len(verdict.state.causes) == 12


def test_ramps_of_every_gyro_are_no_warm_ups(bench) -> None:
    verdict = judged(bench, RAMPS, "ramps")
    assert {(c.effect, c.channels[0]) for c in verdict.state.causes} == places(RAMPS)


@pytest.mark.slow
def test_a_random_walk_beside_offsets_is_no_heap_of_drifts(bench) -> None:
    truth = [*OFFSETS, one("rate_random_walk", "gyro2", deg_h_sqrt_h=8.0)]
    verdict = judged(bench, truth, "walk")
    assert {(c.effect, c.channels[0]) for c in verdict.state.causes} == places(truth)


def test_nothing_wrong_is_nothing(bench) -> None:
    verdict = judged(bench, [], "nothing")
    assert verdict.word == "no_gap"
    assert verdict.gap_probability < 0.5
    assert not verdict.state.causes


def test_what_is_found_leaves_noise(bench) -> None:
    """Squared deviates beside the causes: as many as rows, within four of their own standard deviations."""
    verdict = judged(bench, [*OFFSETS, *SCALES], "eight")
    rows = len(verdict.state.residual.y)
    assert abs(verdict.state.residual.chi2 - rows) < 4.0 * np.sqrt(2.0 * rows)
