"""White noise that gyros share, from their averaged cross spectra."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations

import numpy as np

from fogreduce.diagnosis.inference.evidence import log_bayes, log_mean_exp
from fogreduce.diagnosis.inference.findings import Finding
from fogreduce.diagnosis.which.full_rate.spectrum import Levels
from fogreduce.effects.gyro_names import gyro_name
from fogreduce.effects.table import EFFECTS

_CORRELATIONS = np.array([0.004, 0.007, 0.012, 0.02, 0.035, 0.06, 0.1, 0.2, 0.35, 0.6, 0.85])


def correlation_findings(lv: Levels, allowed: frozenset[str]) -> Iterator[Finding]:
    """White noise that gyros share: one correlation for a group of gyros, or any for any pair."""
    n = len(lv.correlation)
    if n < 2 or lv.dof == 0:
        return
    if "common_noise" in allowed and "common_noise" in EFFECTS:
        for size in range(n, 1, -1):
            groups = list(combinations(range(n), size))
            for group in groups:
                share = 0.7 if size == n else 0.3 / (n - 2) / len(groups)
                if n == 2:
                    share = 1.0
                yield _shared(lv, group, share)
    for i, j in combinations(range(n), 2):
        q = lv.dof * 2.0 * float(np.arctanh(np.clip(lv.correlation[i, j], -0.999999, 0.999999))) ** 2
        pair = (gyro_name(i), gyro_name(j))
        log_b = float(log_bayes(np.array(q), 1))
        yield Finding(
            "unknown", pair, ("*",), log_b, q, {}, 2.0 / n / (n - 1), "correlation", "noise", "correlation"
        )


def _shared(lv: Levels, group: tuple[int, ...], share: float) -> Finding:
    part = lv.correlation[np.ix_(group, group)]
    size = len(group)
    mean = (part.sum() - size) / (size * (size - 1))
    fine = np.linspace(mean - 0.02, mean + 0.02, 41)
    lowest = -1.0 / (size - 1)
    values = np.concatenate([_CORRELATIONS, -_CORRELATIONS, fine])
    logs = np.full(len(values), -np.inf)
    for k, rho in enumerate(values.tolist()):
        if lowest < rho < 1.0:
            # of (1 - r) 1 + r J: eigenvalues 1 - r, and 1 + (m - 1) r once
            own, whole = 1.0 - rho, 1.0 + (size - 1) * rho
            trace = (size - part.sum() / size) / own + part.sum() / size / whole
            logs[k] = -lv.dof * ((size - 1) * np.log(own) + np.log(whole) + trace - size)
    coarse = logs[: 2 * len(_CORRELATIONS)]
    best = int(np.argmax(logs))
    # the true value lies between points of the coarse grid: its peak is the fine grid's, as wide as a cell
    # allows
    std = float(1.0 / np.sqrt(2.0 * lv.dof * size * (size - 1) / 2.0))
    spacing = 0.5 * abs(float(values[best]))
    peak = float(logs[best]) + np.log(min(2.5 * std / max(spacing, std), 1.0)) - np.log(len(coarse))
    log_b = max(float(log_mean_exp(coarse)), peak)
    return Finding(
        "common_noise",
        tuple(gyro_name(i) for i in group),
        ("*",),
        log_b,
        2.0 * float(logs[best]),
        {"correlation": (float(values[best]), std)},
        share,
        "correlation",
        "noise",
        "correlation",
    )
