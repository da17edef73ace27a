"""The cases of a study: which effects, in which campaign, and how large."""

from typing import Any

import numpy as np

from withheld.chain.injector import realistic_world
from withheld.clairvoyant.appraisal import appraise
from withheld.effects import catalogue, strangers
from withheld.streams import stream
from withheld.study.amplitudes import healthy, scaled
from withheld.study.classes import CLASSES
from withheld.study.designs import any_campaign
from withheld.study.draws import draw_entry
from withheld.study.laws import LAWS
from withheld.study.plan import Drawn, Plan
from withheld.study.protocol import Protocol

TRIES = 6


def _spread(names: tuple[str, ...], each: int, total: int, rng: np.random.Generator) -> list[str]:
    """Each name `each` times; or, where `total` is not 0, that many different ones."""
    if total:
        return [str(name) for name in rng.permutation(np.array(names))[:total]]
    return [name for name in names for _ in range(each)]


def plans(protocol: Protocol) -> list[Plan]:
    """All cases of a study, in an order and under names that say nothing."""
    rng = stream(protocol.seed, protocol.domain, "plan")
    drawn: list[tuple[str, tuple[str, ...]]] = [("nothing", ())] * protocol.nothing_wrong
    total = protocol.singles_total
    drawn += [("single", (e,)) for e in _spread(catalogue.NAMES, protocol.singles_each, total, rng)]
    drawn += [("without", (e,)) for e in _spread(catalogue.NAMES, protocol.without_each, total, rng)]
    drawn += [("stranger", (e,)) for e in _spread(strangers.NAMES, protocol.strangers_each, total, rng)]
    # wiring faults are so large that nothing beside them could be judged
    quiet = [e for e in catalogue.NAMES if LAWS[e].main]
    for kind, size, number in (("pair", 2, protocol.pairs), ("triple", 3, protocol.triples)):
        for _ in range(number):
            drawn.append((kind, tuple(str(e) for e in rng.choice(quiet, size, replace=False))))
    planned = [(kind, effects, 0.0) for kind, effects in drawn]
    for kind, campaigns in protocol.classes.items():
        own = stream(protocol.seed, protocol.domain, "plan", kind)
        planned += [(kind, *cell) for cell in CLASSES[kind].spread(campaigns, own)]
    out = []
    for number, place in enumerate(rng.permutation(len(planned)).tolist(), start=1):
        kind, effects, target = planned[place]
        innocent = [e for e in catalogue.NAMES if e not in effects]
        decoy = (str(rng.choice(innocent)),) if rng.random() < protocol.decoy_share else ()
        # what a class will hold is drawn later, and a decoy has to be innocent
        spare = () if kind in CLASSES else decoy
        without = effects if kind == "without" else spare
        out.append(Plan(f"case-{number:04d}", kind, effects, without, target))
    return out


def _targets(protocol: Protocol, kind: str, number: int, rng: np.random.Generator) -> list[float]:
    """Target signal-to-noise ratios: even in the logarithm; less faint where there are several."""
    low = protocol.snr_low if kind not in ("pair", "triple") else 3.0 * protocol.snr_low
    return [float(np.exp(rng.uniform(np.log(low), np.log(protocol.snr_high)))) for _ in range(number)]


def _draw(protocol: Protocol, plan: Plan, rng: np.random.Generator) -> Drawn:
    """Nothing wrong, one, two or three effects, or one outside the catalogue."""
    design, campaign = any_campaign(plan.name, rng, protocol.temperature_share)
    entries = tuple(draw_entry(effect, campaign, rng, protocol.wobble_most) for effect in plan.effects)
    world = realistic_world(campaign, entries, int(rng.integers(1 << 62)), protocol.noise_level_rel)
    if not entries:
        return Drawn(design, world)
    world, seen = scaled(world, _targets(protocol, plan.kind, len(entries), rng), protocol)
    return Drawn(design, world, seen=seen)


def draw_case(protocol: Protocol, plan: Plan) -> Drawn:
    """A campaign for the plan, with amplitudes that meet the targets drawn.

    Where the design cannot show an effect at all (a scale factor at a standstill) another design is drawn;
    after six tries the last stands, and its label says how little there is to see.
    """
    draw = CLASSES[plan.kind].draw if plan.kind in CLASSES else _draw
    for attempt in range(TRIES):
        drawn = draw(protocol, plan, stream(protocol.seed, protocol.domain, plan.name, "case", str(attempt)))
        if drawn.seen:
            break
    return drawn


def label(protocol: Protocol, plan: Plan, drawn: Drawn) -> dict[str, Any]:
    """What is sealed: the truth, and what the clairvoyant makes of it."""
    world = drawn.world
    names = frozenset(catalogue.NAMES) - set(plan.without)
    known = appraise(world, names, healthy(protocol))
    roles = drawn.roles or ("",) * len(world.entries)
    effects = [
        {**entry.document(), "block": catalogue.block(entry.effect), "role": role, **appraisal}
        for entry, role, appraisal in zip(world.entries, roles, known.pop("effects"), strict=True)
    ]
    unit = world.campaign.unit
    return {
        "case": plan.name, "kind": plan.kind, "design": drawn.design, "without": list(plan.without),
        "runs": [run.run_id for run in world.campaign.runs], "gyros": unit.n, "target_snr": plan.snr,
        "temperature": world.campaign.runs[0].temperature, "effects": effects, **known,
    }  # fmt: skip
