"""Effects that depend on what a gyro reads: scale factor, crosstalk, dead zone. All on M_i [deg/s]."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fogreduce.constants import SECONDS_PER_HOUR
from fogreduce.effects.at import At
from fogreduce.effects.design import Departures, Design
from fogreduce.effects.gyro_names import gyro_index
from fogreduce.effects.model import Effect, Numbers, Parameter, Parameters, Stage

Array = NDArray[np.float64]

#: The rate at which nonlinearity is stated [deg/s].
NONLINEARITY_RATE_DEG_S = 10.0


def temperature_scale_factor(reading: Array, p: Numbers, at: At) -> Array:
    """M_i *= 1 + k (T_sensor(t) - T_sensor(0))."""
    return reading * (1.0 + p["ppm_per_degC"] * 1e-6 * at.warmed_degC)


def scale_factor_error(reading: Array, p: Numbers, at: At) -> Array:
    """M_i *= 1 + e."""
    return reading * (1.0 + p["ppm"] * 1e-6)


def scale_factor_asymmetry(reading: Array, p: Numbers, at: At) -> Array:
    """M_i += e abs(M_i)."""
    return reading + p["ppm"] * 1e-6 * np.abs(reading)


def scale_factor_nonlinearity(reading: Array, p: Numbers, at: At) -> Array:
    """M_i *= 1 + e (M_i / 10 deg/s)^2."""
    return reading * (1.0 + p["ppm_at_10_deg_s"] * 1e-6 * (reading / NONLINEARITY_RATE_DEG_S) ** 2)


def crosstalk(reading: Array, p: Parameters, at: At) -> Array:
    """M_i += c M_j, M_j as it was before any crosstalk."""
    source: Array = at.columns[gyro_index(p["source"])]
    return reading + float(p["ppm"]) * 1e-6 * source


def dead_zone(reading: Array, p: Parameters, at: At) -> Array:
    """M_i = 0 where abs(M_i) < w; outside unchanged (`threshold`) or M_i - w sign(M_i) (`subtractive`)."""
    width = p["deg_h"] / SECONDS_PER_HOUR
    outside = reading if p["kind"] == "threshold" else reading - width * np.sign(reading)
    return np.where(np.abs(reading) < width, 0.0, outside)


def widths(largest_deg_h: float) -> tuple[dict[str, float | str], ...]:
    """Widths of a dead zone, of either kind: far below Earth's rate to the largest reading [deg/h]."""
    least, apart = 0.05, 1.167
    count = 1 + int(np.ceil(np.log(max(largest_deg_h, 2.0 * least) / least) / np.log(apart)))
    sizes = np.geomspace(least, max(largest_deg_h, 2.0 * least), count).tolist()
    return tuple({"deg_h": w, "kind": kind} for kind in ("threshold", "subtractive") for w in sizes)


EFFECTS = (
    Effect(
        "temperature_scale_factor",
        Stage.SCALE,
        "M_i *= 1 + k (T_sensor(t) - T_sensor(0))",
        temperature_scale_factor,
        "source's wavelength and coil's size, Lefevre (2014), ch. 8: 5 to 400 ppm/degC uncompensated",
        (Parameter("ppm_per_degC", "ppm/degC", "k", off=0.0, low=-1e6, high=1e6, realistic=(1, 200)),),
        {"ppm_per_degC": 100.0},
        needs_temperature=True,
        words="has a scale factor that goes with the temperature of its sensor",
        design=Design("ppm_per_degC"),
        unlogged="gain warmth",
        sheet="scale_factor_temperature_ppm_per_degC",
    ),
    Effect(
        "scale_factor_error",
        Stage.SCALE,
        "M_i *= 1 + e",
        scale_factor_error,
        "tactical grade in Titterton & Weston, Strapdown Inertial Navigation Technology (2004), ch. 5: "
        "hundreds of ppm; calibrated on a table: tens",
        (Parameter("ppm", "ppm", "e", off=0.0, low=-1e6, high=1e6, realistic=(10, 1000)),),
        {"ppm": 100.0},
        words="has another scale factor than stated",
        design=Design("ppm", alike=True),
        of_record=True,
        sheet="scale_factor_ppm",
    ),
    Effect(
        "scale_factor_asymmetry",
        Stage.SCALE,
        "M_i += e abs(M_i)",
        scale_factor_asymmetry,
        "IEEE Std 952, scale factor asymmetry: 1 to 100 ppm",
        (Parameter("ppm", "ppm", "e", off=0.0, low=-1e6, high=1e6, realistic=(5, 200)),),
        {"ppm": 100.0},
        words="has one scale factor for turns one way and another for turns the other way",
        design=Design("ppm"),
    ),
    Effect(
        "scale_factor_nonlinearity",
        Stage.SCALE,
        "M_i *= 1 + e (M_i / 10 deg/s)^2",
        scale_factor_nonlinearity,
        "IEEE Std 952, scale factor nonlinearity; data sheets of tactical-grade units: 10 to 1000 ppm",
        (Parameter("ppm_at_10_deg_s", "ppm", "e", off=0.0, low=-1e6, high=1e6, realistic=(5, 500)),),
        {"ppm_at_10_deg_s": 100.0},
        words="has a scale factor that goes with the square of the rate",
        design=Design("ppm_at_10_deg_s"),
        sheet="scale_factor_nonlinearity_ppm",
    ),
    Effect(
        "crosstalk",
        Stage.CROSSTALK,
        "M_i += c M_j",
        crosstalk,
        "shared electronics with 60 to 100 dB of isolation: 10 to 1000 ppm",
        (
            Parameter("ppm", "ppm", "c", off=0.0, low=-1e6, high=1e6, realistic=(20, 1000)),
            Parameter("source", "", "gyro j", kind="gyro"),
        ),
        {"ppm": 300.0, "source": "gyro1"},
        words="picks up a share of what another gyro reads",
        design=Design("ppm"),
    ),
    Effect(
        "dead_zone",
        Stage.DEAD_ZONE,
        "M_i = 0 where abs(M_i) < w; outside unchanged (threshold) or M_i - w sign(M_i) (subtractive)",
        dead_zone,
        "IEEE Std 952, dead band: closed loops with electronic crosstalk lock up below 0.1 to 20 deg/h",
        (
            Parameter("deg_h", "deg/h", "w", off=0.0, low=0.0, realistic=(0.1, 20.0)),
            Parameter(
                "kind", "", "what happens outside", kind="choice", choices=("threshold", "subtractive")
            ),
        ),
        {"deg_h": 40.0, "kind": "threshold"},
        words="reads nothing while the rate is smaller than a threshold",
        design=Design(exact="reading", grid=widths),
        departures=Departures(wanders=False),
    ),
)
