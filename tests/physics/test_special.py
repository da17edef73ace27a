"""Special functions against SciPy's."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import special
from scipy.stats import chi2

from fogreduce.physics.special import (
    cosine_integral,
    log_chi2_tail,
    log_i0,
    log_normal_tail,
    normal_deviate,
)


def test_the_cosine_integral_on_both_sides_of_its_series() -> None:
    for x in (np.geomspace(1e-8, 5.9, 200), np.geomspace(1e-4, 300.0, 50)):
        np.testing.assert_allclose(cosine_integral(x), special.sici(x)[1], rtol=1e-12, atol=1e-14)


def test_ln_i0_from_nothing_to_far_beyond_overflow() -> None:
    x = np.concatenate(([0.0], np.geomspace(1e-6, 1e6, 500)))
    np.testing.assert_allclose(log_i0(x), np.log(special.i0e(x)) + x, rtol=1e-13, atol=1e-15)


@pytest.mark.parametrize("x", [3.0, 0.0, -1.0, -5.0, -19.99, -20.01, -37.0, -400.0, -1e6])
def test_ln_of_the_normal_tail(x: float) -> None:
    assert log_normal_tail(x) == pytest.approx(float(special.log_ndtr(x)), rel=1e-9)


@pytest.mark.parametrize("k", [1, 2, 3, 8, 16, 79, 80])
@pytest.mark.parametrize("q", [1e-9, 0.5, 7.0, 80.0, 300.0, 1200.0])
def test_ln_of_the_tail_of_chi_squared(k: int, q: float) -> None:
    assert log_chi2_tail(q, k) == pytest.approx(float(chi2.logsf(q, k)), rel=1e-8, abs=1e-12)


@pytest.mark.parametrize("p", [0.5, 1e-3, 1e-30, 1e-217, 0.99])
def test_the_normal_deviate(p: float) -> None:
    assert normal_deviate(p) == pytest.approx(float(special.ndtri(p)), rel=1e-9, abs=1e-12)
