"""Detectors against the theory: published run lengths, false alarms counted, delays averaged."""

from __future__ import annotations

import numpy as np
import pytest

from fogreduce.characterise.cusum import level_changes, scatter_changes
from fogreduce.characterise.run_length import (
    level_limit,
    level_run_length,
    scatter_limit,
    scatter_run_length,
    two_sided_run_length,
)

SAMPLES = 2000.0


def test_run_lengths_are_the_published_ones() -> None:
    """Montgomery, Introduction to Statistical Quality Control (2009), table 9.3: k = 1/2, two-sided."""
    assert two_sided_run_length(4.0, 0.5, 0.0) == pytest.approx(168, abs=0.5)
    assert two_sided_run_length(5.0, 0.5, 0.0) == pytest.approx(465, abs=0.5)
    assert two_sided_run_length(4.0, 0.5, 1.0) == pytest.approx(8.38, abs=0.01)
    assert two_sided_run_length(5.0, 0.5, 2.0) == pytest.approx(4.01, abs=0.01)
    assert two_sided_run_length(level_limit(465.0, 0.5), 0.5, 0.0) == pytest.approx(465, rel=1e-6)


def test_false_alarms_of_level_are_as_asked() -> None:
    values = np.random.default_rng(1).normal(3.0, 2.0, 200_000)
    found = level_changes(values, np.full(values.size, 2.0), level_limit(SAMPLES, 0.5), 0.5)
    assert len(found) == pytest.approx(100, abs=30)  # three standard deviations of a Poisson count


@pytest.mark.parametrize("shift", [1.0, 2.0, 3.0])
def test_delay_of_a_step_is_within_1_2_of_theory(shift: float) -> None:
    generator = np.random.default_rng(2)
    limit = level_limit(SAMPLES, 0.5)
    delays = []
    for _ in range(200):
        values = generator.normal(0, 1, 900)
        values[500:] += shift
        first = level_changes(values, np.ones(900), limit, 0.5)[0].alarm
        if first >= 500:  # a delay is that of a detector that has not alarmed before
            delays.append(first - 499)
    assert len(delays) > 140
    assert np.mean(delays) <= 1.2 * level_run_length(limit, 0.5, shift)


@pytest.mark.parametrize("ratio", [2.25, 0.25])
def test_scatter_alarms_as_asked_and_within_1_2_of_theory(ratio: float) -> None:
    generator = np.random.default_rng(3)
    freedom = np.full(200_000, 15.0)
    (false,) = scatter_changes(generator.chisquare(15, 200_000) / 15, freedom, [ratio], SAMPLES)
    assert 60 <= len(false) <= 130
    delays = []
    for _ in range(200):
        variance = generator.chisquare(15, 300)
        variance[200:] *= ratio
        (found,) = scatter_changes(variance, freedom[:300], [ratio], SAMPLES)
        delays.append(next(one.alarm - 199 for one in found if one.alarm >= 200))
    theory = scatter_run_length(scatter_limit(SAMPLES, 15.0, ratio), 15.0, ratio, ratio)
    assert np.mean(delays) <= 1.2 * theory


def test_where_and_how_large() -> None:
    values = np.random.default_rng(4).normal(0, 1, 2000)
    values[1200:] += 2.5
    (change,) = level_changes(values, np.ones(2000), level_limit(1e6, 0.5), 0.5)
    assert change.start == pytest.approx(1200, abs=5)
    assert change.alarm - change.start < 20
