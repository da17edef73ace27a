"""Shapes of the unknown that have a number of their own: steps, slow recoveries, after-effects, sawteeth.

Each function gives columns over a run's blocks, (blocks, J, k): J points of a grid, k columns at each.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fogreduce.diagnosis.observe.blocks import Blocks

Array = NDArray[np.float64]

_RECOVERIES_S = np.geomspace(2.0, 200.0, 9)
_MEMORIES_S = np.geomspace(5.0, 600.0, 8)
_FEW, _MANY = np.arange(2.0, 12.0, 0.125), np.arange(12.0, 24.0, 0.25)


def recoveries(blocks: Blocks) -> Array:
    """What dies away more slowly than an exponential: ``1 / (1 + t / tau)`` and ``exp(-sqrt(t / tau))``."""
    x = blocks.centre_s[:, None] / _RECOVERIES_S
    return np.concatenate([1.0 / (1.0 + x), np.exp(-np.sqrt(x))], axis=1)[:, :, None]


def memories(blocks: Blocks) -> Array:
    """Averages over the past, with one tau after another: (J, blocks, blocks)."""
    lag = blocks.centre_s[:, None] - blocks.centre_s
    past = lag > 0.5 * blocks.length_s
    out = np.zeros((len(_MEMORIES_S), blocks.count, blocks.count))
    for weight, tau in zip(out, _MEMORIES_S.tolist(), strict=True):
        keep = np.exp(-blocks.length_s / tau)
        within = (1.0 - keep) * tau / blocks.length_s  # what a block's mean keeps of what it starts with
        weight[past] = np.exp(-lag[past] / tau) * within * (1.0 - keep) / keep
        np.fill_diagonal(weight, 1.0 - within)
    return out


def after_effects(kernels: Array, cause: Array) -> Array:
    """What follows the past of a cause (blocks,), rest before t = 0; `kernels`: of `memories`."""
    result: Array = (kernels @ cause).T[:, :, None]
    return result


def sawteeth(blocks: Blocks, longest_s: float, coarsest_s: float) -> Array:
    """What creeps up and falls back at regular intervals from the run's start on.

    `longest_s`: of all runs; `coarsest_s`: the longest block of any.
    """
    cycles = np.concatenate([_FEW, _MANY])
    cycles = cycles[cycles < max(longest_s / (4.0 * coarsest_s), 3.0)]
    turns = np.outer(blocks.centre_s / longest_s, cycles)
    half = 0.5 * blocks.length_s / longest_s * cycles
    # the mean over a block that holds the fall: of the two parts' integrals
    return (_risen(turns + half) - _risen(turns - half))[:, :, None] / (2.0 * half)[None, :, None]


def _risen(turns: Array) -> Array:
    """Integral of ``x mod 1 - 1/2``."""
    part = turns % 1.0
    result: Array = 0.5 * part * (part - 1.0)
    return result


def steps(matrix: Array) -> Array:
    """Unit steps at each block's start but the first, whitened by a filter (blocks, blocks)."""
    return np.cumsum(matrix[:, ::-1], axis=1)[:, ::-1][:, 1:, None]
