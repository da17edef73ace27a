"""The next run: which one separates the rivals that are still alive, and with what significance.

Two rivals that predict for a run what lies d standard deviations apart are confused with a probability of
at most ``exp(-d^2 / 8)`` (Chernoff); the best run has the least of it over all pairs, each weighed by how
probable both are.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from itertools import combinations
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fogreduce.diagnosis.inference.causes import SHAPES, Cause
from fogreduce.diagnosis.inference.model import simulated
from fogreduce.diagnosis.inference.noise_model import Metric, Whitener, nuisances, whitener
from fogreduce.diagnosis.inference.options import Option
from fogreduce.diagnosis.inference.outcome import Named, Verdict
from fogreduce.diagnosis.inference.search import Search
from fogreduce.diagnosis.next.runs import (
    ANY_BENCH,
    DURATIONS,
    RUN_ID,
    Proposal,
    as_input,
    lasting,
    longest_s,
    proposals,
    temperature,
)
from fogreduce.diagnosis.observe.capture import RunInput
from fogreduce.diagnosis.report.words import named
from fogreduce.effects.table import EFFECTS
from fogreduce.metadata.bench import Bench

Array = NDArray[np.float64]
#: Inner products of two rivals' numbers, of each with itself and with the other.
Blocks = Sequence[Sequence[Array]]

_MOST_RIVALS = 8
_PROMISING_SIGMA = 3.0  # separation from which on a longer run is worth a try [sigma]
_SEPARATED_SIGMA = 6.0  # separation from which on two rivals count as told apart [sigma]


@dataclass(frozen=True)
class NextRun:
    """The run proposed.

    Attributes
    ----------
    proposal : Proposal
    one : Named
        The cause whose rivals it separates.
    rivals : tuple of Cause
        With their fitted values, the cause itself first.
    document : mapping
        As a diagnosis has it.
    """

    proposal: Proposal
    one: Named
    rivals: tuple[Cause, ...]
    document: dict[str, Any]


def proposed(search: Search, verdict: Verdict, limits: Bench = ANY_BENCH) -> NextRun | None:
    """The run that best separates the rivals of the cause that is least sure; None where none has any.

    Parameters
    ----------
    search, verdict :
        The diagnosis of today's runs.
    limits : Bench
        What table and chamber can do.
    """
    doubtful = [one for one in verdict.named if len(one.group) > 1]
    if not doubtful:
        return None
    one = min(doubtful, key=lambda named: named.probability)
    leading = verdict.state.causes[one.index]
    others = [(o, p) for o, p in one.group if o.key != leading.key][: _MOST_RIVALS - 1]
    rivals = (leading, *(o.cause() for o, _ in others))
    weight = np.array([max(one.probability, 1e-3), *(max(p, 1e-3) for _, p in others)])
    evidence = _evidence(one, leading, [o for o, _ in others])
    separations = _Separations(search, rivals, evidence, _today(search, verdict, rivals))
    soaks = any(EFFECTS[c.effect].needs_temperature and not c.unlogged for c in rivals)
    motion = _best(separations, list(proposals(search.data.inputs, soaks, limits)), weight)
    # no longer than it takes; where no length is enough, the longest
    chosen, separation = motion, np.zeros((len(rivals), len(rivals)))
    for part in DURATIONS:
        seconds = float(round(part * longest_s(search.data.inputs), 3))
        chosen = lasting(motion, seconds, search.data.inputs, limits)
        separation = separations.separation(chosen)
        if separated_rivals(separation, weight, _PROMISING_SIGMA)[0] >= _SEPARATED_SIGMA:
            break
    document = _document(search.data.inputs, chosen, rivals, separation, weight)
    return NextRun(chosen, one, rivals, document)


def _best(separations: _Separations, runs: Sequence[Proposal], weight: Array) -> Proposal:
    """The run with the least confusion; what cannot beat the best so far is not looked at closely."""
    # stated uncertainties can only hide a difference: without them confusion is the least that it may be
    least = [confusion(separations.separation(run, stated=False), weight) for run in runs]
    best: tuple[float, Proposal] = (np.inf, runs[0])
    for bound, run in sorted(zip(least, runs, strict=True), key=lambda pair: pair[0]):
        if bound >= best[0]:
            break
        best = min(best, (confusion(separations.separation(run), weight), run), key=lambda pair: pair[0])
    return best[1]


def _today(search: Search, verdict: Verdict, rivals: Sequence[Cause]) -> list[list[Array]]:
    """Inner products of what units of the rivals' numbers change in today's runs, of each pair (k, l)."""
    problem = verdict.state.problem
    inputs, rows = search.data.inputs, problem.whiten.rows
    plain = simulated(inputs, [], rows)
    parts = [np.column_stack([simulated(inputs, [u], rows) - plain for u in _units(c)]) for c in rivals]
    white = [problem.whiten(part) for part in parts]
    return [[problem.metric.gram(a, b) for b in white] for a in white]


def _units(cause: Cause) -> list[Cause]:
    """A cause at a unit of each of its numbers alone; as it was fitted where it has no more than one."""
    names = [name for name in cause.theta if name not in SHAPES]
    if len(names) < 2:
        return [cause]
    return [replace(cause, theta={**cause.theta, **dict.fromkeys(names, 0.0), name: 1.0}) for name in names]


def _sizes(cause: Cause) -> Array:
    """Those numbers (k,)."""
    names = [name for name in cause.theta if name not in SHAPES]
    return np.array([cause.theta[name] for name in names]) if len(names) > 1 else np.ones(1)


def _evidence(one: Named, leading: Cause, others: Sequence[Option]) -> Array:
    """Ln evidence of each rival from today's runs, the cause itself first."""
    mine = next((o.log_b for o, _ in one.group if o.key == leading.key), others[0].log_b)
    return np.array([mine, *(o.log_b for o in others)])


