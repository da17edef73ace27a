"""Constant stretches among readings that scatter, in blocks of any size."""

from __future__ import annotations

import numpy as np
import pytest

from fogreduce.estimate.constant import ConstantSearch


def found(values: np.ndarray, block: int, rate_hz: float = 64.0) -> np.ndarray:
    search = ConstantSearch(len(values), rate_hz)
    parts = [values[:, k : k + block] for k in range(0, values.shape[1], block)]
    out = []
    for part, following in zip(parts, [*parts[1:], None], strict=True):
        size = part.shape[1] + (0 if following is None else following.shape[1])
        flags = search.flags(part, following, lambda size=size: np.zeros(size, int))
        out.append(np.zeros(part.shape, bool) if flags is None else flags)
    return np.concatenate(out, axis=1)


@pytest.mark.parametrize("block", [1000, 2500, 10_000])
def test_a_stretch_is_found_whole(block: int) -> None:
    values = np.random.default_rng(1).integers(-1000, 1000, (2, 8000)).astype(np.int32)
    values[1, 2000:3280] = values[1, 2000]
    flags = found(values, block)
    assert not flags[0].any()
    inside = np.flatnonzero(flags[1])
    assert set(inside.tolist()) >= set(range(2001, 3280))
    assert inside.min() >= 1999
    assert inside.max() == 3279


def test_coarse_readings_are_left_alone() -> None:
    """Noise of a fifth of a step, and none at all: repeats are what is to be expected."""
    noise = np.random.default_rng(2).normal(0.45, 0.2, (1, 20_000))
    assert not found(np.rint(noise).astype(np.int32), 20_000).any()
    assert not found(np.zeros((1, 20_000), np.int32), 20_000).any()


def test_a_gyro_that_never_changes_is_dead_where_the_others_scatter() -> None:
    """To the last record, in blocks of which the last is short; not beside coarse or noiseless readings."""
    live = np.random.default_rng(5).normal(0.0, 30.0, (2, 20_030))
    flags = found(np.rint(np.vstack((live[0], np.full(20_030, 7.0), live[1]))), 5000)
    assert flags[1].all()
    assert not flags[[0, 2]].any()
    coarse = np.vstack((np.full(20_030, 7.0), live[0] / 60))
    assert not found(np.rint(coarse), 5000).any()
    wave = np.vstack((np.full(20_030, 7.0), 1e6 * np.sin(np.arange(20_030) / 300)))
    assert not found(np.rint(wave), 5000).any()


def test_a_slow_wave_of_a_few_steps_rests_at_its_crests() -> None:
    """Three steps of sine, noise of a fifth of a step: at the crests a code repeats for long."""
    wave = 3.0 * np.sin(2 * np.pi * np.arange(20_000) / 20_000)
    noise = np.random.default_rng(3).normal(0.0, 0.2, 20_000)
    assert not found(np.rint(wave + noise)[None, :], 5000).any()


def test_a_rail_far_from_coarse_readings_is_found() -> None:
    values = np.rint(np.random.default_rng(4).normal(0.45, 0.2, (1, 20_000)))
    values[0, 5000:6280] = 40.0
    assert found(values, 20_000)[0, 5001:6280].all()
