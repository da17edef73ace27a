"""The oracle's closures: how far the gap shrinks with the true effects in a simulator.

They are in the catalogue's shape, with their true parameters and the logged temperature.  Of all together it
is 1 - |left|^2 / |gap|^2 in the whitened metric of block means, noise apart; None where those hold less than
SNR 3 of a gap.  Of single effects it is what a diagnosis of these very captures would state with the true
parameters: noise is in the gap, and what only the full rate shows is a part of it.
"""

from dataclasses import replace

import numpy as np

from withheld.arrays import Array
from withheld.chain.campaign import Run
from withheld.chain.injector import World
from withheld.chain.link import struck
from withheld.chain.noise import noise
from withheld.chain.temperature import Temperature
from withheld.chain.truth import nominal
from withheld.clairvoyant.blocks import Metric, block_count, campaign_blocks, difference
from withheld.clairvoyant.full_rate import STATISTICS, Healthy, equal_by_chance
from withheld.clairvoyant.lines import gained_within_blocks
from withheld.clairvoyant.separation import snr
from withheld.effects.entry import Entry, select

LEAST_SNR = 3.0
# They change how far block means may be from their prediction, not the prediction.
PROCESSES = ("bias_instability", "rate_random_walk")
_LINES = ("periodic_interference", "base_motion")
_LINK = ("dropouts", "spikes", "stuck_samples")


def as_known(world: World) -> World:
    """The world as a diagnoser could simulate it at best: the catalogue's shapes, the log's temperature.

    A step that takes its time is a sudden one of the same integral: later by its time constant.
    """
    logged = {
        run: Temperature(heat.time_s, heat.electronics_degC, heat.sensor_degC, heat.sensor_degC)
        for run, heat in world.heat.items()
    }
    return replace(world, heat=logged, entries=tuple(_catalogued(e) for e in world.entries))


def _catalogued(entry: Entry) -> Entry:
    rise = entry.departure.get("rise_s", 0.0)
    parameters = dict(entry.parameters)
    if rise:
        parameters["time_s"] = entry.number("time_s") + rise
    return replace(entry, parameters=parameters, departure={})


def oracle_closure(world: World, inner: Metric) -> float | None:
    """The share of the gap that all the true effects close together."""
    gap = inner.white(difference(world, world.entries))
    if snr(inner, gap) < LEAST_SNR:
        return None
    known = as_known(world)
    model = inner.white(difference(known, known.entries))
    return 1.0 - snr(inner, gap - model) ** 2 / snr(inner, gap) ** 2


def closure_gram(world: World, inner: Metric, healthy: Healthy) -> list[list[float]] | None:
    """Inner products of the gap (first) and of what each effect makes alone, over the gap's with itself.

    (1 + effects, 1 + effects).  From them `subset_closure` has the closure of any effects that add.

    The gap is that of this world's captures, noise in it, along what the effects can make; what noise
    alone would make of it is taken off.  An effect of the full rate adds twice the ln likelihood that it
    gains (`full_rate_gain`) to the gap and to its own product.  None where the gap is below SNR 3, and
    where a further random process is at work: how much it adds to the gap depends on which features of the
    means are looked at.
    """
    if any(e.effect in PROCESSES for e in world.entries):
        return None
    truth = inner.white(difference(world, world.entries))
    known = as_known(world)
    columns = np.stack([truth, *(inner.white(difference(known, (e,))) for e in known.entries)], axis=1)
    measured = inner.white(captured(world))
    gram = inner.gram(columns, columns)
    along = inner.gram(columns, measured[:, None])[:, 0]
    gains = [full_rate_gain(world, entry, healthy) for entry in world.entries]
    size = _before(gram, along, world.noisy) + sum(gains)
    if size < LEAST_SNR**2:
        return None
    out = np.empty_like(gram)
    out[1:, 1:] = gram[1:, 1:] + np.diag(gains)
    out[0, 1:] = out[1:, 0] = along[1:] + gains
    out[0, 0] = size
    return [[float(f"{value:.9g}") for value in row] for row in out / size]


def subset_closure(gram: Array, effects: list[int]) -> float:
    """The share that these effects (from 0) close together, from `closure_gram`."""
    chosen = [1 + k for k in effects]
    return float(2.0 * gram[0, chosen].sum() - gram[np.ix_(chosen, chosen)].sum())


def _before(gram: Array, along: Array, noisy: bool) -> float:
    """Squared deviates of the gap over the span of columns, less what noise alone makes of them."""
    size = np.sqrt(np.maximum(np.diag(gram), 1e-300))
    values, vectors = np.linalg.eigh(gram / np.outer(size, size))
    kept = values > 1e-8 * values[-1]
    squares = (vectors[:, kept].T @ (along / size)) ** 2 / values[kept]
    return float(squares.sum() - noisy * kept.sum())


def captured(world: World) -> list[Array]:
    """Block means of the captures less their prediction from record and metadata: each run (blocks, n)
    [deg/h].
    """
    campaign = world.campaign
    predicted = campaign_blocks(replace(world, truth=nominal(campaign), entries=()))
    out = [a - b for a, b in zip(campaign_blocks(world), predicted, strict=True)]
    if not world.noisy:
        return out
    return [change + _noise_blocks(world, run) for run, change in zip(campaign.runs, out, strict=True)]


def _noise_blocks(world: World, run: Run) -> Array:
    """Block means of a run's noise, (blocks, n) [deg/h]."""
    campaign = world.campaign
    blocks, length = block_count(run)
    samples = noise(run, campaign.unit, world.truth, world.entries, world.seed, campaign.name)
    block = (np.arange(run.samples) / run.sample_rate_hz / length + 1e-9).astype(int)
    starts = np.searchsorted(block, np.arange(blocks + 1))
    sums = np.cumsum(np.vstack([np.zeros(samples.shape[1]), samples]), axis=0)
    count = np.maximum(np.diff(starts), 1)[:, None]
    result: Array = (sums[starts[1:]] - sums[starts[:-1]]) / count * 3600.0
    return result


def full_rate_gain(world: World, entry: Entry, healthy: Healthy) -> float:
    """Twice the ln likelihood that an effect's true parameters gain beyond block means.

    Lines and link faults: of this world's samples.  Other statistics of the full rate: as expected; they come
    from so many samples that chance hardly moves them.  0 for what block means show.
    """
    if entry.effect in _LINES:
        return gained_within_blocks(world, entry)
    if entry.effect in _LINK:
        return _link_gain(world, entry, healthy)
    return STATISTICS[entry.effect](world, entry, healthy) ** 2 if entry.effect in STATISTICS else 0.0


def _link_gain(world: World, entry: Entry, healthy: Healthy) -> float:
    """Of a share of readings struck, by the readings that were struck."""
    total, share = 0.0, entry.number("fraction")
    for run in world.campaign.runs:
        mine = select(world.entries, run.run_id, entry.effect)
        if entry not in mine:
            continue
        for i in entry.gyros():
            hits, _ = struck(run, entry, mine.index(entry), i, run.samples, world.seed, world.campaign.name)
            chance = healthy.link_fault
            if entry.effect == "stuck_samples":
                chance = equal_by_chance(world.campaign.unit, run, i)
            struck_or_alike = share + (1.0 - share) * chance
            found = hits.sum() + (run.samples - hits.sum()) * chance * (entry.effect == "stuck_samples")
            total += found * np.log(struck_or_alike / chance)
            total += (run.samples - found) * np.log((1.0 - struck_or_alike) / (1.0 - chance))
    return float(2.0 * total)
