"""A campaign that determines the quantities of a test report, and what their uncertainties will be.

Staircases up and down about x, y and z on three days (scale factor and all that belongs to it), standstills
in six attitudes (bias, acceleration), turns both ways about x, y and z while the unit warms (scale factor
against temperature), one long standstill from power-on (warm-up, stability, temperature), swings about x, y
and z (bandwidth). The uncertainties are those that the report's own code finds for one campaign drawn from
the record: bins of every run with its noise and turn-on biases, and the samples of a swing.
"""

from __future__ import annotations

from collections.abc import Mapping
from datetime import datetime, timedelta
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fogreduce.calibrate.derive import derive_from
from fogreduce.calibrate.noise import GyroNoise, covariance
from fogreduce.calibrate.readings import Readings, middles, records_in_bin, whole_bins
from fogreduce.calibrate.swings import SwingRun
from fogreduce.characterise.bandwidth import LEAST_SAMPLES, swung_gyros
from fogreduce.characterise.definitions import Definitions
from fogreduce.characterise.quantities import quantities_of
from fogreduce.characterise.quantity import Quantity
from fogreduce.constants import EARTH_RATE_DEG_S, SECONDS_PER_HOUR
from fogreduce.estimate.swing import LONGEST_S, swing_of
from fogreduce.estimate.uncertainty import StatedErrors, axis_rates, motion_departures
from fogreduce.metadata.calibration import CalibrationRecord
from fogreduce.metadata.facts import RunFacts
from fogreduce.metadata.run import Run
from fogreduce.physics.low_pass import bandwidth_hz, of_steps
from fogreduce.physics.noise import white_sigma

Array = NDArray[np.float64]

#: Unit axis -> orientations with it up and down.
_UP = {"x": "z", "y": "x", "z": "y"}
_STAIRS = (0.0, 0.25, 0.5, 1.0, 0.5, 0.25, 0.0, -0.25, -0.5, -1.0, -0.5, -0.25, 0.0)
_STEP_S, _STILL_S, _WARM_S, _LONG_S = 60.0, 300.0, 450.0, 4 * SECONDS_PER_HOUR
#: Small rates for threshold and dead band, beyond what cancels Earth's vertical part [deg/h].
_SMALL_DEG_H = (10.0, 3.0)
_DAYS = 3
#: A swing: its largest rate [deg/s], which a table of 1000 deg/s^2 turns round in 10 ms, how long each rate
#: holds at least [s], and how many times.
_SWING_DEG_S, _SWING_HALF_S, _SWING_CHANGES = 5.0, 0.25, 120
_COLD = "from power-on, cold"
_PAUSE = timedelta(minutes=30)
#: Temperature of a run from power-on, as it is taken to warm up: rise [degC] and time constant [s].
_RISE_DEGC, _RISE_S = 5.0, 1800.0


def planned_runs(pattern: Mapping[str, Any], largest_deg_s: float) -> dict[str, dict[str, Any]]:
    """run.yaml of each planned run, by its id.

    Parameters
    ----------
    pattern : mapping
        run.yaml of a run on the same bench: unit, site, capture, calibration are taken from it.
    largest_deg_s : float
        Largest rate of the staircases.
    """
    at = datetime.fromisoformat(str(pattern["started_at"]))
    latitude = np.radians(float(pattern["site"]["latitude_deg"]))
    vertical = EARTH_RATE_DEG_S * float(np.sin(latitude))
    small = [-vertical + size / SECONDS_PER_HOUR for size in _SMALL_DEG_H]
    runs: dict[str, dict[str, Any]] = {}

    def add(name: str, axis: str, way: str, profile: list[tuple[float, float]], notes: str) -> None:
        nonlocal at
        run_id = f"{len(runs) + 1:02d}-{name}"
        steps = [{"rate_deg_s": float(f"{rate:.9g}"), "duration_s": length} for rate, length in profile]
        kept = {key: pattern[key] for key in ("schema", "unit", "site") if key in pattern}
        table = {"axis": axis, "profile": steps} | {
            key: value for key, value in pattern["table"].items() if key == "rate_uncertainty_ppm"
        }
        runs[run_id] = {
            **kept,
            "run_id": run_id,
            "started_at": at.isoformat().replace("+00:00", "Z"),
            "table": table,
            "orientation": {axis: way, _UP[axis]: "north"},
            "azimuth_uncertainty_deg": pattern.get("azimuth_uncertainty_deg", 0.05),
            "frame_signs": pattern.get("frame_signs", [1, 1, 1]),
            "capture": pattern["capture"],
            "calibration": pattern["calibration"],
            "notes": notes,
        }
        at += timedelta(seconds=sum(length for _, length in profile)) + _PAUSE

    start = at
    stairs = [(part * largest_deg_s, _STEP_S) for part in _STAIRS] + [(rate, _STEP_S) for rate in small]
    for day in range(_DAYS):
        at = start + timedelta(days=day)
        for axis in "xyz":
            add(f"stairs-{axis}-day{day + 1}", axis, "up", stairs, "power cycled before")
    at = start + timedelta(days=_DAYS)
    for axis in "xyz":
        for way in ("up", "down"):
            add(f"still-{axis}-{way}", axis, way, [(0.0, _STILL_S)], "power cycled before")
    notes = f"{_COLD}; log the temperatures and add temperature: temperature.csv"
    for axis in "xyz":
        turns = [(sense * largest_deg_s, _WARM_S) for sense in (1, -1, 1, -1)]
        add(f"warm-{axis}", axis, "up", turns, notes)
    add("long", "z", "up", [(0.0, _LONG_S)], notes)
    half_s = max(_SWING_HALF_S, 2 * LEAST_SAMPLES / float(pattern["capture"]["sample_rate_hz"]))
    if half_s <= LONGEST_S:
        rate = min(largest_deg_s, _SWING_DEG_S)
        swing = [(rate * (-1) ** k, half_s) for k in range(_SWING_CHANGES)]
        notes = "log the encoder at 100 Hz and more, and add table_log: table.csv"
        for axis in "xyz":
            add(f"swing-{axis}", axis, "up", swing, notes)
    return runs


