"""Allan deviation of arrays: limits, gaps, unequal stamps, coefficients, and what comes back."""

from __future__ import annotations

import math

import numpy as np
import pytest

import fogreduce
from fogreduce.characterise.allan_channel import channel_of
from fogreduce.characterise.allan_covariance import covariance
from fogreduce.characterise.allan_distribution import relative_limits
from fogreduce.characterise.allan_freedom import degrees_of_freedom, limits
from fogreduce.characterise.grid import on_grid
from fogreduce.estimate.allan_variance import Series, modified, overlapping, total
from fogreduce.physics.flicker import FlickerSource
from fogreduce.physics.noise import WalkSource, white_sigma

LEVELS = ((0.6826894921370859, "68"), (0.95, "95"))


def lose(values: np.ndarray, part: float, generator: np.random.Generator) -> np.ndarray:
    return np.where(generator.random(values.size) < part, np.nan, values)


def coverage(noise, name: str, size: int, factors: tuple[int, ...], seeds: int, lost: float) -> dict:
    """Part of all seeds whose limits hold the truth, by kind and level, (k,) along the averaging times."""
    truth = np.sqrt([noise.allan_variance(name, size, m) for m in factors])
    hits = {(kind, level): np.zeros(len(factors)) for kind in ("overlapping", "total") for _, level in LEVELS}
    for seed in range(seeds):
        generator = np.random.default_rng([7, seed])
        values = noise.make(name, size, generator)
        values = lose(values, lost, generator) if lost else values
        found = fogreduce.allan(
            values, 1.0, unit="deg/h", factors=factors, kinds=("overlapping", "total"), terms=""
        )
        for (kind, level), hit in hits.items():
            one = found["channel1"].deviations[kind]
            hit += (getattr(one, f"low_{level}") <= truth) & (truth <= getattr(one, f"high_{level}"))
    return {key: hit / seeds for key, hit in hits.items()}


@pytest.mark.parametrize("name", ["white", "flicker", "walk"])
def test_limits_hold_the_truth(noise, name: str) -> None:
    """150 seeds: 68 % is known to 3.8 % then, 95 % to 1.8 %; three of those."""
    found = coverage(noise, name, 1000, (1, 8, 64), 150, 0.0)
    for probability, level in LEVELS:
        allowed = 3 * math.sqrt(probability * (1 - probability) / 150)
        for kind in ("overlapping", "total"):
            np.testing.assert_allclose(found[kind, level], probability, atol=allowed)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["white", "flicker", "walk"])
def test_coverage_within_two_percent(noise, name: str) -> None:
    """2,000 seeds, up to a quarter of the series; their mean is known to half a percent."""
    found = coverage(noise, name, 2000, (1, 4, 16, 64, 125, 250, 333, 500), 2000, 0.0)
    for probability, level in LEVELS:
        for kind in ("overlapping", "total"):
            part = found[kind, level]
            print(f"{name} {kind} {level} %: {np.round(100 * part, 1)}")
            assert part.mean() == pytest.approx(probability, abs=0.02)
            # Each by itself is known to 1 % (68 %) and 0.5 %.
            extra = 2 * math.sqrt(probability * (1 - probability) / 2000)
            np.testing.assert_allclose(part, probability, atol=0.02 + extra)


@pytest.mark.parametrize("share", [1.0, 0.5])
def test_one_window_is_one_chi_squared(share: float) -> None:
    """Two means of all the record: one difference, so one degree of freedom, or what gaps leave of it."""
    expected = [part for _, level in (("", 0.6826894921370859), ("", 0.95)) for part in limits(share, level)]
    found = relative_limits("overlapping", -2, 50, 100, share, share)
    np.testing.assert_allclose(found, expected, rtol=1e-5)


def test_few_windows_are_a_sum_by_experiment() -> None:
    """Three means of white noise: differences of variance 2 and correlation -1/2, by 400,000 draws."""
    draws = np.random.default_rng(1).normal(size=(400_000, 3))
    variance = (np.diff(draws, axis=1) ** 2 / 2).mean(axis=1)
    # At m = 1 each value is a mean, and windows start at each of them.
    low, high = np.quantile(variance, [0.025, 0.975])
    found = relative_limits("overlapping", 0, 1, 3, degrees_of_freedom("overlapping", 0, 1, 3), 1.0)
    np.testing.assert_allclose(found[2:], [high**-0.5, low**-0.5], rtol=0.02)
    assert limits(np.array(1.6), 0.95)[1] > 1.1 * found[3]  # a single chi-squared would be wrong


