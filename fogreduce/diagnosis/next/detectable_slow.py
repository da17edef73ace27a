"""Effects that show in block means: what a planned campaign would show of them, from columns alone."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.special import chndtr, chndtrinc, ndtri

from fogreduce.diagnosis.inference.candidate import Candidate
from fogreduce.diagnosis.inference.evidence import log_bayes, log_mean_exp
from fogreduce.diagnosis.inference.noise_model import Metric, nuisances, whitener
from fogreduce.diagnosis.next.detectable_row import SEPARATED_SIGMA, Row, crossing, threshold
from fogreduce.diagnosis.observe.capture import RunInput
from fogreduce.diagnosis.which.catalogue.builder import Builder
from fogreduce.diagnosis.which.catalogue.candidates import all_candidates
from fogreduce.diagnosis.which.full_rate.spectrum import DRIFTS
from fogreduce.diagnosis.which.processes.processes import Processes
from fogreduce.diagnosis.which.processes.sizes import size_logs
from fogreduce.effects.model import Stage
from fogreduce.effects.table import EFFECTS
from fogreduce.simulate.streams import stream

Array = NDArray[np.float64]

_MOST_POINTS = 16  # of a grid: a finer one says little more before there are data
_DRAWS = 400
_LARGEST = 1e9  # times a column's step


def slow_rows(
    inputs: Sequence[RunInput], allowed: frozenset[str], probability: float, snr: float
) -> Iterator[Row]:
    """Rows of every effect that changes block means, and of the random processes in them.

    Parameters
    ----------
    inputs : runs, with or without captures
    allowed : names of effects
    probability : float
    snr : float
        At which rivals are looked for.
    """
    n = inputs[0].facts.n_gyros
    sizes = [
        np.full((n, b.count), b.length_s * one.facts.sample_rate_hz)
        for one in inputs
        for b in [one.scene.blocks]
    ]
    whiten = whitener(inputs, sizes, np.ones(n))
    metric = Metric.of(whiten(nuisances(inputs)))
    # the spectrum shows a filter long before the lag of its readings does
    filters = {name for name in allowed if EFFECTS[name].stage == Stage.FILTER}
    builder = Builder(inputs, whiten, [], allowed - filters, {})
    candidates = [_thinned(c) for c in all_candidates(builder)]
    scene = _Scene.of(candidates, metric)
    for number, candidate in enumerate(candidates):
        yield from _rows_of(scene, number, candidate, probability, snr)
    processes = Processes(inputs, whiten, builder.plain)
    for effect, (kind, parameter) in DRIFTS.items():
        if effect not in allowed:
            continue
        for i in range(n):
            size = _process(processes, i, kind, probability, 1.0 / n)
            yield Row(effect, (f"gyro{i + 1}",), ("*",), parameter, size, size is not None)


def _thinned(candidate: Candidate) -> Candidate:
    """The candidate at fewer points of its grid."""
    count = candidate.columns.shape[1]
    if count <= _MOST_POINTS or candidate.fixed:
        return candidate
    keep = np.unique(np.linspace(0, count - 1, _MOST_POINTS).round().astype(int))
    return replace(
        candidate,
        columns=candidate.columns[:, keep],
        grid=tuple(candidate.grid[k] for k in keep),
        steps=candidate.steps[keep],
    )


@dataclass(frozen=True)
class _Scene:
    """All candidates' columns, and their inner products with stated uncertainties marginalised."""

    candidates: Sequence[Candidate]
    gram: Array
    starts: NDArray[np.intp]

    @classmethod
    def of(cls, candidates: Sequence[Candidate], metric: Metric) -> _Scene:
        widths = [c.columns.shape[1] * c.columns.shape[2] for c in candidates]
        starts = np.concatenate(([0], np.cumsum(widths))).astype(np.intp)
        whole = np.zeros((metric.a.shape[0], starts[-1]))
        for c, start, width in zip(candidates, starts, widths, strict=False):
            whole[c.rows, start : start + width] = c.columns.reshape(len(c.columns), width)
        return cls(candidates, metric.gram(whole, whole), starts)

    def column(self, number: int, point: int, direction: Array) -> Array:
        """Products of one column, a direction at a point of a candidate's grid, with all columns."""
        first = self.starts[number] + point * len(direction)
        product: Array = self.gram[:, first : first + len(direction)] @ direction
        return product

    def gains(self, number: int, products: Array) -> Array:
        """Twice the gain in ln likelihood of a candidate at each point of its grid, for data as expected."""
        c = self.candidates[number]
        points, k = c.columns.shape[1:]
        b = products[self.starts[number] : self.starts[number + 1]].reshape(points, k)
        first = self.starts[number] + k * np.arange(points)
        index = first[:, None] + np.arange(k)
        gram = self.gram[index[:, :, None], index[:, None, :]]
        if c.fixed:
            gain: Array = np.maximum(2.0 * b[:, 0] - gram[:, 0, 0], 0.0)
            return gain
        gram = gram + (1e-9 * np.trace(gram, axis1=1, axis2=2)[:, None, None] + 1e-30) * np.eye(k)
        found = np.linalg.solve(gram, b[:, :, None])[:, :, 0]
        gain = np.maximum(np.sum(b * found, axis=1), 0.0)
        return gain

    def rivals(self, number: int, products: Array, own: float, snr: float) -> tuple[str, ...]:
        """Labels of what cannot be told from a column at a signal-to-noise ratio."""
        scale, out = snr / np.sqrt(own), []
        me = _label(self.candidates[number])
        for other, c in enumerate(self.candidates):
            if other == number or _label(c) == me:
                continue
            if c.fixed:
                first = self.starts[other] + np.arange(c.columns.shape[1])
                alone = np.diagonal(self.gram)[first]
                apart2 = snr**2 - 2.0 * scale * products[first] + alone
            else:
                apart2 = snr**2 * (1.0 - self.gains(other, products) / own)
            if float(np.min(apart2)) < SEPARATED_SIGMA**2:
                out.append(_label(c))
        return tuple(dict.fromkeys(out))


