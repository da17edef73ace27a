"""Gross causes: into the chain first, and what adds up with others beside them."""

from __future__ import annotations

import pytest
from bench_lab import RECORD, lab, simulated

from fogreduce.diagnosis.inference.gross import gross
from fogreduce.diagnosis.inference.search import Search
from fogreduce.diagnosis.inference.verdict import verdict_of_sets
from fogreduce.diagnosis.observe.data import read_data
from fogreduce.effects.table import EFFECTS

SENSE = {"effect": "rotation_sense", "channels": ["table"], "runs": ["*"], "parameters": {}}
OFFSET = {"effect": "bias_offset", "channels": ["gyro3"], "runs": ["*"], "parameters": {"deg_h": 2.0}}
LARGE = {"effect": "bias_offset", "channels": ["gyro3"], "runs": ["*"], "parameters": {"deg_h": 40.0}}


def test_a_wrong_sense_goes_into_the_chain_and_an_offset_is_found_beside_it(tmp_path) -> None:
    lab(tmp_path)
    search = Search(read_data(simulated(tmp_path, [SENSE, OFFSET]), tmp_path / "cal"), frozenset(EFFECTS))
    first = gross(search, search.state([], search.problem))
    assert [c.effect for c in first.settled] == ["rotation_sense"]
    verdict = verdict_of_sets(search)
    assert {c.effect for c in verdict.state.causes} == {"rotation_sense", "bias_offset"}


def test_what_adds_up_starts_the_sets_and_may_be_exchanged(tmp_path) -> None:
    lab(tmp_path)
    search = Search(read_data(simulated(tmp_path, [LARGE]), tmp_path / "cal"), frozenset(EFFECTS))
    first = gross(search, search.state([], search.problem))
    assert not first.settled
    assert all(fit.candidate.channels == ("gyro3",) for fit in first.others)
    verdict = verdict_of_sets(search)
    assert [(c.effect, c.channels) for c in verdict.state.causes] == [("bias_offset", ("gyro3",))]


@pytest.mark.parametrize("n_deg_sqrt_h", [1e-3, 2e-4])
def test_a_table_off_in_rate_is_simulated_and_leaves_nothing(tmp_path, n_deg_sqrt_h) -> None:
    """By a hundredth: it comes to angles of which a column, linear in the error, knows nothing."""
    rate = {"effect": "table_rate_error", "channels": ["table"], "runs": ["*"], "parameters": {"ppm": -1e4}}
    record = RECORD | {"noise": RECORD["noise"] | {"angle_random_walk_deg_sqrt_h": [n_deg_sqrt_h] * 4}}
    lab(tmp_path, record, rate_hz=16.0, duration_s=400.0, rates=(15.0, -15.0, 15.0, -15.0, 0.3, 0.0))
    search = Search(read_data(simulated(tmp_path, [rate]), tmp_path / "cal"), frozenset(EFFECTS))
    first = gross(search, search.state([], search.problem))
    assert [fit.candidate.effect for fit in first.others] == ["table_rate_error"]
    assert first.state.residual.chi2 < 1.1 * len(first.state.residual.y)
