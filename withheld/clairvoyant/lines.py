"""The part of a waveform that block means do not hold: within blocks, where white noise is all there is.

The block means and the departures from them are independent under white noise, so that SNR^2 and
separations^2 of the two parts add.  (Flicker and random walk within a second are far below the white noise.)
"""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from withheld.arrays import Array
from withheld.chain.campaign import Run
from withheld.chain.electronics import interference
from withheld.chain.injector import World
from withheld.chain.noise import noise
from withheld.chain.readings import readings
from withheld.clairvoyant.blocks import block_count
from withheld.effects.entry import Entry

FAST = (
    "periodic_interference", "base_motion", "latency", "start_offset", "line_intermodulation",
    "encoder_ripple_bias", "glitch_train", "table_rate_ripple",
)  # fmt: skip


def _full(world: World, run: Run, t: Array) -> Array:
    m = readings(run, world.campaign.unit, world.truth, world.entries, world.heat[run.run_id], t)
    return m + interference(run, world.campaign.unit, world.entries, t)


def within_blocks(world: World, entry: Entry) -> Array:
    """SNR^2 of what the effect does within blocks, by gyro, (n,)."""
    total = np.zeros(world.campaign.unit.n)
    for run, rest in _within(world, entry):
        total += np.sum(rest**2, axis=(0, 1)) / world.campaign.unit.white_deg_s(run.sample_rate_hz) ** 2
    return total


def gained_within_blocks(world: World, entry: Entry) -> float:
    """How much of the squared deviates of this world's samples the effect takes away within blocks.

    With the samples' noise n and what the effect does c: |c + n|^2 - |n|^2, in standard deviations.
    """
    campaign, total = world.campaign, 0.0
    for run, rest in _within(world, entry):
        blocks, per, n = rest.shape
        part = rest
        if world.noisy:
            whole = noise(run, campaign.unit, world.truth, world.entries, world.seed, campaign.name)
            part = rest + 2.0 * whole[: blocks * per].reshape(blocks, per, n)
        total += float(np.sum(rest * part / campaign.unit.white_deg_s(run.sample_rate_hz) ** 2))
    return total


def _within(world: World, entry: Entry) -> Iterator[tuple[Run, Array]]:
    """Of each run, what the effect does less its blocks' means, (blocks, samples, n) [deg/s]."""
    for run in world.campaign.runs:
        if not entry.acts_in(run.run_id):
            continue
        blocks, length = block_count(run)
        per = int(length * run.sample_rate_hz)
        if per < 2:
            continue
        t = np.arange(blocks * per) / run.sample_rate_hz
        change = _full(replace(world, entries=(entry,)), run, t) - _full(replace(world, entries=()), run, t)
        parts = change.reshape(blocks, per, world.campaign.unit.n)
        yield run, parts - parts.mean(axis=1, keepdims=True)


def motion_share(world: World, weights: Array) -> float:
    """The share of a line's SNR^2 that a motion of the base about some axis could imitate.

    Parameters
    ----------
    world : World
        For the gyros' axes and noise.
    weights : (n,)
        The line's SNR^2 by gyro.  As whitened amplitudes it is projected onto the columns of G / sigma.
    """
    unit = world.campaign.unit
    reach = unit.axes / unit.white_deg_s(1.0)[:, None]
    line = np.sqrt(weights)
    if not line.any():
        return 0.0
    found, *_ = np.linalg.lstsq(reach, line, rcond=None)
    return float(1.0 - np.sum((line - reach @ found) ** 2) / np.sum(line**2))
