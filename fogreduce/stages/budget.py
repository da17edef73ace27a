"""Part of stage 6: what the uncertainty of every published value comes from (budget.csv, correlations.csv).

A value is linear in the coefficients of mean curves, or nearly so. Its combined standard uncertainty is that
of noise and of every source that calibration record and run.yaml state, each with its sign: a source moves
x, y, z and all segments together, so that sums and correlations come out right.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fogreduce.constants import SECONDS_PER_HOUR
from fogreduce.estimate.curve_terms import drift_terms, mean_rate_terms, plain_terms
from fogreduce.estimate.mean_curve import phase_jacobian
from fogreduce.estimate.propagation import coverage_factor, propagated, standard_uncertainties
from fogreduce.estimate.uncertainty import GROUPS, StatedErrors, source_groups, stated_theta
from fogreduce.metadata.facts import RunFacts
from fogreduce.stages.tables import Cell

Array = NDArray[np.float64]
Item = Mapping[str, Any]

PARTS = ("noise", *GROUPS)
BUDGET_COLUMNS = (
    "quantity,channel,segment,unit,value,"
    + ",".join(f"u_{part}" for part in PARTS)
    + ",u_combined,coverage_factor,u_expanded,version_id"
).split(",")
CORRELATIONS_COLUMNS = [
    "quantity",
    "channel_1",
    "channel_2",
    "segment",
    "unit",
    "covariance_noise",
    "covariance_stated",
    "correlation",
    "version_id",
]

#: Quantities of which the covariance between the axes is given.
JOINT = ("a", "p", "q", "e", "drift", "integral", "mean_rate")


@dataclass(frozen=True)
class Value:
    """A published value.

    Attributes
    ----------
    quantity, channel, unit : str
    segment : int or str
        Its number, or ``all``.
    value : float
        In `unit`, as are `noise` and `sources`.
    noise : float
        Standard uncertainty by noise.
    noise_spread : float
        Variance of noise's variance, since the size of the noise is itself uncertain.
    sources : (sources,) array
        What each stated source, at one standard deviation, adds, with sign; empty for raw readings.
    """

    quantity: str
    channel: str
    segment: int | str
    unit: str
    value: float
    noise: float
    noise_spread: float
    sources: Array

    @property
    def stated(self) -> float:
        """Standard uncertainty by what is stated."""
        return float(np.sqrt(self.sources @ self.sources))

    @property
    def combined(self) -> float:
        """Combined standard uncertainty."""
        return math.hypot(self.noise, self.stated)

    @property
    def factor(self) -> float:
        """Coverage factor of 95 %."""
        return coverage_factor(self.combined**2, self.noise_spread)

    def part(self, groups: Sequence[str], name: str) -> float:
        """Standard uncertainty by one of `PARTS`."""
        if name == PARTS[0]:
            return self.noise
        of = self.sources[[k for k, group in enumerate(groups[: self.sources.size]) if group == name]]
        return float(np.sqrt(of @ of))


@dataclass(frozen=True)
class Budget:
    """Every published value of a run, and the covariance of noise between its axes.

    Attributes
    ----------
    groups : list of str
        Which part of the budget each source belongs to.
    values : dict
        (quantity, channel, segment) -> value.
    noise : dict
        (quantity, channel, channel, segment) -> covariance.
    """

    groups: list[str]
    values: dict[tuple[str, str, int | str], Value]
    noise: dict[tuple[str, str, str, int | str], float]

    def rows(self, version_id: str) -> list[list[Cell]]:
        """Rows of budget.csv."""
        return [
            [
                *(value.quantity, value.channel, value.segment, value.unit, value.value),
                *(value.part(self.groups, part) for part in PARTS),
                *(value.combined, value.factor, value.factor * value.combined, version_id),
            ]
            for value in self.values.values()
        ]

    def correlation_rows(self, version_id: str) -> list[list[Cell]]:
        """Rows of correlations.csv."""
        rows: list[list[Cell]] = []
        for (quantity, one, two, segment), noise in self.noise.items():
            first, second = (self.values[quantity, name, segment] for name in (one, two))
            stated = float(first.sources @ second.sources)
            scale = first.combined * second.combined
            correlation = (noise + stated) / scale if scale > 0 else math.nan
            unit = f"({first.unit})^2"
            rows.append([quantity, one, two, segment, unit, noise, stated, correlation, version_id])
        return rows


def budget_of(
    facts: RunFacts, stated: StatedErrors, fits: Item, gyros: Sequence[str], axes: Sequence[str]
) -> Budget:
    """The budget of a run.

    Parameters
    ----------
    facts, stated :
        Of the run.
    fits : mapping
        See `fogreduce.stages.fit_report.as_plain`.
    gyros, axes : sequence of str
        Names of the channels; no axes for a unit of one or two gyros.
    """
    budget = Budget(source_groups(facts.n_gyros), {}, {})
    for segment in fits["segments"]:
        found = {item["channel"]: item for item in segment["channels"] if item is not None}
        for name in gyros:
            if name in found:
                _add_gyro(budget, facts, fits, segment, found[name])
        if all(axis in found for axis in axes):
            _add_axes(budget, facts, stated, fits, segment, [found[axis] for axis in axes])
    if len(fits["segments"]) > 1:
        _add_whole(budget, fits, axes)
    return budget


def noise_covariance(item: Item) -> Array:
    """Covariance of theta by all noise where there were bins enough to tell, else by white noise."""
    coloured = item["coloured_covariance"]
    return np.array(item["covariance"] if coloured is None else coloured)


def _noise_of(segment: Item, item: Item, weights: Array) -> tuple[float, float]:
    """Standard uncertainty by noise of `weights` times theta, and the variance of its variance."""
    noise = standard_uncertainties(propagated(weights[None], noise_covariance(item)))[0]
    if item["coloured_covariance"] is None:
        return float(noise), 0.0
    forms = np.array(segment["unit_forms"][str(_terms(item))])
    unit = np.einsum("i,kij,j->k", weights, forms, weights)
    return float(noise), float(unit @ np.array(segment["noise_spread"][item["channel"]]) @ unit)


def _terms(item: Item) -> int:
    return 4 if item["has_sine"] else 2 if item["has_slope"] else 1


def _curve_weights(item: Item, unit: str) -> dict[str, tuple[str, float, Array]]:
    """Quantity -> unit, value and derivatives by theta, of the curve's parameters."""
    theta = np.array(item["theta"])
    found = {"a": (unit, theta[0], np.eye(4)[0])}
    if item["has_sine"]:
        b, d, jacobian = phase_jacobian(theta)
        found |= {"p": (unit, theta[1], np.eye(4)[1]), "q": (unit, theta[2], np.eye(4)[2])}
        if b > 0:
            found["b"] = (unit, b, jacobian[0])
        if item["has_phase"]:
            found["d"] = ("rad", d, jacobian[1])
    if item["has_slope"]:
        found["e"] = (f"{unit}/s", theta[3], np.eye(4)[3])
    return found


