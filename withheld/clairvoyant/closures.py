"""The oracle's closures: how far the gap shrinks with the true effects in a simulator.

They are in the catalogue's shape, with their true parameters and the logged temperature.  All closures are
1 - |left|^2 / |gap|^2 in the whitened metric of block means; None where those hold less than SNR 3 of a gap.
"""

from dataclasses import replace

import numpy as np

from withheld.arrays import Array
from withheld.chain.injector import World
from withheld.chain.temperature import Temperature
from withheld.clairvoyant.blocks import Metric, difference
from withheld.clairvoyant.separation import snr

LEAST_SNR = 3.0


def as_known(world: World) -> World:
    """The world as a diagnoser could simulate it at best: the catalogue's shapes, the log's temperature."""
    logged = {
        run: Temperature(heat.time_s, heat.electronics_degC, heat.sensor_degC, heat.sensor_degC)
        for run, heat in world.heat.items()
    }
    return replace(world, heat=logged, entries=tuple(replace(e, departure={}) for e in world.entries))


def oracle_closure(world: World, inner: Metric) -> float | None:
    """The share of the gap that all the true effects close together."""
    gap = inner.white(difference(world, world.entries))
    if snr(inner, gap) < LEAST_SNR:
        return None
    known = as_known(world)
    model = inner.white(difference(known, known.entries))
    return 1.0 - snr(inner, gap - model) ** 2 / snr(inner, gap) ** 2


def closure_gram(world: World, inner: Metric) -> list[list[float]] | None:
    """Inner products of the gap (first) and of what each effect makes alone, over the gap's with itself.

    (1 + effects, 1 + effects).  From them `subset_closure` has the closure of any effects that add.
    """
    gap = inner.white(difference(world, world.entries))
    size = snr(inner, gap) ** 2
    if size < LEAST_SNR**2:
        return None
    known = as_known(world)
    columns = np.stack([gap, *(inner.white(difference(known, (e,))) for e in known.entries)], axis=1)
    return [[float(f"{value:.9g}") for value in row] for row in inner.gram(columns, columns) / size]


def subset_closure(gram: Array, effects: list[int]) -> float:
    """The share that these effects (from 0) close together, from `closure_gram`."""
    chosen = [1 + k for k in effects]
    return float(2.0 * gram[0, chosen].sum() - gram[np.ix_(chosen, chosen)].sum())
