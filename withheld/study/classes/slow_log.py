"""Slow logs: below 2 Hz, for hours, at a standstill or nearly, coarse counts and a few spoilt readings."""

from dataclasses import replace

import numpy as np

from withheld.chain.campaign import Campaign, Run
from withheld.chain.injector import realistic_world
from withheld.effects.entry import Entry
from withheld.study.amplitudes import scaled
from withheld.study.classes.link_slow import even_in_logarithm, link_faults
from withheld.study.classes.model import CampaignClass
from withheld.study.designs import any_campaign
from withheld.study.draws import draw_entry
from withheld.study.plan import Drawn, Plan
from withheld.study.protocol import Protocol

_RATES_HZ = (0.02, 0.1, 0.5, 1.0)
_RECORDS = (500.0, 2500.0)
# A count over a sample's white noise: at 1 rounding adds 4 % to its level.
_COARSENESS = (0.1, 1.0)
_LINK_SHARES = (1e-3, 1e-2)
_DESIGNS = {"one_static": 0.4, "two": 0.2, "eight_static": 0.2, "one_constant": 0.2}
# The table creeps, if it moves at all: a faster turn would go round between two readings.
_FASTEST_DEG_S = 0.02
_SNR = (10.0, 40.0)
_EFFECTS = (
    "bias_offset", "bias_ramp", "bias_step", "warm_up", "temperature_bias", "dead_zone", "angle_random_walk",
    "rate_random_walk",
)  # fmt: skip


def _slowed(run: Run, rate_hz: float, records: int, volts_per_count: float) -> Run:
    """One commanded rate, far below the design's, for that many records."""
    rate = run.profile[0][0]
    crawl = float(np.sign(rate)) * min(abs(rate), _FASTEST_DEG_S)
    return replace(
        run, profile=((crawl, round(records / rate_hz, 3)),), sample_rate_hz=rate_hz,
        volts_per_count=volts_per_count,
    )  # fmt: skip


def slowed(campaign: Campaign, rng: np.random.Generator) -> Campaign:
    """The campaign as a slow logger would have kept it."""
    rate_hz = float(rng.choice(_RATES_HZ))
    records = int(even_in_logarithm(*_RECORDS, rng))
    noise_volts = campaign.unit.white_deg_s(rate_hz) * np.array(campaign.unit.scale_factor)
    count = float(f"{even_in_logarithm(*_COARSENESS, rng) * float(np.median(noise_volts)):.3g}")
    return replace(campaign, runs=tuple(_slowed(run, rate_hz, records, count) for run in campaign.runs))


def stretched(entry: Entry, campaign: Campaign) -> Entry:
    """A warm-up as long to its log as the law's is to a run of 300 s."""
    if entry.effect != "warm_up":
        return entry
    tau = entry.number("tau_s") * max(1.0, campaign.runs[0].duration_s / 300.0)
    return replace(entry, parameters={**entry.parameters, "tau_s": round(tau, 2)})


def _draw(protocol: Protocol, plan: Plan, rng: np.random.Generator) -> Drawn:
    design, plain = any_campaign(plan.name, rng, protocol.temperature_share, _DESIGNS)
    campaign = slowed(plain, rng)
    slow = tuple(
        stretched(draw_entry(effect, campaign, rng, protocol.wobble_most), campaign)
        for effect in plan.effects
    )
    world = realistic_world(campaign, slow, int(rng.integers(1 << 62)), protocol.noise_level_rel)
    world, seen = scaled(world, [even_in_logarithm(*_SNR, rng) for _ in slow], protocol)
    faults = link_faults(campaign, ("dropouts", "spikes"), None, rng, protocol.wobble_most, _LINK_SHARES)
    roles = ("link",) * len(faults) + ("slow",) * len(slow)
    return Drawn(design, replace(world, entries=(*faults, *world.entries)), roles, seen)


# Every ninth has nothing wrong but its link.
SLOW_LOG = CampaignClass("Slow logs", _draw, (((), 0.0), *(((name,), 0.0) for name in _EFFECTS)))