def _add_gyro(budget: Budget, facts: RunFacts, fits: Item, segment: Item, item: Item) -> None:
    """A gyro's curve, fitted to raw readings: noise and rounding are all that there is."""
    for quantity, (unit, value, weights) in _curve_weights(item, facts.raw_unit.name).items():
        noise, spread = _noise_of(segment, item, weights)
        key = quantity, item["channel"], segment["segment"]
        budget.values[key] = Value(*key, unit, float(value), noise, spread, np.zeros(0))


def _axis_weights(segment: Item, item: Item) -> dict[str, tuple[str, float, Array]]:
    """The same of an axis: its curve, drift, accumulated error, plain integral and mean rate."""
    span = segment["start_s"], segment["stop_s"], item["rate_rad_s"]
    per_hour = SECONDS_PER_HOUR / (segment["stop_s"] - segment["start_s"])
    found = _curve_weights(item, "deg/s")
    linear = {"integral": ("deg", plain_terms(*span)), "mean_rate": ("deg/s", mean_rate_terms(*span))}
    if item["has_slope"]:
        terms = drift_terms(*span)
        linear = {"drift": ("deg/h", per_hour * terms), "accumulated_error": ("deg", terms)} | linear
    for quantity, (unit, weights) in linear.items():
        found[quantity] = (unit, float(weights @ np.array(item["theta"])), weights)
    return found


def _add_axes(
    budget: Budget, facts: RunFacts, stated: StatedErrors, fits: Item, segment: Item, items: Sequence[Item]
) -> None:
    number = segment["segment"]
    facts = replace(facts, projection=np.array(segment["projection"]))
    across = segment["axes_noise_covariance"]
    weights_of = {}
    added = {terms: stated_theta(facts, stated, number, terms) for terms in set(map(_terms, items))}
    for k, item in enumerate(items):
        theta = added[_terms(item)][:, k]
        weights_of[item["channel"]] = _axis_weights(segment, item)
        for quantity, (unit, value, weights) in weights_of[item["channel"]].items():
            noise, spread = _noise_of(segment, item, weights)
            key = quantity, item["channel"], number
            budget.values[key] = Value(*key, unit, float(value), noise, spread, theta @ weights)
    if across is None:
        return
    joint = np.array(across).reshape(3, 4, 3, 4)
    for quantity in JOINT:
        for (i, one), (j, two) in combinations(enumerate(weights_of), 2):
            if quantity in weights_of[one] and quantity in weights_of[two]:
                covariance = weights_of[one][quantity][2] @ joint[i, :, j] @ weights_of[two][quantity][2]
                budget.noise[quantity, one, two, number] = float(covariance)


