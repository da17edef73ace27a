"""The search for causes: one, a second beside it, a third; each place in the set then weighed again.

At each depth the best effect of the catalogue is taken in, as long as the odds are for it; the unknown
competes at
every depth. Which depth, with or without something unknown, has the most evidence is the verdict's matter.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from fogreduce.diagnosis import priors
from fogreduce.diagnosis.inference.bundles import Bundles
from fogreduce.diagnosis.inference.candidate import Candidate
from fogreduce.diagnosis.inference.causes import Cause
from fogreduce.diagnosis.inference.departures import departures
from fogreduce.diagnosis.inference.evidence import Field, Fit, log_bayes
from fogreduce.diagnosis.inference.findings import Finding, joined
from fogreduce.diagnosis.inference.fitted import refined
from fogreduce.diagnosis.inference.model import DELAYS, Model, modelled
from fogreduce.diagnosis.inference.noise_model import Metric, Whitener, nuisances, whitener
from fogreduce.diagnosis.observe.data import Data
from fogreduce.diagnosis.which.catalogue.builder import Builder
from fogreduce.diagnosis.which.catalogue.candidates import all_candidates
from fogreduce.diagnosis.which.catalogue.converter import converter_means
from fogreduce.diagnosis.which.full_rate.fast import Fast
from fogreduce.diagnosis.which.processes.processes import Processes
from fogreduce.diagnosis.which.processes.shapes import Known
from fogreduce.diagnosis.which.unknown.families import families
from fogreduce.effects.selection import Action
from fogreduce.effects.table import EFFECTS

Array = NDArray[np.float64]

#: ln prior odds of a gap at all; of a further cause beside one; of something unknown, any family of it.
LOG_GAP, LOG_FURTHER, LOG_UNKNOWN = np.log(0.3 / 0.7), np.log(0.1), np.log(0.1)
MOST_CAUSES = 3
_NAMES = 40.0  # effects that share the prior evenly
_FAMILIES = 12.0
#: How exactly a named effect's shape is taken to be that of the catalogue, relative to its size.
SHAPE_DOUBT = 0.08
#: The same where a temperature drives it: a coil lags behind its sensor.
WARM_DOUBT = 0.15
_IMPOSSIBLE = 50.0  # ln of odds against what cannot be
_BENT = 1.0  # what a cause may change of a spectrum's pieces, in noise of one sample, and leave it as it is


Key = tuple[str, tuple[str, ...], tuple[str, ...], str]


@dataclass(frozen=True)
class Option:
    """Something that may be added: a candidate's fit or a finding, with its evidence and prior."""

    fit: Fit | None
    finding: Finding | None
    log_b: float
    log_prior: float
    raw: float = 0.0  # ln evidence before what departures from shape could make was taken off

    @property
    def source(self) -> Candidate | Finding:
        """What it comes from."""
        if self.fit is not None:
            return self.fit.candidate
        assert self.finding is not None
        return self.finding

    @property
    def known(self) -> bool:
        """Whether the catalogue has it."""
        return self.source.known

    @property
    def key(self) -> tuple[str, tuple[str, ...], tuple[str, ...], str]:
        """Effect, channels, runs, other gyro."""
        return self.source.key

    @property
    def process(self) -> bool:
        """Whether it is a further random process in block means."""
        return self.finding is not None and self.finding.domain == "process"

    @property
    def score(self) -> float:
        """Ln of evidence times prior."""
        return self.log_b + self.log_prior

    @property
    def q(self) -> float:
        """Twice the gain in ln likelihood."""
        if self.fit is not None:
            return self.fit.q
        assert self.finding is not None
        return self.finding.snr2

    def cause(self) -> Cause:
        """As a cause."""
        if self.fit is not None:
            return Cause.of_fit(self.fit)
        assert self.finding is not None
        return Cause.of_finding(self.finding)


@dataclass
class Ground:
    """What candidates are held against: whitener, metric, residual, candidates, full rate."""

    whiten: Whitener
    metric: Metric
    y: Array
    nominal: Array
    candidates: Bundles
    families: Bundles
    processes: Processes
    fast: Fast
    base: frozenset[Key] = frozenset()


