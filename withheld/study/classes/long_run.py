"""A single run of 100 minutes, as the paper's: one effect, and no other run to tell it from its rivals.

The table creeps round at 0.06 deg/s, so that much of the catalogue is one constant here, or nearly the same
slow curve: an effect is found where it is named or stands in its true group.
"""

import numpy as np

from withheld.chain.injector import realistic_world
from withheld.study.amplitudes import scaled
from withheld.study.classes.model import CampaignClass, Cell
from withheld.study.classes.slow_log import stretched
from withheld.study.designs import any_campaign
from withheld.study.draws import draw_entry
from withheld.study.plan import Drawn, Plan
from withheld.study.protocol import Protocol

_SNR = 20.0
# Of each effect what a run shows that turns six times at one rate; the warming at the SNR that were missed.
CELLS: tuple[Cell, ...] = (
    *((("warm_up",), snr) for snr in (15.0, 40.0)),
    *(((effect,), _SNR) for effect in (
        "bias_step", "bias_ramp", "temperature_bias", "temperature_rate_bias", "rate_random_walk",
        "bias_instability", "scale_factor_error", "table_rate_ripple", "heading_error", "magnetic_bias",
    )),
)  # fmt: skip


def _draw(protocol: Protocol, plan: Plan, rng: np.random.Generator) -> Drawn:
    design, campaign = any_campaign(plan.name, rng, protocol.temperature_share, {"one_long": 1.0})
    entry = stretched(draw_entry(plan.effects[0], campaign, rng, protocol.wobble_most), campaign)
    world = realistic_world(campaign, (entry,), int(rng.integers(1 << 62)), protocol.noise_level_rel)
    world, seen = scaled(world, [plan.snr], protocol)
    return Drawn(design, world, ("culprit",), seen)


LONG_RUN = CampaignClass("A single run of 100 minutes", _draw, CELLS)
