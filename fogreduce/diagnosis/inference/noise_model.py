"""What a residual may be when nothing is wrong: noise of the record, and the stated uncertainties.

Rows are block means, gyro after gyro, in each the runs in order. Noise whitens them; a run's turn-on bias,
one unknown constant, stands in the same covariance. The other stated uncertainties are columns with a
standard deviation of one, marginalised exactly (Woodbury):

    x' S^-1 y = x'y - (A'x)' (1 + A'A)^-1 (A'y)    for whitened x, y and A.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from fogreduce.constants import SECONDS_PER_HOUR
from fogreduce.diagnosis.observe.blocks import Blocks
from fogreduce.diagnosis.observe.capture import RunInput
from fogreduce.diagnosis.which.catalogue.unlogged import unlogged_covariance
from fogreduce.effects.gyro_names import gyro_name
from fogreduce.effects.selection import Action, action
from fogreduce.metadata.calibration import CalibrationRecord
from fogreduce.metadata.facts import RunFacts
from fogreduce.physics.frames import across
from fogreduce.physics.noise import flicker_covariance, white_sigma

Array = NDArray[np.float64]

_NOTHING = 1e15  # times the white variance: a block without a sample says nothing, of a gross fault neither


@dataclass(frozen=True)
class Rows:
    """Where each gyro and run stands among the rows.

    Attributes
    ----------
    counts : tuple of int
        Blocks of each run.
    n : int
        Gyros.
    """

    counts: tuple[int, ...]
    n: int

    @property
    def per_gyro(self) -> int:
        """Rows of one gyro."""
        return sum(self.counts)

    @property
    def total(self) -> int:
        """All rows."""
        return self.n * self.per_gyro

    def of(self, gyro: int, run: int | None = None) -> slice:
        """Rows of a gyro, in one run or in all."""
        start = gyro * self.per_gyro
        if run is None:
            return slice(start, start + self.per_gyro)
        start += sum(self.counts[:run])
        return slice(start, start + self.counts[run])

    def stacked(self, runs: Sequence[Array]) -> Array:
        """Values of each run (n, blocks) as one vector."""
        return np.concatenate([run[i] for i in range(self.n) for run in runs])


@dataclass(frozen=True)
class Whitener:
    """Filters (blocks, blocks) of every gyro and run that turn noise into independent unit deviates."""

    rows: Rows
    filters: dict[tuple[int, int], Array]

    def __call__(self, values: Array, rows: slice | None = None) -> Array:
        """Whitened values (rows, k) that begin at `rows`' start and fill whole runs; None: all rows."""
        out = np.empty_like(values)
        begin = 0 if rows is None else rows.start
        end = self.rows.total if rows is None else rows.stop
        for matrix, parts in self._alike:
            here = [
                slice(part.start - begin, part.stop - begin)
                for part in parts
                if begin <= part.start and part.stop <= end
            ]
            if len(here) == 1:
                out[here[0]] = matrix @ values[here[0]]
            elif here:
                # runs that share a filter go through it together: the filter is read from memory once
                together = matrix @ np.hstack([values[part] for part in here])
                for part, column in zip(here, np.hsplit(together, len(here)), strict=True):
                    out[part] = column
        return out

    def coarser(self, times: Mapping[int, float]) -> Whitener:
        """The same with the noise of some gyros so many times as large."""
        scaled: dict[tuple[int, int], Array] = {}
        out = {}
        for at, matrix in self.filters.items():
            gyro = at[0]
            out[at] = scaled.setdefault((gyro, id(matrix)), matrix / times[gyro] if gyro in times else matrix)
        return Whitener(self.rows, out)

    @cached_property
    def _alike(self) -> list[tuple[Array, list[slice]]]:
        """Each filter with all rows that it whitens."""
        found: dict[int, tuple[Array, list[slice]]] = {}
        for (i, r), matrix in self.filters.items():
            found.setdefault(id(matrix), (matrix, []))[1].append(self.rows.of(i, r))
        return list(found.values())


