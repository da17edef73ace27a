"""Noise synthesis against the definitions of the capture contract and IEEE 952."""

from __future__ import annotations

import math

import numpy as np
import pytest

from fogreduce.physics import noise
from fogreduce.physics.flicker import FlickerSource

RATES = [32.0, 128.0, 1000.0]


def generator(seed: int) -> np.random.Generator:
    return np.random.Generator(np.random.SFC64(seed))


def samples(source: FlickerSource | noise.WalkSource, length: int) -> np.ndarray:
    blocks = [source.next_block() for _ in range(-(-length // noise.BLOCK))]
    return np.concatenate(blocks)[:length]


def overlapping_allan(rate: np.ndarray, m: int) -> float:
    """Overlapping Allan deviation of rate samples at m samples (IEEE 952, eq. C.9), by its definition."""
    angle = np.concatenate(([0.0], np.cumsum(rate)))
    second = angle[2 * m :] - 2 * angle[m:-m] + angle[: -2 * m]
    return float(np.sqrt(np.mean(second**2) / 2) / m)


def allantools_allan(rate: np.ndarray, rate_hz: float, m: int) -> float:
    allantools = pytest.importorskip("allantools")
    _, deviation, _, _ = allantools.oadev(rate, rate=rate_hz, data_type="freq", taus=[m / rate_hz])
    return float(deviation[0])


def test_formulas_by_hand() -> None:
    # N = 0.6 deg/sqrt(h) = 0.01 deg/sqrt(s): 0.1 deg/s a sample at 100 Hz, 0.001 deg/s over 100 s.
    assert noise.white_sigma(0.6, 100.0) == pytest.approx(0.1, rel=1e-12)
    assert noise.white_coefficient(0.1, 100.0) == pytest.approx(0.6, rel=1e-12)
    assert noise.white_allan(0.6, np.array([100.0]))[0] == pytest.approx(0.001, rel=1e-12)
    # White noise of variance s^2 at rate r fills 0 to r / 2: density 2 s^2 / r = 2e-4.
    assert noise.white_density(0.6) == pytest.approx(2e-4, rel=1e-12)
    # sqrt(2 ln 2 / pi) = 0.664 (IEEE 952, annex C)
    assert noise.flicker_allan(1.0) == pytest.approx(0.664, abs=5e-4)
    # K = 60 deg/h/sqrt(h): 1 deg/h/sqrt(s); over 3 s sqrt(3 / 3) = 1 deg/h.
    assert noise.walk_allan(60.0, np.array([3.0]))[0] == pytest.approx(1.0, rel=1e-12)


def allan_of_density(density: np.ndarray, f: np.ndarray, tau: float) -> float:
    """The Allan deviation that a one-sided density has: 2 int S sin^4(pi f tau) / (pi f tau)^2 df."""
    x = np.pi * f * tau
    y = 2 * density * np.sin(x) ** 4 / x**2
    return math.sqrt(np.sum((y[1:] + y[:-1]) / 2 * np.diff(f)))


def test_densities_and_allan_deviations_belong_together() -> None:
    """Each pair is tied by the general integral, evaluated numerically."""
    f = np.geomspace(1e-6, 1e3, 400_000)
    tau = 2.0
    white = allan_of_density(np.full_like(f, noise.white_density(0.6)), f, tau)
    assert white == pytest.approx(noise.white_allan(0.6, np.array([tau]))[0], rel=2e-3)
    assert allan_of_density(noise.flicker_density(3.0, f), f, tau) == pytest.approx(
        noise.flicker_allan(3.0), rel=2e-3
    )
    walk = allan_of_density(noise.walk_density(2.0, f), f, tau)
    assert walk == pytest.approx(noise.walk_allan(2.0, np.array([tau]))[0], rel=2e-3)


def test_flicker_covariance_by_hand() -> None:
    """Lag 0 less lag 1 is the Allan variance of one step, so 2 ln 2 / pi, whatever the step."""
    for step in (1e-3, 1.0, 10.0):
        lag0, lag1 = noise.flicker_covariance(1.0, step, 2)
        assert lag0 - lag1 == pytest.approx(2 * math.log(2) / math.pi, rel=1e-6)


def test_flicker_covariance_is_the_integral_over_its_density() -> None:
    for step in (5.0, 2e4):
        f = np.geomspace(noise.LOWEST_FLICKER_HZ, 100 / step, 400_001)
        means = noise.flicker_density(3.0, f) * np.sinc(f * step) ** 2 * f
        means[[0, -1]] /= 2
        weight = math.log(f[1] / f[0])
        expected = [weight * np.sum(means * np.cos(2 * np.pi * f * step * k)) for k in range(6)]
        assert noise.flicker_covariance(3.0, step, 6) == pytest.approx(
            expected, rel=1e-4, abs=1e-5 * expected[0]
        )


def test_walk_starts_at_zero_and_runs_on() -> None:
    source = noise.WalkSource(1.0, generator(3))
    walk = np.concatenate([source.next_block(), source.next_block()])
    assert walk[0] == 0.0
    steps = np.diff(walk)
    # 1 / 60 deg/h a step; 24 575 steps: a standard deviation to 0.45 %
    assert steps.std() * 60 == pytest.approx(1.0, abs=0.02)
    assert abs(steps[noise.BLOCK - 1]) < 6 / 60


@pytest.mark.slow
@pytest.mark.parametrize("rate_hz", RATES)
@pytest.mark.parametrize("process", ["white", "flicker", "walk"])
def test_forty_seeds_measure_what_was_put_in(process: str, rate_hz: float) -> None:
    """Overlapping Allan deviation: the mean within 3 %, its standard error below 1 %; allantools agrees."""
    tau, duration = (1.0, 1000.0) if process == "white" else (2.0, 2000.0)
    m, length = round(tau * rate_hz), round(duration * rate_hz)
    found = []
    for seed in range(40):
        if process == "white":
            made = generator(seed).standard_normal(length) * noise.white_sigma(1.0, rate_hz)
            expected = float(noise.white_allan(1.0, np.array([tau]))[0])
        elif process == "flicker":
            made = samples(FlickerSource(rate_hz, generator(seed)), length)
            expected = noise.flicker_allan(1.0)
        else:
            made = samples(noise.WalkSource(rate_hz, generator(seed)), length)
            expected = float(noise.walk_allan(1.0, np.array([tau]))[0])
        found.append(overlapping_allan(made, m) / expected)
        if seed < 3:
            assert allantools_allan(made, rate_hz, m) / expected == pytest.approx(found[-1], rel=1e-9)
    error = np.std(found, ddof=1) / math.sqrt(40)
    print(f"{process} {rate_hz:g} Hz: mean {np.mean(found):.4f}, standard error {error:.4f}")
    assert error < 0.01
    assert np.mean(found) == pytest.approx(1.0, abs=0.03)