def _label(c: Candidate) -> str:
    return Row(c.effect, c.channels, c.runs, "", None, True, _others(c)).label


def _others(c: Candidate) -> dict[str, Any]:
    other = EFFECTS[c.effect].other
    return {other: c.extra[other]} if other in c.extra else {}


def _rows_of(scene: _Scene, number: int, c: Candidate, probability: float, snr: float) -> Iterator[Row]:
    if c.fixed:
        yield _fixed(scene, number, c, probability)
        return
    for point, direction, parameter, scale, at in _cases(c):
        products = scene.column(number, point, direction)
        first = scene.starts[number] + point * len(direction)
        own = float(direction @ products[first : first + len(direction)])
        floor = 1e-9 * float(np.sum(c.columns[:, point] ** 2))
        if own <= floor:
            yield Row(c.effect, c.channels, c.runs, parameter, None, False, {**_others(c), **at})
            continue
        size = _least(scene.gains(number, products), point, c, probability)
        rivals = scene.rivals(number, products, own, snr)
        amplitude = None if size is None else size * scale
        yield Row(
            c.effect, c.channels, c.runs, parameter, amplitude, size is not None, {**_others(c), **at}, rivals
        )


def _least(gains: Array, point: int, c: Candidate, probability: float) -> float | None:
    """Smallest multiple of a column that is seen; `gains`: those of once the column."""
    k, above = c.columns.shape[2], threshold(c.share) - (np.log(2.0) if c.positive else 0.0)

    def excess(size: float) -> float:
        return float(log_mean_exp(log_bayes(size**2 * gains, k))) - above

    even = crossing(excess, 1e-9, _LARGEST)
    if even is None or gains[point] <= 0.0:
        return None
    q = even**2 * float(gains[point])
    if chndtr(q, k, 0.0) < 1.0 - probability:
        return even
    return float(np.sqrt(chndtrinc(q, k, 1.0 - probability) / gains[point]))