def block_covariance(
    blocks: Blocks, sizes: Array, rate_hz: float, terms: tuple[float, float, float, float]
) -> Array:
    """Covariance [(deg/h)^2] of one gyro's block means in one run.

    Parameters
    ----------
    blocks : Blocks
    sizes : (blocks,) array
        Samples in each mean.
    rate_hz : float
    terms : (N, B, K, turn-on)
        White noise [deg/sqrt(h)], flicker [deg/h], random walk [deg/h/sqrt(h)], turn-on bias [deg/h].
    """
    white, flicker, walk, turn_on = terms
    sample = float(white_sigma(white, rate_hz)) * SECONDS_PER_HOUR
    full = blocks.length_s * rate_hz
    variance = np.where(sizes > 0, 1.0 / np.maximum(sizes, 1.0), _NOTHING / full) * sample**2
    covariance = np.diag(variance) + turn_on**2
    covariance += process_covariance("flicker", flicker, blocks) + process_covariance("walk", walk, blocks)
    return covariance


def rounding_mean_variance(facts: RunFacts, i: int, white_deg_sqrt_h: float) -> float:
    """Variance [(deg/h)^2] of what rounding leaves in a steady mean, where the noise is finer than a step.

    A mean at an unknown place in its step q, smeared by noise of sigma, is off by a Fourier series of
    amplitudes ``q / (pi k) exp(-2 (pi k sigma / q)^2)``, k = 1, 2, ... (Widrow and Kollar, Quantization
    Noise).
    """
    step = facts.least_count / abs(float(facts.scale_factor[i])) * SECONDS_PER_HOUR
    sigma = float(white_sigma(white_deg_sqrt_h, facts.sample_rate_hz)) * SECONDS_PER_HOUR / step
    k = np.arange(1.0, 21.0)
    return float(0.5 * step**2 * np.sum(np.exp(-((2.0 * np.pi * k * sigma) ** 2)) / (np.pi * k) ** 2))


def relative(plain: Sequence[Array]) -> list[Array]:
    """Readings (n, blocks) of each run, of the largest that the gyro has in any."""
    largest = np.max([np.abs(p).max(axis=1) for p in plain], axis=0)
    return [p / np.maximum(largest, 1e-300)[:, None] for p in plain]


def process_covariance(kind: str, size: float, blocks: Blocks) -> Array:
    """Covariance [(deg/h)^2] of block means of flicker of B [deg/h], a walk of K [deg/h/sqrt(h)] from 0, or
    what a temperature without a log does, [deg/h] per unit of it.
    """
    if size == 0.0:
        return np.zeros((blocks.count, blocks.count))
    if kind.startswith(("warmth", "warming")):
        return size**2 * unlogged_covariance(kind, blocks)
    index = np.arange(blocks.count)
    if kind == "flicker":
        lags = flicker_covariance(size, blocks.length_s, blocks.count)
        result: Array = lags[np.abs(index[:, None] - index)]
        return result
    hours = blocks.length_s / SECONDS_PER_HOUR
    start = index * hours
    # means over steps of a walk: what both have seen, and half or a third of the step itself
    covariance = np.minimum.outer(start, start) + hours / 2.0
    np.fill_diagonal(covariance, start + hours / 3.0)
    return size**2 * covariance


