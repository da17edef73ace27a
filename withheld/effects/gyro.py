"""What one gyro adds to its reading: the catalogue's block 'gyro', biases first, then scale factor effects.

Each function returns what is to be added to the reading `m` of gyro `i` [deg/s] (k,), given the scene and
the entry.  Formulas: the contract's page of effects.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from withheld.arrays import Array
from withheld.chain.motion import Motion
from withheld.chain.temperature import Temperature
from withheld.effects.entry import Entry


@dataclass(frozen=True)
class Scene:
    """What a gyro finds around it: the motion, its temperature and the gyros' true axes (n, 3)."""

    motion: Motion
    temperature: Temperature
    axes: Array

    @property
    def t(self) -> Array:
        """Times [s], (k,)."""
        return self.motion.t


Shape = Callable[[Scene, int, Array, Entry], Array | float]


def constant(scene: Scene, i: int, m: Array, e: Entry) -> Array | float:
    """bias_offset and turn_on_bias: a constant."""
    return e.number("deg_h") / 3600.0


def bias_ramp(scene: Scene, i: int, m: Array, e: Entry) -> Array:
    """Value t, t in hours."""
    return e.number("deg_h_per_h") / 3600.0 * scene.t / 3600.0


def bias_step(scene: Scene, i: int, m: Array, e: Entry) -> Array:
    """A constant from `time_s` on; departure `rise_s`: it takes that long to come, exponentially."""
    since = scene.t - e.number("time_s")
    rise = e.departure.get("rise_s", 0.0)
    grown = 1.0 - np.exp(-np.maximum(since, 0.0) / rise) if rise else np.ones_like(since)
    return e.number("deg_h") / 3600.0 * np.where(since >= 0.0, grown, 0.0)


def warm_up(scene: Scene, i: int, m: Array, e: Entry) -> Array:
    """A exp(-t / tau); departure `second_share`: that share decays three times slower."""
    share, tau = e.departure.get("second_share", 0.0), e.number("tau_s")
    decay = (1.0 - share) * np.exp(-scene.t / tau) + share * np.exp(-scene.t / (3.0 * tau))
    return e.number("deg_h") / 3600.0 * decay


def temperature_bias(scene: Scene, i: int, m: Array, e: Entry) -> Array:
    """K (T(t) - T(0))."""
    return e.number("deg_h_per_degC") / 3600.0 * scene.temperature.rise(scene.t)


def temperature_rate_bias(scene: Scene, i: int, m: Array, e: Entry) -> Array:
    """K dT/dt (Shupe)."""
    return e.number("deg_h_per_degC_per_min") / 3600.0 * scene.temperature.slope_per_min(scene.t)


def acceleration_bias(scene: Scene, i: int, m: Array, e: Entry) -> Array:
    """K (G_i . up), in g."""
    up = scene.motion.seen(np.array([0.0, 0.0, 1.0]))
    result: Array = e.number("deg_h_per_g") / 3600.0 * (up @ scene.axes[i])
    return result


def magnetic_bias(scene: Scene, i: int, m: Array, e: Entry) -> Array:
    """K (G_i . R u0 F), F of length 1."""
    field = np.array(e.parameters["field_direction"], dtype=float)
    seen = scene.motion.seen(field / np.linalg.norm(field))
    result: Array = e.number("deg_h") / 3600.0 * (seen @ scene.axes[i])
    return result


def temperature_scale_factor(scene: Scene, i: int, m: Array, e: Entry) -> Array:
    """M k (T(t) - T(0))."""
    return m * (e.number("ppm_per_degC") * 1e-6 * scene.temperature.rise(scene.t))


def scale_factor_error(scene: Scene, i: int, m: Array, e: Entry) -> Array:
    """M e."""
    return m * (e.number("ppm") * 1e-6)


def scale_factor_asymmetry(scene: Scene, i: int, m: Array, e: Entry) -> Array:
    """E abs(m)."""
    return np.abs(m) * (e.number("ppm") * 1e-6)


def scale_factor_nonlinearity(scene: Scene, i: int, m: Array, e: Entry) -> Array:
    """M e (m / 10 deg/s)^2; departure `quartic`: that share goes with the fourth power instead."""
    square = (m / 10.0) ** 2
    share = e.departure.get("quartic", 0.0)
    return m * (e.number("ppm_at_10_deg_s") * 1e-6) * ((1.0 - share) * square + share * square**2)


def dead_zone(scene: Scene, i: int, m: Array, e: Entry) -> Array:
    """Nothing read where abs(m) < w; departure `soft`: the edge is smeared over that share of w."""
    w = e.number("deg_h") / 3600.0
    soft = e.departure.get("soft", 0.0)
    inside = 1.0 / (1.0 + np.exp(np.clip((np.abs(m) - w) / (soft * w), -50, 50))) if soft else np.abs(m) < w
    if e.parameters["kind"] == "threshold":
        return np.where(inside, -m * inside, 0.0)
    return -m * inside - np.sign(m) * w * (1.0 - np.asarray(inside, dtype=float))


BIASES: dict[str, Shape] = {
    "bias_offset": constant,
    "turn_on_bias": constant,
    "bias_ramp": bias_ramp,
    "bias_step": bias_step,
    "warm_up": warm_up,
    "temperature_bias": temperature_bias,
    "temperature_rate_bias": temperature_rate_bias,
    "acceleration_bias": acceleration_bias,
    "magnetic_bias": magnetic_bias,
}
SCALES: dict[str, Shape] = {
    "temperature_scale_factor": temperature_scale_factor,
    "scale_factor_error": scale_factor_error,
    "scale_factor_asymmetry": scale_factor_asymmetry,
    "scale_factor_nonlinearity": scale_factor_nonlinearity,
}
