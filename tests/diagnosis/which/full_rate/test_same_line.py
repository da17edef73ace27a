"""Lines of runs of two sample rates: those of one frequency, gyro and size are one, others are others."""

from __future__ import annotations

import numpy as np
import pytest

from fogreduce.diagnosis.which.full_rate.line import Line
from fogreduce.diagnosis.which.full_rate.same_line import once_each


def line(runs: tuple[str, ...], hz: float = 9.0, deg_h: float = 1.0, channel: str = "gyro1") -> Line:
    return Line((channel,), runs, hz, 1e-3, deg_h, 0.1, None, 20.0, 30.0, 0.125, 2, True)


def test_what_differs_stays_apart() -> None:
    first, runs = line(("r1",)), ("r1", "r2", "r3")
    others = [line(("r2",), hz=9.1), line(("r2",), deg_h=2.0), line(("r2",), channel="gyro2"), line(("r1",))]
    for other in others:
        assert len(once_each([first, other], runs)) == 2
    (both,) = once_each([first, line(("r2",), hz=9.002, deg_h=1.2)], runs)
    assert both.runs == ("r1", "r2")
    assert both.hz == pytest.approx(9.001)
    assert both.deg_h == pytest.approx(1.1)
    assert both.std == pytest.approx(0.1 / np.sqrt(2.0))
    assert both.log_b == 40.0
