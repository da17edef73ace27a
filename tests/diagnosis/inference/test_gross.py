"""Gross causes: into the chain first, and what adds up with others beside them."""

from __future__ import annotations

from bench_lab import lab, simulated

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
    first = gross(search, search.state([], search.ground))
    assert [c.effect for c in first.settled] == ["rotation_sense"]
    verdict = verdict_of_sets(search)
    assert {c.effect for c in verdict.state.causes} == {"rotation_sense", "bias_offset"}


def test_what_adds_up_starts_the_sets_and_may_be_exchanged(tmp_path) -> None:
    lab(tmp_path)
    search = Search(read_data(simulated(tmp_path, [LARGE]), tmp_path / "cal"), frozenset(EFFECTS))
    first = gross(search, search.state([], search.ground))
    assert not first.settled
    assert all(fit.candidate.channels == ("gyro3",) for fit in first.others)
    verdict = verdict_of_sets(search)
    assert [(c.effect, c.channels) for c in verdict.state.causes] == [("bias_offset", ("gyro3",))]
