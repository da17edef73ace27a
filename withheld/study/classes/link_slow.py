"""Link and slow faults together: a link that loses or spoils readings, lines, filters, on a unit that drifts.

What the link does is drawn as links do it, from one reading in a hundred thousand to one in fifty; a fault
that the spectrum, the levels or the stamps show, and the slow one, meet targets of their own.  Often all sit
on one gyro.
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
# Full-rate faults of another kind than the link's, alone, two of them, or with the link's.
_FAST = (
    ("periodic_interference",), ("periodic_interference", "periodic_interference"), ("low_pass",),
    ("angle_random_walk",), ("clock_error", "spikes"), ("lost_bits", "dropouts"), ("base_motion",),
    ("adc_nonlinearity",), ("common_noise", "stuck_samples"),
)  # fmt: skip
FAST_SNR = (10.0, 100.0)
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
    place = gyro if rng.random() < _SAME_GYRO else None
    others, links = list(plan.effects), [effect for effect in plan.effects if effect in LINK]
    for effect in links:
        others.remove(effect)
    # the last is the slow one, on the gyro
    drawn = [draw_entry(effect, campaign, rng, protocol.wobble_most, place) for effect in others[:-1]]
    drawn.append(draw_entry(others[-1], campaign, rng, protocol.wobble_most, gyro))
    targets = [even_in_logarithm(*FAST_SNR, rng) for _ in drawn[:-1]] + [even_in_logarithm(*SLOW_SNR, rng)]
    world = realistic_world(campaign, tuple(drawn), int(rng.integers(1 << 62)), protocol.noise_level_rel)
    world, seen = scaled(world, targets, protocol)
    faults = link_faults(campaign, tuple(links), place, rng, protocol.wobble_most)
    roles = ("link",) * len(faults) + ("full rate",) * (len(drawn) - 1) + ("slow",)
    return Drawn(design, replace(world, entries=(*faults, *world.entries)), roles, seen)


_LINKS = (*((fault,) for fault in LINK), ("dropouts", "spikes"), ("dropouts", "stuck_samples"))
LINK_SLOW = CampaignClass(
    "Link and slow faults together",
    _draw,
    tuple(((*fast, slow), 0.0) for slow in SLOW for fast in (*_LINKS, *_FAST)),
)