def whitener(
    inputs: Sequence[RunInput],
    sizes: Sequence[Array],
    level: Array,
    further: Mapping[tuple[str, int], float] | None = None,
    made: dict[tuple[object, ...], Array] | None = None,
) -> Whitener:
    """Filters for every gyro and run.

    Parameters
    ----------
    inputs : runs
    sizes : (n, blocks) arrays
        Samples in each block's mean.
    level : (n,) or (R, n) array
        White noise as found over that of the record, of each gyro or of each in each run.
    further : mapping
        (kind, gyro) -> size of a further process; ``gain`` before its kind: it goes with the reading.
    made : dict
        Filters made before for the same runs and level, to which new ones are added.
    """
    noise, stated = inputs[0].record.stated_noise, inputs[0].record.stated_uncertainty
    n = inputs[0].facts.n_gyros
    filters: dict[tuple[int, int], Array] = {}
    made = {} if made is None else made
    level = np.broadcast_to(level, (len(inputs), n))
    gains = {at for kind, at in further or {} if kind.startswith("gain ")}
    readings = relative([one.scene.block_means() for one in inputs]) if gains else []
    for r, one in enumerate(inputs):
        blocks, rate = one.scene.blocks, one.facts.sample_rate_hz
        for i in range(n):
            full = sizes[r][i].max() if sizes[r][i].size else 0.0
            key: tuple[object, ...] = (i, blocks.count, blocks.length_s, rate, float(level[r, i]))
            key = (*key, one.facts.least_count)
            usual = blocks.length_s * rate
            near = bool(full > 0) and bool(np.all((sizes[r][i] > 0.9 * usual) | (sizes[r][i] == 0.0)))
            # runs whose blocks are whole in the same places have one filter
            key = (*key, (sizes[r][i] > 0.0).tobytes() if near else (r, sizes[r][i].tobytes()))
            key = (*key, *sorted((kind, size) for (kind, at), size in (further or {}).items() if at == i))
            if i in gains:
                key = (*key, readings[r][i].tobytes())
            if key not in made:
                terms = (
                    noise.angle_random_walk_deg_sqrt_h[i] * float(level[r, i]),
                    noise.bias_instability_deg_h[i],
                    noise.rate_random_walk_deg_h_sqrt_h[i],
                    stated.turn_on_bias_deg_h[i],
                )
                covariance = block_covariance(blocks, sizes[r][i], rate, terms)
                covariance += rounding_mean_variance(one.facts, i, terms[0])
                for (kind, gyro), size in (further or {}).items():
                    if gyro == i:
                        more = process_covariance(kind.removeprefix("gain "), size, blocks)
                        covariance += (
                            more * np.outer(*[readings[r][i]] * 2) if kind.startswith("gain ") else more
                        )
                made[key] = np.linalg.inv(np.linalg.cholesky(covariance))
            filters[i, r] = made[key]
    return Whitener(Rows(tuple(one.scene.blocks.count for one in inputs), n), filters)


def stated_actions(inputs: Sequence[RunInput]) -> list[tuple[Action, float]]:
    """Every stated uncertainty but the turn-on biases: the effect at a small step, and that step in
    sigmas.
    """
    record: CalibrationRecord = inputs[0].record
    facts, stated = inputs[0].facts, record.stated_uncertainty
    every = [one.facts.run_id for one in inputs]
    n = facts.n_gyros
    out: list[tuple[Action, float]] = []

    def add(effect: str, channel: str, runs: Sequence[str], sigma: float, **parameters: object) -> None:
        if sigma > 0.0:
            out.append((action(effect, [channel], runs, parameters, n), sigma))

    for i in range(n):
        gyro = gyro_name(i)
        add("scale_factor_error", gyro, every, stated.scale_factor_rel[i] * 1e6, ppm=1.0)
        bias = stated.bias[i] / abs(record.scale_factor[i]) * SECONDS_PER_HOUR
        add("bias_offset", gyro, every, bias, deg_h=1.0)
        for direction in across(facts.axes[i]):
            tilt = tuple((0.1 * direction).tolist())
            add("axis_misalignment", gyro, every, stated.axis_rad[i] * 1e4, mrad=tilt)
    for one in inputs:
        azimuth = one.run.azimuth_uncertainty_deg
        add("heading_error", "table", [one.facts.run_id], azimuth / 0.01, deg=0.01)
    first = inputs[0].run
    add("table_rate_error", "table", every, first.table.rate_uncertainty_ppm, ppm=1.0)
    add("latitude_error", "table", every, first.site.latitude_uncertainty_deg / 0.01, deg=0.01)
    return out