@pytest.mark.parametrize("lost", [0.001, 0.01, 0.1])
@pytest.mark.parametrize("name", ["white", "flicker", "walk"])
def test_gaps_bias_no_deviation(noise, name: str, lost: float) -> None:
    """200 seeds, by the series without gaps: within 4 standard errors and 0.4 % (windows begin apart).

    What the lost samples would make of white noise is p / (1 - p): 11 % at most.
    """
    size, factors = 1000, (1, 4, 16, 64)
    truth = np.array([noise.allan_variance(name, size, m) for m in factors])
    found = []
    for seed in range(200):
        generator = np.random.default_rng([11, seed])
        whole = noise.make(name, size, generator)
        gapped = lose(whole, lost, generator)
        gap, full = Series(gapped), Series(whole)
        found.append(
            [
                [kind(gap, m).variance - kind(full, m).variance for m in factors]
                for kind in (overlapping, modified, total)
            ]
        )
    differences = np.array(found)
    error = differences.std(axis=0) / math.sqrt(len(found))
    assert np.all(np.abs(differences.mean(axis=0)) < 4 * error + 0.004 * truth)
    assert np.all(4 * error[0, :3] < 0.04 * truth[:3])


def test_a_gap_is_not_where_the_series_ends() -> None:
    """One lost sample of 10,000 changes the deviation by less than the part of windows that it is in."""
    values = np.random.default_rng(3).normal(size=10_000)
    gapped = values.copy()
    gapped[100] = np.nan
    for kind in (overlapping, modified, total):
        for m in (1, 10, 1000):
            assert kind(Series(gapped), m).variance == pytest.approx(
                kind(Series(values), m).variance, rel=0.02
            )


def test_no_gap_and_the_way_of_gaps_agree() -> None:
    """A hole beside the series, which no window of the first half reaches, leaves the estimate as it is."""
    values = np.random.default_rng(4).normal(size=400)
    holed = np.concatenate((values, np.full(400, np.nan)))
    for m in (1, 5, 15):
        assert overlapping(Series(holed), m).variance == pytest.approx(
            overlapping(Series(values), m).variance, rel=1e-10
        )
        assert modified(Series(holed), m).variance == pytest.approx(
            modified(Series(values), m).variance, rel=1e-9
        )


def test_unequal_stamps_find_their_places() -> None:
    """Jitter of a tenth, a clock 50 ppm fast, two lost, one twice: values stay where they belong."""
    generator = np.random.default_rng(1)
    place = np.delete(np.arange(50_000), [100, 30_000])
    time_s = place * 0.01 * (1 + 5e-5) + generator.uniform(-1e-3, 1e-3, place.size)
    time_s, place = np.insert(time_s, 5, time_s[5]), np.insert(place, 5, -1)
    found, interval_s = on_grid(np.round(time_s, 6), place[None].astype(float))
    assert interval_s == pytest.approx(0.01 * (1 + 5e-5), rel=1e-7)
    assert np.flatnonzero(np.isnan(found[0])).tolist() == [100, 30_000]
    there = np.flatnonzero(np.isfinite(found[0]))
    assert np.array_equal(found[0][there[there != 5]], there[there != 5])
    assert found[0][5] == -1  # the first of two


def test_covariance_by_experiment(noise) -> None:
    """White noise and a walk, 1,500 seeds: correlations are known to 2.6 %, variances to 5 % or so."""
    factors, size = (1, 4, 16, 100), 1000
    rows = []
    for seed in range(1500):
        generator = np.random.default_rng([5, seed])
        values = noise.make("white", size, generator) + 0.05 * noise.make("walk", size, generator)
        series = Series(values + 0.0005 * np.arange(size))
        rows.append([overlapping(series, m).variance for m in factors])
    expected = covariance(factors, size, np.array([0.0, 1.0, 0.0, 0.0025 / 3, 0.0005**2 / 2]))
    found = np.cov(np.array(rows).T)
    np.testing.assert_allclose(np.diag(found), np.diag(expected), rtol=0.2)
    spread = np.sqrt(np.outer(np.diag(expected), np.diag(expected)))
    np.testing.assert_allclose(found / spread, expected / spread, atol=0.15)


@pytest.mark.parametrize(("term", "alpha"), [(0, 2), (1, 0), (2, -1), (3, -2)])
def test_covariance_and_freedom_are_of_one_mind(term: int, alpha: int) -> None:
    """Twice the squared variance over its variance is the equivalent number of degrees of freedom."""
    factors, terms = (1, 3, 32, 128, 250), np.zeros(5)
    terms[term] = 1.0
    power = {2: -2, 0: -1, -1: 0, -2: 1}[alpha]
    for m, scatter in zip(factors, np.diag(covariance(factors, 2000, terms)), strict=True):
        expected = degrees_of_freedom("overlapping", alpha, m, 2000)
        assert 2 * float(m) ** (2 * power) / scatter == pytest.approx(expected, rel=0.025)


