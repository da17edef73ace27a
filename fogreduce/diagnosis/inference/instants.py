"""The instant at which a bias stepped: found on a fine grid, its error from the whole likelihood.

A real step takes a while to come, exponentially. How long is no number of the effect; its likelihood says how
far the instant may be from the one at which a sudden step fits best.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from fogreduce.diagnosis import priors
from fogreduce.diagnosis.inference.causes import Cause
from fogreduce.diagnosis.inference.noise_model import Metric, Whitener
from fogreduce.diagnosis.observe.capture import RunInput

Array = NDArray[np.float64]

_PER_BLOCK = 8  # instants tried in a block
_FINER = 8  # parts of a step between them, for the most probable one
_BLOCKS = 2.0  # how far from where it was found, beside the longest rise
_QUANTILES = -np.log1p(-(np.arange(4) + 0.5) / 4.0)  # of an exponential rise: it is a mixture of sudden steps


def ends(inputs: Sequence[RunInput], cause: Cause) -> tuple[float, float]:
    """The first and last instant at which a bias can have stepped: with a block of its run on either side.

    What was there from the start on is no step.
    """
    blocks = [one.scene.blocks for one in inputs if one.facts.run_id in cause.runs]
    return max((b.length_s for b in blocks), default=-np.inf), min(
        ((b.count - 1) * b.length_s for b in blocks), default=np.inf
    )


def timed(inputs: Sequence[RunInput], cause: Cause, whiten: Whitener, metric: Metric, left: Array) -> Cause:
    """A step at its most probable instant, the error of that in its standard deviations.

    Parameters
    ----------
    inputs : runs
    cause : Cause
        With ``time_s`` among its numbers, of one run and one gyro.
    whiten, metric : Whitener, Metric
        The metric with everything else that is free in it.
    left : (rows,) array
        Whitened residual beside all other causes.
    """
    run = next((r for r, one in enumerate(inputs) if one.facts.run_id in cause.runs), None)
    if run is None or len(cause.channels) != 1:
        return cause
    one, gyro = inputs[run], int(cause.channels[0][4:]) - 1
    length = one.scene.blocks.length_s
    longest = max(priors.RISE_S)
    far = _BLOCKS * length
    # of a step that comes slowly, quantiles lie later; where it is sudden the instant is later than it began
    first, last = ends(inputs, cause)
    step = length / _PER_BLOCK
    start = cause.theta["time_s"] - far - longest
    times = np.arange(start, cause.theta["time_s"] + far + longest * (1.0 + _QUANTILES[-1]) + step, step)
    columns = _steps(one, run, gyro, cause, whiten, np.clip(times, first, last))
    near = (np.abs(times - cause.theta["time_s"]) <= far) & (times >= first) & (times <= last)
    if not near.any():
        return cause
    logs, sizes = _gained(metric, columns, left)
    best = int(np.argmax(np.where(near, logs, -np.inf)))
    off, gains, weights = [times[near] - times[best]], [logs[near]], [np.ones(int(near.sum()))]
    for rise in (r for r in priors.RISE_S if r > step):
        at = np.rint(rise * _QUANTILES / step).astype(np.intp)
        begins = np.flatnonzero((times >= first) & (times <= times[best] + far))
        begins = begins[begins + at[-1] < len(times)]
        slow = columns[:, begins[:, None] + at].mean(axis=2)
        off.append(times[begins] - times[best])
        gains.append(_gained(metric, slow, left)[0])
        # a sudden step is as likely before as all slow ones together
        weights.append(np.full(len(begins), 1.0 / len(priors.RISE_S)))
    gain = np.concatenate(gains)
    weight = np.exp(gain - gain.max()) * np.concatenate(weights)
    error = float(np.sqrt(weight @ np.concatenate(off) ** 2 / weight.sum() + step**2 / 12.0))
    finer = np.clip(times[best] + step * np.linspace(-1.0, 1.0, 2 * _FINER + 1), first, last)
    logs, sizes = _gained(metric, _steps(one, run, gyro, cause, whiten, finer), left)
    best = int(np.argmax(logs))
    theta = {**cause.theta, "time_s": float(finer[best]), "deg_h": float(sizes[best])}
    return replace(cause, theta=theta, std={**cause.std, "time_s": error})


def _steps(one: RunInput, run: int, gyro: int, cause: Cause, whiten: Whitener, times: Array) -> Array:
    """Whitened columns (rows, T) of a step of 1 deg/h at each instant."""
    n = whiten.rows.n
    rows = whiten.rows.of(gyro, run)
    plain = one.scene.block_means()[gyro]
    columns = []
    for time in times.tolist():
        unit = replace(cause, theta={"deg_h": 1.0, "time_s": time})
        columns.append(one.scene.block_means([unit.action([one.facts.run_id], n)])[gyro] - plain)
    out = np.zeros((whiten.rows.total, len(times)))
    out[rows] = whiten(np.column_stack(columns), rows)
    return out


def _gained(metric: Metric, columns: Array, left: Array) -> tuple[Array, Array]:
    """Ln likelihood that each column (rows, T) at its best size gains, and that size: (T,) each."""
    onto = metric.a.T @ columns
    gram = np.maximum(np.sum(columns**2, axis=0) - np.sum(onto * (metric.shrink @ onto), axis=0), 1e-300)
    b = columns.T @ metric.without(left)
    return 0.5 * b * b / gram, b / gram
