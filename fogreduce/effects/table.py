"""The table of effects: every name of the catalogue, in its order. A laboratory adds its own here.

See docs/adding-an-effect.md.
"""

from __future__ import annotations

from fogreduce.effects import clock, electronics, gyro_bias, gyro_scale, link, noise, table_site_mounting
from fogreduce.effects.model import Effect

EFFECTS: dict[str, Effect] = {
    effect.name: effect
    for effect in (
        *table_site_mounting.EFFECTS,
        *gyro_bias.EFFECTS,
        *gyro_bias.AXIS_EFFECTS,
        *gyro_scale.EFFECTS,
        *noise.EFFECTS,
        *electronics.EFFECTS,
        *clock.EFFECTS,
        *link.EFFECTS,
    )
}
