"""A campaign in which causes are sought: problems, sets of causes fitted on them, and what may be added."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from fogreduce.diagnosis import priors
from fogreduce.diagnosis.inference.candidates import Candidates
from fogreduce.diagnosis.inference.causes import Cause
from fogreduce.diagnosis.inference.departures import departures
from fogreduce.diagnosis.inference.evidence import Fit, WhitenedResidual, log_bayes
from fogreduce.diagnosis.inference.findings import joined
from fogreduce.diagnosis.inference.fitted import refined
from fogreduce.diagnosis.inference.model import DELAYS, modelled
from fogreduce.diagnosis.inference.noise_model import Metric, nuisances, whitener
from fogreduce.diagnosis.inference.options import Option, beyond, log_prior_of, not_for_being_simpler
from fogreduce.diagnosis.inference.problem import Problem, State, processes_of
from fogreduce.diagnosis.observe.data import Data, steady
from fogreduce.diagnosis.which.catalogue.builder import Builder
from fogreduce.diagnosis.which.catalogue.candidates import all_candidates
from fogreduce.diagnosis.which.catalogue.converter import converter_means
from fogreduce.diagnosis.which.full_rate.statistics import FullRateStatistics
from fogreduce.diagnosis.which.processes.processes import Processes
from fogreduce.diagnosis.which.processes.shapes import ProcessCache
from fogreduce.diagnosis.which.unknown.families import families
from fogreduce.effects.selection import Action

Array = NDArray[np.float64]


@dataclass
class Search:
    """A campaign being diagnosed.

    Parameters
    ----------
    data : Data
    allowed : names of effects
    """

    data: Data
    allowed: frozenset[str]
    full_rate: FullRateStatistics = field(init=False)
    problem: Problem = field(init=False)
    _full_rates: dict[str, FullRateStatistics] = field(init=False, default_factory=dict, repr=False)
    _filters: dict[bytes, dict[tuple[object, ...], Array]] = field(
        init=False, default_factory=dict, repr=False
    )
    _builder: Builder | None = field(init=False, default=None, repr=False)
    _processes: ProcessCache = field(init=False, default_factory=ProcessCache, repr=False)

    def __post_init__(self) -> None:
        self.full_rate = FullRateStatistics(self.data, self.allowed)
        self.problem = self._problem(())

    # ------------------------------------------------------------------------------------- problem

    def _problem(self, base: Sequence[Cause], coarser: Mapping[int, float] | None = None) -> Problem:
        """Whitened residual and candidates, built about a chain with causes in it; processes whiten."""
        data = self.data
        slow = [c for c in base if c.slow]
        actions = [c.action(data.run_ids, data.n) for c in slow]
        full_rate = self._full_rate_with(actions)
        filters = self._filters.setdefault(full_rate.level.tobytes(), {})
        whiten = whitener(data.inputs, data.sizes, full_rate.level, processes_of(base), filters)
        if coarser:
            whiten = whiten.coarser(coarser)
        nominal = whiten.rows.stacked([one.scene.block_means() for one in data.inputs])
        y = whiten(whiten.rows.stacked(full_rate.data.residual)[:, None])[:, 0]
        metric = Metric.of(whiten(nuisances(data.inputs, actions)))
        builder = Builder(data.inputs, whiten, actions, self.allowed, data.rails, self._builder)
        self._builder = builder
        return Problem(
            whiten,
            metric,
            y,
            nominal,
            Candidates(all_candidates(builder)),
            Candidates(families(data.inputs, whiten, builder.plain, self.allowed)),
            Processes(data.inputs, whiten, builder.plain, self._processes),
            full_rate,
            frozenset(c.key for c in slow),
        )

    def _full_rate_with(self, actions: Sequence[Action]) -> FullRateStatistics:
        """The full rate held against a chain with effects in it, where what they change is gross."""
        actions = steady(actions)
        if not actions:
            return self.full_rate
        key = repr([(a.effect.name, a.gyros, sorted(a.runs), a.parameters) for a in actions])
        if key not in self._full_rates:
            data = self.data
            if data.bent(actions) < priors.BENT:
                self._full_rates[key] = self.full_rate
                return self.full_rate
            whiten = self.problem.whiten
            change = whiten.rows.stacked(
                [one.scene.block_means(actions) - one.scene.block_means() for one in data.inputs]
            )
            size = float(np.linalg.norm(whiten(change[:, None])))
            self._full_rates[key] = (
                FullRateStatistics(data.with_effects(actions), self.allowed)
                if size > priors.GROSS
                else self.full_rate
            )
        return self._full_rates[key]

    def problem_with(self, causes: Sequence[Cause], coarser: Mapping[int, float] | None = None) -> Problem:
        """The problem beside some causes: its noise has their processes in it, that of some gyros (their
        numbers) so many times as large.
        """
        return self._problem(causes, coarser) if causes or coarser else self.problem

    def state(self, causes: Sequence[Cause], problem: Problem, refine: bool = True) -> State:
        """The causes in the chain, fitted together."""
        g = problem
        slow = [c for c in causes if c.slow]
        if refine and slow:
            model = refined(self.data.inputs, slow, g.whiten, g.nominal, g.metric, g.y)
        else:
            model = modelled(self.data.inputs, slow, g.whiten, g.nominal)
        fitted = iter(model.causes)
        merged = [next(fitted) if c.slow else c for c in causes]
        free = WhitenedResidual.of(g.metric.with_free(model.slopes), g.y - model.change)
        data = self.data
        codes = g.whiten(converter_means(data.inputs, causes, data.noise_raw(), g.whiten.rows))
        actions = [replace(c.action(data.run_ids, data.n), ordinal=k) for k, c in enumerate(model.causes)]
        wander = [departures(data.inputs, actions, k, g.whiten.rows) for k in range(len(actions))]
        shapes = np.column_stack([g.whiten(np.column_stack(wander)), codes] if wander else [codes])
        return State(model, merged, WhitenedResidual.of(free.metric.wider(shapes), free.y), g, shapes)

    # ------------------------------------------------------------------------------------ options

    def options(self, state: State) -> list[Option]:
        """Everything that may be added to a set of causes, catalogue and unknown."""
        out: list[Option] = []
        taken = {c.key for c in state.causes}
        for candidates in (state.problem.candidates, state.problem.families):
            for fit in self._with_delay(candidates.fits(state.residual), state):
                if not (fit.candidate.catalogued and fit.candidate.key in taken):
                    out.append(self._slow_option(fit, state))
        out = not_for_being_simpler(out)
        findings = joined(
            state.problem.full_rate.findings(state.causes),
            state.problem.processes.findings(state.residual, self.allowed),
        )
        slow_low_pass = {
            o.source.channels: o.log_b
            for o in out
            if o.catalogued and o.key[0] == "low_pass" and o.fit is not None
        }
        out = [o for o in out if o.key[0] != "low_pass"]
        for finding in findings:
            if finding.key in taken:
                continue
            log_b = raw = finding.log_b
            if finding.effect == "low_pass":
                log_b += max(slow_low_pass.get(finding.channels, 0.0), 0.0)
            if finding.domain == "process":
                log_b = self._doubted(log_b, finding.snr2, 8, state, finding.channels)
            out.append(
                Option(None, finding, log_b, log_prior_of(finding.catalogued, finding.share), max(raw, log_b))
            )
        return out

    def fits(self, state: State) -> list[Fit]:
        """Every effect held against what is left beside a set of causes, those that cannot be left out."""
        found = self._with_delay(state.problem.candidates.fits(state.residual), state)
        return [fit for fit in found if not beyond(fit)]

    def _with_delay(self, fits: Iterable[Fit], state: State) -> list[Fit]:
        """Fits, that of the best gross delay simulated: an edge in another block is no small step."""
        out = list(fits)
        late = [
            k
            for k, fit in enumerate(out)
            if fit.q > priors.GROSS**2 and DELAYS.keys() & set(fit.candidate.scales)
        ]
        if late:
            k = max(late, key=lambda k: out[k].q)
            fit, c = out[k], out[k].candidate
            after = self.state([*state.causes, Cause.of_fit(fit)], state.problem)
            done = self.gained(state, after)
            if done > fit.q:
                found = np.array([after.causes[-1].theta[name] for name in c.scales])
                log_b = fit.log_b + 0.5 * (done - fit.q)
                out[k] = replace(fit, log_b=log_b, q=done, coefficients=found / c.steps[fit.best])
        return out

    def _slow_option(self, fit: Fit, state: State) -> Option:
        c = fit.candidate
        k = c.columns.shape[2]
        log_b = fit.log_b if c.fixed else self._doubted(fit.log_b, fit.q, k, state, c.channels)
        if beyond(fit):
            log_b = min(log_b, -priors.IMPOSSIBLE)
        return Option(fit, None, log_b, log_prior_of(c.catalogued, c.share), fit.log_b)

    def _doubted(self, log_b: float, q: float, k: int, state: State, channels: Sequence[str]) -> float:
        """Evidence less what mere departures of the causes found from the catalogue's shape could make."""
        size = self.doubt_at(state, channels)
        if size == 0.0 or q <= 0.0:
            return log_b
        less = max(np.sqrt(q) - size, 0.0) ** 2
        return log_b + float(log_bayes(np.array(less), k) - log_bayes(np.array(q), k))

    def doubt_at(self, state: State, channels: Sequence[str]) -> float:
        """Signal-to-noise ratio that departures of the causes from their shape may have at these channels."""
        change = state.model.change
        if not change.any():
            return 0.0
        warm = any(c.effect.startswith("temperature") for c in state.causes)
        doubt = priors.WARM_DEPARTURE if warm else priors.DEPARTURE
        rows = state.problem.whiten.rows
        if any(not name.startswith("gyro") for name in channels):
            parts = [change]
        else:
            parts = [change[rows.of(int(name[4:]) - 1)] for name in channels]
        return doubt * float(np.sqrt(state.seen * sum(float(part @ part) for part in parts)))

    def gained(self, before: State, after: State) -> float:
        """Twice what a cause, simulated, adds to ln likelihood."""
        metric, y = before.problem.metric, before.problem.y
        return (
            WhitenedResidual.of(metric, y - before.model.change).chi2
            - WhitenedResidual.of(metric, y - after.model.change).chi2
        )
