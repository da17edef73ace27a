"""Two folds count together as all blocks do."""

from __future__ import annotations

import numpy as np
import pytest

from fogreduce.diagnosis.how_far.measure import Part, deviates, shows
from fogreduce.diagnosis.inference.evidence import WhitenedResidual
from fogreduce.diagnosis.inference.noise_model import Metric, Rows, Whitener

ROWS = 240


def part(keep: np.ndarray, y: np.ndarray, nuisance: np.ndarray) -> Part:
    """Blocks of white noise of 1 deg/h, those not kept without weight."""
    filters = {(0, 0): np.diag(keep.astype(float))}
    whiten = Whitener(Rows((ROWS,), 1), filters)
    white = whiten(nuisance)
    return Part(whiten, Metric.of(white), whiten(y[:, None])[:, 0])


def parts(y: np.ndarray, nuisance: np.ndarray) -> tuple[Part, list[Part]]:
    odd = np.arange(ROWS) % 2 == 1
    folds = [part(~odd, y, nuisance), part(odd, y, nuisance)]
    return part(np.ones(ROWS, bool), y, nuisance), folds


def counted(whole: Part, folds: list[Part], columns: np.ndarray) -> float:
    return sum(
        float(np.sum(one.of(fold.y) ** 2))
        for one, fold in zip(deviates(whole, folds, columns), folds, strict=True)
    )


def snr2(whole: Part, column: np.ndarray) -> float:
    white = whole.whiten(column[:, None])
    return float(whole.metric.gram(white, white)[0, 0])


def test_a_gap_counts_as_over_all_blocks_whatever_the_folds_share() -> None:
    """A drift in white noise, which each fold knows half as well, and a constant that an uncertainty of its
    kind hides, which each knows almost as well as both: together and in the same proportion.
    """
    constant, drift = np.ones(ROWS), np.linspace(-1.0, 1.0, ROWS)
    drift -= drift.mean()
    nuisance, columns = 5.0 * constant[:, None], np.column_stack([constant, drift])
    for gap in (20.0 * constant, 3.0 * drift, 20.0 * constant + 3.0 * drift):
        whole, folds = parts(gap, nuisance)
        assert counted(whole, folds, columns) == pytest.approx(snr2(whole, gap), rel=0.02)
    # as they stand the folds would count the constant twice
    whole, folds = parts(20.0 * constant, nuisance)
    assert sum(snr2(fold, 20.0 * constant) for fold in folds) == pytest.approx(
        2.0 * snr2(whole, 20.0 * constant), rel=0.02
    )


def test_expectation_and_scatter_under_noise_alone() -> None:
    generator = np.random.default_rng(8)
    t = np.linspace(0.0, 1.0, ROWS)
    columns = np.column_stack([np.ones(ROWS), t, np.sin(9.0 * t)])
    nuisance = 0.3 * np.ones((ROWS, 1))
    sums = []
    for _ in range(600):
        y = generator.standard_normal(ROWS) + 0.3 * generator.standard_normal()
        whole, folds = parts(y, nuisance)
        one = deviates(whole, folds, columns)[0]
        z = one.of(folds[0].y)
        sums.append(float(z @ z))
    assert np.mean(sums) == pytest.approx(one.expected, rel=0.1)
    assert np.std(sums) == pytest.approx(np.sqrt(2.0 * np.sum(one.spread**2)), rel=0.15)


def test_a_fold_without_a_feature_leaves_it_to_the_other() -> None:
    """A blip in one block: one fold has all of it."""
    blip = np.zeros(ROWS)
    blip[7] = 9.0
    whole, folds = parts(blip, np.zeros((ROWS, 0)))
    columns = np.column_stack([blip, np.ones(ROWS)])
    each = deviates(whole, folds, columns)
    assert np.sum(each[1].of(folds[1].y) ** 2) == pytest.approx(81.0, rel=0.02)
    assert np.sum(each[0].of(folds[0].y) ** 2) < 0.5


def test_no_features_count_nothing() -> None:
    whole, folds = parts(np.ones(ROWS), np.zeros((ROWS, 0)))
    assert all(d.expected == 0.0 for d in deviates(whole, folds, np.zeros((ROWS, 0))))


def test_what_gains_no_more_than_noise_does_not_show() -> None:
    """Three columns gain 3 +- 2.4 of noise alone; of a prior far below noise, hardly anything."""
    metric, blips = Metric.of(np.zeros((ROWS, 0))), np.eye(ROWS)[:, :3]
    for size, seen in ((2.0, False), (3.0, True)):
        y = size * blips[:, 0] + blips[:, 1]
        assert shows(WhitenedResidual.of(metric, y), blips, 0.0) is seen
    assert not shows(WhitenedResidual.of(metric, np.zeros(ROWS)), 1e-3 * blips, 1.0)