def separation_squared(today: Blocks, new: Blocks, sizes: tuple[Array, Array]) -> float:
    """Squared distance of two rivals in all runs, the one at its fitted size, the other at any, and in any
    direction.

    Parameters
    ----------
    today, new : 2 x 2 blocks
        Inner products of what units of the two's numbers change, in the runs that there are and in the new
        one.
    sizes : pair of (k,) arrays
        Their numbers as fitted.
    """
    if min(float(np.trace(today[k][k])) for k in (0, 1)) <= 0.0:
        # a random process has no change of its own to be scaled
        first, second, both = (float(sizes[a] @ new[a][b] @ sizes[b]) for a, b in ((0, 0), (1, 1), (0, 1)))
        return first + second - 2.0 * both
    whole = [[today[a][b] + new[a][b] for b in (0, 1)] for a in (0, 1)]
    # what today's runs have said already is not said again
    said = [_left(whole, k, sizes[k]) - _left(today, k, sizes[k]) for k in (0, 1)]
    return max(min(said), 0.0)


def _left(gram: Blocks, k: int, sizes: Array) -> float:
    """What is left of one rival beside the other."""
    cross = gram[k][1 - k]
    shared = cross @ np.linalg.pinv(gram[1 - k][1 - k], rcond=1e-10, hermitian=True) @ cross.T
    return float(sizes @ (gram[k][k] - shared) @ sizes)


def confusion(separation: Array, weight: Array) -> float:
    """A bound of the probability that the run's likeliest rival is the wrong one (Chernoff).

    Parameters
    ----------
    separation : (rivals, rivals) array
        Distances between what the rivals predict [sigma].
    weight : (rivals,) array
        Probability of each from today's runs.
    """
    pairs = combinations(range(len(weight)), 2)
    return float(sum(weight[a] * weight[b] * np.exp(-(separation[a, b] ** 2) / 8.0) for a, b in pairs))


def separated_rivals(
    separation: Array, weight: Array, enough: float = _SEPARATED_SIGMA
) -> tuple[float, list[int]]:
    """The least separation of the rivals that the run tells apart from one another, and which they are.

    Where it tells none apart, of the best pair.

    Parameters
    ----------
    separation : (rivals, rivals) array
        Distances between what the rivals predict [sigma].
    weight : (rivals,) array
        Probability of each from today's runs.
    enough : float
        Distance [sigma] from which on two are told apart.
    """
    order = np.argsort(-weight, kind="stable").tolist()
    separated = [order[0]]
    for k in order[1:]:
        if all(separation[k, other] >= enough for other in separated):
            separated.append(k)
    if len(separated) == 1:
        separated.append(max(order[1:], key=lambda k: float(separation[order[0], k])))
    return float(min(separation[a, b] for a, b in combinations(separated, 2))), separated


