"""Bias of a gyro, how it repeats between runs and days, and its stability within a run."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray
from scipy.special import chdtri

from fogreduce.calibrate.derive import Derivation
from fogreduce.calibrate.shapes import ACCELERATION, MAGNETIC, Shape
from fogreduce.characterise.definitions import Definitions
from fogreduce.characterise.left_open import bias_is_open
from fogreduce.characterise.quantity import COVERAGE, Quantity, normal, undetermined
from fogreduce.characterise.spread import Spread, about_solution, spread_of_runs, spread_of_values
from fogreduce.characterise.stretch import longest_stretch

Array = NDArray[np.float64]

_FEWEST_MEANS = 20
#: Departures by which a run's bias follows its rates and attitude, which is no scatter.
_FOLLOWS = ("asymmetry", *ACCELERATION, MAGNETIC)


def bias_quantities(
    found: Derivation, gyro: int, shapes: list[Shape], choices: Definitions
) -> list[Quantity]:
    """Bias, repeatability, stability."""
    of = f"gyro{gyro + 1}"
    return [
        _bias(found, gyro, of),
        _between(
            spread_of_runs(
                found.products,
                gyro,
                found.solution.change[found.solution.layout.gyro(gyro)],
                [one.name for one in shapes if one.gyro == gyro and one.name in _FOLLOWS],
            ),
            "bias_repeatability",
            of,
            "runs, power cycled between them, of the same rates and attitudes (two more than are needed "
            "to determine bias, scale factor and axis)",
        ),
        _between(_of_days(found, gyro), "bias_repeatability_days", of, "runs on three days or more"),
        _stability(found, gyro, of, choices),
    ]


def _bias(found: Derivation, gyro: int, of: str) -> Quantity:
    std = float(found.parameters.standard_errors[gyro, 0])
    if bias_is_open(found, gyro):
        needs = "a standstill, or the same rate in both senses"
        return undetermined("bias", of, "deg/h", needs)
    return normal("bias", of, "deg/h", float(found.parameters.bias_deg_h[gyro]), std)


def _between(spread: Spread | None, name: str, of: str, needs: str) -> Quantity:
    if spread is None:
        return undetermined(name, of, "deg/h", needs)
    note = f"{spread.freedom} degrees of freedom"
    return Quantity(name, of, "deg/h", spread.value, spread.low, spread.high, note=note)


def _of_days(found: Derivation, gyro: int) -> Spread | None:
    """Scatter of the daily means beyond that of runs within a day."""
    turn_on = float(found.solution.turn_on_deg_h[gyro])
    days: dict[str, list[tuple[float, float]]] = {}
    for product, one in ((p, found.readings[p.run]) for p in found.products if p.gyro == gyro):
        variance = turn_on**2 + 1 / float(product.gram[0, 0])
        about = about_solution(product.gram, found.solution.change[found.solution.layout.gyro(gyro)])
        days.setdefault(one.run.started_at.date().isoformat(), []).append(
            (float(about[0, 4] / about[0, 0]), variance)
        )
    if len(days) < 3:
        return None
    means = [float(np.mean([value for value, _ in runs])) for runs in days.values()]
    std = [math.sqrt(np.mean([v for _, v in runs]) / len(runs)) for runs in days.values()]
    return spread_of_values(means, std)


def _stability(found: Derivation, gyro: int, of: str, choices: Definitions) -> Quantity:
    """Scatter of means of so many seconds within the longest stretch at one rate."""
    seconds = choices.bias_stability_s
    stretch = longest_stretch(found, gyro)
    means = np.zeros(0)
    if stretch is not None:
        each = max(1, round(seconds / stretch.bin_s))
        values = stretch.values[np.isfinite(stretch.values)]
        means = values[: values.size // each * each].reshape(-1, each).mean(axis=1)
    if stretch is None or means.size < _FEWEST_MEANS:
        needs = f"a run of {_FEWEST_MEANS * seconds:g} s and more at one rate"
        return undetermined("bias_stability", of, "deg/h", needs)
    left = means.size - 1 - stretch.fitted
    about = means - means.mean()
    value = math.sqrt(float(about @ about) / left)
    tail = (1 - COVERAGE) / 2
    # Means that are correlated (flicker) have fewer degrees of freedom than their number.
    lag = max(0.0, float(about[1:] @ about[:-1] / max(float(about @ about), 1e-300)))
    freedom = max(2.0, left * (1 - lag**2) / (1 + lag**2))
    low, high = (value * math.sqrt(freedom / float(chdtri(freedom, part))) for part in (tail, 1 - tail))
    note = f"run {stretch.run}, {means.size} means of {seconds:g} s"
    return Quantity("bias_stability", of, "deg/h", value, low, high, note=note)
