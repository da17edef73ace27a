"""Where a residual departs from nothing: places without a cause, each with its significance.

The most significant family is taken first; what it explains no longer counts for the next. So a place is
named once, and shares add up.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from fogreduce.diagnosis import priors
from fogreduce.diagnosis.inference.candidate import EVERY, Candidate
from fogreduce.diagnosis.inference.candidates import Candidates
from fogreduce.diagnosis.inference.evidence import WhitenedResidual
from fogreduce.diagnosis.inference.findings import Finding
from fogreduce.diagnosis.inference.significance import TRIALS, significance

Array = NDArray[np.float64]
Doubt = Callable[[Sequence[str]], float]

LEAST_SIGMA = 4.0
_MOST = 6
_MORE = 1.0 + 1e-6
_GROSS = 150.0  # signal-to-noise ratio
_GROSS_PLACES = {"channel_swap": "rate", "start_offset": "rate"}


@dataclass(frozen=True)
class Place:
    """One place: the contract's words, its significance, and twice the gain in ln likelihood there.

    `family` and `trials`: what was fitted there, None for other statistics, and among how many.
    """

    stage: str
    channels: tuple[str, ...]
    runs: tuple[str, ...]
    feature: str
    sigma: float
    q: float
    degrees: int
    family: Candidate | None = None
    trials: float = TRIALS


def places(
    residual: WhitenedResidual,
    families: Candidates,
    findings: Iterable[Finding],
    processes: Callable[[WhitenedResidual], Iterable[Finding]],
    run_ids: Sequence[str],
    doubt: Doubt = lambda channels: 0.0,
    least: float = LEAST_SIGMA,
) -> list[Place]:
    """Significant places, the most significant first; each beside what was found elsewhere and is stronger.

    Parameters
    ----------
    residual : WhitenedResidual
        Residual and metric.
    families : candidates of no cause
    findings : of the full rate
    processes : callable
        Findings of random processes in a residual.
    run_ids : all runs
    doubt : callable
        Signal-to-noise ratio that departures of known causes from their shape may have at channels.
    least : float
        Significance from which on a place counts.
    """
    found = _of_families(residual, families, run_ids, doubt, least)
    drifting = _best((_place(f, run_ids, doubt(f.channels)) for f in processes(residual)), least)
    kept: list[Place] = []
    # stated uncertainties that all gyros share hand a part of a great gap to gyros where nothing is
    for place in sorted([*found, *drifting], key=lambda p: -p.sigma):
        others = [p for p in kept if p.channels != place.channels]
        if others:
            columns = np.column_stack([_freed(p, families, len(residual.y), len(run_ids)) for p in others])
            remaining = WhitenedResidual.of(residual.metric.with_free(columns), residual.y)
            if place.family is not None:
                q = max(np.sqrt(max(remaining.fit(place.family).q, 0.0)) - doubt(place.channels), 0.0) ** 2
                if q < place.q:
                    place = replace(place, q=q, sigma=significance(q, place.degrees, place.trials))
            else:
                again = _best((_place(f, run_ids, doubt(f.channels)) for f in processes(remaining)), least)
                place = next((p for p in again if p.channels == place.channels), replace(place, sigma=0.0))
        if place.sigma >= least:
            kept.append(place)
    return sorted([*_without_weaker(kept), *_of_full_rate(findings, run_ids, least)], key=lambda p: -p.sigma)


def farthest(
    residual: WhitenedResidual,
    families: Candidates,
    findings: Iterable[Finding],
    processes: Callable[[WhitenedResidual], Iterable[Finding]],
) -> float:
    """Significance of the statistic that is farthest out, look-elsewhere counted; 0 where that is nothing."""
    whole = 1.001 * residual.chi2 + 1.0
    sigmas = [
        significance(fit.q, fit.candidate.columns.shape[2], TRIALS * fit.candidate.columns.shape[1])
        for fit in families.fits(residual)
        if 0.0 < fit.q <= whole
    ]
    sigmas += [_place(f, ()).sigma for f in [*findings, *processes(residual)]]
    return max(sigmas, default=0.0)


def _place(finding: Finding, run_ids: Sequence[str], doubt: float = 0.0) -> Place:
    """A finding as a place."""
    q = max(np.sqrt(max(finding.snr2, 0.0)) - doubt, 0.0) ** 2
    # evidence has the look-elsewhere of its own grid in it
    q = min(q, 2.0 * max(finding.log_b, 0.0) + 12.0)
    sigma = significance(q, finding.degrees)
    runs = tuple(run_ids) if finding.runs == ("*",) else finding.runs
    return Place(finding.stage, finding.channels, runs, finding.feature, sigma, q, finding.degrees)


def _best(found: Iterable[Place], least: float) -> list[Place]:
    """The most significant place at each gyro, or set of them, where one is significant."""
    best: dict[tuple[str, ...], Place] = {}
    for place in found:
        if place.sigma >= least and place.sigma > getattr(best.get(place.channels), "sigma", 0.0):
            best[place.channels] = place
    return list(best.values())


def _of_full_rate(findings: Iterable[Finding], run_ids: Sequence[str], least: float) -> list[Place]:
    """Places in the full-rate stream, less what a stronger one of the same statistic has said already."""
    domains: dict[str, list[Finding]] = {}
    for finding in findings:
        domains.setdefault(finding.domain, []).append(finding)
    kept = []
    for domain, mine in domains.items():
        here = sorted(_best((_place(f, run_ids) for f in mine), least), key=lambda p: -p.sigma)
        if domain.split()[0] == "lines" and here:
            # a motion of all gyros, or lines of some
            moved = max(here, key=lambda p: p.q - 4.0 * (p.stage == "table")).stage == "table"
            here = [p for p in here if (p.stage == "table") == moved]
        if domain == "correlation":
            here = [
                p for k, p in enumerate(here) if all(len({*p.channels} & {*o.channels}) < 2 for o in here[:k])
            ]
        kept += here
    return [p for p in kept if not any(_implies(other, p) for other in kept)]


def _implies(strong: Place, weak: Place) -> bool:
    """Whether what a statistic of the full rate shows may be what a far stronger one leaves there: leakage
    and codes of a line, a band of samples held.
    """
    return bool({*strong.channels} & {*weak.channels}) and weak.q < priors.DEPARTURE**2 * strong.q


def _of_families(
    residual: WhitenedResidual, families: Candidates, run_ids: Sequence[str], doubt: Doubt, least: float
) -> list[Place]:
    """Places of families, the most significant first, each beside those before it."""
    found: list[Place] = []
    here = residual
    for _ in range(_MOST):
        top: Place | None = None
        whole = 1.001 * here.chi2 + 1.0
        for fit in families.fits(here):
            family = fit.candidate
            if fit.q > whole:
                continue  # more than is there: columns nearly alike, whose sizes rounding decides
            k, trials = family.columns.shape[2], TRIALS * family.columns.shape[1]
            q = max(np.sqrt(max(fit.q, 0.0)) - doubt(family.channels), 0.0) ** 2
            sigma = significance(q, k, trials)
            # of places that say the same, as a mean and a rate that stays do, the first
            if top is None or sigma > top.sigma * _MORE:
                runs = tuple(run_ids) if family.runs == EVERY else family.runs
                at = _at(family, fit.best)
                top = Place(family.stage, family.channels, runs, family.feature, sigma, q, k, at, trials)
        if top is None or top.sigma < least:
            break
        found.append(top)
        here = WhitenedResidual.of(
            here.metric.with_free(_freed(top, families, len(here.y), len(run_ids))), here.y
        )
    return found


def _freed(place: Place, families: Candidates, rows: int, runs: int) -> Array:
    """Whitened columns (rows, k) that a place may be: its family's; of a process, all that is slow there."""
    slow = [f for f in families if f.channels == place.channels and f.feature in ("mean", "low_frequency")]
    parts = [f for f in slow if f.columns.shape[1] == 1 and (f.runs == EVERY or runs == 1)]
    if place.family is not None:
        parts = [place.family]
    columns = [np.zeros((rows, 0))]
    for part in parts:
        whole = np.zeros((rows, part.columns.shape[2]))
        whole[part.rows] = part.columns[:, 0]
        columns.append(whole)
    return np.column_stack(columns)


