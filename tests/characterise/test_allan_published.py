"""Published numbers: NIST SP 1065's data set, Greenhall and Riley's degrees of freedom; and allantools."""

from __future__ import annotations

import numpy as np
import pytest

import fogreduce
from fogreduce.characterise.allan_freedom import degrees_of_freedom, second_difference_correlation

#: NIST SP 1065, table 31 (1,000 points): averaging time -> deviation.
NIST = {
    "overlapping": (0.2922319, 0.09159953, 0.03241343),
    "modified": (0.2922319, 0.06172376, 0.02170921),
    "total": (0.2922319, 0.09134743, 0.03406530),
}


def nist_set() -> np.ndarray:
    """SP 1065, section 12.4: n -> 16807 n mod 2147483647 from 1234567890."""
    numbers = [1234567890]
    for _ in range(999):
        numbers.append(16807 * numbers[-1] % 2147483647)
    return np.array(numbers) / 2147483647


@pytest.mark.parametrize("kind", list(NIST))
def test_nist_sp_1065(kind: str) -> None:
    result = fogreduce.allan(nist_set(), 1.0, unit="deg/h", factors=(1, 10, 100), terms="")
    np.testing.assert_allclose(result["channel1"].deviations[kind].deviation, NIST[kind], rtol=0.5e-6)


@pytest.mark.parametrize(
    ("m", "expected"), [(1, 782.0), (8, 166.0), (16, 86.4), (32, 43.35), (64, 21.24), (128, 9.55)]
)
def test_published_freedom_of_white_noise(m: int, expected: float) -> None:
    """1001 phase points; the published values are sums cut off after 100 terms."""
    found = degrees_of_freedom("overlapping", 0, m, 1000, filtered=True)
    assert found == pytest.approx(expected, rel=1e-3)


@pytest.mark.parametrize(
    ("alpha", "expected"), [(2, 490.5), (1, 124.7), (0, 43.35), (-1, 34.84), (-2, 27.46)]
)
def test_published_freedom_by_noise(alpha: int, expected: float) -> None:
    found = degrees_of_freedom("overlapping", alpha, 32, 1000, filtered=True)
    assert found == pytest.approx(expected, rel=3e-4)


@pytest.mark.parametrize("alpha", [2, 1, 0, -1, -2])
@pytest.mark.parametrize("m", [2, 8, 33, 100, 200])
@pytest.mark.parametrize("modified", [False, True])
def test_freedom_against_allantools(alpha: int, m: int, modified: bool) -> None:
    """Within 2.5 %, by which its table of flicker of phase and its filter rule at m = 34 to 100 differ."""
    ci = pytest.importorskip("allantools.ci")
    expected = ci.edf_greenhall(alpha, 2, m, 20001, overlapping=True, modified=modified)
    kind = "modified" if modified else "overlapping"
    assert degrees_of_freedom(kind, alpha, m, 20000, filtered=True) == pytest.approx(expected, rel=0.025)


def test_freedom_of_white_samples_by_hand() -> None:
    """m = 1: differences of neighbours correlate by -1/2 at lag 1, so M / (1 + 2/4 (1 - 1/M))."""
    windows = 999
    expected = windows / (1 + 0.5 * (1 - 1 / windows))
    assert degrees_of_freedom("overlapping", 0, 1, 1000) == pytest.approx(expected, rel=1e-12)


def test_correlation_of_second_differences_by_hand() -> None:
    """White: -1/2. Random walk: |t|^3 gives (8 - 32 + 27 + 1 - 2) / 8 = 1/4."""
    assert second_difference_correlation(0) == pytest.approx(-0.5, rel=1e-12)
    assert second_difference_correlation(-2) == pytest.approx(0.25, rel=1e-12)


@pytest.mark.parametrize("kind", ["overlapping", "modified", "total"])
@pytest.mark.parametrize("noise", ["white", "walk"])
def test_deviations_against_allantools(kind: str, noise: str) -> None:
    allantools = pytest.importorskip("allantools")
    values = np.random.default_rng(5).normal(size=3000)
    values = values if noise == "white" else np.cumsum(values)
    factors = (1, 2, 7, 50, 400)
    result = fogreduce.allan(values, 4.0, unit="deg/h", factors=factors, kinds=(kind,), terms="")
    theirs = {"overlapping": allantools.oadev, "modified": allantools.mdev, "total": allantools.totdev}[kind]
    taus, expected, _, _ = theirs(values, rate=4.0, data_type="freq", taus=[m / 4 for m in factors])
    one = result["channel1"].deviations[kind]
    np.testing.assert_allclose(one.tau_s, taus, rtol=1e-12)
    np.testing.assert_allclose(one.deviation, expected, rtol=1e-8)
