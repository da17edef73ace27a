"""Runs that swing: which they are, and their samples at the full rate along the table's axis."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from fogreduce.constants import MICROSECONDS_PER_SECOND
from fogreduce.datasets.block import Block
from fogreduce.datasets.flags import GyroFlag, RecordFlag
from fogreduce.datasets.logs import read_table_log
from fogreduce.datasets.readers.contradictions import open_run_capture
from fogreduce.errors import BadInput
from fogreduce.estimate.swing import Swing, swing_of
from fogreduce.estimate.uncertainty import axis_rates
from fogreduce.metadata.calibration import CalibrationRecord
from fogreduce.metadata.config import ReductionConfig
from fogreduce.metadata.facts import RunFacts
from fogreduce.metadata.folder import runs_of_one_record
from fogreduce.metadata.run import Run
from fogreduce.stages.ingest import Ingest

Array = NDArray[np.float64]

#: Samples of a swing that are compared at most, so that memory is bounded: half an hour at 128 Hz.
MOST_SAMPLES = 1 << 18
#: Changes of rate after which the samples begin: what the table did before the run is forgotten by then.
_LEAD = 4
#: Spurious samples are not left out here: beside an edge of the rate the search for them errs.
_UNUSABLE = RecordFlag.REPEATED | RecordFlag.BAD_STAMP | RecordFlag.BEYOND_PROFILE
_UNUSABLE_GYRO = GyroFlag.MISSING | GyroFlag.CONSTANT


@dataclass(frozen=True)
class SwingRun:
    """The samples of a swing.

    Attributes
    ----------
    run, record, facts :
        The run's metadata.
    swing : Swing
    time_s : (N,) array
        Instants at equal intervals [s], one for each pulse, whether it was answered or not.
    rate : (n, N) array
        What each gyro reads by its record [deg/s], polarity, bias and Earth's part taken out; NaN where it
        gave nothing.
    """

    run: Run
    record: CalibrationRecord
    facts: RunFacts
    swing: Swing
    time_s: Array
    rate: Array

    @property
    def step_s(self) -> float:
        """Time between samples [s]."""
        return float(self.time_s[-1] - self.time_s[0]) / (self.time_s.size - 1)


def swing_in(folder: Path, run: Run, facts: RunFacts) -> Swing | None:
    """The swing of a run, by its profile or its encoder's log; None where it does not swing."""
    log = None if run.table_log is None else read_table_log(folder / run.table_log)
    return swing_of(facts.profile, None if log is None else (log.time_s, log.angle_deg))


def read_swings(campaign: Path, calibrations: Path, only: Sequence[str] = ()) -> list[SwingRun]:
    """The runs of a campaign that swing.

    Raises
    ------
    BadInput
        With every fault of the runs; runs of several records.
    """
    found = runs_of_one_record(campaign, calibrations, only, _read)
    return [one for one in found if one is not None]


def _read(folder: Path, run: Run, record: CalibrationRecord) -> SwingRun | None:
    facts = RunFacts.of_models(run, record)
    swing = swing_in(folder, run, facts)
    if swing is None:
        return None
    reader = open_run_capture(folder, run, facts)
    parameters = ReductionConfig()
    ingest = Ingest(facts, parameters.outliers.threshold_sigma)
    pulse, stamp, raw = [], [], []
    size = 0
    for block in ingest.blocks(reader, parameters.block_records):
        kept, values = _usable(block, swing)
        pulse.append(block.pulse[kept])
        stamp.append(block.time_us[kept])
        raw.append(values[:, kept])
        size += pulse[-1].size
        if size >= MOST_SAMPLES:
            break
    numbers = np.concatenate(pulse)[:MOST_SAMPLES]
    if np.unique(numbers).size < 2:
        path = folder / run.capture.file
        raise BadInput.at(path, "", found="no usable data", expected="samples of the swing")
    time_us, values = np.concatenate(stamp)[:MOST_SAMPLES], np.concatenate(raw, axis=1)[:, :MOST_SAMPLES]
    time_s, whole = at_instants(numbers, time_us, values)
    return SwingRun(run, record, facts, swing, time_s, gyro_rates(facts, time_s, whole))


def _usable(block: Block, swing: Swing) -> tuple[NDArray[np.bool_], Array]:
    """Which records of a block lie within the swing and count; readings, NaN where a gyro's does not."""
    time_s = block.time_us / MICROSECONDS_PER_SECOND
    inside = swing.covers(time_s) & (time_s >= swing.change_s[_LEAD]) & ((block.flag & _UNUSABLE) == 0)
    return inside, np.where((block.gyro_flag & _UNUSABLE_GYRO) == 0, block.raw, np.nan)


def at_instants(pulse: NDArray[np.int64], time_us: NDArray[np.int64], values: Array) -> tuple[Array, Array]:
    """Samples at equal intervals, (N,) [s] and (n, N), NaN for a pulse without one.

    `pulse` (m,), their stamps `time_us` (m,) [us] and `values` (n, m) are those that are there.

    The instants are the straight line through the stamps against their pulses: stamps of whole microseconds
    are off by up to a half, which a wave of some deg/s shows.
    """
    place = pulse - pulse.min()
    centred = place - place.mean()
    mean = float(time_us.mean())
    step = float(centred @ (time_us - mean) / (centred @ centred))
    grid = np.arange(int(place.max()) + 1)
    whole = np.full((len(values), grid.size), np.nan)
    whole[:, place] = values
    return (mean + step * (grid - float(place.mean()))) / MICROSECONDS_PER_SECOND, whole


def gyro_rates(facts: RunFacts, time_s: Array, raw: Array) -> Array:
    """What gyros read of the table (n, N) [deg/s], from raw readings (n, N) at times (N,) [s].

    By the record, without Earth's part.
    """
    rate = (raw * facts.polarity[:, None] - facts.bias[:, None]) / facts.scale_factor[:, None]
    table = np.outer(facts.commanded_signs, facts.profile.rate_at(time_s))
    earth: Array = axis_rates(facts, time_s) - table
    found: Array = rate - facts.axes @ earth
    return found
