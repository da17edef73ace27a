"""An effect drawn for one campaign: its seat, its departure, and the amplitude that meets a target."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from withheld.chain.campaign import Campaign
from withheld.effects.catalogue import IN_ONE_RUN
from withheld.effects.entry import Entry
from withheld.study.laws import LAWS

# Only these have a shape that a slow modulation can disturb without making it something else.
WOBBLES = (
    "table_rate_error", "heading_error", "latitude_error", "mount_rotation", "bias_offset", "turn_on_bias",
    "bias_ramp", "bias_step", "warm_up", "temperature_bias", "temperature_rate_bias",
    "temperature_scale_factor", "scale_factor_error", "scale_factor_asymmetry",
    "scale_factor_nonlinearity", "acceleration_bias",
    "magnetic_bias", "crosstalk", "periodic_interference", "base_motion",
)  # fmt: skip


def draw_entry(
    effect: str, campaign: Campaign, rng: np.random.Generator, wobble_most: float, gyro: int | None = None
) -> Entry:
    """An entry with its first amplitude, with a departure from the catalogue's shape.

    `wobble_most`: largest relative modulation (rms).  `gyro`: where it sits, from 0; else drawn.
    """
    law = LAWS[effect]
    gyro = int(rng.integers(campaign.unit.n)) if gyro is None else gyro
    seats = {"gyro": (f"gyro{gyro + 1}",), "table": ("table",), "clock": ("clock",)}
    channels = seats.get(law.seat) or tuple(f"gyro{i + 1}" for i in range(campaign.unit.n))
    runs = ("*",)
    if effect in IN_ONE_RUN:
        acting = campaign.runs[rng.integers(len(campaign.runs))]
        # the laws look at the first run for lengths
        others = tuple(run for run in campaign.runs if run is not acting)
        runs, campaign = (acting.run_id,), replace(campaign, runs=(acting, *others))
    parameters = law.rest(campaign, gyro, rng)
    if effect == "channel_swap" and int(parameters["with"][4:]) < gyro + 1:
        # one swap has one name: the lower gyro stands first
        channels, parameters = (parameters["with"],), {"with": f"gyro{gyro + 1}"}
    departure = dict(law.departure(campaign, gyro, rng))
    if effect in WOBBLES:
        duration = campaign.runs[0].duration_s
        departure |= {
            "wobble": round(float(rng.uniform(0.0, wobble_most)), 4),
            "wobble_period_s": round(float(rng.uniform(0.4, 2.0)) * duration, 2),
            "wobble_phase_rad": round(float(rng.uniform(0.0, 2 * np.pi)), 4),
        }
    entry = Entry(effect, channels, runs, parameters, departure)
    return with_amplitude(entry, law.first * rng.choice([-1.0, 1.0])) if law.main else entry


# An amplitude that cannot be negative.
_POSITIVE = (
    "angle_random_walk", "bias_instability", "rate_random_walk", "common_noise", "periodic_interference",
    "base_motion", "table_rate_ripple", "dead_zone", "adc_nonlinearity", "low_pass", "latency", "dropouts",
    "spikes", "stuck_samples", "band_limited_noise", "line_intermodulation", "soft_dead_zone",
)  # fmt: skip


def amplitude(entry: Entry) -> float:
    """Size of the main parameter, without its sign; of a vector, its length."""
    value = entry.parameters[LAWS[entry.effect].main]
    return float(np.linalg.norm(value)) if isinstance(value, list) else abs(float(value))


def with_amplitude(entry: Entry, value: float) -> Entry:
    """The entry with another amplitude, within the law's bounds, to six digits."""
    law = LAWS[entry.effect]
    sense = 1.0 if entry.effect in _POSITIVE else float(np.sign(value))
    size = float(f"{np.clip(abs(value), law.low, law.high):.6g}")
    old = entry.parameters.get(law.main)
    new: Any = sense * size
    if isinstance(old, list):
        length = float(np.linalg.norm(old))
        new = [float(f"{sense * size * x / length:.6g}") for x in old]
    return replace(entry, parameters={**entry.parameters, law.main: new})


def met(entry: Entry, target: float, snr_of: Callable[[Entry], float], rounds: int = 5) -> Entry:
    """The entry with the amplitude at which its signal-to-noise ratio is near `target`.

    Secant steps in logarithms, the first as if the ratio grew with the amplitude in proportion; it stops at
    2 % or at the law's bounds.  An effect without amplitude comes back as it is.
    """
    if not LAWS[entry.effect].main:
        return entry
    if entry.effect == "angle_random_walk":
        return _met_level(entry, target, snr_of)
    previous: tuple[float, float] | None = None
    for _ in range(rounds):
        now, size = snr_of(entry), amplitude(entry)
        if now <= 0.0 or abs(np.log(now / target)) < 0.02:
            break
        power = 1.0
        if previous is not None and previous[0] != size:
            power = float(np.clip(np.log(now / previous[1]) / np.log(size / previous[0]), 0.3, 3.0))
        previous = (size, now)
        step = float(np.clip((target / now) ** (1.0 / power), 1e-3, 1e3))
        main = entry.parameters[LAWS[entry.effect].main]
        sense = 1.0 if isinstance(main, list) else float(np.sign(main))
        entry = with_amplitude(entry, sense * size * step)
    return entry


def _met_level(entry: Entry, target: float, snr_of: Callable[[Entry], float]) -> Entry:
    """angle_random_walk replaces a level: its ratio is k ln(level / record's), so that two points give k and
    the record's level.
    """
    one, two = 0.05, 0.1  # both far above any record's level
    first, second = snr_of(with_amplitude(entry, one)), snr_of(with_amplitude(entry, two))
    slope = (second - first) / np.log(two / one)
    return with_amplitude(entry, float(np.exp(np.log(one) + (target - first) / slope)))
