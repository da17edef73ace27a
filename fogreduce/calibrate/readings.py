"""What a run says of its gyros: means of raw readings over short bins, and the motion in the same bins.

The raw readings are judged as every reduction judges them (`fogreduce.stages.ingest`); bins that are not
wholly inside a segment of constant rate, a guard left out, are dropped.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from fogreduce.calibrate.swings import swing_in
from fogreduce.constants import MICROSECONDS_PER_SECOND, SECONDS_PER_HOUR
from fogreduce.datasets.flags import UNUSABLE_RECORD
from fogreduce.datasets.logs import TemperatureLog
from fogreduce.datasets.readers.contradictions import open_run_capture
from fogreduce.datasets.run_logs import temperatures_of
from fogreduce.effects.at import slope_around
from fogreduce.errors import BadInput
from fogreduce.estimate.bins import Bins, bins_of
from fogreduce.estimate.swing import Swing
from fogreduce.estimate.uncertainty import StatedErrors, axis_rates, motion_departures
from fogreduce.metadata.calibration import CalibrationRecord
from fogreduce.metadata.config import ReductionConfig
from fogreduce.metadata.facts import RunFacts
from fogreduce.metadata.folder import runs_of_one_record
from fogreduce.metadata.run import Run
from fogreduce.stages.ingest import Ingest, usable_gyros

Array = NDArray[np.float64]

#: Bins of a run: the covariance of its noise is a matrix of this size at most.
MOST_BINS = 512
_SHORTEST_BIN_S = 1.0
#: Steps from sample to sample beyond so many of the median one are no noise: of a normal one in 10^11 is.
_LARGEST_STEP = 10.0
#: Half the window over which the sensors' rate of temperature is taken [s], as the effects have it.
WARMING_HALF_S = 10.0


@dataclass(frozen=True)
class Readings:
    """A run in m bins.

    Attributes
    ----------
    run, record, facts :
        The run's metadata.
    place : (m,) array of int
        Number of each bin, counted from the run's start: bins that were dropped leave holes.
    bin_s : float
        Length of a bin [s].
    segment : (m,) array of int
        Segment of the profile, from 0.
    time_s : (m,) array
        Middles of the bins [s].
    raw : (n, m) array
        Mean raw reading, polarity taken out [raw unit]; NaN where a gyro gave none.
    count : (n, m) array
        Samples in it.
    scatter : (n, m) array
        Their standard deviation, what the present record makes of the motion taken away [raw unit]: Earth's
        wave in a turn is none of it.
    step_square, steps : (n,) arrays
        Sum of the squared steps from one sample to the next, what the present record makes of the motion
        taken away [raw unit^2], and their number.
    motion : (3, m) array
        What the axes x, y, z read of table and Earth [deg/s].
    departure : (3, 3, m) array
        What azimuth, latitude and table rate, each one standard deviation off, add to `motion` [deg/s].
    temperature : (m,) array or None
        Of the sensors less that at the run's start [degC]; None without a log.
    electronics : (m,) array or None
        The same of the electronics.
    warming : (m,) array or None
        Rate of the sensors' temperature [degC/min], over the 20 s around.
    """

    run: Run
    record: CalibrationRecord
    facts: RunFacts
    place: NDArray[np.intp]
    bin_s: float
    segment: NDArray[np.intp]
    time_s: Array
    raw: Array
    count: Array
    scatter: Array
    step_square: Array
    steps: Array
    motion: Array
    departure: Array
    temperature: Array | None
    electronics: Array | None
    warming: Array | None


def residual_rates(one: Readings) -> Array:
    """What the gyros read beyond table and Earth by the record, (n, m) [deg/h]."""
    facts = one.facts
    rates = (one.raw - facts.bias[:, None]) / facts.scale_factor[:, None] - facts.axes @ one.motion
    found: Array = rates * SECONDS_PER_HOUR
    return found


def read_campaign(campaign: Path, calibrations: Path, only: Sequence[str] = ()) -> list[Readings]:
    """The runs of a campaign, all of one unit and one calibration record.

    Runs that swing and hold no bin at a constant rate are left out.

    Raises
    ------
    BadInput
        With every fault of the runs; runs of several records; no run at a constant rate.
    """
    found = runs_of_one_record(campaign, calibrations, only, _unless_it_swings)
    readings = [one for one in found if one is not None]
    if not readings:
        expected = "a run at constant rates beside them"
        raise BadInput.at(campaign, "runs", found="only runs that swing", expected=expected)
    return readings


def _unless_it_swings(folder: Path, run: Run, record: CalibrationRecord) -> Readings | None:
    """One run in bins; None where it swings throughout."""
    facts = RunFacts.of_models(run, record)
    swing = swing_in(folder, run, facts)
    if swing is not None:
        middle = middles(facts)
        _, inside = whole_bins(facts, middle)
        if not (inside & ~swing.covers(middle)).any():
            return None
    return read_run(folder, run, record, swing)


def middles(facts: RunFacts) -> Array:
    """Middles [s] of the bins of a whole run."""
    bin_s = records_in_bin(facts) / facts.sample_rate_hz
    return bin_s * (np.arange(int(facts.profile.end_s / bin_s), dtype=np.float64) + 0.5)


def read_run(folder: Path, run: Run, record: CalibrationRecord, swing: Swing | None = None) -> Readings:
    """One run in bins; what lies within a swing counts in none."""
    facts = RunFacts.of_models(run, record)
    reader = open_run_capture(folder, run, facts)
    parameters = ReductionConfig()
    size = records_in_bin(facts)
    stated = StatedErrors.of(run, record)
    ingest = Ingest(facts, parameters.outliers.threshold_sigma)
    parts = []
    step_square, steps = np.zeros(facts.n_gyros), np.zeros(facts.n_gyros)
    block_records = max(1, parameters.block_records // size) * size
    for block in ingest.blocks(reader, block_records):
        time_s = block.time_us / MICROSECONDS_PER_SECOND
        raw, motion = block.raw * facts.polarity[:, None], axis_rates(facts, time_s)
        left = raw - facts.scale_factor[:, None] * (facts.axes @ motion)
        values = np.vstack((left, raw, motion, motion_departures(facts, stated, time_s).reshape(9, -1)))
        usable = _usable(block.flag, block.gyro_flag, len(values))
        if swing is not None:
            steady = np.broadcast_to(~swing.covers(time_s), values.shape)
            usable = steady if usable is None else usable & steady
        square, number = _steps(left, None if usable is None else usable[: facts.n_gyros])
        step_square, steps = step_square + square, steps + number
        parts.append(bins_of(time_s, values, usable, size))
    bins = Bins.joined(parts)
    n, bin_s = facts.n_gyros, size / facts.sample_rate_hz
    segment, inside = whole_bins(facts, bins.time_s)
    inside &= (bins.count[2 * n] > size / 2) & (bins.count[:n] > size / 2).any(axis=0)
    if not inside.any():
        expected = "at least one bin of usable records inside a segment of the profile"
        raise BadInput.at(folder / run.capture.file, "", found="no usable data", expected=expected)
    log = temperatures_of(folder, run.model_dump(mode="json"), facts.start_us)
    time_s = bins.time_s[inside]
    return Readings(
        run=run,
        record=record,
        facts=facts,
        place=np.rint(time_s / bin_s - 0.5).astype(np.intp),
        bin_s=bin_s,
        segment=segment[inside],
        time_s=time_s,
        raw=np.where(bins.count[:n, inside] > size / 2, bins.mean[n : 2 * n, inside], np.nan),
        count=bins.count[:n, inside],
        scatter=bins.scatter[:n, inside],
        step_square=step_square,
        steps=steps,
        motion=bins.mean[2 * n : 2 * n + 3, inside],
        departure=bins.mean[2 * n + 3 :, inside].reshape(3, 3, -1),
        temperature=None if log is None else log.sensor_at(time_s) - log.sensor_at(np.zeros(1)),
        electronics=_electronics(log, time_s),
        warming=None if log is None else _warming(log, time_s),
    )


def _electronics(log: TemperatureLog | None, time_s: Array) -> Array | None:
    """The electronics' temperature less that at the run's start [degC]; None where it was not logged."""
    if log is None or log.electronics_degC is None:
        return None
    at: Array = np.interp(np.append(time_s, 0.0), log.time_s, log.electronics_degC)
    return at[:-1] - at[-1]


def _warming(log: TemperatureLog, time_s: Array) -> Array:
    return 60.0 * slope_around(log.time_s, log.sensor_degC, time_s, half_s=WARMING_HALF_S)


def records_in_bin(facts: RunFacts) -> int:
    """Records in a bin: a second's at least, and so many that there are not more than `MOST_BINS`."""
    return max(1, round(max(_SHORTEST_BIN_S, facts.profile.end_s / MOST_BINS) * facts.sample_rate_hz))


