"""Amplitudes that meet their targets, and departures of shape within the protocol's share of them."""

from dataclasses import replace

from withheld.chain.injector import World
from withheld.clairvoyant.appraisal import effect_snr
from withheld.clairvoyant.blocks import Metric, difference, metric
from withheld.clairvoyant.full_rate import Healthy
from withheld.clairvoyant.separation import snr
from withheld.effects.entry import Entry
from withheld.study.draws import met
from withheld.study.protocol import Protocol


def healthy(protocol: Protocol) -> Healthy:
    """What the protocol allows a healthy unit."""
    return Healthy(protocol.noise_level_rel, protocol.link_fault)


def scaled(world: World, targets: list[float], protocol: Protocol) -> tuple[World, bool]:
    """Every effect's amplitude set to meet its target, and whether each came within half of it.

    Of a target above the protocol's largest, half of that largest is enough: an amplitude has bounds.
    """
    inner, allowed = metric(world), healthy(protocol)
    done: list[Entry] = []
    seen = True
    for entry, target in zip(world.entries, targets, strict=True):

        def snr_of(trial: Entry) -> float:
            return effect_snr(replace(world, entries=(trial,)), inner, trial, allowed)

        calm = calmed(world, inner, met(entry, target, snr_of), target * protocol.departure_most)
        found = met(calm, target, snr_of)
        seen = seen and snr_of(found) > 0.5 * min(target, protocol.snr_high)
        done.append(found)
    return replace(world, entries=tuple(done)), seen


def calmed(world: World, inner: Metric, entry: Entry, most: float) -> Entry:
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


def as_drawn(world: World, protocol: Protocol) -> World:
    """Amplitudes left as they are; only departures of shape are kept within their share."""
    inner, allowed = metric(world), healthy(protocol)

    def share(entry: Entry) -> float:
        return effect_snr(replace(world, entries=(entry,)), inner, entry, allowed) * protocol.departure_most

    return replace(world, entries=tuple(calmed(world, inner, e, share(e)) for e in world.entries))
