"""Effects of the electronics: on raw readings, and on the bits of a count."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fogreduce.effects.at import At
from fogreduce.effects.design import Departures, Design
from fogreduce.effects.model import Effect, Numbers, Parameter, Parameters, Stage
from fogreduce.physics.low_pass import of_samples

Array = NDArray[np.float64]
Counts = NDArray[np.int32]


def low_pass(volts: Array, p: Numbers, at: At) -> Array:
    """First-order filter ``tau y' = v - y``, exact for v straight between samples; settled at t = 0."""
    tau = p["time_constant_ms"] * 1e-3
    if tau == 0.0:
        return volts
    state = at.place.state
    filtered = of_samples(volts, at.step_s, tau, state.get("low_pass"))
    state["low_pass"] = (filtered[-1], volts[-1])
    return filtered


def adc_nonlinearity(volts: Array, p: Numbers, at: At) -> Array:
    """v_i += A sin(2 pi v_i / p)."""
    return volts + p["volts"] * np.sin(2.0 * np.pi / p["period_volts"] * volts)


def saturation(volts: Array, p: Numbers, at: At) -> Array:
    """v_i clipped to +-value."""
    return np.clip(volts, -p["volts"], p["volts"])


def lost_bits(counts: Counts, p: Parameters, at: At) -> Counts:
    """Count & ~(2^m - 1): rounded down to a multiple of 2^m; "no answer" is such a multiple already."""
    return counts & np.int32(-(1 << p["bits"]))


def shares_of_range(longest_s: float) -> tuple[dict[str, float], ...]:
    """Limits, as shares of the largest reading."""
    return tuple({"volts": share} for share in np.linspace(0.5, 0.98, 9).tolist())


def periods_of_range(longest_s: float) -> tuple[dict[str, float], ...]:
    """Periods, as shares of the largest raw reading, a 16th of a turn apart there: an integral nonlinearity
    bends a few times over the range. Finer ones the codes within the noise show.
    """
    return tuple({"period_volts": 16.0 / part} for part in range(4, 513))


EFFECTS = (
    Effect(
        "low_pass",
        Stage.FILTER,
        "tau y' = v_i - y before sampling",
        low_pass,
        "data sheets of tactical-grade units: 20 to 500 Hz, so 0.3 to 8 ms; deliberate filters: 100 ms",
        (Parameter("time_constant_ms", "ms", "tau", off=0.0, low=0.0, high=1e9, realistic=(0.3, 100.0)),),
        {"time_constant_ms": 100.0},
        words="is smoothed by a filter that the metadata do not state",
        design=Design("time_constant_ms", 10.0, positive=True, like=("latency", "ms"), least_deg_h=1e-9),
        departures=Departures(wanders=False, relative=0.06),
        sheet="bandwidth_hz",
    ),
    Effect(
        "adc_nonlinearity",
        Stage.CONVERTER,
        "v_i += A sin(2 pi v_i / p)",
        adc_nonlinearity,
        "data sheets of 16 to 24 bit converters: integral nonlinearity 1 to 50 ppm of full scale",
        (
            Parameter("volts", "V", "A", off=0.0, low=-1e6, high=1e6, realistic=(1e-7, 1e-4)),
            Parameter(
                "period_volts",
                "V",
                "p",
                low=1e-12,
                high=1e9,
                realistic=(1e-4, 5.0),
                words="period",
                bends=1e-4,
            ),
        ),
        {"volts": 2e-5, "period_volts": 5e-3},
        words="is read by a converter whose steps are uneven, with a period in volts",
        design=Design("volts", 1e-6, exact="volts", grid=periods_of_range, turning=True),
    ),
    Effect(
        "saturation",
        Stage.CLIPPING,
        "v_i clipped to +-value",
        saturation,
        "a converter's range: 1.25, 2.5, 5 or 10 V; a unit's rate range of 100 to 500 deg/s",
        (Parameter("volts", "V", "value", off=1e12, low=0.0, realistic=(0.05, 10.0), bends=1e-5),),
        {"volts": 0.2},
        words="is clipped at the end of its range",
        design=Design(exact="range", grid=shares_of_range),
        departures=Departures(knee=0.006),
    ),
    Effect(
        "lost_bits",
        Stage.BITS,
        "count & ~(2^m - 1)",
        lost_bits,
        "converters with fewer true bits than the word: 1 to 8 bits",
        (Parameter("bits", "", "m", off=0, low=0, high=31, realistic=(1, 12), kind="integer"),),
        {"bits": 11},
        words="is read with fewer true bits than the count has",
    ),
)
