"""Further random processes in a gyro's block means: flicker, a random walk, or one of no catalogue.

In the eigenvectors of the whitened process a residual z has the variance 1 + A^2 d, so that for each size A

    ln B = sum -1/2 ln(1 + A^2 d) + 1/2 z^2 A^2 d / (1 + A^2 d).

Constants of each run are projected out: turn-on biases and scale factors speak for those. A process that
forgets its past after some seconds stands for what the catalogue has not; so does one that goes with the
reading, as an unsteady scale factor does; and one that jumps between two levels (`jumps`).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from fogreduce.diagnosis.inference.evidence import WhitenedResidual, log_mean_exp
from fogreduce.diagnosis.inference.findings import Finding
from fogreduce.diagnosis.inference.noise_model import Whitener
from fogreduce.diagnosis.observe.capture import RunInput
from fogreduce.diagnosis.which.catalogue.unlogged import HOLDS_S, UNLOGGED
from fogreduce.diagnosis.which.full_rate.spectrum import DRIFTS
from fogreduce.diagnosis.which.processes.jumps import Record, jumps_add
from fogreduce.diagnosis.which.processes.shapes import ProcessCache, Shapes
from fogreduce.diagnosis.which.processes.sizes import size_logs, whole_evidence
from fogreduce.effects.gyro_names import gyro_name

Array = NDArray[np.float64]

_FORGETS_S = (1.5, 5.0, 15.0, 45.0)
_SHARE = 3.0  # how often the unknown is a process, beside other families
_OF_GAIN = 0.5  # of those, how often it goes with the reading
_JUMPS = 0.5  # and how often it jumps
_WORTH = 4.0  # ln evidence of a process from which on jumps are looked for


class Processes:
    """Eigenvectors of every process at every gyro; they hold for any residual under the same whitener.

    Parameters
    ----------
    inputs : runs
    whiten : Whitener
    plain : (n, blocks) arrays
        Predicted readings in each run's blocks [deg/h].
    cache : ProcessCache
        What was found before, to which more is added.
    """

    def __init__(
        self,
        inputs: Sequence[RunInput],
        whiten: Whitener,
        plain: Sequence[Array],
        cache: ProcessCache | None = None,
    ) -> None:
        self.inputs, self.whiten = inputs, whiten
        self._shapes = Shapes(inputs, whiten, plain, cache or ProcessCache())
        self._found: dict[tuple[bytes, frozenset[str]], list[Finding]] = {}
        self._warm = all(one.scene.temperature is not None for one in inputs)
        self._turns = any(bool(np.any(one.facts.profile.rate_deg_s != 0.0)) for one in inputs)

    def findings(self, residual: WhitenedResidual, allowed: frozenset[str]) -> list[Finding]:
        """Every process at every gyro; remembered, for a residual may come again.

        Parameters
        ----------
        residual : WhitenedResidual
            Whitened residual less causes, and the metric of stated uncertainties and causes.
        allowed : names of effects
        """
        left = residual.metric.without(residual.y)
        key = (left.tobytes(), allowed)
        if key not in self._found:
            self._found[key] = list(self._findings(residual, left, allowed))
        return self._found[key]

    def _findings(
        self, residual: WhitenedResidual, left: Array, allowed: frozenset[str]
    ) -> Iterator[Finding]:
        n = self.whiten.rows.n
        # what may jump: place, its record, and ln evidence, gain and share of the process without jumps
        jumping: list[tuple[tuple[str, ...], Record, float, float, float]] = []
        for i in range(n):
            name = (gyro_name(i),)
            for effect, (kind, parameter) in DRIFTS.items():
                log_b, gain, value, std = self._weighed(left, i, kind)
                catalogued = effect in allowed
                yield Finding(
                    effect if catalogued else "unknown",
                    name,
                    ("*",),
                    log_b,
                    2.0 * gain,
                    {parameter: (value, std)} if catalogued else {},
                    1.0 / n,
                    "process",
                    "noise" if catalogued else "gyro",
                    "low_frequency",
                    8,
                    (kind, value) if catalogued else None,
                )
            if not self._warm:
                yield from self._unlogged(residual, left, i, allowed)
            kinds = [("forgets", _SHARE)]
            if self._turns:
                kinds.append(("gain forgets", _SHARE * _OF_GAIN))
            for kind, weight in kinds:
                share = weight / n
                found = [self._weighed(left, i, f"{kind} {time}") for time in _FORGETS_S]
                for log_b, gain, _, _ in found:
                    yield _unknown(name, log_b, gain, share / len(_FORGETS_S))
                best = max(found, key=lambda one: one[0])
                if best[0] > _WORTH:
                    log_b = float(log_mean_exp(np.array([one[0] for one in found])))
                    jumping.append((name, self._record(left, i, kind), log_b, best[1], share * _JUMPS))
        added = jumps_add([one[1] for one in jumping])
        for (place, _, log_b, gain, share), more in zip(jumping, added, strict=True):
            yield _unknown(place, log_b + more, gain + more, share)

    def _unlogged(
        self, residual: WhitenedResidual, left: Array, i: int, allowed: frozenset[str]
    ) -> Iterator[Finding]:
        """What a temperature without a log may do at gyro i; nobody knows how far it went: it has no numbers.

        That there is one, its waveform says. Which effect it drives, the runs' means say as well: warmth
        begins at nothing, its rate does not.
        """
        name, share = (gyro_name(i),), 1.0 / self.whiten.rows.n
        by_effect: dict[str, tuple[float, float, float, str]] = {}
        for effect, kind in UNLOGGED.items():
            if kind.startswith("gain") and not self._turns:
                continue
            found = [(*self._weighed(left, i, f"{kind} {hold}")[:3], f"{kind} {hold}") for hold in HOLDS_S]
            _, gain, size, best = max(found, key=lambda one: one[0])
            by_effect[effect] = float(log_mean_exp(np.array([one[0] for one in found]))), gain, size, best
        total = float(np.logaddexp.reduce([one[0] for one in by_effect.values()]))
        # less than no evidence at all makes none of them a rival of anything: then theirs stay as they are
        shares = self._shares(residual, i, list(by_effect)) if total > 0.0 else {}
        for effect, (log_b, gain, size, best) in by_effect.items():
            if shares:
                log_b = total + shares[effect]
            if effect not in allowed:
                yield _unknown(name, log_b, gain, share)
                continue
            yield Finding(
                effect,
                name,
                ("*",),
                log_b,
                2.0 * gain,
                {},
                share,
                "process",
                "gyro",
                "low_frequency",
                8,
                (best, size),
            )

    def _shares(self, residual: WhitenedResidual, i: int, effects: Sequence[str]) -> dict[str, float]:
        """Ln of the part that each effect without a log has in what they explain together, means in it."""
        runs = range(len(self.inputs))
        rows, whole = [self.whiten.rows.of(i, r) for r in runs], []
        for effect in effects:
            kind = UNLOGGED[effect].removeprefix("gain ")
            factors = [None if kind == UNLOGGED[effect] else p[i] for p in self._shapes.reading]
            logs = [
                whole_evidence(
                    residual, rows, [self._shapes.modes(i, r, f"{kind} {hold}", factors[r]) for r in runs]
                )
                for hold in HOLDS_S
            ]
            whole.append(float(log_mean_exp(np.array(logs))))
        total = float(np.logaddexp.reduce(whole))
        return {effect: one - total for effect, one in zip(effects, whole, strict=True)}

    def _record(self, left: Array, i: int, kind: str) -> Record:
        """Block means of a gyro, in which jumps of either kind are looked for."""
        runs = range(len(self.inputs))
        length = max(one.scene.blocks.count for one in self.inputs)
        values, seen = np.zeros((len(runs), length)), np.zeros((len(runs), length), bool)
        weights = np.ones(len(runs))
        for r in runs:
            matrix = self.whiten.filters[i, r]
            part, count = self.whiten.rows.of(i, r), len(matrix)
            values[r, :count] = self._shapes.inverse(i, r)[0] @ left[part]
            scale = np.diag(matrix)
            # a block without samples has next to no weight
            seen[r, :count] = scale > 0.1 * float(np.median(scale))
            if kind.startswith("gain"):
                weights[r] = float(np.mean(self._shapes.reading[r][i]))
        lengths = np.array([one.scene.blocks.length_s for one in self.inputs])
        backgrounds = [self._shapes.inverse(i, r)[1] for r in runs]
        return Record(values, seen, weights, backgrounds, lengths)

    def spread(self, i: int, kind: str) -> tuple[Array, Array]:
        """Variances of the process of unit size at gyro i in its eigenvectors; how many runs share each."""
        alike: dict[int, tuple[Array, int]] = {}
        for r in range(len(self.inputs)):
            _, d = self._shapes.eigen(i, r, kind)
            alike[id(d)] = (d, alike.get(id(d), (d, 0))[1] + 1)
        every = list(alike.values())
        return np.concatenate([d for d, _ in every]), np.concatenate(
            [np.full(len(d), float(k)) for d, k in every]
        )

    def _weighed(self, left: Array, i: int, kind: str) -> tuple[float, float, float, float]:
        """Ln B, best gain in ln likelihood, best size and its error."""
        # runs that share a filter share eigenvectors: (their variances, how many runs, sums of powers)
        alike: dict[int, tuple[Array, list[Array]]] = {}
        for r in range(len(self.inputs)):
            vectors, d = self._shapes.of(i, r, kind)
            power = (vectors.T @ left[self.whiten.rows.of(i, r)]) ** 2
            alike.setdefault(id(d), (d, []))[1].append(power)
        d = np.concatenate([d for d, _ in alike.values()])
        runs = np.concatenate([np.full(len(d), float(len(p))) for d, p in alike.values()])
        z2 = np.concatenate([np.sum(p, axis=0) for _, p in alike.values()])
        a2, logs = size_logs(d, runs, z2)
        k = int(np.argmax(logs))
        size = float(np.sqrt(a2[k]))
        inside = min(max(k, 1), len(a2) - 2)
        h = np.log(a2[1] / a2[0])
        bend = (logs[inside - 1] - 2.0 * logs[inside] + logs[inside + 1]) / h**2
        shift = -(logs[inside + 1] - logs[inside - 1]) / (2.0 * h) / bend if bend < 0.0 else 0.0
        if k == inside:
            size *= float(np.exp(0.5 * np.clip(shift, -h, h)))
        std = 0.5 * size / np.sqrt(-bend) if bend < 0.0 else size
        return float(log_mean_exp(logs)), float(max(logs[k], 0.0)), size, float(std)


def _unknown(name: tuple[str, ...], log_b: float, gain: float, share: float) -> Finding:
    return Finding(
        "unknown", name, ("*",), log_b, 2.0 * gain, {}, share, "process", "gyro", "low_frequency", 8
    )
