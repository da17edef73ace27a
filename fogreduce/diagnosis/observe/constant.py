"""Gyros that give one value all through a run: dead, at a converter's rail, or moving by less than a step."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from fogreduce.constants import SECONDS_PER_HOUR
from fogreduce.diagnosis.inference.findings import Finding
from fogreduce.diagnosis.observe.capture import RunInput, Samples
from fogreduce.effects.gyro_names import gyro_name
from fogreduce.physics.noise import white_sigma

Array = NDArray[np.float64]

_FEWEST = 5  # samples of one value: fewer say nothing
_LOG_CHANCE = -14.0  # ln of the chance of such a run below which it is none: one in a million
_BEYOND = 6.0  # stated standard deviations


@dataclass(frozen=True)
class Constant:
    """One gyro in one run.

    Attributes
    ----------
    run : str
    gyro, count, samples : int
        Number from 0; the value, and how often it came.
    kind : str
        ``dead``: a healthy gyro would have read something else; ``rail``: as far as its converter goes;
        ``below_step``: what was to be read, noise in it, lies within one step: nobody can tell.
    """

    run: str
    gyro: int
    count: int
    samples: int
    kind: str

    def document(self) -> dict[str, object]:
        """As a diagnosis has it."""
        return {"channel": gyro_name(self.gyro), "run": self.run, "count": self.count, "judged": self.kind}


def constant_gyros(inputs: Sequence[RunInput], captures: Sequence[Samples]) -> tuple[Constant, ...]:
    """Every gyro whose counts are all alike in a run, judged by what its runs were to show."""
    found: list[Constant] = []
    for i in range(inputs[0].facts.n_gyros):
        most = [_farthest(samples, i) for samples in captures]
        here = []
        for r, (one, samples) in enumerate(zip(inputs, captures, strict=True)):
            good = np.isfinite(samples.residual[i])
            counts = samples.counts[i, good]
            if counts.size >= _FEWEST and np.all(counts == counts[0]):
                count = int(counts[0])
                wanted = count - _departure_counts(one, samples.residual[i, good], i)
                elsewhere = max([most[s] for s in range(len(most)) if s != r], default=0)
                kind = _classified(one, i, count, wanted, elsewhere)
                here.append(Constant(one.facts.run_id, i, count, int(counts.size), kind))
        if any(one.kind == "dead" for one in here):
            here = [replace(one, kind="dead") if one.kind == "rail" else one for one in here]
        found += here
    return tuple(found)


def _farthest(samples: Samples, i: int) -> int:
    good = np.isfinite(samples.residual[i])
    return int(np.abs(samples.counts[i, good]).max(initial=0))


def _departure_counts(one: RunInput, residual: Array, i: int) -> Array:
    """Residuals [deg/h] of a gyro in counts."""
    facts = one.facts
    per_deg_h = facts.polarity[i] * facts.scale_factor[i] / facts.least_count / SECONDS_PER_HOUR
    return np.asarray(residual * per_deg_h, np.float64)


def _classified(one: RunInput, i: int, count: int, wanted: Array, elsewhere: int) -> str:
    """What a gyro is that gave `count` alone where `wanted` (N,) was to be read [counts].

    `elsewhere`: the largest count that it gave in other runs.
    """
    beyond = float(np.mean(np.sign(count) * wanted > abs(count) - 1.0)) > 0.95
    if (
        abs(count) > 1
        and beyond
        and elsewhere <= abs(count) + 1
        and float(np.mean(np.abs(wanted))) > abs(count)
    ):
        return "rail"
    facts, stated = one.facts, one.record.stated_uncertainty
    step = facts.least_count
    off = float(
        np.sqrt(
            stated.bias[i] ** 2
            + (stated.turn_on_bias_deg_h[i] / SECONDS_PER_HOUR * facts.scale_factor[i]) ** 2
            + (stated.scale_factor_rel[i] * step * float(np.abs(wanted).max())) ** 2
        )
    )
    if float(np.ptp(wanted)) > 2.0 or abs(float(np.mean(wanted)) - count) > 1.0 + _BEYOND * off / step:
        return "dead"
    if facts.white_noise is None:
        return "below_step"
    sigma = float(white_sigma(facts.white_noise[i], facts.sample_rate_hz)) * abs(facts.scale_factor[i]) / step
    alike = min(1.0 / (2.0 * max(sigma, 1e-9) * np.sqrt(np.pi)), 1.0)  # two neighbours' chance
    return "dead" if (wanted.size - 1) * float(np.log(alike)) < _LOG_CHANCE else "below_step"


def without_dead(
    inputs: Sequence[RunInput], captures: Sequence[Samples], constant: Sequence[Constant]
) -> list[Samples]:
    """The captures with dead gyros left out: they say nothing of what was to be measured."""
    out = []
    for one, samples in zip(inputs, captures, strict=True):
        dead = [c.gyro for c in constant if c.run == one.facts.run_id and c.kind == "dead"]
        if dead:
            residual = samples.residual.copy()
            residual[dead] = np.nan
            samples = replace(samples, residual=residual)
        out.append(samples)
    return out


def dead_findings(constant: Sequence[Constant], runs: int, n: int) -> Iterator[Finding]:
    """One finding for each gyro that is dead in some run; no effect of the catalogue does that."""
    for i in range(n):
        dead = [c for c in constant if c.gyro == i and c.kind == "dead"]
        if not dead:
            continue
        gain = sum(c.samples for c in dead) * float(np.log(2.0))
        ids = ("*",) if len(dead) == runs else tuple(c.run for c in dead)
        name = (gyro_name(i),)
        yield Finding("unknown", name, ids, gain, 2.0 * gain, {}, 1.0 / n, "dead", "link", "repeats")
