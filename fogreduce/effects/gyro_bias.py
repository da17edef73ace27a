"""Effects that add to what a gyro reads, ``M_i += ...`` [deg/s], and the one that tips its axis."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fogreduce.constants import SECONDS_PER_HOUR
from fogreduce.effects.at import At
from fogreduce.effects.design import Design
from fogreduce.effects.model import Effect, Numbers, Parameter, Parameters, Stage

Array = NDArray[np.float64]

_TACTICAL = (
    "tactical grade: 1 to 100 deg/h in Groves, Principles of GNSS, Inertial, and Multisensor Integrated "
    "Navigation Systems (2013), ch. 4; fibre-optic units calibrated on a table: tenths"
)
_SHUPE = (
    "Shupe (1980); Lefevre, The Fiber-Optic Gyroscope (2014), ch. 6: 0.01 to 1 deg/h per degC/min with "
    "quadrupolar winding, ten times that without"
)


def bias_offset(reading: Array, p: Numbers, at: At) -> Array:
    """M_i += value."""
    return reading + p["deg_h"] / SECONDS_PER_HOUR


def bias_ramp(reading: Array, p: Numbers, at: At) -> Array:
    """M_i += value t, t in hours."""
    return reading + p["deg_h_per_h"] / SECONDS_PER_HOUR * (at.time_s / SECONDS_PER_HOUR)


def bias_step(reading: Array, p: Numbers, at: At) -> Array:
    """M_i += value from `time_s` on, that instant included."""
    return reading + p["deg_h"] / SECONDS_PER_HOUR * (at.time_s >= p["time_s"])


def warm_up(reading: Array, p: Numbers, at: At) -> Array:
    """M_i += A exp(-t / tau)."""
    return reading + p["deg_h"] / SECONDS_PER_HOUR * np.exp(-at.time_s / p["tau_s"])


def temperature_bias(reading: Array, p: Numbers, at: At) -> Array:
    """M_i += k (T_sensor(t) - T_sensor(0))."""
    return reading + p["deg_h_per_degC"] / SECONDS_PER_HOUR * at.warmed_degC


def temperature_rate_bias(reading: Array, p: Numbers, at: At) -> Array:
    """M_i += k dT_sensor/dt."""
    return reading + p["deg_h_per_degC_per_min"] / SECONDS_PER_HOUR * at.warming_degC_per_min


def acceleration_bias(reading: Array, p: Numbers, at: At) -> Array:
    """M_i += k (G_i . up), in g: on a table that does not accelerate, the specific force is 1 g upward."""
    up = at.motion.seen(np.array([0.0, 0.0, 1.0]), at.alpha_rad)
    return reading + p["deg_h_per_g"] / SECONDS_PER_HOUR * (at.axis @ up)


def magnetic_bias(reading: Array, p: Parameters, at: At) -> Array:
    """M_i += k (G_i . R u0 F), F of length 1."""
    field = np.array(p["field_direction"])
    seen = at.motion.seen(field / np.linalg.norm(field), at.alpha_rad)
    size = float(p["deg_h"]) / SECONDS_PER_HOUR
    return reading + size * (at.axis @ seen)


def axis_misalignment(axis: Array, p: Parameters, at: At) -> Array:
    """G_i += delta; what of delta lies along G_i is removed."""
    delta = np.array(p["mrad"]) * 1e-3
    along = axis / np.linalg.norm(axis)
    return axis + (delta - along * (along @ delta))


_TIME_CONSTANTS = 12


def time_constants(longest_s: float) -> tuple[dict[str, float], ...]:
    """From what the blocks of a run still show to what it hardly tells from a straight line."""
    return tuple(
        {"tau_s": t} for t in np.geomspace(longest_s / 60.0, 2.0 * longest_s, _TIME_CONSTANTS).tolist()
    )


EFFECTS = (
    Effect(
        "bias_offset",
        Stage.BIAS,
        "M_i += value, in every run",
        bias_offset,
        _TACTICAL,
        (Parameter("deg_h", "deg/h", "value", off=0.0, realistic=(0.1, 20.0)),),
        {"deg_h": 2.0},
        words="reads off by a constant, the same in every run",
        design=Design("deg_h", alike=True),
        of_record=True,
        sheet="bias_repeatability_deg_h",
    ),
    Effect(
        "turn_on_bias",
        Stage.BIAS,
        "M_i += value, in one run, beyond the stated uncertainty",
        bias_offset,
        "turn-on to turn-on repeatability of tactical-grade units' data sheets: 0.1 to 10 deg/h",
        (Parameter("deg_h", "deg/h", "value", off=0.0, realistic=(0.1, 10.0)),),
        {"deg_h": 2.0},
        words="reads off by a constant in one run alone, more than the record allows from one "
        "switching on to the next",
        design=Design("deg_h", one_run=True),
        drifts=True,
        sheet="bias_repeatability_deg_h",
    ),
    Effect(
        "bias_ramp",
        Stage.BIAS,
        "M_i += value t, t in hours since the run's start",
        bias_ramp,
        "rate ramp of IEEE Std 952, annex C; the slopes e of the paper's Table 4 are 0.1 to 3 deg/h/h",
        (Parameter("deg_h_per_h", "deg/h/h", "value", off=0.0, realistic=(0.05, 5.0)),),
        {"deg_h_per_h": 20.0},
        words="drifts in a straight line from each run's start",
        design=Design("deg_h_per_h", 10.0),
        drifts=True,
    ),
    Effect(
        "bias_step",
        Stage.BIAS,
        "M_i += value for t >= time_s, in one run",
        bias_step,
        "hops of a source's mode or of a loop's lock, of the size of a turn-on bias",
        (
            Parameter("deg_h", "deg/h", "value", off=0.0, realistic=(0.1, 10.0)),
            Parameter(
                "time_s", "s", "when", low=-1e9, high=1e9, realistic=(0.0, 6000.0), words="at", bends=0.0
            ),
        ),
        {"deg_h": 2.0, "time_s": 120.0},
        words="jumps once in one run and stays there",
        design=Design("deg_h", one_run=True, begins="time_s"),
        drifts=True,
        sheet="bias_repeatability_deg_h",
    ),
    Effect(
        "warm_up",
        Stage.BIAS,
        "M_i += A exp(-t / tau), in every run",
        warm_up,
        "IEEE Std 952, warm-up time; data sheets of tactical-grade units: minutes to an hour to settle",
        (
            Parameter("deg_h", "deg/h", "A", off=0.0, realistic=(0.2, 20.0)),
            Parameter(
                "tau_s",
                "s",
                "tau",
                low=1e-6,
                high=1e9,
                realistic=(30.0, 3000.0),
                words="time constant",
                bends=1e-3,
            ),
        ),
        {"deg_h": 3.0, "tau_s": 60.0},
        words="settles exponentially after each run's start",
        design=Design("deg_h", grid=time_constants, shown={"tau_s": (1 / 3, 2 / 3)}),
        drifts=True,
    ),
    Effect(
        "temperature_bias",
        Stage.BIAS,
        "M_i += k (T_sensor(t) - T_sensor(0))",
        temperature_bias,
        "IEEE Std 952, bias temperature sensitivity; data sheets: 0.02 to 2 deg/h/degC uncompensated",
        (Parameter("deg_h_per_degC", "deg/h/degC", "k", off=0.0, realistic=(0.02, 2.0)),),
        {"deg_h_per_degC": 2.0},
        needs_temperature=True,
        words="reads off in proportion to how far its sensor has warmed",
        design=Design("deg_h_per_degC"),
        drifts=True,
        unlogged="warmth",
        sheet="bias_temperature_deg_h_per_degC",
    ),
    Effect(
        "temperature_rate_bias",
        Stage.BIAS,
        "M_i += k dT_sensor/dt, the slope of a straight line over the 20 s around t",
        temperature_rate_bias,
        _SHUPE,
        (Parameter("deg_h_per_degC_per_min", "deg/h/(degC/min)", "k", off=0.0, realistic=(0.05, 10.0)),),
        {"deg_h_per_degC_per_min": 10.0},
        needs_temperature=True,
        words="reads off in proportion to how fast its sensor warms (Shupe effect)",
        design=Design("deg_h_per_degC_per_min"),
        drifts=True,
        unlogged="warming",
        sheet="bias_temperature_rate_deg_h_per_degC_per_min",
    ),
    Effect(
        "acceleration_bias",
        Stage.BIAS,
        "M_i += k (G_i . up)",
        acceleration_bias,
        "IEEE Std 952, acceleration-sensitive drift: small in a fibre-optic gyro, up to 1 deg/h/g",
        (Parameter("deg_h_per_g", "deg/h/g", "k", off=0.0, realistic=(0.01, 1.0)),),
        {"deg_h_per_g": 2.0},
        words="reads off in proportion to gravity along its axis",
        design=Design("deg_h_per_g"),
        sheet="acceleration_deg_h_per_g",
    ),
    Effect(
        "magnetic_bias",
        Stage.BIAS,
        "M_i += k (G_i . R u0 F), F a direction fixed in the room",
        magnetic_bias,
        "Faraday effect in depolarised coils, Lefevre (2014), ch. 7: 0.1 to 10 deg/h per gauss unshielded, "
        "in Earth's field of 0.25 to 0.65 gauss",
        (
            Parameter("deg_h", "deg/h", "k", off=0.0, realistic=(0.05, 5.0)),
            Parameter(
                "field_direction",
                "",
                "F, east, north, up; normalised",
                kind="vector",
                words="toward",
                frame="room",
            ),
        ),
        {"deg_h": 2.0, "field_direction": (0.0, 0.8, 0.6)},
        words="reads off in proportion to a magnetic field along its axis, a field fixed in the room",
        design=Design("deg_h", vector="room", along="field_direction"),
    ),
)

AXIS_EFFECTS = (
    Effect(
        "axis_misalignment",
        Stage.AXES,
        "G_i += delta, delta at right angles to G_i",
        axis_misalignment,
        "input-axis misalignment of IEEE Std 952; 0.1 to 3 mrad as mounted, some 0.02 mrad calibrated",
        (
            Parameter(
                "mrad",
                "mrad",
                "delta, along x, y, z of the unit; a part along the axis is removed",
                off=(0.0, 0.0, 0.0),
                low=-1e3,
                high=1e3,
                realistic=(0.05, 3.0),
                kind="vector",
                frame="unit",
            ),
        ),
        {"mrad": (1.0, 0.0, 0.5)},
        words="has its input axis tipped",
        design=Design("mrad", 0.1, vector="across"),
        of_record=True,
        sheet="misalignment_mrad",
    ),
)
