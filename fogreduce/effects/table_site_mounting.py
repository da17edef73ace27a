"""Effects of the table, the site and the mounting: they change the true motion."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from fogreduce.effects.at import At
from fogreduce.effects.design import Departures, Design
from fogreduce.effects.model import PHASE, Effect, Numbers, Parameter, Parameters, Stage
from fogreduce.effects.motion import Motion, Ripple, Vibration
from fogreduce.physics.frames import rotation

Array = NDArray[np.float64]
_UP = np.array([0.0, 0.0, 1.0])


def table_rate_error(motion: Motion, p: Numbers, at: At) -> Motion:
    """True rate = commanded (1 + e)."""
    return replace(motion, gain=motion.gain * (1.0 + p["ppm"] * 1e-6))


def table_rate_ripple(motion: Motion, p: Parameters, at: At) -> Motion:
    """True rate = commanded (1 + A cos(n alpha + phi)), alpha the commanded angle."""
    if p["ppm"] == 0.0:
        return motion
    ripple = Ripple(p["ppm"] * 1e-6, p["harmonic"], at.phase_rad(p["phase_rad"]))
    return replace(motion, ripples=(*motion.ripples, ripple))


def heading_error(motion: Motion, p: Numbers, at: At) -> Motion:
    """True azimuth = stated + value, clockwise from above: before u0 the room turns the other way."""
    turned = rotation(_UP, np.radians(p["deg"]))
    return replace(motion, unit_from_enu=motion.unit_from_enu @ turned)


def latitude_error(motion: Motion, p: Numbers, at: At) -> Motion:
    """True latitude = stated + value."""
    return replace(motion, latitude_deg=motion.latitude_deg + p["deg"])


def rotation_sense(motion: Motion, p: Parameters, at: At) -> Motion:
    """True rate = -commanded."""
    return replace(motion, gain=-motion.gain)


def start_offset(motion: Motion, p: Numbers, at: At) -> Motion:
    """The table's profile begins this much later than the capture."""
    return replace(motion, start_s=motion.start_s + p["s"])


def mount_rotation(motion: Motion, p: Parameters, at: At) -> Motion:
    """W -> w - theta x w."""
    if not any(p["mrad"]):
        return motion
    return replace(motion, tilts_rad=(*motion.tilts_rad, np.array(p["mrad"]) * 1e-3))


def base_motion(motion: Motion, p: Parameters, at: At) -> Motion:
    """W += A sin(2 pi f t + phi) u."""
    if p["deg_h"] == 0.0:
        return motion
    axis = np.array(p["axis"])
    axis = axis / np.linalg.norm(axis)
    vibration = Vibration(p["deg_h"] / 3600.0, p["frequency_hz"], at.phase_rad(p["phase_rad"]), axis)
    return replace(motion, vibrations=(*motion.vibrations, vibration))


#: Delays at which a late start is looked for [s]; of each, its negative too.
_DELAYS_S = (0.02, 0.05, 0.15, 0.4, 1.0, 2.0, 3.0, -0.02, -0.05, -0.15, -0.4, -1.0, -2.0, -3.0)


#: Errors of heading at which one is looked for [deg]: what it changes points along half of it, so that nine
#: tenths of its square lie along the nearest's. Nearly all are a few degrees.
_HEADINGS_DEG = (0.01, 60.0, 120.0, 180.0, -120.0, -60.0)
_FAR_OFF = 0.002  # each


def harmonics(longest_s: float) -> tuple[dict[str, int], ...]:
    """Waves of a turn: an encoder's eccentricity, poles and teeth."""
    return tuple({"harmonic": n} for n in (1, 2, 3, 4, 5, 6, 8, 9, 10, 12, 18, 24, 36))


