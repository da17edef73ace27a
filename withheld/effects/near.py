"""Effects of shapes near those of the catalogue, and not of it: each has a kin whose name is half right.

What they add to one gyro's reading [deg/s] (k,), like the functions of `withheld.effects.gyro`.
"""

import numpy as np

from withheld.arrays import Array
from withheld.effects.entry import Entry
from withheld.effects.gyro import Scene, Shape, dead_zone


def two_warmings(scene: Scene, i: int, m: Array, e: Entry) -> Array:
    """Warming with two time constants: the coil's and, `ratio` times as long, the housing's."""
    tau, share = e.number("tau_s"), e.number("share")
    fast, slow = np.exp(-scene.t / tau), np.exp(-scene.t / (e.number("ratio") * tau))
    return e.number("deg_h") / 3600.0 * ((1.0 - share) * fast + share * slow)


def late_temperature_bias(scene: Scene, i: int, m: Array, e: Entry) -> Array:
    """Temperature bias of a coil that follows its sensor with a lag of `lag_s`, settled at t = 0."""
    from scipy.signal import lfilter

    heat = scene.temperature
    keep = np.exp(-(heat.time_s[1] - heat.time_s[0]) / e.number("lag_s"))
    rise = heat.felt_degC - heat.felt_degC[0]
    late = lfilter([1.0 - keep], [1.0, -keep], rise)
    result: Array = e.number("deg_h_per_degC") / 3600.0 * np.interp(scene.t, heat.time_s, late)
    return result


def soft_dead_zone(scene: Scene, i: int, m: Array, e: Entry) -> Array:
    """A dead zone whose edge is smeared over a good part of its width."""
    parameters = {"deg_h": e.parameters["deg_h"], "kind": "threshold"}
    smeared = Entry("dead_zone", e.channels, e.runs, parameters, {"soft": e.number("soft")})
    return np.asarray(dead_zone(scene, i, m, smeared))


def fifth_power(scene: Scene, i: int, m: Array, e: Entry) -> Array:
    """A scale factor that bends with the fourth power of the rate: M e (M / 10 deg/s)^4."""
    return m * (e.number("ppm_at_10_deg_s") * 1e-6) * (m / 10.0) ** 4


def slow_step(scene: Scene, i: int, m: Array, e: Entry) -> Array:
    """A step that takes `rise_s` to come, a good part of the run."""
    since = np.maximum(scene.t - e.number("time_s"), 0.0)
    result: Array = e.number("deg_h") / 3600.0 * (1.0 - np.exp(-since / e.number("rise_s")))
    return result


def bent_ramp(scene: Scene, i: int, m: Array, e: Entry) -> Array:
    """A drift that grows with the square of time, stated by what it is after an hour."""
    return e.number("deg_h_after_1_h") / 3600.0 * (scene.t / 3600.0) ** 2


NEAR: dict[str, Shape] = {
    "two_warmings": two_warmings,
    "late_temperature_bias": late_temperature_bias,
    "soft_dead_zone": soft_dead_zone,
    "fifth_power": fifth_power,
    "slow_step": slow_step,
    "bent_ramp": bent_ramp,
}
# The effect of the catalogue that each is a departure from.
KIN: dict[str, str] = {
    "two_warmings": "warm_up",
    "late_temperature_bias": "temperature_bias",
    "soft_dead_zone": "dead_zone",
    "fifth_power": "scale_factor_nonlinearity",
    "slow_step": "bias_step",
    "bent_ramp": "bias_ramp",
}
