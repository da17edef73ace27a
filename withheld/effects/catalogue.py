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
