"""Families of the unknown that a true rotation would show: the same motion at every gyro."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from fogreduce.diagnosis.inference.candidate import Candidate
from fogreduce.diagnosis.inference.family import HARMONICS, family, lessened, modes, waves_of_angle
from fogreduce.diagnosis.inference.noise_model import Whitener
from fogreduce.diagnosis.observe.capture import RunInput
from fogreduce.physics.frames import across, turn_about_axis

Array = NDArray[np.float64]

_TREND = 4
_AFTER = 4  # blocks in which a jump of the rate may show


def of_table(inputs: Sequence[RunInput], whiten: Whitener, allowed: frozenset[str]) -> Iterator[Candidate]:
    """All of them; parameters as of `fogreduce.diagnosis.which.unknown.families.families`."""
    rows, table, everything = whiten.rows, ("table",), slice(0, whiten.rows.total)

    def rotation(shapes: Sequence[Array], direction: Sequence[Array]) -> Array:
        """What rotations about `direction` (3,) in each run, with shapes (blocks, k), do to all rows."""
        parts = []
        for i in range(rows.n):
            for one, shape, u in zip(inputs, shapes, direction, strict=True):
                parts.append(shape * float(one.facts.axes[i] @ (one.facts.frame_signs * u)))
        return whiten(np.concatenate(parts))

    axes = [one.facts.table_axis for one in inputs]
    counts = rows.counts
    rates = [
        one.scene.blocks.means(one.facts.profile.rate_at(one.scene.blocks.time_s))[:, None] for one in inputs
    ]
    if any(np.any(r) for r in rates):
        prior_share = lessened("table_rate_error", allowed)
        yield family(table, everything, rotation(rates, axes)[:, None, :], "rate", "table", share=prior_share)
        # what happens where the rate jumps, and just after
        edges = rotation([_edges(one) for one in inputs], axes)
        prior_share = lessened("start_offset", allowed)
        yield family(table, everything, edges[:, None, :], "rate", "table", share=prior_share)
        # a table's axis that is tipped, the same way in every run
        tips = [rotation(rates, [np.cross(np.eye(3)[k], axis) for axis in axes]) for k in range(3)]
        prior_share = lessened("mount_rotation", allowed)
        yield family(table, everything, np.column_stack(tips)[:, None, :], "rate", "table", share=prior_share)
        waves = [
            waves_of_angle(one, bool(np.any(one.facts.profile.rate_deg_s != 0.0))) * np.sign(r.sum() or 1.0)
            for one, r in zip(inputs, rates, strict=True)
        ]
        about = rotation(waves, axes)
        across = [rotation(waves, [_across(one, k) for one in inputs]) for k in range(2)]
        for j, harmonic in enumerate(HARMONICS):
            pair = slice(2 * j, 2 * j + 2)
            share = 3.0 / len(HARMONICS)
            yield family(
                table, everything, about[:, pair][:, None, :], f"harmonic_{harmonic}", "table", share=share
            )
            both = np.column_stack([a[:, pair] for a in across])[:, None, :]
            yield family(table, everything, both, f"harmonic_{harmonic}", "table", share=share)
    for r in range(len(inputs)):
        alone = [np.ones((c, 1)) * float(k == r) for k, c in enumerate(counts)]
        steady = np.column_stack([rotation(alone, [np.eye(3)[k]] * len(inputs)) for k in range(3)])
        run = (inputs[r].facts.run_id,)
        yield family(table, everything, steady[:, None, :], "mean", "table", run, 1.0 / len(inputs))
    steady = np.column_stack(
        [rotation([np.ones((c, 1)) for c in counts], [np.eye(3)[k]] * len(inputs)) for k in range(3)]
    )
    yield family(table, everything, steady[:, None, :], "mean", "table")
    fixed = np.column_stack([_fixed_in_room(inputs, np.eye(3)[k], rows.n) for k in range(3)])
    prior_share = 0.5 * (lessened("latitude_error", allowed) + lessened("heading_error", allowed))
    yield family(table, everything, whiten(fixed)[:, None, :], "mean", "table", share=prior_share)
    drifting = rotation([modes(c, 1, _TREND) for c in counts], axes)
    yield family(table, everything, drifting[:, None, :], "drift", "table")


def _edges(one: RunInput) -> Array:
    """The jumps of the table's rate, each in its block and in the next ones, (blocks, _AFTER)."""
    profile, blocks = one.facts.profile, one.scene.blocks
    shape = np.zeros((blocks.count, _AFTER))
    for edge in np.unique(np.append(profile.edges_s, 0.0)).tolist():
        beside = np.array([edge - 1e-6, edge + 1e-6])
        before, after = profile.rate_at(beside).tolist()
        jump = after - (before if edge > 0.0 else 0.0)
        first = int(edge / blocks.length_s + 1e-9)
        for j in range(min(_AFTER, blocks.count - first)):
            shape[first + j, j] += jump
    return shape


def _fixed_in_room(inputs: Sequence[RunInput], enu: Array, n: int) -> Array:
    """What a rotation fixed in the room, along `enu` (3,), does to all rows, (rows,)."""
    parts: list[list[Array]] = [[] for _ in range(n)]
    for one in inputs:
        facts, blocks = one.facts, one.scene.blocks
        split = turn_about_axis(facts.table_axis, facts.unit_from_enu @ enu)
        alpha = facts.profile.angle_at(blocks.time_s.copy())
        turning = blocks.means(np.array([np.ones_like(alpha), np.cos(alpha), np.sin(alpha)]))
        for i in range(n):
            seen = facts.axes[i] * facts.frame_signs
            parts[i].append(sum(float(seen @ v) * shape for v, shape in zip(split, turning, strict=True)))
    return np.concatenate([part for gyro in parts for part in gyro])


def _across(one: RunInput, k: int) -> Array:
    """One of two directions at right angles to the table's axis: Earth's horizontal part shows there."""
    return across(one.facts.table_axis)[k]
