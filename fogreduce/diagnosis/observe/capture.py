"""A run's capture, decoded beside its prediction: the reduction's own readers, judgement and flags."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from fogreduce.constants import MISSING_COUNT, SECONDS_PER_HOUR
from fogreduce.datasets.flags import GyroFlag, RecordFlag
from fogreduce.datasets.readers.contradictions import open_run_capture
from fogreduce.datasets.run_logs import table_log_of, temperatures_of
from fogreduce.diagnosis.observe.blocks import Blocks
from fogreduce.diagnosis.observe.predict import Scene
from fogreduce.diagnosis.observe.table_motion import table_motion
from fogreduce.effects.selection import Action
from fogreduce.estimate.outliers import dense
from fogreduce.metadata.assumed import Assumed
from fogreduce.metadata.calibration import CalibrationRecord
from fogreduce.metadata.config import OutliersConfig
from fogreduce.metadata.facts import RunFacts
from fogreduce.metadata.folder import runs_of_one_record
from fogreduce.metadata.part import Part
from fogreduce.metadata.run import Run
from fogreduce.stages.ingest import Ingest

Array = NDArray[np.float64]


#: Sample rate below which a log is slow: a few samples a dwell, no spectrum of noise alone.
SLOWEST_HZ = 2.0
_NEAR = 0.1  # of the largest reading predicted at any gyro
_SEVERAL, _NEAR_EDGE_S = 3, 10.0


@dataclass(frozen=True)
class Samples:
    """Every pulse of a run, at its place; what is not there is NaN.

    Attributes
    ----------
    residual : (n, N) array
        Measured less predicted [deg/h]; NaN where missing or spurious.
    counts : (n, N) array of int64
        As they arrived; `MISSING_COUNT` where there is none.
    spurious, missing : (n, N) arrays of bool
        Counts out of all proportion; answers that did not come though the record did.
    lost : int
        Records that never arrived.
    stamp_s : (N,) array
        Time stamps [s]; NaN where the record was lost.
    """

    residual: Array
    counts: NDArray[np.int64]
    spurious: NDArray[np.bool_]
    missing: NDArray[np.bool_]
    lost: int
    stamp_s: Array


@dataclass(frozen=True)
class RunInput:
    """One run's metadata, ready: model, record, numbers and scene.

    Where a part was given, the record is filled in from its data sheet, and `from_part` says with what.
    """

    run: Run
    record: CalibrationRecord
    facts: RunFacts
    scene: Scene
    folder: Path
    part: Part | None = None
    from_part: tuple[Assumed, ...] = ()


def read_inputs(
    campaign: Path,
    calibrations: Path,
    only: Sequence[str] = (),
    need_capture: bool = True,
    part: Part | None = None,
) -> list[RunInput]:
    """Metadata of a campaign's runs, checked; BadInput with every fault.

    All runs must be of one unit and one calibration record: a gap is a statement about one unit.
    """

    def ready(folder: Path, run: Run, record: CalibrationRecord) -> RunInput:
        assumed: list[Assumed] = []
        if part is not None:
            # captures say more of their white noise than a data sheet does
            record, assumed = part.filled(record, white_noise=not need_capture)
        facts = RunFacts.of_models(run, record)
        plain = run.model_dump(mode="json")
        log = temperatures_of(folder, plain, facts.start_us)
        angles = table_log_of(folder, plain, facts.start_us) if need_capture else None
        table = None if angles is None else table_motion(angles, facts.profile)
        blocks = Blocks.of(facts)
        if table is not None:
            blocks = Blocks.of(facts, blocks.holding(table.departure.time_s))
        return RunInput(run, record, facts, Scene(facts, log, blocks, table), folder, part, tuple(assumed))

    return runs_of_one_record(campaign, calibrations, only, ready, need_capture=need_capture)


def read_samples(one: RunInput, actions: Sequence[Action] = ()) -> Samples:
    """The capture of a run beside its prediction, every sample.

    Parameters
    ----------
    one : RunInput
    actions : sequence of Action
        Effects in the chain that predicts; no filters, which remember what came before.
    """
    facts = one.facts
    reader = open_run_capture(one.folder, one.run, facts)
    ingest = Ingest(facts, OutliersConfig().threshold_sigma)
    n, size = facts.n_gyros, facts.n_expected
    residual = np.full((n, size), np.nan)
    counts = np.full((n, size), MISSING_COUNT, np.int64)
    spurious, missing = np.zeros((n, size), bool), np.zeros((n, size), bool)
    stamp = np.full(size, np.nan)
    for block in ingest.blocks(reader, 65536):
        # pulses keep true time, whatever the stamps say: a wrong stamp is no reason to leave a sample out
        wanted = ((block.flag & RecordFlag.REPEATED) == 0) & (block.pulse >= 0) & (block.pulse < size)
        take = slice(None) if wanted.all() else wanted
        pulse = block.pulse[take]
        time_s = pulse / facts.sample_rate_hz
        measured = one.scene.rates(block.raw[:, take].copy())
        predicted = one.scene.decoded(time_s, actions)
        values = measured - predicted
        # a constant reading is a sample like others: what holds it is for the diagnosis to say
        flag = block.gyro_flag[:, take] & np.uint8(GyroFlag.MISSING | GyroFlag.SPURIOUS)
        if facts.sample_rate_hz < SLOWEST_HZ:
            flag = np.where(_as_predicted(values, predicted), flag & ~GyroFlag.SPURIOUS, flag)
        flag = np.where(_moved(values, predicted, flag, time_s, facts), flag & ~GyroFlag.SPURIOUS, flag)
        if facts.sample_rate_hz >= SLOWEST_HZ:
            _judge_many(values, block.raw[:, take], flag, facts)
        values[flag != 0] = np.nan
        at = _places(pulse)
        residual[:, at] = values
        if block.counts is not None:
            counts[:, at] = block.counts[:, take]
        else:
            whole = np.rint(np.nan_to_num(block.raw[:, take]) / ingest.least_count)
            counts[:, at] = np.where(flag & GyroFlag.MISSING, MISSING_COUNT, whole)
        spurious[:, at] = (flag & GyroFlag.SPURIOUS) != 0
        missing[:, at] = (flag & GyroFlag.MISSING) != 0
        stamp[at] = block.time_us[take] / 1e6 - ingest.set_back_s(block)[take]
    return Samples(residual, counts, spurious, missing, int(np.isnan(stamp).sum()), stamp)


def _judge_many(values: Array, raw: Array, flag: NDArray[np.uint8], facts: RunFacts) -> None:
    """Flags (n, N), in place, of gyros of which spurious counts are so many that the reduction's own search
    takes them for noise: judged by the departures (n, N) [deg/h], which no edge of a profile is in.
    """
    step = facts.least_count / np.abs(facts.scale_factor) * SECONDS_PER_HOUR
    for i, (row, flags) in enumerate(zip(values, flag, strict=True)):
        there = np.flatnonzero((flags & GyroFlag.MISSING) == 0)
        same = np.diff(raw[i, there]) == 0.0
        found = dense(row[there], same, OutliersConfig().threshold_sigma, float(step[i]))
        if found is not None:
            flags[there] = np.where(found, GyroFlag.SPURIOUS, 0)


def _places(pulse: NDArray[np.int64]) -> NDArray[np.int64] | slice:
    """Pulses as a slice where they follow one another."""
    if pulse.size and np.all(np.diff(pulse) == 1):
        return slice(int(pulse[0]), int(pulse[-1]) + 1)
    return pulse


def _as_predicted(departure: Array, predicted: Array) -> NDArray[np.bool_]:
    """Whether samples (n, N) of a slow log are near what the table's profile makes them.

    A dwell of a few samples looks like a burst of spurious counts to who does not know the profile.
    """
    largest = np.max(np.abs(predicted), initial=0.0)
    return np.asarray(np.abs(departure) <= _NEAR * largest)


def _moved(
    departure: Array, predicted: Array, flag: NDArray[np.uint8], time_s: Array, facts: RunFacts
) -> NDArray[np.bool_]:
    """Whether samples (N,) called spurious are the table's doing: near an edge of its profile, at several
    gyros at once, and no larger than a rate turned round.

    A table that starts a few samples late looks like a burst of spurious counts.
    """
    several: NDArray[np.bool_] = np.sum((flag & GyroFlag.SPURIOUS) != 0, axis=0) >= _SEVERAL
    if not several.any():
        return several
    edges = facts.profile.edges_s
    near = np.min(np.abs(time_s[:, None] - edges), axis=1) < _NEAR_EDGE_S
    largest = np.max(np.abs(predicted), initial=0.0)
    return several & near & np.all(np.abs(departure) <= 2.1 * largest, axis=0)


def block_residual(samples: Samples, blocks: Blocks, sample_rate_hz: float) -> tuple[Array, Array]:
    """Means of the residual over blocks (n, blocks) [deg/h], NaN where nothing is, and how many samples
    each.
    """
    n, size = samples.residual.shape
    index = blocks.of_samples(np.arange(size) / sample_rate_hz)
    there = np.isfinite(samples.residual)
    filled = np.where(there, samples.residual, 0.0)
    sums, sizes = np.empty((n, blocks.count)), np.empty((n, blocks.count))
    for i in range(n):
        sums[i] = np.bincount(index, filled[i], blocks.count + 1)[: blocks.count]
        sizes[i] = np.bincount(index, there[i], blocks.count + 1)[: blocks.count]
    means = np.full((n, blocks.count), np.nan)
    np.divide(sums, sizes, out=means, where=sizes > 0)
    return means, sizes
