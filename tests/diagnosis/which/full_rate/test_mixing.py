"""Lines of no catalogue: two that mix, and one that starts anew with each run."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fogreduce.diagnosis.which.full_rate.mixing import unknown_lines

LINES, RUNS = 4000, 4
HZ: NDArray[np.float64] = np.linspace(1.0, 1.0 + 0.01 * (LINES - 1), LINES)
FREE = np.ones(LINES, bool)
COUNT = LINES / 2.0


def _noise(rng: np.random.Generator) -> NDArray[np.complex128]:
    return rng.standard_normal((LINES, RUNS)) + 1j * rng.standard_normal((LINES, RUNS))


def _line(z: NDArray[np.complex128], hz: float, size: float, phase: NDArray[np.float64]) -> None:
    z[round((hz - HZ[0]) / 0.01)] += size * np.exp(1j * phase)


def _best(z: NDArray[np.complex128]) -> float:
    return max(
        (log_b for log_b, _, _ in unknown_lines(list(z.T), np.sum(np.abs(z) ** 2, axis=1), HZ, FREE, COUNT)),
        default=0.0,
    )


def test_two_lines_with_their_sum_and_difference() -> None:
    rng = np.random.default_rng(1)
    z, alone = _noise(rng), _noise(rng)
    for one in (z, alone):
        _line(one, 11.0, 4.0, rng.uniform(0, 6.28, RUNS))
        _line(one, 4.5, 4.0, rng.uniform(0, 6.28, RUNS))
    _line(z, 15.5, 3.0, rng.uniform(0, 6.28, RUNS))
    _line(z, 6.5, 3.0, rng.uniform(0, 6.28, RUNS))
    assert _best(z) > _best(alone) + 8.0


def test_a_line_of_one_phase_in_every_run() -> None:
    rng = np.random.default_rng(2)
    z, free = _noise(rng), _noise(rng)
    _line(z, 11.0, 4.0, np.full(RUNS, 0.7))
    _line(free, 11.0, 4.0, np.array([0.0, 1.6, 3.1, 4.7]))
    assert _best(z) > 10.0
    assert _best(free) < 3.0


def test_noise_alone() -> None:
    assert _best(_noise(np.random.default_rng(3))) < 2.0


def test_a_line_that_is_a_cause_already_is_no_product_of_others() -> None:
    rng = np.random.default_rng(5)
    z = _noise(rng)
    for hz in (20.0, 22.5):
        _line(z, hz, 4.0, rng.uniform(0, 6.28, RUNS))
    free = np.abs(HZ - 2.5) > 0.12

    def best(z: NDArray[np.complex128]) -> float:
        power = np.sum(np.abs(z) ** 2, axis=1)
        return max((one[0] for one in unknown_lines(list(z.T), power, HZ, free, COUNT)), default=0.0)

    before = best(z)
    _line(z, 2.5, 30.0, rng.uniform(0, 6.28, RUNS))
    assert best(z) < before + 1.0
