"""Blocks: their means are those of the samples in them."""

from __future__ import annotations

import numpy as np
import pytest
from bench_lab import RECORD, write_record, write_run

from fogreduce.diagnosis.observe.blocks import Blocks
from fogreduce.diagnosis.observe.capture import read_inputs


@pytest.mark.parametrize("rate_hz", [2.0, 10.0, 64.0, 100.0])
def test_a_slope_has_the_mean_of_its_samples(tmp_path, rate_hz: float) -> None:
    write_record(tmp_path, RECORD)
    write_run(tmp_path, "r0", "x", [(10.0, 60.0)], 4, rate_hz)
    (one,) = read_inputs(tmp_path / "plan", tmp_path / "cal", need_capture=False)
    blocks = Blocks.of(one.facts)
    time = np.arange(one.facts.n_expected) / rate_hz
    block = blocks.of_samples(time)
    expected = [time[block == k].mean() for k in range(blocks.count)]
    np.testing.assert_allclose(blocks.means(blocks.time_s), expected, atol=1e-9)
