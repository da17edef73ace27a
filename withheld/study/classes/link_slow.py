"""Link and slow faults together: a link that loses or spoils readings, on a unit that drifts.

What the link does is drawn as links do it, from one reading in a hundred thousand to one in fifty; the slow
fault meets a target of its own.  Often both sit on one gyro.
"""

from dataclasses import replace

import numpy as np

from withheld.chain.campaign import Campaign
from withheld.chain.injector import realistic_world
from withheld.effects.entry import Entry
from withheld.study.amplitudes import scaled
from withheld.study.classes.model import CampaignClass
from withheld.study.designs import any_campaign
from withheld.study.draws import draw_entry, with_amplitude
from withheld.study.plan import Drawn, Plan
from withheld.study.protocol import Protocol

LINK = ("dropouts", "spikes", "stuck_samples")
SLOW = (
    "bias_offset", "bias_ramp", "bias_step", "warm_up", "temperature_bias", "scale_factor_error",
    "axis_misalignment", "acceleration_bias", "dead_zone", "heading_error", "table_rate_ripple",
)  # fmt: skip
# Shares of readings that a poor link loses or spoils, even in the logarithm.
LINK_SHARES = (1e-5, 2e-2)
SLOW_SNR = (10.0, 40.0)
_SAME_GYRO = 0.5


def even_in_logarithm(low: float, high: float, rng: np.random.Generator) -> float:
    """A number between two, even in the logarithm."""
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))


def link_faults(
    campaign: Campaign, effects: tuple[str, ...], gyro: int | None, rng: np.random.Generator,
    wobble_most: float, shares: tuple[float, float] = LINK_SHARES,
) -> tuple[Entry, ...]:  # fmt: skip
    """An entry for each link fault, on the gyro given, or on one drawn."""
    return tuple(
        with_amplitude(draw_entry(effect, campaign, rng, wobble_most, gyro), even_in_logarithm(*shares, rng))
        for effect in effects
    )


def _draw(protocol: Protocol, plan: Plan, rng: np.random.Generator) -> Drawn:
    design, campaign = any_campaign(plan.name, rng, protocol.temperature_share)
    gyro = int(rng.integers(campaign.unit.n))
    slow = draw_entry(plan.effects[-1], campaign, rng, protocol.wobble_most, gyro)
    world = realistic_world(campaign, (slow,), int(rng.integers(1 << 62)), protocol.noise_level_rel)
    world, seen = scaled(world, [even_in_logarithm(*SLOW_SNR, rng)], protocol)
    place = gyro if rng.random() < _SAME_GYRO else None
    faults = link_faults(campaign, plan.effects[:-1], place, rng, protocol.wobble_most)
    roles = ("link",) * len(faults) + ("slow",)
    return Drawn(design, replace(world, entries=(*faults, *world.entries)), roles, seen)


_LINKS = (*((fault,) for fault in LINK), ("dropouts", "spikes"), ("dropouts", "stuck_samples"))
LINK_SLOW = CampaignClass(
    "Link and slow faults together", _draw, tuple(((*link, slow), 0.0) for slow in SLOW for link in _LINKS)
)