def duration_s(runs: Mapping[str, Mapping[str, Any]]) -> float:
    """Time on the table [s], pauses not in it."""
    return float(sum(step["duration_s"] for run in runs.values() for step in run["table"]["profile"]))


def expected_quantities(
    runs: list[Run], record: CalibrationRecord, choices: Definitions, generator: np.random.Generator
) -> list[Quantity]:
    """The quantities of one campaign drawn from the record."""
    steady, swings = [], []
    for run in runs:
        swing = drawn_swing(run, record, generator)
        if swing is None:
            steady.append(drawn_readings(run, record, generator))
        else:
            swings.append(swing)
    return quantities_of(derive_from(steady), choices, *swung_gyros(swings))


def drawn_swing(run: Run, record: CalibrationRecord, generator: np.random.Generator) -> SwingRun | None:
    """A swing's samples: a pole at half the Nyquist frequency, white noise as stated; None if it is none."""
    facts = RunFacts.of_models(run, record)
    swing = swing_of(facts.profile, None)
    if swing is None:
        return None
    time_s = np.arange(round(facts.profile.end_s * facts.sample_rate_hz)) / facts.sample_rate_hz
    edge, rate = swing.steps.edge_s, swing.steps.rate_deg_s
    turned = of_steps(edge, rate, bandwidth_hz(facts.sample_rate_hz / 4), time_s)
    stated = np.array(record.stated_noise.angle_random_walk_deg_sqrt_h)
    white: Array = np.asarray(white_sigma(stated, facts.sample_rate_hz))
    read = np.outer(facts.axes @ facts.commanded_signs, turned)
    read += white[:, None] * generator.standard_normal(read.shape)
    return SwingRun(run, record, facts, swing, time_s, read)


def drawn_readings(run: Run, record: CalibrationRecord, generator: np.random.Generator) -> Readings:
    """A run's bins: the motion as planned, turn-on biases and noise as the record states them.

    Parameters
    ----------
    run, record, generator
        Run, calibration record, and where all draws come from.

    Returns
    -------
    Readings
        Their scatter within bins is what it is on average.
    """
    facts = RunFacts.of_models(run, record)
    size = records_in_bin(facts)
    bin_s = size / facts.sample_rate_hz
    middle = middles(facts)
    segment, inside = whole_bins(facts, middle)
    time_s: Array = middle[inside]
    stated, noise, n = StatedErrors.of(run, record), record.stated_noise, facts.n_gyros
    motion = axis_rates(facts, time_s)
    long = (run.notes or "").startswith(_COLD)
    warm = _RISE_DEGC * (1 - np.exp(-time_s / _RISE_S))
    white = white_sigma(np.array(noise.angle_random_walk_deg_sqrt_h), 1.0 / bin_s)  # deg/s of a bin
    planned = Readings(
        run=run,
        record=record,
        facts=facts,
        place=np.rint(time_s / bin_s - 0.5).astype(np.intp),
        bin_s=bin_s,
        segment=segment[inside],
        time_s=time_s,
        raw=np.zeros((n, time_s.size)),
        count=np.full((n, time_s.size), float(size)),
        scatter=np.tile((white * np.sqrt(size) * np.abs(facts.scale_factor))[:, None], time_s.size),
        step_square=np.zeros(n),
        steps=np.zeros(n),
        motion=motion,
        departure=motion_departures(facts, stated, time_s),
        temperature=warm if long else None,
        electronics=warm if long else None,
        warming=60 * (_RISE_DEGC - warm) / _RISE_S if long else None,
    )
    for i in range(n):
        each = GyroNoise(
            noise.angle_random_walk_deg_sqrt_h[i],
            noise.bias_instability_deg_h[i],
            noise.rate_random_walk_deg_h_sqrt_h[i],
            stated=True,
        )
        lower = np.linalg.cholesky(covariance(planned, i, each))
        off = stated.turn_on_bias_deg_h[i] * generator.standard_normal()
        off = off + lower @ generator.standard_normal(time_s.size)
        rate = facts.axes[i] @ motion + off / SECONDS_PER_HOUR
        planned.raw[i] = facts.scale_factor[i] * rate + facts.bias[i]
    return planned
