"""The catalogue's forty names, in the contract's order, by block."""

BLOCKS: dict[str, tuple[str, ...]] = {
    "table": (
        "table_rate_error", "table_rate_ripple", "heading_error", "latitude_error", "rotation_sense",
        "start_offset", "mount_rotation", "base_motion",
    ),
    "gyro": (
        "bias_offset", "turn_on_bias", "bias_ramp", "bias_step", "warm_up", "temperature_bias",
        "temperature_rate_bias", "temperature_scale_factor", "scale_factor_error",
        "scale_factor_asymmetry", "scale_factor_nonlinearity", "axis_misalignment", "acceleration_bias",
        "magnetic_bias", "dead_zone",
    ),
    "noise": (
        "angle_random_walk", "bias_instability", "rate_random_walk", "common_noise", "periodic_interference",
    ),
    "electronics": ("lost_bits", "adc_nonlinearity", "saturation", "crosstalk", "low_pass"),
    "link": (
        "clock_error", "latency", "dropouts", "spikes", "stuck_samples", "channel_swap", "polarity_error",
    ),
}  # fmt: skip
NAMES: tuple[str, ...] = tuple(name for names in BLOCKS.values() for name in names)
# What an entry of each effect has to state; a phase may be left out, and is then drawn in each run.
PARAMETERS: dict[str, tuple[str, ...]] = {
    "table_rate_error": ("ppm",), "table_rate_ripple": ("ppm", "harmonic"), "heading_error": ("deg",),
    "latitude_error": ("deg",), "rotation_sense": (), "start_offset": ("s",), "mount_rotation": ("mrad",),
    "base_motion": ("deg_h", "frequency_hz", "axis"), "bias_offset": ("deg_h",), "turn_on_bias": ("deg_h",),
    "bias_ramp": ("deg_h_per_h",), "bias_step": ("deg_h", "time_s"), "warm_up": ("deg_h", "tau_s"),
    "temperature_bias": ("deg_h_per_degC",), "temperature_rate_bias": ("deg_h_per_degC_per_min",),
    "temperature_scale_factor": ("ppm_per_degC",), "scale_factor_error": ("ppm",),
    "scale_factor_asymmetry": ("ppm",), "scale_factor_nonlinearity": ("ppm_at_10_deg_s",),
    "axis_misalignment": ("mrad",), "acceleration_bias": ("deg_h_per_g",),
    "magnetic_bias": ("deg_h", "field_direction"), "dead_zone": ("deg_h", "kind"),
    "angle_random_walk": ("deg_sqrt_h",), "bias_instability": ("deg_h",),
    "rate_random_walk": ("deg_h_sqrt_h",),
    "common_noise": ("correlation",), "periodic_interference": ("deg_h", "frequency_hz"),
    "lost_bits": ("bits",), "adc_nonlinearity": ("volts", "period_volts"), "saturation": ("volts",),
    "crosstalk": ("ppm", "source"), "low_pass": ("time_constant_ms",), "clock_error": ("ppm",),
    "latency": ("ms",), "dropouts": ("fraction",), "spikes": ("fraction",), "stuck_samples": ("fraction",),
    "channel_swap": ("with",), "polarity_error": (),
}  # fmt: skip
WITH_PHASE = ("table_rate_ripple", "base_motion", "periodic_interference")
IN_ONE_RUN = ("turn_on_bias", "bias_step")
# Only the full-rate stream shows these; their signal-to-noise ratio is a likelihood ratio's.
FULL_RATE = (
    "base_motion", "angle_random_walk", "common_noise", "periodic_interference", "lost_bits",
    "adc_nonlinearity", "low_pass", "clock_error", "dropouts", "spikes", "stuck_samples",
)  # fmt: skip


def block(effect: str) -> str:
    """The block in which an effect of the catalogue stands; others sit in a gyro or its noise."""
    for name, effects in BLOCKS.items():
        if effect in effects:
            return name
    return "noise" if effect == "band_limited_noise" else "gyro"
