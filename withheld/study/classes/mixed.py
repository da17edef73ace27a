"""Mixed campaigns: runs of several rates and lengths, gyros of several grades; nothing or one thing wrong."""

from dataclasses import replace

import numpy as np

from withheld.chain.campaign import Campaign, Run, Unit
from withheld.chain.injector import realistic_world
from withheld.effects.catalogue import NAMES
from withheld.study.amplitudes import scaled
from withheld.study.classes.link_slow import even_in_logarithm
from withheld.study.classes.model import CampaignClass
from withheld.study.designs import any_campaign
from withheld.study.draws import draw_entry
from withheld.study.plan import Drawn, Plan
from withheld.study.protocol import Protocol

_RATES_HZ = (32.0, 50.0, 64.0, 100.0, 128.0, 200.0)
_LENGTHS = (0.3, 2.0)
# Standard deviation of the logarithm of a gyro's noise over the others': the grades in one unit span ten.
_GRADES = 0.8
_DESIGNS = {"eight": 0.5, "eight_slow": 0.1, "eight_static": 0.1, "three": 0.2, "two": 0.1}
_SNR = (10.0, 40.0)


def _mixed_run(run: Run, rng: np.random.Generator) -> Run:
    stretch = even_in_logarithm(*_LENGTHS, rng)
    profile = tuple((rate, float(np.round(duration * stretch))) for rate, duration in run.profile)
    return replace(run, profile=profile, sample_rate_hz=float(rng.choice(_RATES_HZ)))


def _mixed_unit(unit: Unit, rng: np.random.Generator) -> Unit:
    grade = np.exp(_GRADES * rng.standard_normal(unit.n))

    def graded(values: tuple[float, ...], digits: int) -> tuple[float, ...]:
        return tuple(round(float(v), digits) for v in np.array(values) * grade)

    return replace(
        unit, arw_deg_sqrt_h=graded(unit.arw_deg_sqrt_h, 6),
        instability_deg_h=graded(unit.instability_deg_h, 4), turn_on_deg_h=graded(unit.turn_on_deg_h, 4),
    )  # fmt: skip


def mixed(campaign: Campaign, rng: np.random.Generator) -> Campaign:
    """The campaign with a rate and a length of its own for every run, and a grade for every gyro."""
    runs = tuple(_mixed_run(run, rng) for run in campaign.runs)
    return replace(campaign, unit=_mixed_unit(campaign.unit, rng), runs=runs)


def _draw(protocol: Protocol, plan: Plan, rng: np.random.Generator) -> Drawn:
    design, plain = any_campaign(plan.name, rng, protocol.temperature_share, _DESIGNS)
    campaign = mixed(plain, rng)
    entries = tuple(draw_entry(effect, campaign, rng, protocol.wobble_most) for effect in plan.effects)
    world = realistic_world(campaign, entries, int(rng.integers(1 << 62)), protocol.noise_level_rel)
    world, seen = scaled(world, [even_in_logarithm(*_SNR, rng) for _ in entries], protocol)
    return Drawn(design, world, seen=seen)


MIXED_QUIET = CampaignClass("Mixed rates, lengths and noise levels, nothing wrong", _draw)
MIXED = CampaignClass(
    "Mixed rates, lengths and noise levels, one effect", _draw, tuple(((name,), 0.0) for name in NAMES)
)
