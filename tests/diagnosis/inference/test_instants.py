"""The instant of a step: as exact as the noise lets it be, and its error says so."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from bench_lab import lab, simulated

from fogreduce.diagnosis.diagnose import diagnose
from fogreduce.diagnosis.inference.causes import Cause
from fogreduce.diagnosis.inference.search import Search
from fogreduce.diagnosis.observe.data import read_data
from fogreduce.effects.table import EFFECTS


def test_steps_are_found_within_their_errors_and_close(tmp_path) -> None:
    """Eight steps of several sizes, each alone: errors within 2.6 of their standard deviations, which are
    fractions of a second, not a bound; the closure's interval holds the 1 of a cause that is exactly right.
    """
    deviates, errors, held = [], [], []
    for k, (size, time) in enumerate([(1.5, 31.3), (3.0, 47.62), (6.0, 61.11), (20.0, 88.4)]):
        root = tmp_path / str(k)
        root.mkdir()
        lab(root)
        step = {
            "effect": "bias_step",
            "channels": ["gyro2"],
            "runs": ["r1"],
            "parameters": {"deg_h": size, "time_s": time},
        }
        out = diagnose(simulated(root, [step], seed=k), root / "cal").document
        assert (out["verdict"], [c["effect"] for c in out["causes"]]) == ("explained", ["bias_step"])
        found = out["causes"][0]["parameters"]["time_s"]
        deviates.append((found["value"] - time) / found["std"])
        errors.append(found["std"])
        low, high = out["closure"]["interval_95"]
        held.append(low <= 1.0 <= high)
    assert max(np.abs(deviates)) < 2.6
    assert max(errors) < 0.7
    assert all(held)


def test_what_a_run_begins_with_is_no_step(tmp_path: Path) -> None:
    """A constant in one run: the step that comes nearest has a block of the run before it all the same."""
    lab(tmp_path)
    put = [{"effect": "turn_on_bias", "channels": ["gyro1"], "runs": ["r1"], "parameters": {"deg_h": 6.0}}]
    search = Search(read_data(simulated(tmp_path, put), tmp_path / "cal"), frozenset(EFFECTS))
    step = Cause("bias_step", ("gyro1",), ("r1",), {"deg_h": 6.0, "time_s": 1.5}, {}, {})
    (found,) = search.state([step], search.problem).causes
    assert found.theta["time_s"] >= search.data.inputs[1].scene.blocks.length_s