def nuisances(inputs: Sequence[RunInput], base: Sequence[Action] = ()) -> Array:
    """Columns (rows, q) of the stated uncertainties, one sigma each [deg/h], about a chain with effects in
    it; the errors of a logged motion of the table among them.
    """
    rows = Rows(tuple(one.scene.blocks.count for one in inputs), inputs[0].facts.n_gyros)
    plain = [one.scene.block_means(base) for one in inputs]
    columns = []
    for step, sigma in stated_actions(inputs):
        changed = [
            (one.scene.block_means([*base, _after(step, base)]) - before) * sigma
            if one.facts.run_id in step.runs
            else np.zeros_like(before)
            for one, before in zip(inputs, plain, strict=True)
        ]
        columns.append(rows.stacked(changed))
    for r, one in enumerate(inputs):
        for changed_here in one.scene.table_errors():
            parts = [changed_here if k == r else np.zeros_like(p) for k, p in enumerate(plain)]
            columns.append(rows.stacked(parts))
    return np.column_stack(columns) if columns else np.zeros((rows.total, 0))


def _after(step: Action, base: Sequence[Action]) -> Action:
    """The same action under a number of its own."""
    return replace(step, ordinal=len(base))


@dataclass(frozen=True)
class Metric:
    """An inner product on whitened vectors in which the columns `a` are marginalised.

    Attributes
    ----------
    a : (rows, q) array
        Whitened columns, one standard deviation each.
    shrink : (q, q) array
        (1 + A'A)^-1.
    inner : (q, q) array
        A'A.
    parent : Metric or None
        The one whose columns come first.
    """

    a: Array
    shrink: Array
    inner: Array
    parent: Metric | None = None
    _products: dict[int, tuple[Array, Array]] = field(default_factory=dict, repr=False)

    @classmethod
    def of(cls, a: Array) -> Metric:
        """From whitened columns."""
        return cls._of(a, a.T @ a, None)

    @classmethod
    def _of(cls, a: Array, inner: Array, parent: Metric | None) -> Metric:
        return cls(a, np.asarray(np.linalg.inv(np.eye(len(inner)) + inner), np.float64), inner, parent)

    def with_free(self, columns: Array) -> Metric:
        """The same with further whitened columns, quite free in size."""
        if columns.shape[1] == 0:
            return self
        length = np.sqrt(np.maximum(np.sum(columns**2, axis=0), 1e-300))
        return self.wider(columns * (1e5 / length))

    def onto(self, columns: Array, rows: slice) -> Array:
        """A'x of whitened columns (m, k) that stand at `rows`: (q, k).

        Remembered for the metric that others were made from: the same columns are held against
        many residuals.
        """
        if self.parent is not None:
            added = self.a[rows, self.parent.a.shape[1] :].T @ columns
            return np.vstack([self.parent.onto(columns, rows), added])
        if id(columns) not in self._products:
            self._products[id(columns)] = (columns, self.a[rows].T @ columns)
        return self._products[id(columns)][1]

    def wider(self, columns: Array) -> Metric:
        """The same with further whitened columns, one standard deviation each, marginalised."""
        if columns.shape[1] == 0:
            return self
        cross = self.a.T @ columns
        inner = np.block([[self.inner, cross], [cross.T, columns.T @ columns]])
        return Metric._of(np.column_stack([self.a, columns]), inner, self)

    def gram(self, x: Array, y: Array) -> Array:
        """Inner products of whitened columns x (rows, k) and y (rows, l)."""
        onto_x = self.a.T @ x
        onto_y = onto_x if y is x else self.a.T @ y
        result: Array = x.T @ y - onto_x.T @ (self.shrink @ onto_y)
        return result

    def without(self, y: Array) -> Array:
        """Whitened y less its expected nuisances."""
        result: Array = y - self.a @ (self.shrink @ (self.a.T @ y))
        return result
