"""The metric: closed forms against sums, and a residual of nothing but noise against its expectation."""

from __future__ import annotations

import numpy as np
import pytest

from fogreduce.diagnosis.inference.evidence import Field, log_bayes
from fogreduce.diagnosis.inference.noise_model import Metric
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
    metric = Metric.of(a).beside(x)
    assert abs(metric.gram(x, x)[0, 0]) < 1e-6


def test_evidence_of_one_scale_is_the_ratio_of_two_gaussians() -> None:
    # with many scales the mixture lies between the least and the greatest of them
    q = np.array([0.0, 30.0])
    g = np.array([9.0, 1e12])
    one = -0.5 * np.log1p(g) + 0.5 * q[:, None] * g / (1 + g)
    found = log_bayes(q, 1)
    assert (found <= one.max(axis=1) + 12.0).all()
    assert found[0] < 0.0 < found[1]


def test_chi_squared_of_noise_is_its_number_of_rows() -> None:
    generator = np.random.default_rng(3)
    a = 5.0 * generator.standard_normal((2000, 3))
    y = generator.standard_normal(2000) + a @ generator.standard_normal(3)
    # a sum of 2000 squares of unit deviates: 2000 +- 63
    assert Field.of(Metric.of(a), y).chi2 == pytest.approx(2000.0, abs=4 * 63.0)


@pytest.mark.parametrize("z", [1.0, 4.0, 12.0, 60.0])
def test_a_deviate_squared_is_one_degree_of_freedom(z: float) -> None:
    # chi-squared of one degree has two tails
    assert deviate(log_chi2_tail(z * z, 1) - np.log(2.0)) == pytest.approx(z, rel=2e-3)