def coefficients(seeds: range, size: int = 20_000) -> dict[str, np.ndarray]:
    """Pulls of N, B, K: (found - put in) / stated error, of every set of terms that the software fits."""
    truths = {"N": 0.002, "B": 0.02, "K": 0.08}
    pulls: dict[str, list[float]] = {}
    for seed in seeds:
        generator = np.random.Generator(np.random.SFC64(seed))
        sources = [FlickerSource(1.0, generator), WalkSource(1.0, generator)]
        parts = [
            np.concatenate([source.next_block() for _ in range(-(-size // 12288))]) for source in sources
        ]
        values = 3600 * white_sigma(truths["N"], 1.0) * generator.standard_normal(size)
        values = values + truths["B"] * parts[0][:size] + truths["K"] * parts[1][:size]
        for terms in ("QNBKR", "NBK"):
            channel = channel_of("a", values, 1.0, ("overlapping",), (1,), terms, density=False)
            for symbol, truth in truths.items():
                one = channel.coefficient(symbol)
                pulls.setdefault(f"{symbol} of {terms}", []).append((one.value - truth) / one.error)
    return {name: np.array(values) for name, values in pulls.items()}


def test_coefficients_are_recovered() -> None:
    """12 seeds: mean pull within 3 / sqrt(12), none beyond 5."""
    for name, pulls in coefficients(range(12)).items():
        assert abs(pulls.mean()) < 3 / math.sqrt(12), name
        assert np.all(np.abs(pulls) < 5), name


@pytest.mark.slow
def test_pulls_are_standard_normal() -> None:
    """300 seeds, Kolmogorov-Smirnov."""
    from scipy.stats import kstest

    for name, pulls in coefficients(range(300), 86_400).items():
        p = kstest(pulls, "norm").pvalue
        print(f"{name}: mean {pulls.mean():.3f}, sd {pulls.std():.3f}, K-S p {p:.4f}")
        assert p > 0.001, name


def test_density_of_white_noise() -> None:
    """1 deg/h a sample at 10 Hz fills 0 to 5 Hz: 0.2 (deg/h)^2/Hz; with 5 % missing too."""
    generator = np.random.default_rng(2)
    values = lose(generator.normal(size=40_000), 0.05, generator)
    found = fogreduce.allan(values, 10.0, unit="deg/h", factors=(1,), kinds=("overlapping",), terms="")
    one = found["channel1"].spectrum
    sure = one.freedom > 2000
    assert sure.any()
    np.testing.assert_allclose(one.density[sure], 0.2, rtol=0.1)


def test_what_comes_back() -> None:
    generator = np.random.default_rng(0)
    found = fogreduce.allan(generator.normal(size=(2, 4000)), 10.0, unit="deg/h", names=["a", "b"])
    # 1 deg/h a sample at 10 Hz: N = 60 / sqrt(10) deg/h sqrt(s) / 3600 = 0.00527 deg/sqrt(h)
    assert found["a"].coefficient("N").value == pytest.approx(1 / 60 / math.sqrt(10), rel=0.05)
    assert "a: N = 0.005" in repr(found)
    assert len(repr(found).splitlines()) == 3
    dataset = found.to_dataset()
    assert dataset["deviation"].dims == ("channel", "kind", "tau")
    assert dataset["deviation"].sel(channel="b", kind="modified").values[0] == pytest.approx(1, rel=0.05)
    assert len(found.plot().axes) == 2
    with pytest.raises(KeyError, match="there are a, b"):
        found["c"]


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        ({}, "rate_hz or time_s"),
        ({"rate_hz": -1.0}, "positive"),
        ({"time_s": [0.0, 1.0]}, "shape"),
        ({"time_s": [0.0, 2.0, 1.0, 3.0]}, r"time_s\[2\]"),
        ({"rate_hz": 1.0, "names": ["a", "b"]}, "2 names for 1"),
    ],
)
def test_what_is_refused(arguments: dict, says: str) -> None:
    with pytest.raises(ValueError, match=says):
        fogreduce.allan([1.0, 2.0, 3.0, 4.0], **arguments)


@pytest.mark.parametrize("values", [[np.nan] * 20, [1.0], [0.0] * 50])
def test_nothing_to_say_is_no_error(values: list[float]) -> None:
    assert "no coefficient" in repr(fogreduce.allan(values, 1.0))