def add_mean_rate(
    budget: Budget, fits: Item, segment: Item, item: Item, measured: float, sources: Array, scale: float
) -> None:
    """The mean rate of a gyro in a segment [deg/s], which the offset of its raw curve gives.

    `sources` (sources, 4) is what the stated sources add to theta of its rate, `scale` its scale factor.
    """
    weights = mean_rate_terms(segment["start_s"], segment["stop_s"], item["rate_rad_s"])
    noise, spread = _noise_of(segment, item, weights / scale)
    key = "mean_rate", item["channel"], segment["segment"]
    budget.values[key] = Value(*key, "deg/s", measured, noise, spread, sources @ weights)


def add_mean_rates_of_all(budget: Budget, facts: RunFacts, fits: Item, gyros: Sequence[str]) -> None:
    """The mean rates of gyros over all segments together."""
    per_s = 1.0 / _duration(fits)
    for k, gyro in enumerate(gyros):
        scale = float(facts.scale_factor[k])
        _add_sum(budget, fits, gyro, "mean_rate", "integral", [("mean_rate", "deg/s", per_s)], scale)


def _add_whole(budget: Budget, fits: Item, axes: Sequence[str]) -> None:
    """Of all segments together: values and what sources add sum up, signs and all."""
    duration = _duration(fits)
    drift = [("drift", "deg/h", SECONDS_PER_HOUR / duration), ("accumulated_error", "deg", 1.0)]
    integral = [("integral", "deg", 1.0), ("mean_rate", "deg/s", 1.0 / duration)]
    whole = fits["whole"] or {}
    for summed, of, results in (("accumulated_error", "drift", drift), ("integral", "integral", integral)):
        for axis in axes:
            _add_sum(budget, fits, axis, summed, of, results)
        if not whole.get(of):
            continue
        for (i, one), (j, two) in combinations(enumerate(axes), 2):
            for quantity, _, factor in results:
                if quantity in JOINT and (quantity, one, "all") in budget.values:
                    covariance = factor**2 * whole[of]["covariance"][i][j]
                    budget.noise[quantity, one, two, "all"] = covariance


def _duration(fits: Item) -> float:
    """Of the whole run [s]."""
    return float(fits["segments"][-1]["stop_s"] - fits["segments"][0]["start_s"])


def _add_sum(
    budget: Budget,
    fits: Item,
    channel: str,
    summed: str,
    of: str,
    results: Sequence[tuple[str, str, float]],
    scale: float = 1.0,
) -> None:
    """What one channel has over all segments, where every segment has it.

    Parameters
    ----------
    budget, fits, channel :
    summed : str
        The quantity of a segment; a mean rate counts by the segment's duration.
    of : str
        Which angle of the whole run it makes: ``drift`` or ``integral``.
    results : sequence of (quantity, unit, factor)
        What is published of that angle, and as which multiple of it.
    scale : float
        Raw unit of the channel per deg/s.
    """
    segments = fits["segments"]
    parts = [budget.values.get((summed, channel, segment["segment"])) for segment in segments]
    if any(part is None for part in parts):
        return
    spans = [each["stop_s"] - each["start_s"] if summed == "mean_rate" else 1.0 for each in segments]
    determined = [(span, part) for span, part in zip(spans, parts, strict=True) if part is not None]
    value = math.fsum(span * part.value for span, part in determined)
    sources = np.sum([span * part.sources for span, part in determined], axis=0)
    error, spread = math.hypot(*(span * part.noise for span, part in determined)), 0.0
    whole = (fits["whole"] or {}).get(of)
    if whole is not None and channel in fits["whole"]["channels"]:
        k = fits["whole"]["channels"].index(channel)
        rounded = _rounding_over(segments, channel, of) / scale**2
        error = math.sqrt(max(0.0, whole["covariance"][k][k]) + rounded)
        spread = whole["spread"][k]
    for quantity, unit_name, factor in results:
        key = quantity, channel, "all"
        noise = factor * error, factor**4 * spread
        budget.values[key] = Value(*key, unit_name, factor * value, *noise, factor * sources)


def _rounding_over(segments: Sequence[Item], channel: str, of: str) -> float:
    """Variance of an angle over all segments by rounding, segments independent [(raw unit s)^2]."""
    terms = drift_terms if of == "drift" else plain_terms
    total = 0.0
    for segment in segments:
        item = next(each for each in segment["channels"] if each is not None and each["channel"] == channel)
        if item["rounding_covariance"] is not None:
            weights = terms(segment["start_s"], segment["stop_s"], item["rate_rad_s"])
            total += float(propagated(weights[None], np.array(item["rounding_covariance"]))[0, 0])
    return total
