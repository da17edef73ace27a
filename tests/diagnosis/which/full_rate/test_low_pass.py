"""A filter is named with its time constant, whatever stands between the noise's samples and it."""

from __future__ import annotations

import numpy as np
import pytest

from fogreduce.diagnosis.which.full_rate.pieces import filter_gains
from fogreduce.diagnosis.which.full_rate.spectrum import Levels, level_findings
from fogreduce.effects.table import EFFECTS

RATE, PIECES = 128.0, 400
FREQUENCY = np.fft.rfftfreq(256)[4:-1]
KINDS = {"straight between samples": 0, "sample by sample": 1, "continuous": 2}


def levels(tau_ms: float, kind: int, seed: int) -> Levels:
    """Averaged spectra of filtered white noise of the record's level, as chance makes them."""
    count = len(FREQUENCY)
    gain = filter_gains(np.array([tau_ms]), RATE, FREQUENCY)[kind, 0]
    ratio = gain * np.random.default_rng(seed).gamma(PIECES, 1.0 / PIECES, count)
    one = np.ones((1, count))
    return Levels(
        ratio=ratio[None],
        pieces=PIECES * one,
        frequency=FREQUENCY,
        keep=one > 0.0,
        correlation=np.eye(1),
        dof=float(PIECES * count),
        stated=np.array([2e-3]),
        rate_hz=np.full(count, RATE),
        expected=one,
        rounding=0.0 * one,
        drift=0.0 * one,
    )


#: Below half a sample a filter leaves one correlation, of neighbours: 3 ms taken sample by sample is nearly
#: 0.54 ms of the catalogue's own kind. The error holds the difference.
CASES = [
    *((kind, tau) for kind in KINDS for tau in (1e3 / RATE / -np.log(0.3), 30.0, 90.0)),  # q = 0.3: 6.49 ms
    *((kind, 3.0) for kind in KINDS),
]


@pytest.mark.parametrize(("kind", "tau_ms"), CASES)
def test_its_time_constant_lies_within_its_error(kind: str, tau_ms: float) -> None:
    pulls = []
    for seed in range(5):
        lv = levels(tau_ms, KINDS[kind], seed)
        found = level_findings(lv, 0, frozenset(EFFECTS), np.ones(len(FREQUENCY)), False)
        best = max(found, key=lambda f: f.log_b)
        assert best.effect == "low_pass"
        value, std = best.parameters["time_constant_ms"]
        pulls.append((value - tau_ms) / std)
        # beside it there is nothing of another level, and no unknown colour
        rest = frozenset(EFFECTS) - {"low_pass"}
        left = level_findings(lv, 0, rest, lv.low_passed(value, 0), False, filtered=True)
        assert max(f.log_b for f in left) < 3.0
    assert np.max(np.abs(pulls)) < 4.0  # once in 16000
