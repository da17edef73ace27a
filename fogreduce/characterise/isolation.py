"""What says which gyro failed, beside the parity that says that one did.

With four gyros parity is one number, and a failure of any of them shows in it alike. Evidence of each gyro
by itself, as odds that start equal:

- **known motion**: what each gyro reads beyond the motion that table and Earth give it (on a table only);
- **own noise**: its scatter within bins, before and after;
- **own output**: it stays the same, or is missing (`parity`'s check of outputs);
- **dynamics**: whether the parity follows the rate. That tells a scale factor from a bias; which gyro's scale
  factor it is only turns about several axes tell, by the share that each gyro has in each of them;
- **history**: what a step would be as a step of each gyro's bias, against the scatter of turn-on biases that
  its record states. A failure need not keep to that: it is shown, and isolates nothing.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fogreduce.constants import SECONDS_PER_HOUR
from fogreduce.physics.special import log_chi2_tail

Array = NDArray[np.float64]

#: Share of the hypotheses at which a gyro counts as isolated.
CLEAR = 0.99
#: Chance at which one cause does not explain all runs.
_UNLIKELY = 1e-4
KNOWN_MOTION, OWN_NOISE, OWN_OUTPUT = "known motion", "own noise", "own output"
DYNAMICS, HISTORY = "dynamics", "history"


@dataclass(frozen=True)
class Evidence:
    """One piece of evidence.

    Attributes
    ----------
    by : str
        What it is from.
    odds : (n,) array
        Probability of each gyro, equal beforehand; what they lack to 1 is that of none of them.
    says : str
        In words; empty where the odds say it all.
    """

    by: str
    odds: Array
    says: str = ""


def isolated(evidence: Sequence[Evidence]) -> tuple[int | None, str]:
    """The gyro that some evidence isolates and none contradicts, from 0, and by what; history left out."""
    found: dict[int, list[str]] = {}
    for one in evidence:
        best = int(np.argmax(one.odds))
        if one.by != HISTORY and one.odds[best] >= CLEAR:
            found.setdefault(best, []).append(one.by)
    if len(found) != 1:
        return None, ""
    ((gyro, by),) = found.items()
    return gyro, ", ".join(dict.fromkeys(by))


def by_known_motion(off: Array, variance: Array) -> Evidence:
    """The gyro that is off, of readings beyond the motion `off` (n,) and their variances (n,)."""
    return Evidence(KNOWN_MOTION, _odds(off**2 / variance / 2))


def by_own_noise(scatter: Array, count: Array, before: slice, after: slice) -> Evidence | None:
    """The gyro whose scatter within bins changed; None where there are too few bins.

    Likelihood ratio of two variances against one, each charged with Schwarz's penalty for the second.

    Parameters
    ----------
    scatter, count : (n, m) arrays
        Of each bin, as `Readings` has them.
    before, after : slice
        Of the bins.
    """
    freedom = np.maximum(count - 1, 0)
    squares = np.where(freedom > 0, scatter**2 * freedom, 0.0)
    many = [freedom[:, part].sum(axis=1) for part in (before, after)]
    if min(float(each.min()) for each in many) < 1:
        return None
    sums = [squares[:, part].sum(axis=1) for part in (before, after)]
    apart = [np.maximum(s / f, 1e-300) for s, f in zip(sums, many, strict=True)]
    joined = np.maximum((sums[0] + sums[1]) / (many[0] + many[1]), 1e-300)
    gain = sum(f / 2 * np.log(joined / each) for f, each in zip(many, apart, strict=True))
    gain = gain - np.log(np.minimum(*many)) / 2
    odds = _odds(np.append(gain, 0.0))[:-1]
    best = int(np.argmax(odds))
    ratio = float(apart[1][best] / apart[0][best])
    return Evidence(
        OWN_NOISE, odds, f"variance {ratio:.2g} times the one before" if odds[best] >= CLEAR else ""
    )


def by_history(size: float, row: Array, usual: Array) -> Evidence | None:
    """A parity step of `size` [deg/h] as a step of each gyro's bias.

    `row` (n,): of the parity; `usual` (n,): scatter of the biases [deg/h].
    """
    if not (usual > 0).all():
        return None
    step = size / row
    return Evidence(HISTORY, _odds(-((step / usual) ** 2) / 2 - np.log(usual * np.abs(row))))


def by_dynamics(
    parity: Array, spread: Array, rate: Array, since: NDArray[np.bool_], share: Array
) -> Evidence:
    """Whether a parity step follows the rate: a scale factor, or a bias.

    Parameters
    ----------
    parity, spread : (m,) arrays
        Of the run's bins, and their standard deviations [deg/h].
    rate : (m,) array
        Commanded [deg/s].
    since : (m,) array of bool
        Bins after the step.
    share : (n,) array
        What each gyro's whole output is in parity for 1 deg/s of the table [deg/s].
    """
    n = share.size
    even = np.full(n, 1 / n)
    base = [np.ones(rate.size), rate]
    left, found = zip(
        *(_fit([*base, column], parity, spread) for column in (since.astype(float), since * rate)),
        strict=True,
    )
    gain = (left[0] - left[1]) / 2
    if abs(gain) < -math.log(1 - CLEAR):
        return Evidence(DYNAMICS, even, "too few rates: a bias and a scale factor look alike")
    if gain < 0:
        return Evidence(DYNAMICS, even, "does not follow the rate: a bias")
    # A scale factor cannot lose more than all: a gyro that hardly senses the turn is none.
    relative = np.abs(found[1]) / SECONDS_PER_HOUR / np.maximum(np.abs(share), 1e-12)
    can = relative <= 1.1
    odds = can / can.sum() if can.any() else np.zeros(n)
    return Evidence(DYNAMICS, odds, "follows the rate: a scale factor")


def by_all_runs(parity: Array, spread: Array, motion: Array, axes: Array, row: Array) -> Evidence:
    """Which one cause explains the parity of every segment of every run: a gyro's scale factor, or a bias.

    Parameters
    ----------
    parity, spread : (s,) arrays
        Mean parity of each segment and its standard deviation [deg/h].
    motion : (s, 3) array
        Mean motion in it [deg/s].
    axes, row : (n, 3), (n,) arrays
        Of the gyros; of the parity.
    """
    columns = [row[i] * (motion @ axes[i]) for i in range(len(row))] + [np.ones(parity.size)]
    left = np.array([_fit([column], parity, spread)[0] for column in columns])
    best = int(np.argmin(left))
    if parity.size < 2 or log_chi2_tail(float(left[best]), parity.size - 1) < math.log(_UNLIKELY):
        return Evidence(DYNAMICS, np.zeros(len(row)), "no one scale factor or bias explains all runs")
    odds = _odds(-left / 2)
    if odds[-1] >= CLEAR:
        return Evidence(DYNAMICS, odds[:-1], "the same at every rate: a bias")
    says = "follows the rates of all runs: a scale factor" if odds[:-1].sum() >= CLEAR else ""
    return Evidence(DYNAMICS, odds[:-1], says)


def _fit(columns: Sequence[Array], values: Array, spread: Array) -> tuple[float, float]:
    """Weighted least squares: chi-square left, and the last column's coefficient."""
    matrix = np.column_stack(columns) / spread[:, None]
    solved, *_ = np.linalg.lstsq(matrix, values / spread, rcond=None)
    left = values / spread - matrix @ solved
    return float(left @ left), float(solved[-1])


def _odds(gain: Array) -> Array:
    """Probabilities of log likelihoods."""
    found = np.exp(gain - gain.max())
    total: Array = found / found.sum()
    return total