def _without_weaker(found: Sequence[Place]) -> list[Place]:
    """Places less processes that say no more of a gyro than its families do."""
    kept = [p for p in found if p.family is not None]
    for place in found:
        same = [p.sigma for p in found if p.family is not None and p.channels == place.channels]
        if place.family is None and place.sigma > max(same, default=0.0):
            kept.append(place)
    return kept


def gross(residual: WhitenedResidual, candidates: Iterable[Candidate]) -> list[Candidate]:
    """Gross faults of wiring and timing as places: what no family of features takes in as one.

    Two swapped columns look like a rotation and the rest of it, a late start like a little of everything.
    """
    out = []
    for one in candidates:
        if one.effect in _GROSS_PLACES and residual.fit(one).q > _GROSS**2:
            other = one.extra.get("with")
            channels = (*one.channels, other) if other else one.channels
            out.append(replace(one, channels=channels, catalogued=False, feature=_GROSS_PLACES[one.effect]))
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
    """As a diagnosis has them, each place once; shares of the whole, which sum to at most 1."""
    total = sum(p.q for p in found)
    same: dict[tuple[object, ...], list[Place]] = {}
    for p in sorted(found, key=lambda p: -p.sigma):
        same.setdefault((p.stage, p.channels, p.runs, p.feature), []).append(p)
    return [
        {
            "stage": parts[0].stage,
            "channels": list(parts[0].channels),
            "runs": list(parts[0].runs),
            "feature": parts[0].feature,
            "sigma": round(parts[0].sigma, 3),
            "share": round(0.999 * sum(p.q for p in parts) / total, 4),
        }
        for parts in same.values()
    ]
