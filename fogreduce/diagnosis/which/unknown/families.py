"""Families of the unknown: low-dimensional features of a residual that need no cause.

They say where a gap lies, they are what a remainder is tested with, and they compete with the catalogue for
what it cannot explain. Each is a gyro's own doing, or what a true rotation would do to all gyros alike.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from fogreduce.constants import SECONDS_PER_HOUR
from fogreduce.diagnosis.inference.candidate import Candidate
from fogreduce.diagnosis.inference.family import HARMONICS, diagonal, family, lessened, modes, waves_of_angle
from fogreduce.diagnosis.inference.noise_model import Whitener
from fogreduce.diagnosis.observe.capture import RunInput
from fogreduce.diagnosis.which.unknown.families_table import of_table
from fogreduce.diagnosis.which.unknown.waveforms import after_effects, memories, recoveries, sawteeth, steps
from fogreduce.effects.at import slope_around
from fogreduce.effects.gyro_names import gyro_name
from fogreduce.physics.scale_factor import raw_from_rate

Array = NDArray[np.float64]

_MODES = 10
_TREND = 4
_MOST_CYCLES = 31.0  # periods that come again from the run's start, at most so many in a run
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
    turning = any(bool(np.any(one.facts.profile.rate_deg_s != 0.0)) for one in inputs)
    found = [
        *_of_gyros(inputs, whiten, plain, allowed),
        *(_exchanges(inputs, whiten, plain, allowed) if turning else ()),
        *of_table(inputs, whiten, allowed),
    ]
    # a run of a few blocks has no room for some shapes
    return [one for one in found if one.columns.shape[1] > 0]


def _of_gyros(
    inputs: Sequence[RunInput], whiten: Whitener, plain: Sequence[Array], allowed: frozenset[str]
) -> Iterator[Candidate]:
    rows, runs = whiten.rows, len(inputs)
    turning = [bool(np.any(one.facts.profile.rate_deg_s != 0.0)) for one in inputs]
    warm = all(one.scene.temperature is not None for one in inputs)
    longest = max(one.scene.blocks.count * one.scene.blocks.length_s for one in inputs)
    coarsest = max(one.scene.blocks.length_s for one in inputs)
    shapes = {
        "periods": lambda one: _periods(one, longest, coarsest),
        "sawteeth": lambda one: sawteeth(one.scene.blocks, longest, coarsest),
        "recoveries": lambda one: recoveries(one.scene.blocks),
    }
    plainly: dict[tuple[object, ...], Array] = {}

    def timed(i: int, kind: str) -> Array:
        """Whitened shapes of the time since the start: alike in runs that have one filter."""
        parts = []
        for r, one in enumerate(inputs):
            matrix = whiten.filters[i, r]
            key = (kind, id(matrix), one.scene.blocks.length_s)
            if key not in plainly:
                columns = shapes[kind](one)
                plainly[key] = (matrix @ columns.reshape(len(columns), -1)).reshape(columns.shape)
            parts.append(plainly[key])
        return np.concatenate(parts)

    def stepped(i: int, r: int) -> Array:
        matrix = whiten.filters[i, r]
        key = ("steps", id(matrix))
        if key not in plainly:
            plainly[key] = steps(matrix)
        return plainly[key]

    def kernels(one: RunInput) -> Array:
        blocks = one.scene.blocks
        key = ("memories", blocks.count, blocks.length_s)
        if key not in plainly:
            plainly[key] = memories(blocks)
        return plainly[key]

    motion = [(np.linalg.pinv(inputs[0].facts.axes) @ p).T for p in plain]
    for i in range(rows.n):
        name, here, share = (gyro_name(i),), rows.of(i), 1.0 / rows.n

        def white(parts: Sequence[Array], here: slice = here) -> Array:
            """Columns that run through all runs, (rows, k)."""
            return whiten(np.concatenate(parts), here)

        def of_one_run(r: int, columns: Array, i: int = i) -> Array:
            return whiten(columns, rows.of(i, r))

        each = [np.ones((c, 1)) for c in rows.counts]
        single = share * (lessened("bias_offset", allowed) if runs == 1 else 1.0)
        yield family(name, here, whiten(diagonal(each), here)[:, None, :], "mean", "gyro", share=single)
        for r, one in enumerate(inputs):
            run = (one.facts.run_id,)
            part = rows.of(i, r)
            prior_share = share / runs * lessened("turn_on_bias", allowed)
            yield family(name, part, of_one_run(r, each[r])[:, None, :], "mean", "gyro", run, prior_share)
            slow = of_one_run(r, modes(rows.counts[r], 1, _MODES))[:, None, :]
            yield family(name, part, slow, "low_frequency", "gyro", run, share / runs)
            prior_share = share / runs * lessened("bias_step", allowed)
            if rows.counts[r] > 2:
                yield family(name, part, stepped(i, r), "step", "gyro", run, prior_share)
        trend = [modes(c, 1, _TREND) for c in rows.counts]
        yield family(name, here, white(trend)[:, None, :], "drift", "gyro", share=share)
        ramp = share * lessened("bias_ramp", allowed)
        yield family(name, here, white([t[:, :1] for t in trend])[:, None, :], "drift", "gyro", share=ramp)
        yield family(name, here, timed(i, "periods"), "low_frequency", "gyro", share=share)
        yield family(name, here, timed(i, "sawteeth"), "low_frequency", "gyro", share=share)
        yield family(name, here, timed(i, "recoveries"), "drift", "gyro", share=share)
        if runs > 1:
            every = whiten(diagonal([modes(c, 1, _MODES) for c in rows.counts]), here)[:, None, :]
            yield family(name, here, every, "low_frequency", "gyro", share=share)
        reading = [p[i] / SECONDS_PER_HOUR / 10.0 for p in plain]
        if len(plain[0]) >= 3:
            # an axis of any direction and length
            prior_share = share * lessened("axis_misalignment", allowed)
            yield family(name, here, white(motion)[:, None, :], "rate", "gyro", share=prior_share)
        drifting = white([t * m[:, None] for t, m in zip(trend, reading, strict=True)])
        yield family(name, here, drifting[:, None, :], "drift", "gyro", share=0.5 * share)
        if bumps := _bumps(reading):
            yield family(name, here, white(bumps)[:, None, :], "rate", "gyro", share=share)
        if any(turning):
            powers = [np.column_stack([m, np.abs(m), m**2, m**3]) for m in reading]
            for k in range(4):
                yield family(
                    name,
                    here,
                    white([p[:, [k]] for p in powers])[:, None, :],
                    "rate",
                    "gyro",
                    share=share * lessened(_POWERS[k], allowed),
                )
            for past, weight in ((reading, 1.0), ([np.abs(m) for m in reading], 0.5)):
                late = [after_effects(kernels(one), m) for one, m in zip(inputs, past, strict=True)]
                columns = white([c[:, :, 0] for c in late])[:, :, None]
                yield family(name, here, columns, "rate", "gyro", share=weight * share)
            waves = white([waves_of_angle(one, r) for one, r in zip(inputs, turning, strict=True)])
            for j, harmonic in enumerate(HARMONICS):
                pair = waves[:, 2 * j : 2 * j + 2][:, None, :]
                yield family(
                    name, here, pair, f"harmonic_{harmonic}", "gyro", share=share / len(HARMONICS) * 3.0
                )
        if warm:
            for k in range(4):
                hot = [_heat(one, m)[:, [k]] for one, m in zip(inputs, reading, strict=True)]
                if any(np.any(h) for h in hot):
                    prior_share = share * lessened(_HEATS[k], allowed)
                    yield family(name, here, white(hot)[:, None, :], "temperature", "gyro", share=prior_share)


def _exchanges(
    inputs: Sequence[RunInput], whiten: Whitener, plain: Sequence[Array], allowed: frozenset[str]
) -> Iterator[Candidate]:
    """Two gyros, each with some of what it would read of the other's volts less what it reads of its own."""
    rows = whiten.rows
    pairs = [(i, j) for i in range(rows.n) for j in range(i + 1, rows.n)]
    share = lessened("channel_swap", allowed) / max(len(pairs), 1)
    raw = [_volts(one, p) for one, p in zip(inputs, plain, strict=True)]
    for i, j in pairs:
        both = slice(rows.of(i).start, rows.of(j).stop)
        order = np.arange(rows.n)
        order[[i, j]] = j, i
        apart = [one.scene.rates(v[order]) - p for one, v, p in zip(inputs, raw, plain, strict=True)]
        columns = np.zeros((both.stop - both.start, 2))
        columns[: rows.per_gyro, 0] = np.concatenate([a[i] for a in apart])
        columns[-rows.per_gyro :, 1] = np.concatenate([a[j] for a in apart])
        name = (gyro_name(i), gyro_name(j))
        yield family(name, both, whiten(columns, both)[:, None, :], "rate", "gyro", share=share)


