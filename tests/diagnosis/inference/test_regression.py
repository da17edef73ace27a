"""Evidence of sets in closed form, against densities worked out in full."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import multivariate_normal

from fogreduce.diagnosis.inference.candidate import Candidate
from fogreduce.diagnosis.inference.hierarchy import Kind
from fogreduce.diagnosis.inference.noise_model import Metric
from fogreduce.diagnosis.inference.regression import (
    Entry,
    Member,
    Option,
    Regression,
    additions,
    fitted,
    worths,
)

ROWS = 30
SCALES = np.array([0.5, 3.0])
WEIGHTS = np.log([0.7, 0.3])


def laboratory(fixed: bool = False) -> tuple[Regression, np.ndarray, np.ndarray, np.ndarray]:
    """A regression of one column, one pair of columns and one more; nuisances; columns; residual."""
    rng = np.random.default_rng(3)
    columns, nuisance = rng.standard_normal((ROWS, 4)), rng.standard_normal((ROWS, 2))
    y = columns @ [1.0, -0.4, 0.8, 0.0] + rng.standard_normal(ROWS)
    options = []
    for entry, mine in enumerate(([0], [1, 2], [3])):
        k = len(mine)
        whole = columns[:, mine][:, None, :]
        one = Candidate(
            "bias_offset", (f"gyro{entry}",), ("*",), slice(0, ROWS), whole, ({},), ("deg_h",) * k,
            np.ones((1, k)), fixed=fixed and entry == 2,
        )  # fmt: skip
        variances = np.repeat(SCALES[:, None] ** 2, k, axis=1)
        logs = WEIGHTS
        if one.fixed:
            variances, logs = np.ones((1, 1)), np.zeros(1)
        options.append(Option(entry, one, 0, np.array(mine), 0.0, variances, logs))
    entries = [
        Entry(Kind("bias_offset", 3, True), ("bias_offset", (f"gyro{e}",), ("*",), "")) for e in range(3)
    ]
    regression = Regression.of(Metric.of(nuisance), y, columns, options, entries)
    return regression, nuisance, columns, y


def density(y: np.ndarray, nuisance: np.ndarray, columns: np.ndarray, variances: list[float]) -> float:
    covariance = np.eye(ROWS) + nuisance @ nuisance.T + (columns * variances) @ columns.T
    return float(multivariate_normal(np.zeros(ROWS), covariance).logpdf(y))


def test_a_sets_evidence_is_the_ratio_of_densities() -> None:
    regression, nuisance, columns, y = laboratory()
    found = fitted(regression, [Member(0, 1), Member(1, 0)]).log_b
    v = SCALES**2
    expected = density(y, nuisance, columns[:, :3], [v[1], v[0], v[0]]) - density(
        y, nuisance, columns[:, :0], []
    )
    assert found == pytest.approx(expected + WEIGHTS[1] + WEIGHTS[0], abs=1e-6)


def test_what_an_option_adds_is_its_evidence_over_all_scales() -> None:
    regression, nuisance, columns, y = laboratory()
    first = [Member(0, 0)]
    more = additions(regression, fitted(regression, first))
    v = SCALES**2
    base = density(y, nuisance, columns[:, :1], [v[0]])
    each = [
        density(y, nuisance, columns[:, :3], [v[0], w, w]) - base + log
        for w, log in zip(v, WEIGHTS, strict=True)
    ]
    assert more.gain[1] == pytest.approx(np.logaddexp.reduce(each), abs=1e-6)
    assert more.scale[1] == int(np.argmax(each))


def test_an_effect_without_an_amplitude_is_its_difference_taken_off() -> None:
    regression, nuisance, columns, y = laboratory(fixed=True)
    with_it = (
        fitted(regression, [Member(0, 0), Member(2, 0)]).log_b - fitted(regression, [Member(0, 0)]).log_b
    )
    v = SCALES[0] ** 2
    expected = density(y - columns[:, 3], nuisance, columns[:, :1], [v]) - density(
        y, nuisance, columns[:, :1], [v]
    )
    assert with_it == pytest.approx(expected, abs=1e-6)
    more = additions(regression, fitted(regression, [Member(0, 0)]))
    assert more.gain[2] == pytest.approx(expected, abs=1e-6)


def test_amplitudes_are_those_of_ridge_regression() -> None:
    """The textbook's posterior mean (X' S^-1 X + D^-1)^-1 X' S^-1 y, S with the nuisances in it."""
    regression, nuisance, columns, y = laboratory()
    inverse = np.linalg.inv(np.eye(ROWS) + nuisance @ nuisance.T)
    x = columns[:, :1]
    expected = np.linalg.solve(x.T @ inverse @ x + np.eye(1) / SCALES[1] ** 2, x.T @ inverse @ y)
    assert fitted(regression, [Member(0, 1)]).mean == pytest.approx(expected, rel=1e-7)


def test_a_members_worth_is_what_leaving_it_out_loses() -> None:
    regression, *_ = laboratory()
    members = [Member(0, 1), Member(1, 0), Member(2, 0)]
    whole = fitted(regression, members)
    lost = [whole.log_b - fitted(regression, members[:k] + members[k + 1 :]).log_b for k in range(3)]
    assert worths(regression, members, whole) == pytest.approx(lost, abs=1e-6)
