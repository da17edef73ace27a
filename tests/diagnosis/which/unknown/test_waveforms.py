"""Shapes of the unknown over a run's blocks, held against what they are said to be."""

from __future__ import annotations

import numpy as np

from fogreduce.diagnosis.observe.blocks import Blocks
from fogreduce.diagnosis.which.unknown.waveforms import after_effects, memories, recoveries, sawteeth, steps

COUNT = 300
BLOCKS = Blocks(1.0, COUNT, np.linspace(0.5, COUNT - 0.5, COUNT), np.arange(COUNT))


def test_an_after_effect_of_a_steady_cause_rises_to_it() -> None:
    shapes = after_effects(memories(BLOCKS), np.full(COUNT, 2.0))[:, :, 0]
    assert np.all(np.diff(shapes, axis=0) >= -1e-12)
    assert np.isclose(shapes[-1, 0], 2.0)  # the shortest memory has forgotten the start
    assert np.all(shapes < 2.0 + 1e-9)


def test_recoveries_fall_more_slowly_at_the_end_than_an_exponential() -> None:
    for shape in recoveries(BLOCKS)[:, :, 0].T:
        slope = np.diff(np.log(shape))
        assert np.all(slope < 0.0)
        assert abs(slope[-1]) < abs(slope[0])


def test_sawteeth_have_the_mean_over_a_block() -> None:
    cycles, k = 3.0, 8
    fine = (np.arange(COUNT * 500) + 0.5) / 500.0
    plain = ((cycles * fine / COUNT) % 1.0 - 0.5).reshape(COUNT, 500).mean(axis=1)
    assert np.allclose(sawteeth(BLOCKS, float(COUNT), 1.0)[:, k, 0], plain, atol=2e-3)


def test_steps_are_whitened_units_from_each_block_on() -> None:
    matrix = np.tril(np.random.default_rng(1).standard_normal((6, 6)))
    found = steps(matrix)[:, :, 0]
    for start in range(1, 6):
        assert np.allclose(found[:, start - 1], matrix @ (np.arange(6) >= start))
