"""The metric: closed forms against sums, and a residual of nothing but noise against its expectation."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.special import logsumexp
from scipy.stats import multivariate_normal

from fogreduce.diagnosis.inference.evidence import LOG_WEIGHTS, SCALES, WhitenedResidual, log_bayes
from fogreduce.diagnosis.inference.noise_model import Metric, Rows, Whitener
from fogreduce.diagnosis.inference.significance import deviate
from fogreduce.physics.special import log_chi2_tail


def test_the_marginal_product_is_that_of_the_whole_covariance() -> None:
    generator = np.random.default_rng(1)
    a, x = generator.standard_normal((30, 4)), generator.standard_normal((30, 2))
    whole = np.linalg.inv(np.eye(30) + a @ a.T)
    np.testing.assert_allclose(Metric.of(a).gram(x, x), x.T @ whole @ x, rtol=1e-10)


def test_a_free_column_is_projected_out() -> None:
    generator = np.random.default_rng(2)
    a, x = generator.standard_normal((30, 3)), generator.standard_normal((30, 1))
    metric = Metric.of(a).with_free(x)
    assert abs(metric.gram(x, x)[0, 0]) < 1e-6


@pytest.mark.parametrize("k", [1, 3])
def test_evidence_is_the_ratio_of_gaussian_densities_over_the_scales(k: int) -> None:
    """By scipy's densities: columns at right angles, so that a product is normal with variance 1 or 1 + g."""
    products = np.array([[0.0] * k, [2.0] * k, [9.0] * k])
    nothing = multivariate_normal(cov=np.eye(k)).logpdf(products)
    each = [multivariate_normal(cov=(1.0 + s**2 / k) * np.eye(k)).logpdf(products) - nothing for s in SCALES]
    found = log_bayes(np.sum(products**2, axis=1), k)
    np.testing.assert_allclose(found, logsumexp(each, axis=0, b=np.exp(LOG_WEIGHTS)[:, None]), rtol=1e-9)


def test_chi_squared_of_noise_is_its_number_of_rows() -> None:
    generator = np.random.default_rng(3)
    a = 5.0 * generator.standard_normal((2000, 3))
    y = generator.standard_normal(2000) + a @ generator.standard_normal(3)
    # a sum of 2000 squares of unit deviates: 2000 +- 63
    assert WhitenedResidual.of(Metric.of(a), y).chi2 == pytest.approx(2000.0, abs=4 * 63.0)


@pytest.mark.parametrize("z", [1.0, 4.0, 12.0, 60.0])
def test_a_deviate_squared_is_one_degree_of_freedom(z: float) -> None:
    # chi-squared of one degree has two tails
    assert deviate(log_chi2_tail(z * z, 1) - np.log(2.0)) == pytest.approx(z, rel=2e-3)


def test_a_coarser_noise_counts_less_of_one_gyro_alone() -> None:
    rows = Rows((3, 2), 2)
    filters = {(i, r): np.eye(rows.counts[r]) for i in range(2) for r in range(2)}
    white = Whitener(rows, filters).coarser({1: 4.0})(np.ones((rows.total, 1)))[:, 0]
    np.testing.assert_allclose(white[rows.of(0)], 1.0)
    np.testing.assert_allclose(white[rows.of(1)], 0.25)
