"""Where a residual departs from nothing: places without a cause, each with its significance.

The most significant family is taken first; what it explains no longer counts for the next. So a place is
named
once, and shares add up.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from fogreduce.gap.bundles import Bundles
from fogreduce.gap.candidate import EVERY, Candidate
from fogreduce.gap.evidence import Field
from fogreduce.gap.findings import Finding
from fogreduce.physics.special import log_chi2_tail, log_normal_tail, normal_deviate

#: Look-elsewhere: how many places a campaign is searched at, as a round number.
_TRIALS = 300.0
LEAST_SIGMA = 4.0
_MOST = 6
_MORE = 1.0 + 1e-6
_GROSS = 150.0  # signal-to-noise ratio
_GROSS_PLACES = {"channel_swap": "rate", "start_offset": "rate"}


@dataclass(frozen=True)
class Place:
    """One place: the contract's words, its significance, and twice the gain in ln likelihood there."""

    stage: str
    channels: tuple[str, ...]
    runs: tuple[str, ...]
    feature: str
    sigma: float
    q: float
    degrees: int
    family: Candidate | None = None


def deviate(log_p: float) -> float:
    """The normal deviate whose upper tail has this ln probability; 0 for anything from one half up."""
    if log_p > np.log(0.5):
        return 0.0
    if log_p > -500.0:
        return float(-normal_deviate(float(np.exp(log_p))))
    z = np.sqrt(-2.0 * log_p)
    for _ in range(20):
        # the tail's logarithm falls by nearly z for each unit of z
        z += (log_normal_tail(-float(z)) - log_p) / z
    return float(z)


def significance(q: float, k: int, trials: float = _TRIALS) -> float:
    """Normal deviate of q with k degrees, found among so many."""
    return deviate(min(log_chi2_tail(max(q, 1e-9), k) + np.log(trials), 0.0))


def places(
    field: Field,
    families: Bundles,
    findings: Iterable[Finding],
    run_ids: Sequence[str],
    doubt: float = 0.0,
) -> list[Place]:
    """Significant places, the most significant first.

    Parameters
    ----------
    field : Field
        Residual and metric.
    families : candidates of no cause
    findings : of the full rate
    run_ids : all runs
    doubt : float
        Signal-to-noise ratio that departures of known causes from their shape may have.
    """
    found: list[Place] = []
    best: dict[tuple[str, tuple[str, ...]], Place] = {}
    for finding in findings:
        q = max(np.sqrt(max(finding.snr2, 0.0)) - (doubt if finding.domain == "process" else 0.0), 0.0) ** 2
        # evidence has the look-elsewhere of its own grid in it
        q = min(q, 2.0 * max(finding.log_b, 0.0) + 12.0)
        sigma = significance(q, finding.degrees)
        runs = tuple(run_ids) if finding.runs == ("*",) else finding.runs
        place = Place(finding.stage, finding.channels, runs, finding.feature, sigma, q, finding.degrees)
        key = (finding.domain, finding.channels)
        if sigma >= LEAST_SIGMA and (key not in best or best[key].sigma < sigma):
            best[key] = place
    processes = [p for (domain, _), p in best.items() if domain == "process"]
    lines = [p for (domain, _), p in best.items() if domain == "lines"]
    others = [p for (domain, _), p in best.items() if domain not in ("process", "lines")]
    if lines:
        others.append(max(lines, key=lambda p: p.q - 4.0 * (p.stage == "table")))
    here = field
    for _ in range(_MOST):
        top: Place | None = None
        whole = 1.001 * here.chi2 + 1.0
        for fit in families.fits(here):
            family = fit.candidate
            if fit.q > whole:
                continue  # more than is there: columns nearly alike, whose sizes rounding decides
            k = family.columns.shape[2]
            q = max(np.sqrt(max(fit.q, 0.0)) - doubt, 0.0) ** 2
            sigma = significance(q, k, _TRIALS * family.columns.shape[1])
            # of places that say the same, as a mean and a rate that stays do, the first
            if top is None or sigma > top.sigma * _MORE:
                runs = tuple(run_ids) if family.runs == ("*",) else family.runs
                top = Place(
                    family.stage, family.channels, runs, family.feature, sigma, q, k, _at(family, fit.best)
                )
        if top is None or top.sigma < LEAST_SIGMA or top.family is None:
            break
        found.append(top)
        columns = np.zeros((len(here.y), top.degrees))
        columns[top.family.rows] = top.family.columns[:, 0, :]
        here = Field.of(here.metric.beside(columns), here.y)
    # a process at a gyro is named only where it says more than what was found there already
    for process in processes:
        same = [p.sigma for p in found if p.channels == process.channels]
        if not same or process.sigma > max(same):
            found.append(process)
    return sorted([*found, *others], key=lambda p: -p.sigma)


def gross(field: Field, candidates: Iterable[Candidate]) -> list[Candidate]:
    """Gross faults of wiring and timing as places: what no family of features takes in as one.

    Two swapped columns look like a rotation and the rest of it, a late start like a little of everything.
    """
    out = []
    for one in candidates:
        if one.effect in _GROSS_PLACES and field.fit(one).q > _GROSS**2:
            other = one.extra.get("with")
            channels = (*one.channels, other) if other else one.channels
            out.append(replace(one, channels=channels, known=False, feature=_GROSS_PLACES[one.effect]))
    return out


def joined(families: Iterable[Candidate]) -> list[Candidate]:
    """A rotation of the table that is steady in each run, any in each: its families of single runs as one."""
    parts = [f for f in families if f.stage == "table" and f.feature == "mean" and f.runs != EVERY]
    if len(parts) < 2:
        return []
    columns = np.concatenate([p.columns for p in parts], axis=2)
    k = columns.shape[2]
    return [replace(parts[0], runs=EVERY, columns=columns, scales=("",) * k, steps=np.ones((1, k)))]


def _at(family: Candidate, best: int) -> Candidate:
    """A family at one point of its grid."""
    return replace(
        family,
        columns=family.columns[:, best : best + 1],
        grid=family.grid[best : best + 1],
        steps=family.steps[best : best + 1],
    )


def document(found: Sequence[Place]) -> list[dict[str, object]]:
    """As a diagnosis has them; shares of the whole, which sum to at most 1."""
    total = sum(p.q for p in found)
    return [
        {
            "stage": p.stage,
            "channels": list(p.channels),
            "runs": list(p.runs),
            "feature": p.feature,
            "sigma": round(p.sigma, 3),
            "share": round(0.999 * p.q / total, 4),
        }
        for p in found
    ]
