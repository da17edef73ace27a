"""Strong: each effect of the catalogue, alone, far above the noise.

What is an idealisation at SNR 10 is a waveform at SNR 1000.  Half the campaigns have the catalogue's shape
to the letter, half depart from it as those of other classes do.  Effects without an amplitude are as large
as they are.
"""

from dataclasses import replace

import numpy as np

from withheld.chain.injector import realistic_world
from withheld.effects.catalogue import NAMES
from withheld.study.amplitudes import scaled
from withheld.study.classes.model import CampaignClass
from withheld.study.designs import DESIGNS, SHORT_AND_LONG, any_campaign
from withheld.study.draws import draw_entry
from withheld.study.plan import Drawn, Plan
from withheld.study.protocol import Protocol

LEVELS = (50.0, 200.0, 1000.0)
_LEFT = 1.0 - sum(SHORT_AND_LONG.values())
_DESIGNS = {**{design: _LEFT * share for design, share in DESIGNS.items()}, **SHORT_AND_LONG}


def _draw(protocol: Protocol, plan: Plan, rng: np.random.Generator) -> Drawn:
    exact = bool(rng.random() < 0.5)
    design, campaign = any_campaign(plan.name, rng, protocol.temperature_share, _DESIGNS)
    entry = draw_entry(plan.effects[0], campaign, rng, protocol.wobble_most)
    if exact:
        entry = replace(entry, departure={})
    world = realistic_world(campaign, (entry,), int(rng.integers(1 << 62)), protocol.noise_level_rel)
    world, seen = scaled(world, [plan.snr], protocol)
    return Drawn(design, world, seen=seen)


STRONG = CampaignClass("Strong", _draw, tuple(((name,), level) for name in NAMES for level in LEVELS))
