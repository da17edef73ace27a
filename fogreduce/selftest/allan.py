"""NIST SP 1065's data set, and the degrees of freedom that Greenhall and Riley publish."""

from __future__ import annotations

import numpy as np

from fogreduce.characterise.allan import allan
from fogreduce.characterise.allan_freedom import degrees_of_freedom
from fogreduce.estimate.allan_variance import Series, overlapping
from fogreduce.selftest.check import Check, printed

_NIST = "NIST SP 1065, section 12.4, 1,000 points"
_FACTORS = (1, 10, 100)
_DEVIATIONS = {
    "overlapping": ("0.2922319", "0.09159953", "0.03241343"),
    "modified": ("0.2922319", "0.06172376", "0.02170921"),
    "total": ("0.2922319", "0.09134743", "0.03406530"),
}
_PLAIN = ("0.2922319", "0.09965736", "0.03897804")
_RILEY = "Greenhall and Riley 2003, 1,001 phase points, overlapping"
_WHITE = {1: 782.0, 8: 166.0, 16: 86.4, 32: 43.35, 64: 21.24, 128: 9.55}
_BY_ALPHA = {2: 490.5, 1: 124.7, 0: 43.35, -1: 34.84, -2: 27.46}
_CUT_OFF = 1e-3  # the published sums are cut off after 100 terms or approximated


def nist_set() -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    """The 1,000 points: ``n -> 16807 n mod 2147483647`` from 1234567890, over 2147483647."""
    numbers = [1234567890]
    for _ in range(999):
        numbers.append(16807 * numbers[-1] % 2147483647)
    return np.array(numbers) / 2147483647


def nist() -> list[Check]:
    """Allan deviations of the set."""
    values = nist_set()
    found = allan(values, 1.0, unit="deg/h", factors=_FACTORS, terms="")["channel1"]
    checks = []
    for m, text in zip(_FACTORS, _PLAIN, strict=True):
        # Without overlap: means of m, then neighbours.
        means = values[: values.size // m * m].reshape(-1, m).mean(axis=1)
        deviation = overlapping(Series(means), 1).variance ** 0.5
        checks.append(printed("Allan deviation", f"not overlapping, tau {m}", _NIST, text, deviation))
    for kind, texts in _DEVIATIONS.items():
        one = next(each for name, each in found.deviations.items() if name == kind)
        for m, text, deviation in zip(_FACTORS, texts, one.deviation.tolist(), strict=True):
            checks.append(printed("Allan deviation", f"{kind}, tau {m}", _NIST, text, deviation))
    return checks


def freedom() -> list[Check]:
    """Equivalent degrees of freedom."""
    wanted = [(0, m, value) for m, value in _WHITE.items()]
    wanted += [(alpha, 32, value) for alpha, value in _BY_ALPHA.items() if alpha != 0]
    return [
        Check(
            "Degrees of freedom",
            f"alpha {alpha:+d}, m {m}",
            _RILEY,
            value,
            degrees_of_freedom("overlapping", alpha, m, 1000, filtered=True),
            _CUT_OFF * value,
            "0.1 %: the published sums are cut off",
        )
        for alpha, m, value in wanted
    ]
