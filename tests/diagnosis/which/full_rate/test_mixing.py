"""Lines of no catalogue: two that mix."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fogreduce.diagnosis.which.full_rate.mixing import mixed

LINES, RUNS = 4000, 4
HZ: NDArray[np.float64] = np.linspace(1.0, 1.0 + 0.01 * (LINES - 1), LINES)
FREE = np.ones(LINES, bool)
COUNT = LINES / 2.0


def _noise(rng: np.random.Generator) -> NDArray[np.complex128]:
    return rng.standard_normal((LINES, RUNS)) + 1j * rng.standard_normal((LINES, RUNS))


def _line(z: NDArray[np.complex128], hz: float, size: float, phase: NDArray[np.float64]) -> None:
    z[round((hz - HZ[0]) / 0.01)] += size * np.exp(1j * phase)


def _best(z: NDArray[np.complex128], free: NDArray[np.bool_] = FREE) -> float:
    found = mixed(list(z.T), HZ, free, COUNT)
    return 0.0 if found is None else found.log_b


def test_two_lines_with_their_sum_and_difference() -> None:
    rng = np.random.default_rng(1)
    z, alone = _noise(rng), _noise(rng)
    for one in (z, alone):
        _line(one, 11.0, 4.0, rng.uniform(0, 6.28, RUNS))
        _line(one, 4.5, 4.0, rng.uniform(0, 6.28, RUNS))
    _line(z, 15.5, 3.0, rng.uniform(0, 6.28, RUNS))
    _line(z, 6.5, 3.0, rng.uniform(0, 6.28, RUNS))
    assert _best(z) > _best(alone) + 8.0


def test_two_strong_lines_alone_make_no_product() -> None:
    rng = np.random.default_rng(4)
    z = _noise(rng)
    for hz in (20.0, 33.0):
        _line(z, hz, 300.0, rng.uniform(0, 6.28, RUNS))
    found = mixed(list(z.T), HZ, FREE, COUNT)
    assert found is not None
    assert found.product < 3.0


def test_a_line_and_twice_its_frequency_are_no_pair() -> None:
    rng = np.random.default_rng(6)
    z = _noise(rng)
    for hz in (10.0, 20.0, 30.0):
        _line(z, hz, 30.0, rng.uniform(0, 6.28, RUNS))
    found = mixed(list(z.T), HZ, FREE, COUNT)
    assert found is None or found.product < 3.0 or not {10.0, 20.0} <= set(np.round(found.hz[:2], 1))


def test_noise_alone() -> None:
    assert _best(_noise(np.random.default_rng(3))) < 2.0


def test_a_line_that_is_a_cause_already_is_no_product_of_others() -> None:
    rng = np.random.default_rng(5)
    z = _noise(rng)
    for hz in (20.0, 22.5):
        _line(z, hz, 4.0, rng.uniform(0, 6.28, RUNS))
    free = np.abs(HZ - 2.5) > 0.12
    before = _best(z, free)
    _line(z, 2.5, 30.0, rng.uniform(0, 6.28, RUNS))
    assert _best(z, free) < before + 1.0
