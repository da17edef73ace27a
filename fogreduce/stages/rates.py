"""Part of stage 6: measured mean rates held against the commanded ones, Earth's part taken away (rates.csv).

The offset rule of drift.csv moves each curve to the commanded rate, so that a run with a wrong sign, factor
or axis shows a small drift. Here nothing is moved. A row is flagged where its mean rate, or the sine that is
left of Earth's rate, lies farther off than noise and stated uncertainties let expect in one of 10 000 good
runs, all rows of the run counted. What a flagged run looks like is searched among plausible mistakes.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fogreduce.constants import EARTH_RATE_DEG_S, SECONDS_PER_HOUR
from fogreduce.estimate.gyro_curves import expected_gyro_curves, rate_curve
from fogreduce.estimate.mistakes import MeasuredCurve, MeasuredSegment, likely_mistakes
from fogreduce.estimate.propagation import from_sources
from fogreduce.estimate.rate_difference import RateDifference, over_segments, rate_difference
from fogreduce.estimate.uncertainty import StatedErrors, stated_gyro_theta
from fogreduce.metadata.facts import RunFacts
from fogreduce.stages.budget import Budget, Value, add_mean_rate, add_mean_rates_of_all, noise_covariance
from fogreduce.stages.tables import Cell

Array = NDArray[np.float64]

RATES = (
    "axis,segment,duration_s,measured_deg_s,commanded_deg_s,difference_deg_s,difference_err_deg_s,"
    "difference_err_noise_deg_s,difference_err_stated_deg_s,difference_deg_h,difference_err_deg_h,"
    "difference_sigma,difference_ppm,difference_err_ppm,sine_deg_h,sine_err_deg_h,sine_sigma,"
    "verdict,looks_like,version_id,coverage_factor,difference_err_expanded_deg_s"
)
RATES_COLUMNS = RATES.split(",")

#: Probability that a good run has a flagged row.
CHANCE = 1e-4
#: A difference of this part of the largest commanded rate, and more than Earth's rate, is gross.
_GROSS = 0.1

#: A mistake is looked for in so many segments, which takes a second or two; more of them tell it no better.
_MOST_SEGMENTS = 12

OK, FLAG, GROSS, NONE = "ok", "flag", "gross", "none"

#: A segment or a channel of the fits.
Item = Mapping[str, Any]
#: Channel and segment -> its difference.
Differences = dict[tuple[str, int | str], RateDifference]


def rate_rows(
    facts: RunFacts,
    stated: StatedErrors,
    fits: Mapping[str, Any],
    axes: Sequence[str],
    budget: Budget,
    version_id: str,
) -> list[list[Cell]]:
    """Rows of rates.csv: of each axis in each segment, and in the whole run where there are several.

    Gyros stand in for x, y, z where no record gives those: in a unit of one or two gyros, or where
    a gyro never answered.

    Parameters
    ----------
    facts, stated :
        Of the run.
    fits : mapping
        See `fogreduce.stages.fit_report.as_plain`.
    axes : sequence of str
        Names of the projected axes; none for a unit of one or two gyros.
    budget : Budget
        Of the run; what the gyros' mean rates come from is added to it where they stand in.
    version_id : str
    """
    gyros = [f"gyro{i + 1}" for i in range(facts.n_gyros)]
    curves = [{item["channel"]: item for item in s["channels"] if item is not None} for s in fits["segments"]]
    differences: Differences = {}
    for segment, found in zip(fits["segments"], curves, strict=True):
        for k, axis in enumerate(axes):
            differences[axis, segment["segment"]] = _of_axis(facts, k, segment, found.get(axis))
    if not any(part.is_determined for part in differences.values()):
        for segment, found in zip(fits["segments"], curves, strict=True):
            items = [found.get(gyro) for gyro in gyros]
            of_gyros = _of_gyros(facts, stated, fits, segment, items, budget)
            for gyro, difference in zip(gyros, of_gyros, strict=True):
                differences[gyro, segment["segment"]] = difference
        if len(fits["segments"]) > 1:
            add_mean_rates_of_all(budget, facts, fits, gyros)
    if len(fits["segments"]) > 1:
        for name in dict.fromkeys(name for name, _ in differences):
            parts = [part for (of, _), part in differences.items() if of == name]
            whole = budget.values.get(("mean_rate", name, "all"))
            errors = (math.nan, math.nan) if whole is None else (whole.noise, whole.stated)
            differences[name, "all"] = over_segments(parts, *errors)
    verdicts = _verdicts(facts, differences)
    words = ""
    if any(verdict in (FLAG, GROSS) for verdict in verdicts.values()):
        off = _most_off(fits, differences)
        words = " or ".join(likely_mistakes(facts, stated, _measured(facts, off, gyros)))
    absent = [gyro for gyro in gyros if not any(gyro in found for found in curves)]
    return [
        [
            *_row(key, difference, *_said(facts, verdicts[key], words, absent, difference), version_id),
            *_expanded(budget.values.get(("mean_rate", *key))),
        ]
        for key, difference in differences.items()
    ]


def _of_axis(facts: RunFacts, axis: int, segment: Item, item: Item | None) -> RateDifference:
    commanded = float(facts.commanded_signs[axis]) * segment["rate_deg_s"]
    if item is None:
        return _unknown(segment, commanded)
    stated = item["stated_covariance"]
    return rate_difference(
        np.array(item["theta"]),
        noise_covariance(item),
        np.zeros((4, 4)) if stated is None else np.array(stated),
        item["rate_rad_s"],
        item["has_sine"],
        (segment["start_s"], segment["stop_s"]),
        commanded,
    )


def _of_gyros(
    facts: RunFacts,
    stated: StatedErrors,
    fits: Mapping[str, Any],
    segment: Mapping[str, Any],
    items: Sequence[Mapping[str, Any] | None],
    budget: Budget,
) -> list[RateDifference]:
    """Of the gyros' own axes: their raw curves as rates, Earth's part taken away."""
    number = segment["segment"]
    projection = MeasuredSegment.of(facts.profile, number, ()).projection
    commanded = facts.axes @ facts.commanded_signs * segment["rate_deg_s"]
    expected = expected_gyro_curves(facts, projection)
    sources = stated_gyro_theta(facts, stated, projection)
    found = []
    for i, item in enumerate(items):
        if item is None:
            found.append(_unknown(segment, float(commanded[i])))
            continue
        theta = rate_curve(facts, i, np.array(item["theta"])) - expected[i]
        theta[0] += commanded[i]
        found.append(
            rate_difference(
                theta,
                noise_covariance(item) / facts.scale_factor[i] ** 2,
                from_sources(sources[:, i]),
                item["rate_rad_s"],
                item["has_sine"],
                (segment["start_s"], segment["stop_s"]),
                float(commanded[i]),
            )
        )
        add_mean_rate(budget, fits, segment, item, found[-1].measured, sources[:, i], facts.scale_factor[i])
    return found


def _unknown(segment: Item, commanded: float) -> RateDifference:
    duration = segment["stop_s"] - segment["start_s"]
    return RateDifference(duration, math.nan, commanded, math.nan, math.nan)


def _verdicts(facts: RunFacts, differences: Differences) -> dict[tuple[str, int | str], str]:
    allowed = CHANCE / max(1, sum(len(part.chances) for part in differences.values()))
    largest = max(_GROSS * float(np.max(np.abs(facts.profile.rate_deg_s))), EARTH_RATE_DEG_S)
    verdicts = dict.fromkeys(differences, NONE)
    for key, part in differences.items():
        if part.is_determined:
            off = min(part.chances) < allowed
            verdicts[key] = (GROSS if abs(part.difference) > largest else FLAG) if off else OK
    return verdicts


def _most_off(fits: Mapping[str, Any], differences: Differences) -> list[Item]:
    """The segments that are farthest off, at most `_MOST_SEGMENTS`, in order."""
    off: dict[int | str, float] = {}
    for (_, number), part in differences.items():
        for sigma in (abs(part.sigma), part.sine_sigma):
            if sigma > off.get(number, 0.0):  # never where it is NaN: no record, or no sine
                off[number] = sigma
    chosen = sorted(fits["segments"], key=lambda segment: off.get(segment["segment"], 0.0), reverse=True)
    return sorted(chosen[:_MOST_SEGMENTS], key=lambda segment: int(segment["segment"]))


def _measured(facts: RunFacts, segments: Sequence[Item], gyros: Sequence[str]) -> list[MeasuredSegment]:
    found = []
    for segment in segments:
        curves = [
            MeasuredCurve(
                gyros.index(item["channel"]),
                np.array(item["theta"]),
                noise_covariance(item),
                item["has_sine"],
            )
            for item in segment["channels"]
            if item is not None and item["channel"] in gyros
        ]
        found.append(MeasuredSegment.of(facts.profile, segment["segment"], curves))
    return found


def _said(
    facts: RunFacts, verdict: str, words: str, absent: Sequence[str], part: RateDifference
) -> tuple[str, str]:
    """Verdict and what it looks like."""
    if verdict == OK:
        return OK, ""
    if verdict == NONE:
        return NONE, f"no record of {' and '.join(absent)}" if absent else "too few usable records"
    if words:
        return GROSS, words
    if verdict == GROSS and part.commanded:
        return GROSS, f"{part.measured / part.commanded:.4g} times the commanded rate"
    if verdict == GROSS and facts.profile.rate_deg_s.any():
        return GROSS, "a turn where none is commanded"
    return verdict, ""


def _row(
    key: tuple[str, int | str], part: RateDifference, verdict: str, words: str, version_id: str
) -> list[Cell]:
    name, segment = key
    ppm = 1e6 / abs(part.commanded) if part.commanded else math.nan
    return [
        name,
        segment,
        part.duration_s,
        part.measured,
        part.commanded + 0.0,
        part.difference,
        part.error,
        part.noise,
        part.stated,
        part.difference * SECONDS_PER_HOUR,
        part.error * SECONDS_PER_HOUR,
        part.sigma,
        math.copysign(1.0, part.commanded) * part.difference * ppm,
        part.error * ppm,
        part.sine * SECONDS_PER_HOUR,
        part.sine_err * SECONDS_PER_HOUR,
        part.sine_sigma,
        verdict,
        words,
        version_id,
    ]


def _expanded(value: Value | None) -> list[Cell]:
    """Coverage factor and expanded uncertainty of a mean rate."""
    return [None, None] if value is None else [value.factor, value.factor * value.combined]
