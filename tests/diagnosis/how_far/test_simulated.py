"""What captures simulated with the causes in them show as well is no sign of anything further."""

from __future__ import annotations

import numpy as np
import pytest
from bench_lab import lab, simulated

from fogreduce.diagnosis.diagnose import diagnose
from fogreduce.diagnosis.how_far.simulated import Simulated, Source
from fogreduce.diagnosis.inference.evidence import WhitenedResidual
from fogreduce.diagnosis.where.places import LEAST_SIGMA, places


def test_only_what_the_simulated_captures_do_not_show_stands_out(tmp_path) -> None:
    """A ramp and a step at one gyro, the ramp alone taken as the cause: captures with the ramp in them show
    no step, so that it stands out; captures with both, put in their place, do, and it does not.
    """
    lab(tmp_path)
    ramp = {"effect": "bias_ramp", "channels": ["gyro2"], "runs": ["*"], "parameters": {"deg_h_per_h": 300.0}}
    step = {
        "effect": "bias_step",
        "channels": ["gyro2"],
        "runs": ["r1"],
        "parameters": {"deg_h": 4.0, "time_s": 60.0},
    }
    found = diagnose(simulated(tmp_path, [ramp, step]), tmp_path / "cal")
    alone = [c for c in found.verdict.state.causes if c.effect == "bias_ramp"]
    search = found.search
    state = search.state(alone, search.problem)
    residual = WhitenedResidual.of(
        search.problem.metric.with_free(state.model.slopes), search.problem.y - state.model.change
    )
    there = places(residual, search.problem.families, [], lambda _: [], search.data.run_ids)
    assert there[0].sigma > 20.0
    source = Source(tmp_path / "bench", tmp_path / "cal")
    ours = Simulated(search, state, source)
    assert ours.left_of(there[0]).sigma == there[0].sigma
    # their residual beside the ramp is noise: chi-squared of as many degrees as there are blocks
    size = len(search.problem.y)
    assert [f.chi2 for f in ours._residuals] == pytest.approx([size] * 2, abs=5.0 * np.sqrt(2.0 * size))
    both = Simulated(search, state, source)
    both.__dict__["campaigns"] = [found.data]
    assert both.left_of(there[0]).sigma < LEAST_SIGMA
