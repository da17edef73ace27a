"""How large, and of what shape: parameters of an effect drawn for one campaign.

The law is not any diagnoser's prior: a target signal-to-noise ratio is drawn evenly in its logarithm, and the
effect's main parameter is set to meet it within physical bounds.  Other parameters come from wide ranges.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from withheld.chain.campaign import Campaign
from withheld.effects.catalogue import IN_ONE_RUN
from withheld.effects.entry import Entry

Draw = Callable[[Campaign, int, np.random.Generator], dict[str, Any]]


@dataclass(frozen=True)
class Law:
    """An effect's main parameter (empty: it has none), a first value, its bounds, where it sits, the rest.

    `seat`: `gyro`, `all` (every gyro in one entry), `table` or `clock`.
    """

    main: str = ""
    first: float = 1.0
    low: float = 0.0
    high: float = 1e9
    seat: str = "gyro"
    rest: Draw = lambda campaign, gyro, rng: {}
    departure: Draw = lambda campaign, gyro, rng: {}


def _direction(rng: np.random.Generator) -> list[float]:
    v = rng.standard_normal(3)
    return [round(float(x), 6) for x in v / np.linalg.norm(v)]


def _other_gyro(campaign: Campaign, gyro: int, rng: np.random.Generator) -> str:
    n = campaign.unit.n
    return f"gyro{(gyro + rng.integers(1, n)) % n + 1}"


def _line_hz(campaign: Campaign, rng: np.random.Generator) -> float:
    half = campaign.runs[0].sample_rate_hz / 2.0
    return round(float(np.exp(rng.uniform(np.log(1.5), np.log(0.95 * half)))), 4)


def _sense(rng: np.random.Generator) -> float:
    return float(rng.choice([-1.0, 1.0]))


def _largest_volts(campaign: Campaign, gyro: int) -> float:
    unit = campaign.unit
    rates = [
        abs(rate) * abs(unit.axes[gyro] @ np.array(r.axis)) for r in campaign.runs for rate, _ in r.profile
    ]
    return float(unit.scale_factor[gyro] * max([*rates, 0.004]))


def _sample_noise_volts(campaign: Campaign, gyro: int) -> float:
    unit, rate = campaign.unit, campaign.runs[0].sample_rate_hz
    return float(unit.white_deg_s(rate)[gyro] * unit.scale_factor[gyro])


def _share(low: float, high: float, key: str) -> Draw:
    return lambda campaign, gyro, rng: {key: round(float(rng.uniform(low, high)), 4)}


LAWS: dict[str, Law] = {
    "table_rate_error": Law("ppm", 50.0, 0.1, 1e4, "table"),
    "table_rate_ripple": Law(
        "ppm",
        50.0,
        0.1,
        1e5,
        "table",
        lambda c, g, r: {
            "harmonic": int(r.choice([1, 2, 3, 4, 6])),
            "phase_rad": round(float(r.uniform(0, 6.28)), 4),
        },
    ),
    "heading_error": Law("deg", 0.5, 0.01, 90.0, "table"),
    "latitude_error": Law("deg", 0.5, 0.01, 60.0, "table"),
    "rotation_sense": Law(seat="table"),
    "start_offset": Law(
        seat="table",
        rest=lambda c, g, r: {"s": round(float(np.exp(r.uniform(np.log(0.02), np.log(3.0)))), 4)},
    ),
    "mount_rotation": Law("mrad", 0.5, 1e-3, 50.0, "table", lambda c, g, r: {"mrad": _direction(r)}),
    "base_motion": Law(
        "deg_h",
        2.0,
        0.01,
        1e4,
        "table",
        lambda c, g, r: {"frequency_hz": _line_hz(c, r), "axis": _direction(r)},
    ),
    "bias_offset": Law("deg_h", 1.0, 1e-3, 1e3),
    "turn_on_bias": Law("deg_h", 1.0, 1e-3, 1e3),
    "bias_ramp": Law("deg_h_per_h", 5.0, 1e-3, 1e3),
    "bias_step": Law(
        "deg_h",
        0.5,
        1e-3,
        1e3,
        "gyro",
        lambda c, g, r: {"time_s": round(float(r.uniform(0.15, 0.85)) * c.runs[0].duration_s, 2)},
        _share(0.2, 4.0, "rise_s"),
    ),
    "warm_up": Law(
        "deg_h",
        0.5,
        1e-3,
        1e3,
        "gyro",
        lambda c, g, r: {"tau_s": round(float(np.exp(r.uniform(np.log(20), np.log(200)))), 2)},
        _share(0.02, 0.12, "second_share"),
    ),
    "temperature_bias": Law("deg_h_per_degC", 0.3, 1e-3, 1e3),
    "temperature_rate_bias": Law("deg_h_per_degC_per_min", 0.5, 1e-3, 1e3),
    "temperature_scale_factor": Law("ppm_per_degC", 20.0, 0.01, 1e5),
    "scale_factor_error": Law("ppm", 100.0, 0.1, 1e5),
    "scale_factor_asymmetry": Law("ppm", 50.0, 0.1, 1e5),
    "scale_factor_nonlinearity": Law(
        "ppm_at_10_deg_s", 50.0, 0.1, 1e5, "gyro", departure=_share(0, 0.08, "quartic")
    ),
    "axis_misalignment": Law("mrad", 0.2, 1e-3, 50.0, "gyro", lambda c, g, r: {"mrad": _direction(r)}),
    "acceleration_bias": Law("deg_h_per_g", 0.5, 1e-3, 1e3),
    "magnetic_bias": Law("deg_h", 0.5, 1e-3, 1e3, "gyro", lambda c, g, r: {"field_direction": _direction(r)}),
    "dead_zone": Law(
        "deg_h",
        3.0,
        0.05,
        200.0,
        "gyro",
        lambda c, g, r: {"kind": str(r.choice(["threshold", "subtractive"]))},
        _share(0.01, 0.05, "soft"),
    ),
    "angle_random_walk": Law("deg_sqrt_h", 0.003, 1e-4, 0.1),
    "bias_instability": Law("deg_h", 0.2, 1e-3, 100.0),
    "rate_random_walk": Law("deg_h_sqrt_h", 1.0, 1e-3, 300.0),
    "common_noise": Law("correlation", 0.03, 1e-4, 0.9, "all"),
    "periodic_interference": Law(
        "deg_h",
        2.0,
        1e-3,
        1e4,
        "gyro",
        lambda c, g, r: {"frequency_hz": _line_hz(c, r)},
        lambda c, g, r: {"drift_hz_per_s": float(r.normal()) * 0.2 / c.runs[0].duration_s ** 2},
    ),
    "lost_bits": Law(seat="gyro", rest=lambda c, g, r: {"bits": int(r.integers(2, 9))}),
    "adc_nonlinearity": Law(
        "volts",
        1e-6,
        1e-9,
        1e-3,
        "gyro",
        lambda c, g, r: {
            "period_volts": float(
                f"{_sample_noise_volts(c, g) * np.exp(r.uniform(np.log(2), np.log(12))):.4g}"
            )
        },
        _share(0.0, 0.1, "second_harmonic"),
    ),
    "saturation": Law(
        seat="gyro",
        rest=lambda c, g, r: {"volts": float(f"{_largest_volts(c, g) * r.uniform(0.5, 0.98):.5g}")},
        departure=_share(0, 0.01, "knee"),
    ),
    "crosstalk": Law("ppm", 100.0, 0.1, 1e5, "gyro", lambda c, g, r: {"source": _other_gyro(c, g, r)}),
    "low_pass": Law("time_constant_ms", 2.0, 0.05, 200.0, "gyro", departure=_share(0.01, 0.1, "second_pole")),
    "clock_error": Law(
        seat="clock",
        rest=lambda c, g, r: {
            "ppm": round(_sense(r) * float(np.exp(r.uniform(np.log(0.5), np.log(200.0)))), 3)
        },
    ),
    "latency": Law("ms", 20.0, 0.1, 2000.0),
    "dropouts": Law("fraction", 1e-4, 1e-6, 0.2, "gyro", departure=_share(1.0, 2.0, "burst")),
    "spikes": Law("fraction", 1e-4, 1e-6, 0.1, "gyro", departure=_share(0.5, 1.0, "reach")),
    "stuck_samples": Law("fraction", 1e-3, 1e-5, 0.3, "gyro", departure=_share(1.0, 1.6, "burst")),
    "channel_swap": Law(rest=lambda c, g, r: {"with": _other_gyro(c, g, r)}),
    "polarity_error": Law(),
    # never in the catalogue
    "telegraph_bias": Law(
        "deg_h",
        1.0,
        1e-3,
        1e3,
        "gyro",
        lambda c, g, r: {"mean_s": round(float(r.uniform(15, 60)), 2), "seed": int(r.integers(1 << 30))},
    ),
    "gain_switching": Law(
        "ppm",
        50.0,
        0.01,
        1e5,
        "gyro",
        lambda c, g, r: {"mean_s": round(float(r.uniform(15, 60)), 2), "seed": int(r.integers(1 << 30))},
    ),
    "glitch_train": Law(
        "deg_h",
        5.0,
        1e-3,
        1e4,
        "gyro",
        lambda c, g, r: {
            "mean_s": round(float(r.uniform(20, 60)), 2),
            "decay_s": round(float(r.uniform(0.5, 4)), 2),
            "seed": int(r.integers(1 << 30)),
        },
    ),
    "sawtooth_bias": Law(
        "deg_h", 1.0, 1e-3, 1e3, "gyro", lambda c, g, r: {"period_s": round(float(r.uniform(30, 120)), 2)}
    ),
    "rate_squared": Law("deg_h_at_10_deg_s", 1.0, 1e-3, 1e3),
    "third_harmonic": Law(
        "deg_h", 0.5, 1e-3, 1e3, "gyro", lambda c, g, r: {"phase_rad": round(float(r.uniform(0, 6.28)), 4)}
    ),
    "temperature_squared": Law("deg_h_per_degC2", 0.5, 1e-3, 1e3),
    "rate_after_effect": Law(
        "ppm", 50.0, 0.01, 1e5, "gyro", lambda c, g, r: {"tau_s": round(float(r.uniform(20, 120)), 2)}
    ),
    "saturation_recovery": Law(
        "deg_h", 1.0, 1e-3, 1e3, "gyro", lambda c, g, r: {"tau_s": round(float(r.uniform(5, 40)), 2)}
    ),
    "line_intermodulation": Law(
        "deg_h",
        2.0,
        1e-3,
        1e4,
        "gyro",
        lambda c, g, r: {
            "frequency_1_hz": round(float(r.uniform(8.0, 14.0)), 4),
            "frequency_2_hz": round(float(r.uniform(2.0, 6.0)), 4),
        },
    ),
    "encoder_ripple_bias": Law(
        "deg_h",
        1.0,
        1e-3,
        1e3,
        "gyro",
        lambda c, g, r: {
            "lines_per_turn": int(r.integers(5, 16)),
            "phase_rad": round(float(r.uniform(0, 6.28)), 4),
        },
    ),
    "band_limited_noise": Law(
        "deg_h",
        2.0,
        1e-3,
        1e4,
        "gyro",
        lambda c, g, r: {
            "low_hz": round(float(r.uniform(2.0, 8.0)), 3),
            "high_hz": round(float(r.uniform(9.0, 20.0)), 3),
        },
    ),
}
# Only these have a shape that a slow modulation can disturb without making it something else.
WOBBLES = (
    "table_rate_error", "heading_error", "latitude_error", "mount_rotation", "bias_offset", "turn_on_bias",
    "bias_ramp", "bias_step", "warm_up", "temperature_bias", "temperature_rate_bias",
    "temperature_scale_factor", "scale_factor_error", "scale_factor_asymmetry",
    "scale_factor_nonlinearity", "acceleration_bias",
    "magnetic_bias", "crosstalk", "periodic_interference", "base_motion",
)  # fmt: skip


def draw_entry(effect: str, campaign: Campaign, rng: np.random.Generator, wobble_most: float) -> Entry:
    """An entry with its first amplitude, in a random seat, with a departure from the catalogue's shape.

    `wobble_most`: largest relative modulation (rms).
    """
    law = LAWS[effect]
    gyro = int(rng.integers(campaign.unit.n))
    seats = {"gyro": (f"gyro{gyro + 1}",), "table": ("table",), "clock": ("clock",)}
    channels = seats.get(law.seat) or tuple(f"gyro{i + 1}" for i in range(campaign.unit.n))
    runs = (campaign.runs[rng.integers(len(campaign.runs))].run_id,) if effect in IN_ONE_RUN else ("*",)
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
    return with_amplitude(entry, law.first * _sense(rng)) if law.main else entry


# An amplitude that cannot be negative.
_POSITIVE = (
    "angle_random_walk", "bias_instability", "rate_random_walk", "common_noise", "periodic_interference",
    "base_motion", "table_rate_ripple", "dead_zone", "adc_nonlinearity", "low_pass", "latency", "dropouts",
    "spikes", "stuck_samples", "band_limited_noise", "line_intermodulation",
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