@dataclass
class State:
    """A set of causes, and what is left beside them.

    Attributes
    ----------
    model : Model
        Causes that change block means, simulated.
    causes : list of Cause
        All of them.
    field : Field
        Residual left, in a metric in which their amplitudes are free and wander.
    ground : Ground
        What it stands on.
    shapes : (rows, d) array
        How the causes may wander, whitened, one standard deviation each.
    wandered : float
        Ln evidence that the causes' sizes wander a little, at least 0.
    """

    model: Model
    causes: list[Cause]
    field: Field
    ground: Ground
    shapes: Array
    wandered: float = 0.0

    @cached_property
    def seen(self) -> float:
        """Share of what the causes change that the stated uncertainties could not have made."""
        change = self.model.change
        left = self.ground.metric.without(change)
        return max(float(change @ left), 0.0) / max(float(change @ change), 1e-300)


@dataclass(frozen=True)
class Step:
    """A set of causes on the way: its state, what may be added to it, and ln of its evidence and prior."""

    state: State
    options: list[Option]
    score: float


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
    fast: Fast = field(init=False)
    ground: Ground = field(init=False)
    _beside: dict[str, Fast] = field(init=False, default_factory=dict, repr=False)
    _filters: dict[bytes, dict[tuple[object, ...], Array]] = field(
        init=False, default_factory=dict, repr=False
    )
    _known: Known = field(init=False, default_factory=Known, repr=False)

    def __post_init__(self) -> None:
        self.fast = Fast(self.data, self.allowed)
        self.ground = self._ground(())

    # ------------------------------------------------------------------------------------- ground

    def _ground(self, base: Sequence[Cause]) -> Ground:
        """Whitened residual and candidates, built about a chain with causes in it; processes whiten."""
        data = self.data
        slow = [c for c in base if c.slow]
        actions = [c.action(data.run_ids, data.n) for c in slow]
        fast = self._fast_beside(actions)
        known = self._filters.setdefault(fast.level.tobytes(), {})
        whiten = whitener(data.inputs, data.sizes, fast.level, _processes(base), known)
        nominal = whiten.rows.stacked([one.scene.block_means() for one in data.inputs])
        y = whiten(whiten.rows.stacked(fast.data.residual)[:, None])[:, 0]
        metric = Metric.of(whiten(nuisances(data.inputs, actions)))
        builder = Builder(data.inputs, whiten, actions, self.allowed, data.rails)
        return Ground(
            whiten,
            metric,
            y,
            nominal,
            Bundles(all_candidates(builder)),
            Bundles(families(data.inputs, whiten, builder.plain, self.allowed)),
            Processes(data.inputs, whiten, builder.plain, self._known),
            fast,
            frozenset(c.key for c in slow),
        )

    def _fast_beside(self, actions: Sequence[Action]) -> Fast:
        """The full rate held against a chain with effects in it, where what they change is gross."""
        if not actions:
            return self.fast
        key = repr([(a.effect.name, a.gyros, sorted(a.runs), a.parameters) for a in actions])
        if key not in self._beside:
            data = self.data
            if data.bent(actions) < _BENT:
                self._beside[key] = self.fast
                return self.fast
            whiten = self.ground.whiten
            change = whiten.rows.stacked(
                [one.scene.block_means(actions) - one.scene.block_means() for one in data.inputs]
            )
            size = float(np.linalg.norm(whiten(change[:, None])))
            self._beside[key] = Fast(data.beside(actions), self.allowed) if size > priors.GROSS else self.fast
        return self._beside[key]

    def ground_of(self, causes: Sequence[Cause]) -> Ground:
        """The ground beside some causes: its noise has their processes in it."""
        return self._ground(causes) if causes else self.ground

    def state(self, causes: Sequence[Cause], ground: Ground, refine: bool = True) -> State:
        """The causes in the chain, fitted together."""
        g = ground
        slow = [c for c in causes if c.slow]
        if refine and slow:
            model = refined(self.data.inputs, slow, g.whiten, g.nominal, g.metric, g.y)
        else:
            model = modelled(self.data.inputs, slow, g.whiten, g.nominal)
        fitted = iter(model.causes)
        merged = [next(fitted) if c.slow else c for c in causes]
        free = Field.of(g.metric.beside(model.slopes), g.y - model.change)
        data = self.data
        codes = g.whiten(converter_means(data.inputs, causes, data.noise_raw(), g.whiten.rows))
        actions = [replace(c.action(data.run_ids, data.n), ordinal=k) for k, c in enumerate(model.causes)]
        wander = [departures(data.inputs, actions, k, g.whiten.rows) for k in range(len(actions))]
        shapes = np.column_stack([g.whiten(np.column_stack(wander)), codes] if wander else [codes])
        return State(model, merged, Field.of(free.metric.wider(shapes), free.y), g, shapes, free.gain(shapes))

    # ------------------------------------------------------------------------------------ options

    def options(self, state: State) -> list[Option]:
        """Everything that may be added to a set of causes, catalogue and unknown."""
        out: list[Option] = []
        taken = {c.key for c in state.causes}
        for bundles in (state.ground.candidates, state.ground.families):
            for fit in self._with_delay(bundles.fits(state.field), state):
                if not (fit.candidate.known and fit.candidate.key in taken):
                    out.append(self._slow_option(fit, state))
        out = _not_for_being_simpler(out)
        findings = joined(
            state.ground.fast.findings(state.causes),
            state.ground.processes.findings(state.field, self.allowed),
        )
        slow_low_pass = {
            o.source.channels: o.log_b
            for o in out
            if o.known and o.key[0] == "low_pass" and o.fit is not None
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
                Option(None, finding, log_b, log_prior_of(finding.known, finding.share), max(raw, log_b))
            )
        return out

    def fits(self, state: State) -> list[Fit]:
        """Every effect held against what is left beside a set of causes, those that cannot be left out."""
        found = self._with_delay(state.ground.candidates.fits(state.field), state)
        return [fit for fit in found if not _beyond(fit)]

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
            after = self.state([*state.causes, Cause.of_fit(fit)], state.ground)
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
        if _beyond(fit):
            log_b = min(log_b, -_IMPOSSIBLE)
        return Option(fit, None, log_b, log_prior_of(c.known, c.share), fit.log_b)

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
        doubt = WARM_DOUBT if warm else SHAPE_DOUBT
        rows = state.ground.whiten.rows
        if any(not name.startswith("gyro") for name in channels):
            parts = [change]
        else:
            parts = [change[rows.of(int(name[4:]) - 1)] for name in channels]
        return doubt * float(np.sqrt(state.seen * sum(float(part @ part) for part in parts)))

    def credit(self, step: Step) -> float:
        """What departures from shape explain of what the unknown would take: ln of evidence."""
        wandered = step.state.wandered
        if not step.state.causes or any(c.process for c in step.state.causes):
            return wandered
        places = {channel for c in step.state.causes for channel in c.channels}
        anywhere = any(not place.startswith("gyro") for place in places)
        rivals = [o for o in step.options if (o.process or not o.known) and o.raw > 0.0]
        if not anywhere:
            rivals = [o for o in rivals if places.issuperset(o.source.channels)]
        return wandered + max((o.raw - max(o.log_b, 0.0) for o in rivals), default=0.0)

    # -------------------------------------------------------------------------------------- search

    def run(self, processes: bool = True) -> list[Step]:
        """Sets of no, one, two, three causes.

        Parameters
        ----------
        processes : bool
            Whether a random process may be a cause; it imitates any drift, so that both ways are worth a try.
        """
        state = self.state([], self.ground)
        options = self.options(state)
        path = [Step(state, options, 0.0)]
        score, depth = 0.0, 0
        hollow: set[Key] = set()
        while depth < MOST_CAUSES:
            choice = [o for o in options if o.known and (processes or not o.process) and o.key not in hollow]
            best = max(choice, key=lambda o: o.score, default=None)
            further = LOG_GAP if depth == 0 else LOG_FURTHER
            if best is None or best.score + further < 0.0:
                break
            causes = [*state.causes, best.cause()]
            # where departures from shape are credited to what is left, a cause that takes it gets that back
            gain = best.raw + best.log_prior + further
            # the unknown counts with all its families, and so does what could stand in this one's place
            gain += float(np.logaddexp.reduce([o.score - best.score for o in choice]))
            taken = self.state(causes, state.ground)
            if best.fit is not None:
                # an effect, simulated, may not do what its column promised: it was no small step
                done = self.gained(state, taken)
                if done < 0.5 * best.q:
                    hollow.add(best.key)
                    continue
            taken = self._settled(taken, best)
            score += gain
            # evidence of the new one was taken beside the wandering of those before
            score += max(path[-1].state.wandered - taken.wandered, 0.0)
            depth += 1
            state, change = self._weighed_again(taken, processes)
            options = self.options(state)
            score += change
            path.append(Step(state, options, score))
        return path

    def gained(self, before: State, after: State) -> float:
        """Twice what a cause, simulated, adds to ln likelihood."""
        metric, y = before.ground.metric, before.ground.y
        return Field.of(metric, y - before.model.change).chi2 - Field.of(metric, y - after.model.change).chi2

    def _settled(self, taken: State, best: Option) -> State:
        """The causes on a ground with a gross one in the chain, or a random process in the noise."""
        gross = best.fit is not None and best.q > priors.GROSS**2
        if not (gross or best.process):
            return taken
        return self.state(taken.causes, self._ground(taken.causes))

    def _weighed_again(self, state: State, processes: bool) -> tuple[State, float]:
        """Every cause but the last set against all others in its place; the better one stays."""
        change = 0.0
        for k in range(len(state.causes) - 1):
            cause, ground = state.causes[k], state.ground
            if (cause.finding is not None and not cause.process) or cause.key in ground.base:
                continue
            others = [c for j, c in enumerate(state.causes) if j != k]
            if cause.process:
                ground = self._ground_beside(others, ground)
            without = self.state(others, ground, refine=False)
            choice = [o for o in self.options(without) if o.known and (processes or not o.process)]
            now = next((o for o in choice if o.key == cause.key), None)
            best = max(choice, key=lambda o: o.score, default=None)
            if now is None or best is None or (best.process and not cause.process):
                continue
            # what departures of the others may have made of it counts alike for both
            better = min(best.score - now.score, best.raw + best.log_prior - now.raw - now.log_prior)
            if better > 1.0:
                change += better
                causes = [*others[:k], best.cause(), *others[k:]]
                state = self.state(causes, self._ground_beside(causes, ground) if best.process else ground)
        return state, change

    def _ground_beside(self, causes: Sequence[Cause], ground: Ground) -> Ground:
        """The ground with the processes of other causes in its noise, and the same in its chain."""
        base = [c for c in causes if c.process or c.key in ground.base]
        return self._ground(base) if base else self.ground