EFFECTS = (
    Effect(
        "table_rate_error",
        Stage.MOTION,
        "rate(t) = commanded (1 + e)",
        table_rate_error,
        "data sheets of precision rate tables: rate accuracy 0.001 to 0.01 % over a turn",
        (Parameter("ppm", "ppm", "e", off=0.0, low=-1e6, high=1e6, realistic=(5, 100)),),
        {"ppm": 100.0},
        channels="table",
        words="turns faster or slower than commanded by a fixed share",
        design=Design("ppm"),
    ),
    Effect(
        "table_rate_ripple",
        Stage.MOTION,
        "rate(t) = commanded (1 + A cos(n alpha + phi)), alpha the commanded angle",
        table_rate_ripple,
        "data sheets of precision rate tables: rate stability 0.01 to 0.1 % over 1 to 10 degrees; "
        "harmonics of the encoder's eccentricity (1, 2) and of the motor's poles",
        (
            Parameter("ppm", "ppm", "A", off=0.0, low=-1e6, high=1e6, realistic=(20, 1000)),
            Parameter(
                "harmonic",
                "",
                "n",
                low=1,
                high=100_000,
                realistic=(1, 36),
                kind="integer",
                words="harmonic",
            ),
            PHASE,
        ),
        {"ppm": 200.0, "harmonic": 2, "phase_rad": 0.5},
        channels="table",
        words="turns unevenly, with a wave that returns with its angle",
        design=Design(
            "ppm", grid=harmonics, wave="phase_rad", turning=True, shown={"harmonic": (1, 2, 4, 12)}
        ),
    ),
    Effect(
        "heading_error",
        Stage.MOTION,
        "azimuth = stated + value, clockwise seen from above",
        heading_error,
        "transfer of north to a table by theodolite: 0.01 to 0.5 degrees",
        (Parameter("deg", "deg", "value", off=0.0, low=-360.0, high=360.0, realistic=(0.1, 2.0)),),
        {"deg": 1.0},
        channels="table",
        words="points another way than stated: the azimuth is off",
        design=Design("deg", steps=_HEADINGS_DEG, rarer=_FAR_OFF, shown={"deg": (0.01,)}),
    ),
    Effect(
        "latitude_error",
        Stage.MOTION,
        "latitude = stated + value",
        latitude_error,
        "a laboratory's coordinates: arc minutes when taken from a map, degrees when mistyped",
        (Parameter("deg", "deg", "value", off=0.0, low=-180.0, high=180.0, realistic=(0.02, 1.0)),),
        {"deg": 0.5},
        channels="table",
        words="stands at another latitude than stated",
        design=Design("deg", 0.01),
    ),
    Effect(
        "rotation_sense",
        Stage.MOTION,
        "rate(t) = -commanded",
        rotation_sense,
        "a mistake of wiring or of bookkeeping: there or not",
        (),
        {},
        channels="table",
        words="turns the other way than commanded",
        design=Design(exact="switch", turning=True),
        departures=Departures(wanders=False),
    ),
    Effect(
        "start_offset",
        Stage.MOTION,
        "the profile begins `s` later than the capture",
        start_offset,
        "two computers started by hand or by a trigger over a network: 10 ms to some seconds",
        (Parameter("s", "s", "delay", off=0.0, low=-1e6, high=1e6, realistic=(0.01, 5.0), bends=1e-3),),
        {"s": 2.0},
        channels="table",
        words="begins its profile later than the capture begins",
        design=Design("s", steps=_DELAYS_S, turning=True, shown={"s": (0.15,)}),
        departures=Departures(wanders=False),
    ),
    Effect(
        "mount_rotation",
        Stage.MOTION,
        "w -> w - theta x w",
        mount_rotation,
        "a unit bolted to a fixture without dowels: 0.1 to 3 mrad",
        (
            Parameter(
                "mrad",
                "mrad",
                "theta, about x, y, z of the unit",
                off=(0.0, 0.0, 0.0),
                low=-1e3,
                high=1e3,
                realistic=(0.1, 3.0),
                kind="vector",
                frame="unit",
            ),
        ),
        {"mrad": (0.0, 1.0, 0.0)},
        channels="table",
        words="holds the unit turned by a small angle",
        design=Design("mrad", 0.1, vector="unit"),
    ),
    Effect(
        "base_motion",
        Stage.MOTION,
        "w += A sin(2 pi f t + phi) u, f the true frequency",
        base_motion,
        "angular vibration of a laboratory's floor, 0.1 to 30 Hz; machinery at 25 to 30 Hz",
        (
            Parameter("deg_h", "deg/h", "A", off=0.0, realistic=(0.5, 50.0)),
            Parameter("frequency_hz", "Hz", "f", low=0.0, high=1e6, realistic=(0.1, 60.0), words="at"),
            Parameter(
                "axis", "", "u, a direction in the unit frame", kind="vector", words="about", frame="unit"
            ),
            PHASE,
        ),
        {"deg_h": 20.0, "frequency_hz": 0.02, "axis": (1.0, 0.0, 0.0), "phase_rad": 0.0},
        channels="table",
        words="is shaken by an angular vibration of the floor",
        departures=Departures(relative=0.03),
    ),
)