def _volts(one: RunInput, readings: Array) -> Array:
    """Raw volts of decoded readings (n, blocks) [deg/h]."""
    facts = one.facts
    return raw_from_rate(readings / SECONDS_PER_HOUR, facts.scale_factor, facts.bias, facts.polarity)


def _bumps(reading: Sequence[Array]) -> list[Array]:
    """Smooth functions of the reading: five cells between its quantiles, (blocks, 5) a run; less their
    sum.
    """
    edges = np.unique(np.quantile(np.concatenate(reading), np.linspace(0.0, 1.0, 6)))
    if len(edges) < 4:
        return []
    return [np.column_stack([np.interp(m, edges, unit) for unit in np.eye(len(edges))[1:]]) for m in reading]


def _periods(one: RunInput, longest_s: float, coarsest_s: float) -> Array:
    """Cosine and sine of the time since the run's start, for each of many periods, (blocks, periods, 2).

    `longest_s`: of all runs; `coarsest_s`: the longest block of any.
    """
    blocks = one.scene.blocks
    cycles = np.arange(1.5, min(longest_s / (4.0 * coarsest_s), _MOST_CYCLES), 0.5)
    turn = 2.0 * np.pi * np.outer(blocks.centre_s / longest_s, cycles)
    return np.stack([np.cos(turn), np.sin(turn)], axis=-1)


def _heat(one: RunInput, reading: Array) -> Array:
    """Warming, its square, its slope, and it times the reading, (blocks, 4)."""
    log, t = one.scene.temperature, one.scene.blocks.centre_s
    assert log is not None
    warmed = log.sensor_at(t) - float(log.sensor_at(np.zeros(1))[0])
    slope = 60.0 * slope_around(log.time_s, log.sensor_degC, t, half_s=10.0)
    return np.column_stack([warmed, warmed**2, slope, warmed * reading])
