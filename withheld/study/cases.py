"""The cases of a study: which effects, in which campaign, and how large."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from withheld.chain.injector import World, realistic_world
from withheld.clairvoyant.appraisal import appraise, effect_snr
from withheld.clairvoyant.blocks import Metric, difference, metric
from withheld.clairvoyant.full_rate import Healthy
from withheld.clairvoyant.separation import snr
from withheld.effects import catalogue, strangers
from withheld.effects.entry import Entry
from withheld.streams import stream
from withheld.study.designs import DESIGNS, draw_campaign
from withheld.study.draws import draw_entry, met
from withheld.study.laws import LAWS
from withheld.study.protocol import Protocol

TRIES = 6


@dataclass(frozen=True)
class Plan:
    """A case before anything is drawn for it.  `without`: effects that the diagnoser is told to leave out."""

    name: str
    kind: str
    effects: tuple[str, ...]
    without: tuple[str, ...]


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
    out = []
    for number, place in enumerate(rng.permutation(len(drawn)).tolist(), start=1):
        kind, effects = drawn[place]
        innocent = [e for e in catalogue.NAMES if e not in effects]
        decoy = (str(rng.choice(innocent)),) if rng.random() < protocol.decoy_share else ()
        without = effects if kind == "without" else decoy
        out.append(Plan(f"case-{number:04d}", kind, effects, without))
    return out


@dataclass(frozen=True)
class Case:
    """A case with everything drawn: its world and the design it came from."""

    plan: Plan
    design: str
    world: World


def _targets(protocol: Protocol, kind: str, number: int, rng: np.random.Generator) -> list[float]:
    """Target signal-to-noise ratios: even in the logarithm; less faint where there are several."""
    low = protocol.snr_low if kind not in ("pair", "triple") else 3.0 * protocol.snr_low
    return [float(np.exp(rng.uniform(np.log(low), np.log(protocol.snr_high)))) for _ in range(number)]


def healthy(protocol: Protocol) -> Healthy:
    """What the protocol allows a healthy unit."""
    return Healthy(protocol.noise_level_rel, protocol.link_fault)


def draw_case(protocol: Protocol, plan: Plan) -> Case:
    """A campaign for the plan, with amplitudes that meet the targets drawn.

    Where the design cannot show an effect at all (a scale factor at a standstill) another design is drawn;
    after six tries the last stands, and its label says how little there is to see.
    """
    for attempt in range(TRIES):
        rng = stream(protocol.seed, protocol.domain, plan.name, "case", str(attempt))
        names = list(DESIGNS)
        design = str(rng.choice(names, p=np.array(list(DESIGNS.values()))))
        gyros = int(rng.choice([4, 3, 6], p=[0.7, 0.15, 0.15]))
        campaign = draw_campaign(
            plan.name, design, gyros, rng, bool(rng.random() < protocol.temperature_share)
        )
        entries = tuple(draw_entry(effect, campaign, rng, protocol.wobble_most) for effect in plan.effects)
        seed = int(rng.integers(1 << 62))
        world = realistic_world(campaign, entries, seed, protocol.noise_level_rel)
        if not entries:
            return Case(plan, design, world)
        world, seen = _scaled(world, _targets(protocol, plan.kind, len(entries), rng), protocol)
        if seen:
            break
    return Case(plan, design, world)


def _scaled(world: World, targets: list[float], protocol: Protocol) -> tuple[World, bool]:
    """Every effect's amplitude set to meet its target, and whether each came within half of it."""
    inner, allowed = metric(world), healthy(protocol)
    done: list[Entry] = []
    seen = True
    for entry, target in zip(world.entries, targets, strict=True):

        def snr_of(trial: Entry) -> float:
            return effect_snr(replace(world, entries=(trial,)), inner, trial, allowed)

        calm = _calmed(world, inner, met(entry, target, snr_of), target * protocol.departure_most)
        found = met(calm, target, snr_of)
        seen = seen and snr_of(found) > 0.5 * target
        done.append(found)
    return replace(world, entries=tuple(done)), seen


def _calmed(world: World, inner: Metric, entry: Entry, most: float) -> Entry:
    """The entry with its wobble reduced where that alone would show with more than SNR `most`."""
    wobble = entry.departure.get("wobble", 0.0)
    if wobble == 0.0:
        return entry
    steady = replace(entry, departure={**entry.departure, "wobble": 0.0})
    change = difference(world, (entry,)), difference(world, (steady,))
    size = snr(inner, inner.white([a - b for a, b in zip(*change, strict=True)]))
    if size <= most:
        return entry
    return replace(entry, departure={**entry.departure, "wobble": round(wobble * most / size, 7)})


def label(protocol: Protocol, case: Case) -> dict[str, Any]:
    """What is sealed: the truth, and what the clairvoyant makes of it."""
    world, plan = case.world, case.plan
    names = frozenset(catalogue.NAMES) - set(plan.without)
    known = appraise(world, names, healthy(protocol))
    effects = [
        {**entry.document(), "block": catalogue.block(entry.effect), **appraisal}
        for entry, appraisal in zip(world.entries, known.pop("effects"), strict=True)
    ]
    unit = world.campaign.unit
    return {
        "case": plan.name, "kind": plan.kind, "design": case.design, "without": list(plan.without),
        "runs": [run.run_id for run in world.campaign.runs], "gyros": unit.n,
        "temperature": world.campaign.runs[0].temperature, "effects": effects, **known,
    }  # fmt: skip
