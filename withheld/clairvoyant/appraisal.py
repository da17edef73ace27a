"""Everything the clairvoyant knows about one campaign: what each score will stand beside."""

from typing import Any

import numpy as np

from withheld.arrays import Array
from withheld.chain.injector import World
from withheld.clairvoyant.blocks import Metric, difference, metric
from withheld.clairvoyant.closures import as_known, closure_gram, oracle_closure
from withheld.clairvoyant.exchange import linear_columns
from withheld.clairvoyant.full_rate import STATISTICS, Healthy, level_free, process_separation
from withheld.clairvoyant.lines import FAST, motion_share, within_blocks
from withheld.clairvoyant.rivals import EVERY, Key, Rival, slow_rivals
from withheld.clairvoyant.separation import left_by, separations, snr
from withheld.effects.entry import Entry

# A label lists rivals up to this separation; groups are judged well below it.
KEPT_BELOW = 12.0
# From so many effects on a label keeps what sets of causes can do in place of the true set.
SEVERAL = 4
# These change means too, so that block means tell about them.
_BOTH = ("low_pass",)


def _others(world: World, entry: Entry) -> tuple[Entry, ...]:
    return tuple(other for other in world.entries if other is not entry)


def _slow_part(world: World, inner: Metric, entry: Entry) -> Array:
    """Whitened difference of block means that the entry makes beside the others, (rows,)."""
    if entry.effect in STATISTICS and entry.effect not in _BOTH:
        return np.zeros(inner.nuisances.shape[0])
    return inner.white(difference(world, (entry,), _others(world, entry)))


def _fast_part(world: World, entry: Entry, healthy: Healthy) -> tuple[float, Array]:
    """SNR^2 beyond block means: of the full-rate statistic, and within blocks by gyro (n,)."""
    found = STATISTICS[entry.effect](world, entry, healthy) ** 2 if entry.effect in STATISTICS else 0.0
    weights = within_blocks(world, entry) if entry.effect in FAST else np.zeros(world.campaign.unit.n)
    return found, weights


def effect_snr(world: World, inner: Metric, entry: Entry, healthy: Healthy) -> float:
    """The signal-to-noise ratio of one effect beside the campaign's others."""
    statistic, weights = _fast_part(world, entry, healthy)
    return float(np.sqrt(snr(inner, _slow_part(world, inner, entry)) ** 2 + statistic + weights.sum()))


def _imitated_within(
    world: World, entry: Entry, weights: Array, slow: dict[Key, float], slow_snr: float
) -> dict[Key, float]:
    """How much of the SNR^2 within blocks each rival could imitate.

    A rival that imitates a share of the block means is taken to imitate the same share of what lies inside
    the blocks.  Lines too fast for block means are treated by themselves: a motion of the base has three free
    components, a line on one gyro is one amplitude, and one line is 1 / 2.72 of an intermodulation's four.
    """
    total = float(weights.sum())
    if slow_snr > 3.0:
        return {key: total * max(1.0 - (d / slow_snr) ** 2, 0.0) for key, d in slow.items()}
    lines: dict[Key, float] = {
        ("periodic_interference", (f"gyro{i + 1}",), EVERY): float(weight) for i, weight in enumerate(weights)
    }
    if entry.effect == "periodic_interference":
        lines[("base_motion", ("table",), EVERY)] = total * motion_share(world, weights)
        return lines
    if entry.effect == "base_motion":
        return lines
    if entry.effect == "line_intermodulation":
        return {key: weight / 2.72 for key, weight in lines.items()}
    return {}


def _rival_distances(
    world: World, entry: Entry, slow_snr: float, slow: dict[Key, float], healthy: Healthy
) -> tuple[float, dict[Key, float]]:
    """SNR, and separations of rivals: on block means, as given, and beyond them together."""
    statistic, weights = _fast_part(world, entry, healthy)
    own: Key = (entry.effect, entry.channels, entry.runs)
    within = _imitated_within(world, entry, weights, slow, slow_snr) if weights.any() else {}
    fast = statistic + float(weights.sum())
    distances = {
        key: float(np.sqrt(max(slow.get(key, slow_snr) ** 2 + fast - within.get(key, 0.0), 0.0)))
        for key in slow.keys() | within.keys()
        if key != own
    }
    processes = ("bias_instability", "rate_random_walk")
    if entry.effect in processes:
        rival = processes[1 - processes.index(entry.effect)]
        distances[(rival, entry.channels, EVERY)] = process_separation(world, entry, rival)
    if entry.effect in ("low_pass", "band_limited_noise"):
        left = np.hypot(level_free(world, entry), slow_snr)
        distances[("angle_random_walk", entry.channels, EVERY)] = float(left)
    return float(np.sqrt(slow_snr**2 + fast)), distances


