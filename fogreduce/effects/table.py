"""The table of effects: every name of the catalogue, in its order. A laboratory adds its own here.

See docs/adding-an-effect.md.
"""

from __future__ import annotations

from collections.abc import Iterable

from fogreduce.effects import clock, electronics, gyro_bias, gyro_scale, link, noise, table_site_mounting
from fogreduce.effects.model import Effect
from fogreduce.errors import BadInput

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


def catalogue(without: Iterable[str] = ()) -> frozenset[str]:
    """Names of all effects but some.

    Raises
    ------
    BadInput
        One of those is no effect of the catalogue.
    """
    for name in without:
        if name not in EFFECTS:
            raise BadInput.at("--without", "", found=name, expected="an effect of the catalogue")
    return frozenset(EFFECTS) - frozenset(without)
