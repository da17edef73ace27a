"""Families of the unknown: low-dimensional features of a residual that need no cause.

They say where a gap lies, they are what a remainder is tested with, and they compete with the catalogue for
what
it cannot explain. Each is a gyro's own doing, or what a true rotation would do to all gyros alike.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from fogreduce.constants import SECONDS_PER_HOUR
from fogreduce.effects.at import slope_around
from fogreduce.effects.gyro_names import gyro_name
from fogreduce.gap.candidates import EVERY, Candidate
from fogreduce.gap.capture import RunInput
from fogreduce.gap.noise_model import Whitener

Array = NDArray[np.float64]

HARMONICS = tuple(range(1, 17))
_MODES = 10
_TREND = 4
_MOST_CYCLES = 31.0  # periods that come again from the run's start, at most so many in a run
_DOUBLE = 0.05  # prior of a family that an effect of the catalogue does already
_POWERS = ("scale_factor_error", "scale_factor_asymmetry", "", "scale_factor_nonlinearity")
_HEATS = ("temperature_bias", "", "temperature_rate_bias", "temperature_scale_factor")


def families(
    inputs: Sequence[RunInput], whiten: Whitener, plain: Sequence[Array], allowed: frozenset[str]
) -> list[Candidate]:
    """All families.

    Parameters
    ----------
    inputs : runs
    whiten : Whitener
    plain : (n, blocks) arrays
        Predicted readings in each run's blocks [deg/h].
    allowed : names of effects
        A family that is just what one of them does has little prior of its own.
    """
    return [*_of_gyros(inputs, whiten, plain, allowed), *_of_table(inputs, whiten, allowed)]


def modes(count: int, first: int, number: int) -> Array:
    """Cosine modes `first` to `first + number - 1` over a run's blocks, (blocks, number)."""
    t = (np.arange(count) + 0.5) / count
    return np.cos(np.pi * np.outer(t, np.arange(first, first + number)))


def _family(
    name: tuple[str, ...],
    rows: slice,
    columns: Array,
    feature: str,
    stage: str,
    runs: tuple[str, ...] = EVERY,
    share: float = 1.0,
) -> Candidate:
    j, k = columns.shape[1:]
    return Candidate(
        "unknown",
        name,
        runs,
        rows,
        columns,
        ({},) * j,
        ("",) * k,
        np.ones((j, k)),
        share=share,
        known=False,
        feature=feature,
        stage=stage,
    )


def _of_gyros(
    inputs: Sequence[RunInput], whiten: Whitener, plain: Sequence[Array], allowed: frozenset[str]
) -> Iterator[Candidate]:
    rows, runs = whiten.rows, len(inputs)
    turning = [bool(np.any(one.facts.profile.rate_deg_s != 0.0)) for one in inputs]
    warm = all(one.scene.temperature is not None for one in inputs)
    longest = max(one.scene.blocks.count * one.scene.blocks.length_s for one in inputs)
    for i in range(rows.n):
        name, here, share = (gyro_name(i),), rows.of(i), 1.0 / rows.n

        def white(parts: Sequence[Array], here: slice = here) -> Array:
            """Columns that run through all runs, (rows, k)."""
            return whiten(np.concatenate(parts), here)

        def of_one_run(r: int, columns: Array, i: int = i) -> Array:
            return whiten(columns, rows.of(i, r))

        each = [np.ones((c, 1)) for c in rows.counts]
        single = share * (_lessened("bias_offset", allowed) if runs == 1 else 1.0)
        yield _family(name, here, whiten(_diagonal(each), here)[:, None, :], "mean", "gyro", share=single)
        for r, one in enumerate(inputs):
            run = (one.facts.run_id,)
            part = rows.of(i, r)
            own = share / runs * _lessened("turn_on_bias", allowed)
            yield _family(name, part, of_one_run(r, each[r])[:, None, :], "mean", "gyro", run, own)
            slow = of_one_run(r, modes(rows.counts[r], 1, _MODES))[:, None, :]
            yield _family(name, part, slow, "low_frequency", "gyro", run, share / runs)
        trend = [modes(c, 1, _TREND) for c in rows.counts]
        yield _family(name, here, white(trend)[:, None, :], "drift", "gyro", share=share)
        ramp = share * _lessened("bias_ramp", allowed)
        yield _family(name, here, white([t[:, :1] for t in trend])[:, None, :], "drift", "gyro", share=ramp)
        periodic = white([_periods(one, longest) for one in inputs]).reshape(rows.per_gyro, -1, 2)
        yield _family(name, here, periodic, "low_frequency", "gyro", share=share)
        if runs > 1:
            every = whiten(_diagonal([modes(c, 1, _MODES) for c in rows.counts]), here)[:, None, :]
            yield _family(name, here, every, "low_frequency", "gyro", share=share)
        reading = [p[i] / SECONDS_PER_HOUR / 10.0 for p in plain]
        if bumps := _bumps(reading):
            yield _family(name, here, white(bumps)[:, None, :], "rate", "gyro", share=share)
        if any(turning):
            powers = [np.column_stack([m, np.abs(m), m**2, m**3]) for m in reading]
            for k in range(4):
                yield _family(
                    name,
                    here,
                    white([p[:, [k]] for p in powers])[:, None, :],
                    "rate",
                    "gyro",
                    share=share * _lessened(_POWERS[k], allowed),
                )
            waves = white([_waves(one, r) for one, r in zip(inputs, turning, strict=True)])
            for j, harmonic in enumerate(HARMONICS):
                pair = waves[:, 2 * j : 2 * j + 2][:, None, :]
                yield _family(
                    name, here, pair, f"harmonic_{harmonic}", "gyro", share=share / len(HARMONICS) * 3.0
                )
        if warm:
            for k in range(4):
                hot = [_heat(one, m)[:, [k]] for one, m in zip(inputs, reading, strict=True)]
                if any(np.any(h) for h in hot):
                    own = share * _lessened(_HEATS[k], allowed)
                    yield _family(name, here, white(hot)[:, None, :], "temperature", "gyro", share=own)


