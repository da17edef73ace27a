"""How significant a gain in likelihood is, found among many places: as a normal deviate."""

from __future__ import annotations

import numpy as np

from fogreduce.physics.special import log_chi2_tail, log_normal_tail, normal_deviate

#: Look-elsewhere: how many places a campaign is searched at, as a round number.
TRIALS = 300.0


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


def significance(q: float, k: int, trials: float = TRIALS) -> float:
    """Normal deviate of q with k degrees, found among so many."""
    return deviate(min(log_chi2_tail(max(q, 1e-9), k) + np.log(trials), 0.0))
