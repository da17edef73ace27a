"""Effects of time: the clock that stamps the records, and a gyro that answers late."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fogreduce.effects.at import At
from fogreduce.effects.design import Departures, Design
from fogreduce.effects.model import Effect, Numbers, Parameter, Stage

Array = NDArray[np.float64]


def clock_error(shown_s: Array, p: Numbers, at: At) -> Array:
    """A sample taken at true time t is stamped t / (1 + e)."""
    return shown_s / (1.0 + p["ppm"] * 1e-6)


def latency(age_s: float, p: Numbers, at: At) -> float:
    """The gyro's answer is this much older; before t = 0 it reads what it reads at t = 0."""
    return age_s + float(p["ms"]) * 1e-3


EFFECTS = (
    Effect(
        "clock_error",
        Stage.STAMPS,
        "a sample taken at true time t is stamped t / (1 + e); pulses keep true time",
        clock_error,
        "crystals: 1 to 100 ppm; an operating system's clock without discipline: up to 500 ppm",
        (Parameter("ppm", "ppm", "e", off=0.0, low=-9e5, high=1e6, realistic=(5, 500)),),
        {"ppm": 100.0},
        channels="clock",
        words="runs fast or slow",
        departures=Departures(wanders=False),
    ),
    Effect(
        "latency",
        Stage.LATENCY,
        "gyro i's answer is this much old",
        latency,
        "digital filters and serial links of tactical-grade units: 0.5 to 20 ms; queues in software: 1 s",
        (Parameter("ms", "ms", "age", off=0.0, low=0.0, high=1e9, realistic=(0.5, 1000.0)),),
        {"ms": 500.0},
        words="answers with readings that are already old",
        design=Design("ms", 10.0, positive=True, least_deg_h=1e-9),
        departures=Departures(wanders=False),
    ),
)
