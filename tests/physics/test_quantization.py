"""Volts and counts: the contract's rounding, limits and "no answer"."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from fogreduce.physics.quantization import counts_from_raw, raw_from_counts

MISSING = -2147483648  # capture contract
LARGEST = 2147483647


def test_rounding_by_hand() -> None:
    """count = round(v / volts_per_count); one eighth volt a count is exact in binary. Halves go to even."""
    volts = np.array([[0.0, 0.0624, 0.0626, -0.0626, 0.0625, 0.1875, -0.0625, 1.0]])
    np.testing.assert_array_equal(counts_from_raw(volts, 0.125), [[0, 0, 1, -1, 0, 2, 0, 8]])


def test_kept_to_the_largest_count_and_never_the_missing_one() -> None:
    volts = np.array([[1e6, -1e6, np.inf, -np.inf, -214.7483648, np.nan]])
    np.testing.assert_array_equal(
        counts_from_raw(volts, 1e-7), [[LARGEST, -LARGEST, LARGEST, -LARGEST, -LARGEST, MISSING]]
    )


def test_no_answer_is_nan() -> None:
    volts = raw_from_counts(np.array([[MISSING, 0, -LARGEST]], np.int32), 1e-7)
    np.testing.assert_array_equal(volts, [[np.nan, 0.0, -LARGEST * 1e-7]])


@given(st.lists(st.integers(-LARGEST, LARGEST), min_size=1), st.sampled_from([1e-7, 0.125, 3e-5]))
def test_counts_survive_the_way_there_and_back(counts: list[int], quantum: float) -> None:
    array = np.array([counts], np.int32)
    np.testing.assert_array_equal(counts_from_raw(raw_from_counts(array, quantum), quantum), array)


@given(st.lists(st.floats(-200, 200), min_size=1))
def test_volts_come_back_within_half_a_count(volts: list[float]) -> None:
    """And some rounding errors of double precision: 2^31 counts leave 2^-22 of a count."""
    array = np.array([volts])
    back = raw_from_counts(counts_from_raw(array, 1e-7), 1e-7)
    assert np.abs(back - array).max() <= 0.5e-7 * (1 + 1e-5)


def test_inputs_are_not_changed() -> None:
    volts = np.array([[0.3, np.nan]])
    counts_from_raw(volts, 1e-7)
    np.testing.assert_array_equal(volts, [[0.3, np.nan]])
