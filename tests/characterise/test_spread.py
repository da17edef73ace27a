"""Scatter between groups, and how far values that agree can bound it."""

from __future__ import annotations

import numpy as np
import pytest

from fogreduce.characterise.spread import spread_of_values


def test_values_that_agree_by_chance_do_not_rule_scatter_out() -> None:
    """Eight values of standard deviation 1 that agree: the bound is one that eight such values can give.

    By chi-squared of 7 degrees of freedom, 1.690 is fallen short of in 2.5 %: 1 + s^2 = 7 / 1.690.
    """
    found = spread_of_values([0.1, -0.1] * 4, [1.0] * 8)
    assert found is not None
    assert (found.value, found.low) == (0.0, 0.0)
    assert found.high == pytest.approx(np.sqrt(7 / 1.6899 - 1), rel=1e-3)


def test_where_values_scatter_the_interval_is_that_of_chi_squared() -> None:
    values = 10.0 * np.random.default_rng(1).standard_normal(8)
    found = spread_of_values(list(values), [0.01] * 8)
    assert found is not None
    square = float(np.sum((values - values.mean()) ** 2))
    assert found.high == pytest.approx(np.sqrt(square / 1.6899), rel=1e-3)
    assert found.low == pytest.approx(np.sqrt(square / 16.0128), rel=1e-3)