def _not_for_being_simpler(options: list[Option]) -> list[Option]:
    """The unknown must fit better than an effect with a direction in it: fewer numbers are no evidence.

    Where all runs turn about one axis, a magnetic field is a wave of the angle; and the larger it is, the
    more would its third number cost it.
    """
    named: dict[tuple[str, ...], list[Option]] = {}
    for o in options:
        if o.known and o.fit is not None and o.fit.candidate.columns.shape[2] > 1:
            named.setdefault(o.source.channels, []).append(o)
    out = []
    for o in options:
        if not o.known and o.fit is not None:
            numbers = o.fit.candidate.columns.shape[2]
            for rival in named.get(o.source.channels, ()):
                assert rival.fit is not None
                if rival.fit.candidate.columns.shape[2] >= numbers:
                    most = rival.raw + 0.5 * max(o.q - rival.q, 0.0) - priors.AS_WELL
                    less = max(o.raw - most, 0.0)
                    o = replace(o, log_b=o.log_b - less, raw=o.raw - less)
        out.append(o)
    return out


def _beyond(fit: Fit) -> bool:
    """Whether an effect would need a number that it does not accept, as a scale factor less than nothing."""
    c = fit.candidate
    if not c.known or c.fixed:
        return False
    values = dict(zip(c.scales, (fit.coefficients * c.steps[fit.best]).tolist(), strict=False))
    limits = {p.name: (p.low, p.high) for p in EFFECTS[c.effect].parameters if p.kind == "number"}
    return any(not limits[k][0] <= v <= limits[k][1] for k, v in values.items() if k in limits)


def log_prior_of(known: bool, share: float) -> float:
    """Ln prior of an effect, or of something unknown, at a place that has a share of its name."""
    if known:
        return float(np.log(share / _NAMES))
    return float(LOG_UNKNOWN + np.log(share / _FAMILIES))


def _processes(causes: Sequence[Cause]) -> dict[tuple[str, int], float]:
    """Sizes of the random processes among causes, by kind and gyro."""
    return {key: size for c in causes for key, size in c.process.items()}
