"""Effects on the noise: its sizes, its sharing among gyros, and a line in it."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from fogreduce.constants import SECONDS_PER_HOUR
from fogreduce.effects.at import At
from fogreduce.effects.design import Departures
from fogreduce.effects.model import PHASE, Effect, Numbers, Parameter, Parameters, Stage

Array = NDArray[np.float64]


@dataclass(frozen=True)
class NoiseLevels:
    """Noise of one gyro.

    Attributes
    ----------
    white_deg_sqrt_h, flicker_deg_h, walk_deg_h_sqrt_h : float
        N, B and K of the calibration record; N after effects.
    mixing : (n,) array
        Its unit white noise is this combination of the gyros' independent ones; nominally its own alone.
    further_flicker, further_walk : tuples of (float, Generator)
        Processes beside the record's: coefficient and stream.
    """

    white_deg_sqrt_h: float
    flicker_deg_h: float
    walk_deg_h_sqrt_h: float
    mixing: Array
    further_flicker: tuple[tuple[float, np.random.Generator], ...] = ()
    further_walk: tuple[tuple[float, np.random.Generator], ...] = ()


def angle_random_walk(levels: NoiseLevels, p: Numbers, at: At) -> NoiseLevels:
    """N replaced; the stream is the record's own."""
    return replace(levels, white_deg_sqrt_h=p["deg_sqrt_h"])


def bias_instability(levels: NoiseLevels, p: Numbers, at: At) -> NoiseLevels:
    """A further flicker process."""
    if p["deg_h"] == 0.0:
        return levels
    return replace(levels, further_flicker=(*levels.further_flicker, (p["deg_h"], at.place.generator)))


def rate_random_walk(levels: NoiseLevels, p: Numbers, at: At) -> NoiseLevels:
    """A further random walk."""
    if p["deg_h_sqrt_h"] == 0.0:
        return levels
    return replace(levels, further_walk=(*levels.further_walk, (p["deg_h_sqrt_h"], at.place.generator)))


def common_noise(levels: NoiseLevels, p: Numbers, at: At) -> NoiseLevels:
    """Unit white noises correlated pairwise: the symmetric root of their correlation matrix, row i.

    For m gyros ``R = (1 - r) 1 + r J`` has the root ``s 1 + (sqrt(1 + (m - 1) r) - s) / m J``,
    s = sqrt(1 - r); r must lie between -1 / (m - 1) and 1.
    """
    correlation, group = p["correlation"], list(at.place.group)
    weight_of_own = math.sqrt(1.0 - correlation)
    whole = math.sqrt(max(1.0 + (len(group) - 1) * correlation, 0.0))
    mixing = levels.mixing * weight_of_own
    mixing[group] += (whole - weight_of_own) / len(group)
    return replace(levels, mixing=mixing)


def periodic_interference(added: Array, p: Parameters, at: At) -> Array:
    """M_i += A sin(2 pi f t + phi), f as sampled."""
    turn: Array = 2.0 * np.pi * p["frequency_hz"] * at.time_s + at.phase_rad(p["phase_rad"])
    amplitude = float(p["deg_h"]) / SECONDS_PER_HOUR
    return added + amplitude * np.sin(turn)


EFFECTS = (
    Effect(
        "angle_random_walk",
        Stage.NOISE,
        "white noise: N in place of the record's",
        angle_random_walk,
        "IEEE Std 952, annex C; tactical grade in Groves (2013), ch. 4: 0.03 to 0.1 deg/sqrt(h); "
        "quiet units 0.001 to 0.01",
        (Parameter("deg_sqrt_h", "deg/sqrt(h)", "N", low=0.0, high=1e6, realistic=(0.001, 0.1)),),
        {"deg_sqrt_h": 0.01},
        words="has another level of white noise than stated",
        departures=Departures(relative=0.002),
    ),
    Effect(
        "bias_instability",
        Stage.NOISE,
        "a further flicker process, one-sided density B^2 / (pi f) from 1e-5 Hz up",
        bias_instability,
        "IEEE Std 952, annex C; tactical-grade data sheets: 0.05 to 1 deg/h",
        (Parameter("deg_h", "deg/h", "B", off=0.0, low=0.0, high=1e9, realistic=(0.05, 5.0)),),
        {"deg_h": 2.0},
        words="has flicker noise beyond what is stated",
        process=("flicker", "deg_h"),
    ),
    Effect(
        "rate_random_walk",
        Stage.NOISE,
        "a further random walk, K / 60 sqrt(dt) deg/h a step of dt seconds, from 0",
        rate_random_walk,
        "IEEE Std 952, annex C; 0.01 to 5 deg/h/sqrt(h)",
        (
            Parameter(
                "deg_h_sqrt_h", "deg/h/sqrt(h)", "K", off=0.0, low=0.0, high=1e9, realistic=(0.05, 10.0)
            ),
        ),
        {"deg_h_sqrt_h": 10.0},
        words="wanders in a random walk beyond what is stated",
        process=("walk", "deg_h_sqrt_h"),
    ),
    Effect(
        "common_noise",
        Stage.NOISE,
        "the white noises of the gyros named are correlated pairwise; each keeps its N",
        common_noise,
        "a light source shared by the gyros: its intensity noise, Lefevre (2014), ch. 2; x of the paper's "
        "Table 5 is noisier than four independent gyros by as much as 0.3 would make it (y and z are not)",
        (Parameter("correlation", "", "r", off=0.0, low=-1.0, high=1.0, realistic=(0.05, 0.9)),),
        {"correlation": 0.9},
        smallest_group=2,
        words="share a part of their white noise",
    ),
    Effect(
        "periodic_interference",
        Stage.INTERFERENCE,
        "M_i += A sin(2 pi f t + phi), f as sampled, after aliasing",
        periodic_interference,
        "mains, switching supplies and dither pick-up aliased by the sampling: 0.1 to 100 deg/h",
        (
            Parameter("deg_h", "deg/h", "A", off=0.0, realistic=(0.2, 100.0)),
            Parameter("frequency_hz", "Hz", "f", low=0.0, high=1e6, realistic=(0.01, 64.0), words="at"),
            PHASE,
        ),
        {"deg_h": 20.0, "frequency_hz": 0.02, "phase_rad": 0.0},
        words="shows a line: a sine of one frequency",
        departures=Departures(relative=0.02),
    ),
)
