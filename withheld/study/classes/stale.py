"""Stale records: a unit that has aged since it was calibrated, every gyro by an amount of its own.

Sizes are drawn about what units of the class show between calibrations, a year apart: lognormal, so that some
entries stand far clear of the noise and others are lost in it, as on a bench.
"""

from dataclasses import replace

import numpy as np

from withheld.chain.campaign import Campaign
from withheld.chain.injector import realistic_world
from withheld.effects.catalogue import NAMES
from withheld.effects.entry import Entry
from withheld.study.amplitudes import as_drawn, scaled
from withheld.study.classes.model import CampaignClass
from withheld.study.designs import any_campaign
from withheld.study.draws import draw_entry, with_amplitude
from withheld.study.laws import LAWS
from withheld.study.plan import Drawn, Plan
from withheld.study.protocol import Protocol

# Kinds that every gyro has its own of: chance of the kind, median size in the unit of its main parameter.
# Sizes: those of the stale records in which the first diagnosis failed (0.3 to 1.2 deg/h, 150 to 600 ppm, 0.2
# to 0.8 mrad), of fibre-optic gyros of 0.1 to 3 deg/h.
_GYRO_KINDS = {
    "bias_offset": (0.85, 0.6),
    "scale_factor_error": (0.6, 300.0),
    "axis_misalignment": (0.5, 0.4),
    "bias_ramp": (0.25, 4.0),
}
_TEMPERATURE_KINDS = {
    "temperature_bias": (0.6, 0.3),
    "temperature_rate_bias": (0.25, 0.5),
    "temperature_scale_factor": (0.15, 30.0),
}
_TEMPERATURE_CHANCE = 0.35
# What the bench itself is off by: chance, median size.
_BENCH_KINDS = {"heading_error": (0.3, 0.8), "latitude_error": (0.15, 0.15), "mount_rotation": (0.2, 0.5)}
# Standard deviation of a size's logarithm: from half to twice the median, mostly.
_SPREAD = 0.6
# Chance that a gyro has kept its value of a kind.
_SPARED = 0.1
FEWEST, MOST = 4, 25
_DESIGNS = {"eight": 0.62, "eight_slow": 0.08, "eight_static": 0.06, "three": 0.14, "two": 0.1}
_CULPRITS = tuple(
    name
    for name in NAMES
    if LAWS[name].main and name not in {**_GYRO_KINDS, **_TEMPERATURE_KINDS, **_BENCH_KINDS}
)
_CULPRIT_SNR = 15.0


def _kinds(campaign: Campaign, rng: np.random.Generator) -> dict[str, float]:
    """Kinds of ageing and their median sizes."""
    drawn = {**_GYRO_KINDS, **_BENCH_KINDS}
    kinds = {kind: size for kind, (chance, size) in drawn.items() if rng.random() < chance}
    if campaign.runs[0].temperature and rng.random() < _TEMPERATURE_CHANCE:
        chances = np.array([chance for chance, _ in _TEMPERATURE_KINDS.values()])
        kind = str(rng.choice(list(_TEMPERATURE_KINDS), p=chances))
        kinds[kind] = _TEMPERATURE_KINDS[kind][1]
    return kinds


def stale_entries(
    campaign: Campaign, rng: np.random.Generator, wobble_most: float, most: int = MOST
) -> tuple[Entry, ...]:
    """Entries of an aged record, four to `most` of them, drawn again until they are so many."""
    while True:
        entries: list[Entry] = []
        for kind, median in _kinds(campaign, rng).items():
            gyros = range(campaign.unit.n) if LAWS[kind].seat == "gyro" else [None]
            for gyro in gyros:
                if gyro is not None and rng.random() < _SPARED:
                    continue
                size = median * float(np.exp(_SPREAD * rng.standard_normal()))
                entry = draw_entry(kind, campaign, rng, wobble_most, gyro)
                entries.append(with_amplitude(entry, size * float(rng.choice([-1.0, 1.0]))))
        if FEWEST <= len(entries) <= most:
            return tuple(entries)


def _draw_stale(protocol: Protocol, plan: Plan, rng: np.random.Generator) -> Drawn:
    design, campaign = any_campaign(plan.name, rng, protocol.temperature_share, _DESIGNS)
    entries = stale_entries(campaign, rng, protocol.wobble_most)
    world = realistic_world(campaign, entries, int(rng.integers(1 << 62)), protocol.noise_level_rel)
    return Drawn(design, as_drawn(world, protocol), ("stale",) * len(entries))


def _draw_culprit(protocol: Protocol, plan: Plan, rng: np.random.Generator) -> Drawn:
    """A smaller ageing, and beside it one thing that happened to the bench or the unit."""
    design, campaign = any_campaign(plan.name, rng, protocol.temperature_share, _DESIGNS)
    seed = int(rng.integers(1 << 62))
    culprit = draw_entry(plan.effects[0], campaign, rng, protocol.wobble_most)
    alone = realistic_world(campaign, (culprit,), seed, protocol.noise_level_rel)
    alone, seen = scaled(alone, [_CULPRIT_SNR], protocol)
    entries = stale_entries(campaign, rng, protocol.wobble_most, most=12)
    aged = as_drawn(replace(alone, entries=entries), protocol)
    world = replace(aged, entries=(*aged.entries, *alone.entries))
    return Drawn(design, world, ("stale",) * len(entries) + ("culprit",), seen)


STALE = CampaignClass("Stale records", _draw_stale)
STALE_CULPRIT = CampaignClass(
    "Stale record and a culprit at SNR 15",
    _draw_culprit,
    tuple(((name,), _CULPRIT_SNR) for name in _CULPRITS),
)
