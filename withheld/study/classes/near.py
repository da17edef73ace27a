"""Shapes near but not of the catalogue, as large as keeps SNR 15 from everything that is in it."""

from dataclasses import replace

import numpy as np

from withheld.chain.injector import realistic_world
from withheld.clairvoyant.appraisal import appraise
from withheld.effects.catalogue import NAMES
from withheld.effects.entry import Entry
from withheld.effects.near import NEAR
from withheld.study.amplitudes import healthy
from withheld.study.classes.model import CampaignClass
from withheld.study.designs import any_campaign
from withheld.study.draws import draw_entry, met
from withheld.study.plan import Drawn, Plan
from withheld.study.protocol import Protocol

_KEEPS = 15.0
_DESIGNS = {"eight": 0.7, "eight_slow": 0.15, "eight_static": 0.15}
_MANY_RATES = {"eight": 0.5, "one_many_rate": 0.5}


def _draw(protocol: Protocol, plan: Plan, rng: np.random.Generator) -> Drawn:
    effect = plan.effects[0]
    designs = _MANY_RATES if effect == "fifth_power" else _DESIGNS
    # all have a temperature log: without one its kin has no numbers
    design, campaign = any_campaign(plan.name, rng, 1.0, designs)
    entry = draw_entry(effect, campaign, rng, protocol.wobble_most)
    if effect == "slow_step":
        entry = replace(entry, runs=(campaign.runs[int(rng.integers(len(campaign.runs)))].run_id,))
    world = realistic_world(campaign, (entry,), int(rng.integers(1 << 62)), protocol.noise_level_rel)

    def kept(trial: Entry) -> float:
        known = appraise(replace(world, entries=(trial,)), frozenset(NAMES), healthy(protocol))
        return float(known["effects"][0]["best_rival"])

    found = met(entry, _KEEPS, kept)
    return Drawn(design, replace(world, entries=(found,)), seen=kept(found) > 0.5 * _KEEPS)


NEAR_SHAPES = CampaignClass(
    "Near but not of the catalogue, keeping SNR 15", _draw, tuple(((name,), _KEEPS) for name in NEAR)
)
