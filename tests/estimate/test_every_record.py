"""x, y, z from the gyros that answered."""

from __future__ import annotations

import numpy as np
import pytest

from fogreduce.estimate.every_record import EveryRecord, Geometries, patterns

#: Three orthogonal gyros and their diagonal.
AXES = np.vstack((np.eye(3), np.ones(3) / np.sqrt(3)))


def test_incomplete_records_give_the_same_rates_as_complete_ones() -> None:
    """Biases of the gyros that do not agree: a gyro that goes silent moves nothing."""
    generator = np.random.default_rng(1)
    motion = generator.normal(0, 10, (3, 400))
    read = AXES @ motion + np.array([0.3, -0.2, 0.5, 0.1])[:, None]
    whole = EveryRecord(Geometries(AXES)).project(read, np.ones(read.shape, bool), np.zeros(400, int))
    usable = np.ones(read.shape, bool)
    usable[2, 200:] = False  # a value that is there and spurious must not count
    read[2, 200:] = 1e6
    found = EveryRecord(Geometries(AXES)).project(read, usable, np.zeros(400, int))
    assert found == pytest.approx(whole, abs=1e-12)
    # And from one block to the next.
    every = EveryRecord(Geometries(AXES))
    parts = [
        every.project(read[:, part], usable[:, part], np.zeros(200, int))
        for part in (slice(0, 200), slice(200, 400))
    ]
    assert np.hstack(parts) == pytest.approx(found, abs=1e-12)


def test_two_gyros_or_three_in_a_plane_give_nothing() -> None:
    axes = np.vstack((AXES, [0.6, 0.8, 0.0]))
    geometries = Geometries(axes)
    assert geometries.of(np.array([True, True, False, False, False])) is None
    assert geometries.of(np.array([True, True, False, False, True])) is None
    assert geometries.of(np.array([True, True, False, True, False])) is not None
    usable = np.array([[True], [True], [False], [False], [True]])
    assert np.isnan(EveryRecord(geometries).project(np.ones((5, 1)), usable, np.zeros(1, int))).all()


def test_weights_are_ratios_of_variances_by_hand() -> None:
    """Without the diagonal each axis has one gyro's variance, 1; with it 1 - 1/3/(1 + 1) = 5/6."""
    geometry = Geometries(AXES).of(np.array([True, True, True, False]))
    assert geometry is not None
    assert geometry.weight == pytest.approx([5 / 6] * 3)
    assert geometry.projection == pytest.approx(np.eye(3, 4))


def test_patterns_hold_every_record_once() -> None:
    usable = np.random.default_rng(2).random((4, 100)) > 0.3
    found = patterns(usable)
    assert sorted(np.concatenate([records for _, records in found]).tolist()) == list(range(100))
    assert all((usable[:, records] == there[:, None]).all() for there, records in found)