def _usable(flag: NDArray[np.uint8], gyro_flag: NDArray[np.uint8], rows: int) -> NDArray[np.bool_] | None:
    """Which values count: of each gyro, less motion and whole, then of the motion."""
    gyros = usable_gyros(flag, gyro_flag)
    if gyros is None:
        return None
    records = np.broadcast_to((flag & UNUSABLE_RECORD) == 0, (rows - 2 * len(gyros), flag.size))
    return np.vstack((gyros, gyros, records))


def _steps(left: Array, usable: NDArray[np.bool_] | None) -> tuple[Array, NDArray[np.intp]]:
    """Sum of the squared steps between neighbouring samples less the motion, and their number, (n,) each.

    Jumps between two commanded rates, of which there are few, are left out as their size says.
    """
    if usable is not None:
        left = np.where(usable, left, np.nan)
    step = np.diff(left, axis=1)
    typical = np.nanmedian(np.abs(step), axis=1, keepdims=True) if step.size else np.zeros((len(left), 1))
    there = np.abs(step) <= _LARGEST_STEP * typical
    return np.sum(np.where(there, step, 0.0) ** 2, axis=1), np.count_nonzero(there, axis=1)


def whole_bins(facts: RunFacts, time_s: Array) -> tuple[NDArray[np.intp], NDArray[np.bool_]]:
    """Segment of each bin, and whether the whole bin lies in it (the guard left out between segments).

    `time_s` (m,): middles of the bins [s]; NaN for one without samples.
    """
    edges, guard_s = facts.profile.edges_s, ReductionConfig().edge_guard_s
    bin_s = records_in_bin(facts) / facts.sample_rate_hz
    middle = np.nan_to_num(time_s, nan=-1.0)
    segment = np.clip(np.searchsorted(edges, middle, side="right") - 1, 0, len(edges) - 2)
    first, last = segment == 0, segment == len(edges) - 2
    low = edges[segment] + bin_s / 2 + np.where(first, -bin_s / 4, guard_s)
    high = edges[segment + 1] - bin_s / 2 - np.where(last, -bin_s / 4, guard_s)
    return segment, (middle >= low) & (middle <= high)
