"""What is judged of a search: nothing that is not named stays in the noise."""

from __future__ import annotations

from pathlib import Path

import pytest
from bench_lab import lab, simulated

from fogreduce.diagnosis.inference import verdict
from fogreduce.diagnosis.inference.outcome import Named
from fogreduce.diagnosis.inference.search import Search
from fogreduce.diagnosis.inference.unknown import Unknown
from fogreduce.diagnosis.observe.data import read_data
from fogreduce.effects.table import EFFECTS

_FLICKER = [
    {"effect": "bias_instability", "channels": ["gyro4"], "runs": ["*"], "parameters": {"deg_h": 1.0}},
]


def test_a_process_in_whose_stead_something_unknown_stands_is_in_no_noise(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    lab(tmp_path)
    search = Search(read_data(simulated(tmp_path, _FLICKER), tmp_path / "cal"), frozenset(EFFECTS))
    key = ("bias_instability", ("gyro4",), ("*",), "")
    instead = [Unknown(("gyro4",), 1.0, frozenset({key}))]
    monkeypatch.setattr(verdict, "unknowns", lambda search, posterior: instead)
    found = verdict.verdict_of_sets(search)
    assert (found.word, found.state.causes) == ("unexplained", [])
    left, whole = found.state.residual.chi2, search.state([], search.problem).residual.chi2
    assert left == pytest.approx(whole)


def test_a_process_less_probable_than_something_unknown_is_not_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    lab(tmp_path)
    search = Search(read_data(simulated(tmp_path, _FLICKER), tmp_path / "cal"), frozenset(EFFECTS))
    monkeypatch.setattr(verdict, "unknowns", lambda search, posterior: [])
    monkeypatch.setattr(verdict, "in_its_place", lambda search, state, k, most: Named(k, 0.1, 0.2, ()))
    found = verdict.verdict_of_sets(search)
    assert (found.word, found.state.causes, found.named) == ("unexplained", [], ())
    assert found.unknown_probability == pytest.approx(0.8)
