"""Effects that never were in the catalogue.

A diagnoser has no name for any of these; what it should say is that something is left, and where.  All but
band-limited noise are functions like those of `withheld.effects.gyro`: what is added to one gyro's reading
[deg/s] (k,).  Where `seed` is a parameter, `in_run` turns it into random times, afresh in each run.
"""

from dataclasses import replace

import numpy as np

from withheld.arrays import Array
from withheld.effects.entry import Entry
from withheld.effects.gyro import Scene, Shape
from withheld.streams import stream


def in_run(entry: Entry, run_id: str) -> Entry:
    """The entry with its seed turned into random times for one run (parameter `times_s`)."""
    if "seed" not in entry.parameters:
        return entry
    rng = stream(int(entry.parameters["seed"]), "stranger", entry.effect, run_id)
    gaps = rng.exponential(entry.number("mean_s"), 4000)
    times = np.cumsum(gaps) - gaps[0] * rng.random()
    return replace(entry, parameters={**entry.parameters, "times_s": times})


def _high(t: Array, times: Array) -> Array:
    """+1/2 or -1/2, turning over at each of `times`."""
    turned: Array = 0.5 - (np.searchsorted(times, t, side="right") % 2).astype(float)
    return turned


def telegraph_bias(scene: Scene, i: int, m: Array, e: Entry) -> Array:
    """A bias that jumps between two values at random times, `mean_s` apart."""
    return e.number("deg_h") / 3600.0 * _high(scene.t, e.parameters["times_s"])


def gain_switching(scene: Scene, i: int, m: Array, e: Entry) -> Array:
    """A scale factor that jumps between two values at random times."""
    return m * (e.number("ppm") * 1e-6) * _high(scene.t, e.parameters["times_s"])


def glitch_train(scene: Scene, i: int, m: Array, e: Entry) -> Array:
    """At random times a glitch that dies away over `decay_s`."""
    times = e.parameters["times_s"]
    last = np.searchsorted(times, scene.t, side="right")
    since = scene.t - times[np.maximum(last - 1, 0)]
    return e.number("deg_h") / 3600.0 * np.where(last > 0, np.exp(-since / e.number("decay_s")), 0.0)


def sawtooth_bias(scene: Scene, i: int, m: Array, e: Entry) -> Array:
    """A bias that creeps up and falls back, every `period_s`."""
    return e.number("deg_h") / 3600.0 * ((scene.t / e.number("period_s")) % 1.0 - 0.5)


def rate_squared(scene: Scene, i: int, m: Array, e: Entry) -> Array:
    """Response to the square of the rate, stated at 10 deg/s."""
    return e.number("deg_h_at_10_deg_s") / 3600.0 * (m / 10.0) ** 2


def third_harmonic(scene: Scene, i: int, m: Array, e: Entry) -> Array:
    """A bias with the third harmonic of the table's angle."""
    return e.number("deg_h") / 3600.0 * np.cos(3.0 * scene.motion.alpha_rad + e.number("phase_rad"))


def temperature_squared(scene: Scene, i: int, m: Array, e: Entry) -> Array:
    """Bias with the square of the temperature's departure from its start."""
    return e.number("deg_h_per_degC2") / 3600.0 * scene.temperature.rise(scene.t) ** 2


def rate_after_effect(scene: Scene, i: int, m: Array, e: Entry) -> Array:
    """A bias that follows the rate's past: the reading's average over the last `tau_s`, with rest before t =
    0.

    First-order recursion on whatever grid is given, exact for a reading that holds between its points.
    """
    if scene.t.size < 2:
        return np.zeros_like(m)
    from scipy.signal import lfilter

    keep = np.exp(-(scene.t[1] - scene.t[0]) / e.number("tau_s"))
    result: Array = e.number("ppm") * 1e-6 * lfilter([0.0, 1.0 - keep], [1.0, -keep], m)
    return result


def saturation_recovery(scene: Scene, i: int, m: Array, e: Entry) -> Array:
    """Slow recovery after the start's jolt: A / (1 + t / tau), far slower at the end than an exponential."""
    return e.number("deg_h") / 3600.0 / (1.0 + scene.t / e.number("tau_s"))


def line_intermodulation(scene: Scene, i: int, m: Array, e: Entry) -> Array:
    """Two lines and their sum and difference."""
    p = e.parameters
    first = 2 * np.pi * p["frequency_1_hz"] * scene.t
    second = 2 * np.pi * p["frequency_2_hz"] * scene.t
    lines = np.sin(first) + np.sin(second) + 0.6 * (np.sin(first + second) + np.sin(first - second))
    result: Array = p["deg_h"] / 3600.0 * lines
    return result


def encoder_ripple_bias(scene: Scene, i: int, m: Array, e: Entry) -> Array:
    """A bias that follows the encoder's ripple, `lines_per_turn` to a turn."""
    turn = e.number("lines_per_turn") * scene.motion.alpha_rad
    return e.number("deg_h") / 3600.0 * np.sin(turn + e.number("phase_rad"))


STRANGERS: dict[str, Shape] = {
    "telegraph_bias": telegraph_bias,
    "gain_switching": gain_switching,
    "glitch_train": glitch_train,
    "sawtooth_bias": sawtooth_bias,
    "rate_squared": rate_squared,
    "third_harmonic": third_harmonic,
    "temperature_squared": temperature_squared,
    "rate_after_effect": rate_after_effect,
    "saturation_recovery": saturation_recovery,
    "line_intermodulation": line_intermodulation,
    "encoder_ripple_bias": encoder_ripple_bias,
}
# Band-limited noise has no waveform of its own: `withheld.chain.noise` makes it.
NAMES = (*STRANGERS, "band_limited_noise")
