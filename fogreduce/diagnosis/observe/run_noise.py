"""White noise of each run: found where the record states none, and where a run has another than the rest."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from fogreduce.constants import SECONDS_PER_HOUR
from fogreduce.diagnosis.inference.findings import Finding
from fogreduce.diagnosis.observe.capture import RunInput, Samples
from fogreduce.diagnosis.observe.full_rate import NORMAL, FullRate
from fogreduce.diagnosis.which.full_rate.spectrum import level_evidence, rounding_variance
from fogreduce.effects.gyro_names import gyro_name
from fogreduce.metadata.calibration import Noise
from fogreduce.physics.noise import white_sigma

Array = NDArray[np.float64]

_FEWEST = 32  # neighbouring samples from whose differences a noise is told to a sixth
_ROUNDED = 0.01  # of rounding's variance: noise below it cannot be told from none
#: A run's noise is its own where it departs by so much, relative, and by so many standard deviations.
_APART, _BEYOND_CHANCE = 0.1, 6.0
_COARSE = 0.5  # share of rounding in the variance above which it is no white noise any more


def with_white_noise(
    inputs: Sequence[RunInput], captures: Sequence[Samples], full: Sequence[FullRate]
) -> tuple[list[RunInput], Array | None]:
    """The runs with the white noise that their captures show, where their record states none.

    Returns
    -------
    inputs : list of RunInput
    found : (n,) array or None
        N [deg/sqrt(h)]; None where the record states it, or where no gyro shows it.
    """
    if inputs[0].facts.white_noise is not None:
        return list(inputs), None
    record = inputs[0].record
    assumed = np.array(record.stated_noise.angle_random_walk_deg_sqrt_h)
    each = np.array(
        [
            [_white(one, samples, run, i) for i in range(len(assumed))]
            for one, samples, run in zip(inputs, captures, full, strict=True)
        ]
    )
    if not np.isfinite(each).any():
        return list(inputs), None
    weight = np.array([float(one.facts.n_expected) for one in inputs])
    found = np.array(
        [_middle(column, weight, value) for column, value in zip(each.T, assumed.tolist(), strict=True)]
    )
    stated = {"angle_random_walk_deg_sqrt_h": tuple(found.tolist())}
    noise = Noise(**stated) if record.noise is None else record.noise.model_copy(update=stated)
    record = record.model_copy(update={"noise": noise})
    changed = [replace(one, record=record, facts=replace(one.facts, white_noise=found)) for one in inputs]
    return changed, found


def _white(one: RunInput, samples: Samples, run: FullRate, i: int) -> float:
    """N [deg/sqrt(h)] of gyro i in a run, without what rounding adds; NaN where nothing shows it."""
    if run.pieces > 0:
        # the median of a mean of K exponential deviates of mean 1 is 1 - 1 / (3 K)
        variance = float(np.median(run.power[i])) / (1.0 - 1.0 / (3.0 * run.pieces))
    else:
        steps = np.abs(np.diff(samples.residual[i]))
        steps = steps[np.isfinite(steps)]
        variance = 0.5 * float(NORMAL * np.median(steps)) ** 2 if steps.size >= _FEWEST else 0.0
    if variance <= 0.0:
        return float("nan")
    rounding = float(rounding_variance(one.facts, np.zeros(one.facts.n_gyros))[i])
    unit = float(white_sigma(1.0, one.facts.sample_rate_hz)) * SECONDS_PER_HOUR
    return float(np.sqrt(max(variance - rounding, _ROUNDED * rounding))) / unit


def _middle(values: Array, weight: Array, otherwise: float) -> float:
    """Weighted median of what is finite, the lower of two."""
    there = np.isfinite(values)
    if not there.any():
        return otherwise
    order = np.argsort(values[there], kind="stable")
    share = np.cumsum(weight[there][order])
    return float(values[there][order][np.searchsorted(share, 0.5 * share[-1])])


def run_levels(runs: Sequence[FullRate], inputs: Sequence[RunInput], stated: Array, bits: Array) -> Array:
    """Noise of each gyro in each run over that of its other runs, (R, n): 1 where they are alike.

    Of a gyro's runs, the one in the middle is the measure, the record's own level counted as one more run.
    Runs of one rate and piece are compared line by line: a filter that they share leaves that as it is.
    `stated` (n,): white noise by the record [deg/sqrt(h)]; `bits` (n,): lost at each gyro.
    """
    n = len(stated)
    levels, error = np.ones((len(runs), n)), np.full((len(runs), n), np.inf)
    groups: dict[tuple[float, int], list[int]] = {}
    for r, (run, one) in enumerate(zip(runs, inputs, strict=True)):
        if run.pieces > 0:
            groups.setdefault((one.facts.sample_rate_hz, len(run.frequency)), []).append(r)
    for (rate, lines), members in groups.items():
        white = np.array([float(white_sigma(s, rate)) for s in stated]) * SECONDS_PER_HOUR
        for i in range(n):
            heard = []
            for r in members:
                rounding = float(rounding_variance(inputs[r].facts, bits)[i])
                if not runs[r].at_rest[i] and rounding < _COARSE * (white[i] ** 2 + rounding):
                    heard.append((r, white[i] ** 2 + rounding))
            if not heard:
                continue
            which = [r for r, _ in heard]
            pieces = np.array([runs[r].pieces for r in which])
            power = np.array([runs[r].power[i] / expected for r, expected in heard])
            levels[which, i] = np.exp(0.5 * _compared(power, pieces))
            # of a median, pi / 2 times the variance of a mean; a level is half its power's logarithm
            error[which, i] = np.sqrt(0.5 * np.pi / (4.0 * pieces * lines))
    ratio = np.ones(levels.shape)
    for i in range(n):
        seen = np.flatnonzero(np.isfinite(error[:, i]) & (levels[:, i] > 0.0))
        if seen.size < 2:
            continue
        logs = np.log(levels[seen, i])
        usual = int(np.argmin(np.abs(logs - np.median(np.append(logs, 0.0)))))
        apart = logs - logs[usual]
        chance = np.hypot(error[seen, i], error[seen[usual], i])
        other = (np.abs(apart) > _APART) & (np.abs(apart) > _BEYOND_CHANCE * chance)
        ratio[seen[other], i] = np.exp(apart[other])
    return ratio


def _compared(power: Array, pieces: NDArray[np.int64]) -> Array:
    """Ln level (r,) of each of a gyro's runs: that of their middle spectrum, and how far each is from it.

    `power` (r, F): mean powers of `pieces` (r,) pieces over the expected ones.
    """
    # the median of a mean of K exponential deviates of mean 1 is 1 - 1 / (3 K)
    logs = np.log(np.maximum(power, 1e-300) / (1.0 - 1.0 / (3.0 * pieces))[:, None])
    middle = np.median(logs, axis=0)
    result: Array = np.median(logs - middle, axis=1) + np.median(middle)
    return result


def run_level_findings(
    runs: Sequence[FullRate], inputs: Sequence[RunInput], ratio: Array, allowed: frozenset[str]
) -> Iterator[Finding]:
    """White noise of another level in some runs alone; `ratio`: (R, n), as of `run_levels`."""
    effect = "angle_random_walk" if "angle_random_walk" in allowed else "unknown"
    for r, i in np.argwhere(ratio != 1.0).tolist():
        run, facts = runs[r], inputs[r].facts
        weight = float(run.pieces * run.power.shape[1])
        log_b, snr2 = level_evidence(float(ratio[r, i]) ** 2, weight)
        rounding = float(rounding_variance(facts, np.zeros(facts.n_gyros))[i])
        unit = float(white_sigma(1.0, facts.sample_rate_hz)) * SECONDS_PER_HOUR
        whole = float(np.median(run.power[i])) / (1.0 - 1.0 / (3.0 * run.pieces))
        value = float(np.sqrt(max(whole - rounding, _ROUNDED * rounding))) / unit
        std = whole / unit**2 / value * float(np.sqrt(0.5 * np.pi / (4.0 * weight)))
        given = {"deg_sqrt_h": (value, std)} if effect != "unknown" else {}
        yield Finding(
            effect,
            (gyro_name(i),),
            (run.run_id,),
            log_b,
            snr2,
            given,
            1.0 / ratio.size,
            f"level of {run.run_id}",
            "noise",
            "white",
        )
