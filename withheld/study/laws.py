"""For every effect its main parameter, bounds and seat, and how the rest of it is drawn.

The law of amplitudes is not any diagnoser's prior: `withheld.study.draws` sets the main parameter so that a
drawn signal-to-noise ratio is met.  The other parameters come from the wide ranges here.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from withheld.chain.campaign import Campaign

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


def _across(campaign: Campaign, gyro: int, rng: np.random.Generator) -> list[float]:
    """A direction at right angles to the gyro's axis: a part along it would do nothing."""
    axis = campaign.unit.axes[gyro] / np.linalg.norm(campaign.unit.axes[gyro])
    v = rng.standard_normal(3)
    v -= axis * (axis @ v)
    return [round(float(x), 9) for x in v / np.linalg.norm(v)]


def _other_gyro(campaign: Campaign, gyro: int, rng: np.random.Generator) -> str:
    n = campaign.unit.n
    return f"gyro{(gyro + rng.integers(1, n)) % n + 1}"


def _line_hz(campaign: Campaign, rng: np.random.Generator) -> float:
    half = min(run.sample_rate_hz for run in campaign.runs) / 2.0
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
    "axis_misalignment": Law("mrad", 0.2, 1e-3, 50.0, "gyro", lambda c, g, r: {"mrad": _across(c, g, r)}),
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
    # near the catalogue, and not of it
    "two_warmings": Law(
        "deg_h",
        1.0,
        1e-3,
        1e3,
        rest=lambda c, g, r: {
            "tau_s": round(float(r.uniform(10, 30)), 2),
            "ratio": round(float(r.uniform(6, 12)), 2),
            "share": round(float(r.uniform(0.35, 0.65)), 3),
        },
    ),
    "late_temperature_bias": Law(
        "deg_h_per_degC", 0.3, 1e-3, 1e3, rest=lambda c, g, r: {"lag_s": round(float(r.uniform(30, 90)), 1)}
    ),
    "soft_dead_zone": Law("deg_h", 5.0, 0.05, 200.0, rest=_share(0.25, 0.6, "soft")),
    "fifth_power": Law("ppm_at_10_deg_s", 50.0, 0.01, 5e3),
    "slow_step": Law(
        "deg_h",
        1.0,
        1e-3,
        1e3,
        rest=lambda c, g, r: {
            "time_s": round(float(r.uniform(0.1, 0.4)) * c.runs[0].duration_s, 1),
            "rise_s": round(float(r.uniform(0.1, 0.4)) * c.runs[0].duration_s, 1),
        },
    ),
    "bent_ramp": Law("deg_h_after_1_h", 50.0, 1e-2, 1e5),
}
