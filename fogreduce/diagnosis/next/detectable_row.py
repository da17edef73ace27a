"""One effect at one place in a planned campaign: the smallest amplitude that would be seen."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from fogreduce.diagnosis import priors
from fogreduce.diagnosis.inference.options import log_prior_of
from fogreduce.effects.table import EFFECTS

#: Separation below which two effects are not told apart for sure [sigma].
SEPARATED_SIGMA = 4.0


@dataclass(frozen=True)
class Row:
    """One effect at one place.

    Attributes
    ----------
    effect : str
    channels, runs : tuples of str
        As an effects file has them.
    parameter : str
        What `amplitude` is; empty for an effect that has no size.
    amplitude : float or None
        The smallest that is seen with the probability asked for; None where none is, or where it has no size.
    seen : bool
        Whether it can be seen at all.
    at : mapping
        The other parameters at which this holds.
    rivals : tuple of str
        What it could not be told from, as `label` has them.
    """

    effect: str
    channels: tuple[str, ...]
    runs: tuple[str, ...]
    parameter: str
    amplitude: float | None
    seen: bool
    at: Mapping[str, Any] = field(default_factory=dict)
    rivals: tuple[str, ...] = ()

    @property
    def label(self) -> str:
        """Effect, channels, other gyro, run."""
        other = self.at.get(EFFECTS[self.effect].other, "")
        pair = f" from {other}" if other else ""
        runs = "" if self.runs == ("*",) else f" in {', '.join(self.runs)}"
        return f"{self.effect} {', '.join(self.channels)}{pair}{runs}"

    def document(self, raw_unit: str) -> dict[str, Any]:
        """As detectable.json has it, for gyros that are read in `raw_unit`."""
        of = [p.unit_in(raw_unit) for p in EFFECTS[self.effect].parameters if p.name == self.parameter]
        return {
            "effect": self.effect,
            "channels": list(self.channels),
            "runs": list(self.runs),
            "parameter": self.parameter,
            "unit": of[0] if of else "",
            "amplitude": self.amplitude,
            "seen": self.seen,
            "at": dict(self.at),
            "not_told_from": list(self.rivals),
        }


def threshold(share: float) -> float:
    """Ln of evidence at which an effect's odds are even; `share`: of its name's prior that its place has."""
    return -(log_prior_of(True, share) + float(priors.LOG_GAP))


def crossing(function: Callable[[float], float], low: float, high: float) -> float | None:
    """Where an increasing function of a size passes 0, by bisection in its logarithm; None beyond `high`."""
    if function(high) < 0.0:
        return None
    if function(low) >= 0.0:
        return low
    a, b = np.log(low), np.log(high)
    for _ in range(50):
        middle = 0.5 * (a + b)
        if function(float(np.exp(middle))) < 0.0:
            a = middle
        else:
            b = middle
    return float(np.exp(b))