@dataclass
class _Separations:
    """Rivals set against runs that might be next."""

    search: Search
    rivals: Sequence[Cause]
    evidence: Array
    today: list[list[Array]]
    _whiteners: dict[tuple[object, ...], Whitener] = field(default_factory=dict)

    def separation(self, proposal: Proposal, stated: bool = True) -> Array:
        """Distances (rivals, rivals) between what the rivals predict for a run [sigma].

        Parameters
        ----------
        proposal : Proposal
        stated : bool
            Whether the stated uncertainties are in it; without them it is quick and too great.
        """
        inputs = self.search.data.inputs
        here = as_input(inputs, proposal)
        plain = here.scene.block_means()
        columns = nuisances([here]) if stated else np.zeros((plain.size, 0))
        metrics: dict[int, Metric] = {}
        changes = [self._change(here, cause, plain) for cause in self.rivals]
        size, sizes = len(self.rivals), [_sizes(c) for c in self.rivals]
        out = np.zeros((size, size))
        for a, b in combinations(range(size), 2):
            if any(self._at_full_rate(k) for k in (a, b)):
                # what these runs say for one against the other grows with time, whatever the table does
                seconds = sum(one.run.duration_s for one in inputs)
                said = 2.0 * abs(self.evidence[a] - self.evidence[b]) * proposal.duration_s / seconds
                d2 = said
            else:
                whiten = self._whitener(here, [self.rivals[a], self.rivals[b]])
                if id(whiten) not in metrics:
                    metrics[id(whiten)] = Metric.of(whiten(columns))
                white = [whiten(changes[k]) for k in (a, b)]
                new = [[metrics[id(whiten)].gram(x, y) for y in white] for x in white]
                today = [[self.today[k][m] for m in (a, b)] for k in (a, b)]
                d2 = separation_squared(today, new, (sizes[a], sizes[b]))
            out[a, b] = out[b, a] = np.sqrt(max(d2, 0.0))
        return out

    def _at_full_rate(self, k: int) -> bool:
        cause = self.rivals[k]
        return not cause.slow and not cause.process

    def _change(self, here: RunInput, cause: Cause, plain: Array) -> Array:
        """What units of a rival's numbers change in the block means of a run, (rows, k) [deg/h]."""
        units = _units(cause)
        cold = EFFECTS[cause.effect].needs_temperature and here.scene.temperature is None
        if cold or not cause.slow or cause.runs != ("*",):
            return np.zeros((plain.size, len(units)))
        here = replace(here, facts=replace(here.facts, run_id=RUN_ID))
        scene = replace(here.scene, facts=here.facts)
        actions = [unit.action([RUN_ID], here.facts.n_gyros) for unit in units]
        return np.column_stack([(scene.block_means([one]) - plain).reshape(-1) for one in actions])

    def _whitener(self, here: RunInput, pair: Sequence[Cause]) -> Whitener:
        """Of runs of one length; a rival that is a random process is part of the noise."""
        further = {key: size for c in pair for key, size in c.process.items()}
        blocks = here.scene.blocks
        key = (blocks.count, blocks.length_s, *sorted(further.items()))
        if key not in self._whiteners:
            full = np.full((here.facts.n_gyros, blocks.count), blocks.length_s * here.facts.sample_rate_hz)
            self._whiteners[key] = whitener([here], [full], self.search.full_rate.level[:1], further)
        return self._whiteners[key]


def _document(
    inputs: Sequence[RunInput],
    proposal: Proposal,
    rivals: Sequence[Cause],
    separation: Array,
    weight: Array,
) -> dict[str, Any]:
    sigma, separated = separated_rivals(separation, weight)
    names = [named(rivals[k]) for k in separated]
    left = [named(rivals[k]) for k in range(len(rivals)) if k not in separated or sigma < _SEPARATED_SIGMA]
    least = "" if len(names) == 2 else " or more"
    why = f"{proposal.words}: {names[0]} is then told from {', '.join(names[1:])} by {sigma:.1f} sigma{least}"
    if sigma < _SEPARATED_SIGMA:
        why += (
            f", which is not enough ({_SEPARATED_SIGMA:g} would be), and no run that was weighed brings more"
        )
    elif left:
        why += f". {', '.join(left)}: not told from all of these"
    if any(c.unlogged for c in rivals):
        why += ". A temperature log in every run would tell what a temperature does from the rest"
    out: dict[str, Any] = {
        "separates": names if sigma >= _SEPARATED_SIGMA else [],
        "table": {"axis": proposal.axis, "profile": proposal.profile()},
        "orientation": proposal.orientation,
        "expected_sigma": round(sigma, 3),
        "why": why,
    }
    if left:
        out["leaves"] = left
    log = temperature(inputs, proposal)
    if log is not None:
        start, end = float(log.sensor_degC[0]), float(log.sensor_degC[-1])
        warmed = [{"time_s": proposal.duration_s / 2.0, "sensor_degC": end}] if proposal.soak_degC else []
        out["temperature"] = [{"time_s": 0.0, "sensor_degC": start}, *warmed]
    return out