def _cases(c: Candidate) -> Iterator[tuple[int, Array, str, float, dict[str, Any]]]:
    """(point, direction, parameter, size of one step, other parameters) at which a candidate is looked at."""
    points, k = c.columns.shape[1:]
    design = EFFECTS[c.effect].design
    assert design is not None, f"{c.effect}: a candidate has a design"
    shown = design.shown or {}
    if design.wave:
        for point, given in enumerate(c.grid):
            if all(given[name] in values for name, values in shown.items()):
                at = {**given, design.wave: 0.0}  # one that is new in each run would show otherwise
                yield point, np.array([1.0, 0.0]), design.scaled, float(c.steps[point, 0]), at
    elif design.vector == "room":
        for unit in np.eye(3):
            yield 0, unit, design.scaled, float(c.steps[0, 0]), {design.along: unit.tolist()}
    elif design.vector:
        ways = c.extra["tips"] if "tips" in c.extra else np.eye(3)
        for axis, unit in enumerate(np.eye(k)):
            along = [round(float(v), 3) for v in ways[axis]]
            yield 0, unit, design.scaled, float(c.steps[0, axis]), {"along": along}
    elif design.steps:
        near = np.subtract.outer(c.steps[:, 0], np.array(shown[design.scaled]))
        for point in np.argmin(np.abs(near), axis=0).tolist():
            yield point, np.ones(1), design.scaled, float(c.steps[point, 0]), {}
    else:
        for point in _points_shown(shown, points):
            numbers = {key: float(v) for key, v in c.grid[point].items() if not isinstance(v, str)}
            at = {key: round(v, 1) if abs(v) >= 1.0 else float(f"{v:.3g}") for key, v in numbers.items()}
            yield point, np.ones(1), design.scaled, float(c.steps[point, 0]), at


def _points_shown(shown: Mapping[str, tuple[float, ...]], points: int) -> list[int]:
    """Of a grid in order, the points at shares of its length; the middle where none are said."""
    shares = next(iter(shown.values()), (0.5,))
    return [int(share * points) for share in shares]


def _fixed(scene: _Scene, number: int, c: Candidate, probability: float) -> Row:
    """What has a given size: the least of its grid from which on it is seen; for a swap whether it is."""
    first, count = scene.starts[number], c.columns.shape[1]
    block = scene.gram[first : first + count, first : first + count]
    alone = np.diagonal(block)
    logs = log_mean_exp(block - 0.5 * alone[:, None], axis=0)
    doubt = float(ndtri(probability)) * np.sqrt(np.maximum(alone, 0.0))
    seen = (logs - doubt >= threshold(c.share)) & (alone > 0.0)
    sizes_of = [p.name for p in EFFECTS[c.effect].parameters if p.kind == "number" and p.name in c.grid[0]]
    parameter = sizes_of[0] if sizes_of else ""
    others = {**{key: v for key, v in c.grid[0].items() if key != parameter}, **_others(c)}
    if not seen.any():
        return Row(c.effect, c.channels, c.runs, parameter, None, False, others)
    sizes = [float(given.get(parameter, 0.0)) for given in c.grid]
    # a dead zone grows with its width, clipping as its limit falls
    design = EFFECTS[c.effect].design
    falls = design is not None and design.exact == "range"
    order = np.argsort(sizes)[::-1] if falls else np.argsort(sizes)
    sure = [k for j, k in enumerate(order.tolist()) if seen[order[j:]].all()]
    at = sure[0] if sure else int(np.flatnonzero(seen)[0])
    amplitude = sizes[at] if parameter else None
    products = scene.gram[:, first + at]
    rivals = scene.rivals(number, products, float(alone[at]), float(np.sqrt(alone[at])))
    return Row(c.effect, c.channels, c.runs, parameter, amplitude, True, others, rivals)


def _process(processes: Processes, i: int, kind: str, probability: float, share: float) -> float | None:
    """Smallest size of a process that is seen, from draws of its own eigenvectors."""
    d, runs = processes.spread(i, kind)
    drawn = stream(0, "detectable", kind).chisquare(np.repeat(runs[:, None], _DRAWS, axis=1))

    def excess(size: float) -> float:
        _, logs = size_logs(d, runs, (1.0 + size**2 * d)[:, None] * drawn)
        seen = np.mean(log_mean_exp(logs, axis=0) > threshold(share))
        return float(seen) - probability

    return crossing(excess, 1e-6, 1e6)
