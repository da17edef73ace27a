"""What may be added to a set of causes: an effect's fit or a finding, with its evidence and its prior."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from fogreduce.diagnosis import priors
from fogreduce.diagnosis.inference.candidate import Candidate
from fogreduce.diagnosis.inference.causes import Cause
from fogreduce.diagnosis.inference.evidence import Fit
from fogreduce.diagnosis.inference.findings import Finding
from fogreduce.effects.table import EFFECTS


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
    def catalogued(self) -> bool:
        """Whether the catalogue has it."""
        return self.source.catalogued

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


def not_for_being_simpler(options: list[Option]) -> list[Option]:
    """The unknown must fit better than an effect with a direction in it: fewer numbers are no evidence.

    Where all runs turn about one axis, a magnetic field is a wave of the angle; and the larger it is, the
    more would its third number cost it.
    """
    named: dict[tuple[str, ...], list[Option]] = {}
    for o in options:
        if o.catalogued and o.fit is not None and o.fit.candidate.columns.shape[2] > 1:
            named.setdefault(o.source.channels, []).append(o)
    out = []
    for o in options:
        if not o.catalogued and o.fit is not None:
            numbers = o.fit.candidate.columns.shape[2]
            for rival in named.get(o.source.channels, ()):
                assert rival.fit is not None
                if rival.fit.candidate.columns.shape[2] >= numbers:
                    most = rival.raw + 0.5 * max(o.q - rival.q, 0.0) - priors.AS_WELL
                    less = max(o.raw - most, 0.0)
                    o = replace(o, log_b=o.log_b - less, raw=o.raw - less)
        out.append(o)
    return out


def beyond(fit: Fit) -> bool:
    """Whether an effect would need a number that it does not accept, as a scale factor less than nothing."""
    c = fit.candidate
    if not c.catalogued or c.fixed:
        return False
    values = dict(zip(c.scales, (fit.coefficients * c.steps[fit.best]).tolist(), strict=False))
    limits = {p.name: (p.low, p.high) for p in EFFECTS[c.effect].parameters if p.kind == "number"}
    return any(not limits[k][0] <= v <= limits[k][1] for k, v in values.items() if k in limits)


def log_prior_of(catalogued: bool, share: float) -> float:
    """Ln prior of an effect, or of something unknown, at a place that has a share of its name."""
    if catalogued:
        return float(np.log(share / priors.NAMES))
    return float(priors.LOG_UNKNOWN + np.log(share / priors.FAMILIES))