def _spans(truths: Array, keys: list[Key], rivals: list[Rival]) -> list[Array]:
    """For each effect the whitened columns that it can make at its place, (rows, k).

    Of one that is linear in its parameters all (an axis tips in any direction), of another the difference
    that it does make.
    """
    linear = [[r.columns for r in rivals if r.key == key and not r.fixed] for key in keys]
    return [
        found[0] if len(found) == 1 else truth[:, None] for truth, found in zip(truths.T, linear, strict=True)
    ]


def _others_of(spans: list[Array], number: int) -> Array | None:
    """Columns of the campaign's other effects, (rows, k); None where block means show none."""
    seen = [span for k, span in enumerate(spans) if k != number and span.any()]
    return np.concatenate(seen, axis=1) if seen else None


def appraise(world: World, catalogue: frozenset[str], healthy: Healthy) -> dict[str, Any]:
    """For each effect its SNR, its rivals' separations, the nearest first."""
    if not world.entries:
        nothing = ("oracle_closure", "closure_gram", "linear")
        return {"effects": [], "slow_snr": 0.0, **dict.fromkeys(nothing)}
    inner = metric(world)
    rivals = slow_rivals(world, inner, catalogue)
    keys: list[Key] = [(e.effect, e.channels, e.runs) for e in world.entries]
    truths = np.stack([_slow_part(world, inner, entry) for entry in world.entries], axis=1)
    spans = _spans(truths, keys, rivals)
    near = separations(inner, truths, keys, rivals, spans)
    effects: list[dict[str, Any]] = []
    for number, entry in enumerate(world.entries):
        truth, others = truths[:, number], _others_of(spans, number)
        slow_snr = snr(inner, truth)
        total, distances = _rival_distances(
            world, entry, slow_snr, near[number] if slow_snr > 0.5 else {}, healthy
        )
        alone = slow_snr if others is None else left_by(inner, truth, others)
        fast = np.sqrt(max(total**2 - slow_snr**2, 0.0))
        listed = sorted(((k, d) for k, d in distances.items() if k[0] in catalogue), key=lambda item: item[1])
        effects.append(
            {
                "snr": total,
                "best_rival": min([float(np.hypot(alone, fast)), *(d for _, d in listed[:1])]),
                "nearest": _named(listed[0][0]) if listed else None,
                "rivals": [{**_named(key), "separation": d} for key, d in listed if d < KEPT_BELOW],
                "attainable_std": _attainable(world, entry, alone),
            }
        )
    whole, known = inner.white(difference(world, world.entries)), as_known(world)
    model = inner.white(difference(known, known.entries))
    several = len(world.entries) >= SEVERAL
    return {
        "effects": effects, "slow_snr": snr(inner, whole), "oracle_closure": oracle_closure(world, inner),
        "closure_gram": closure_gram(world, inner, healthy),
        "linear": linear_columns(inner, model, truths, keys, rivals) if several else None,
    }  # fmt: skip


def _named(key: Key) -> dict[str, Any]:
    return {"effect": key[0], "channels": list(key[1]), "runs": list(key[2])}


def _attainable(world: World, entry: Entry, alone: float) -> float | None:
    """Relative standard deviation that the best estimate of the amplitude could have, others profiled out.

    1 / SNR for an effect whose amplitude shifts means in proportion; None for the rest.  `alone`: what the
    campaign's other effects leave of it in block means.
    """
    if entry.effect in STATISTICS:
        return None
    kept = float(np.hypot(alone, np.sqrt(within_blocks(world, entry).sum() if entry.effect in FAST else 0.0)))
    return 1.0 / kept if kept > 0.0 else None
