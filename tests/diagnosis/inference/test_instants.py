"""The instant of a step: as exact as the noise lets it be, and its error says so."""

from __future__ import annotations

import numpy as np
from bench_lab import lab, simulated

from fogreduce.diagnosis.diagnose import diagnose


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