def _lessened(effect: str, allowed: frozenset[str]) -> float:
    """Share of its prior that a family keeps beside the effect that does the same."""
    return _DOUBLE if effect in allowed else 1.0


def _bumps(reading: Sequence[Array]) -> list[Array]:
    """Smooth functions of the reading: five cells between its quantiles, (blocks, 5) a run; less their
    sum.
    """
    edges = np.unique(np.quantile(np.concatenate(reading), np.linspace(0.0, 1.0, 6)))
    if len(edges) < 4:
        return []
    return [np.column_stack([np.interp(m, edges, unit) for unit in np.eye(len(edges))[1:]]) for m in reading]


def _diagonal(parts: Sequence[Array]) -> Array:
    """Columns of each run by themselves: a block-diagonal matrix."""
    out = np.zeros((sum(len(p) for p in parts), sum(p.shape[1] for p in parts)))
    row = column = 0
    for part in parts:
        out[row : row + len(part), column : column + part.shape[1]] = part
        row, column = row + len(part), column + part.shape[1]
    return out


def _waves(one: RunInput, turns: bool) -> Array:
    """Cosine and sine of each harmonic of alpha in block means, (blocks, 2 harmonics); none where it
    stands.
    """
    blocks = one.scene.blocks
    if not turns:
        return np.zeros((blocks.count, 2 * len(HARMONICS)))
    alpha = one.facts.profile.angle_at(blocks.time_s.copy())
    pairs = [f(n * alpha) for n in HARMONICS for f in (np.cos, np.sin)]
    return blocks.means(np.array(pairs)).T


def _periods(one: RunInput, longest_s: float) -> Array:
    """Cosine and sine of the time since the run's start, for each of many periods, (blocks, 2 periods)."""
    blocks = one.scene.blocks
    shortest = 4.0 * blocks.length_s
    cycles = np.arange(1.5, min(longest_s / shortest, _MOST_CYCLES), 0.5)
    turn = 2.0 * np.pi * np.outer(blocks.centre_s / longest_s, cycles)
    return np.stack([np.cos(turn), np.sin(turn)], axis=-1).reshape(blocks.count, -1)


def _heat(one: RunInput, reading: Array) -> Array:
    """Warming, its square, its slope, and it times the reading, (blocks, 4)."""
    log, t = one.scene.temperature, one.scene.blocks.centre_s
    assert log is not None
    warmed = log.sensor_at(t) - float(log.sensor_at(np.zeros(1))[0])
    slope = 60.0 * slope_around(log.time_s, log.sensor_degC, t, half_s=10.0)
    return np.column_stack([warmed, warmed**2, slope, warmed * reading])


def _of_table(inputs: Sequence[RunInput], whiten: Whitener, allowed: frozenset[str]) -> Iterator[Candidate]:
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
        own = _lessened("table_rate_error", allowed)
        yield _family(table, everything, rotation(rates, axes)[:, None, :], "rate", "table", share=own)
        waves = [
            _waves(one, bool(np.any(one.facts.profile.rate_deg_s != 0.0))) * np.sign(r.sum() or 1.0)
            for one, r in zip(inputs, rates, strict=True)
        ]
        about = rotation(waves, axes)
        across = [rotation(waves, [_across(one, k) for one in inputs]) for k in range(2)]
        for j, harmonic in enumerate(HARMONICS):
            pair = slice(2 * j, 2 * j + 2)
            share = 3.0 / len(HARMONICS)
            yield _family(
                table, everything, about[:, pair][:, None, :], f"harmonic_{harmonic}", "table", share=share
            )
            both = np.column_stack([a[:, pair] for a in across])[:, None, :]
            yield _family(table, everything, both, f"harmonic_{harmonic}", "table", share=share)
    for r in range(len(inputs)):
        alone = [np.ones((c, 1)) * float(k == r) for k, c in enumerate(counts)]
        steady = np.column_stack([rotation(alone, [np.eye(3)[k]] * len(inputs)) for k in range(3)])
        run = (inputs[r].facts.run_id,)
        yield _family(table, everything, steady[:, None, :], "mean", "table", run, 1.0 / len(inputs))
    steady = np.column_stack(
        [rotation([np.ones((c, 1)) for c in counts], [np.eye(3)[k]] * len(inputs)) for k in range(3)]
    )
    yield _family(table, everything, steady[:, None, :], "mean", "table")
    drifting = rotation([modes(c, 1, _TREND) for c in counts], axes)
    yield _family(table, everything, drifting[:, None, :], "drift", "table")


def _across(one: RunInput, k: int) -> Array:
    """One of two directions at right angles to the table's axis: Earth's horizontal part shows there."""
    from fogreduce.physics.frames import across

    return across(one.facts.table_axis)[k]
