"""One run's capture, simulated and written: in the format that its run.yaml names, or as fogcap-1."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from pathlib import Path
from typing import TYPE_CHECKING

from fogreduce.datasets.atomic import whole_file
from fogreduce.datasets.readers import fogcap
from fogreduce.datasets.readers.csv1 import column_names
from fogreduce.metadata.facts import RunFacts
from fogreduce.physics.quantization import raw_from_counts
from fogreduce.simulate.forward import SimulatedBlock

if TYPE_CHECKING:
    from fogreduce.metadata.capture import CaptureInfo
    from fogreduce.metadata.run import Run

Blocks = Iterable[SimulatedBlock]

#: Names of logs that were columns of a capture.
TEMPERATURE_FILE, TABLE_FILE = "temperature.csv", "table.csv"


def write_fogcap(path: Path, facts: RunFacts, blocks: Blocks) -> None:
    """Write a ``fogcap-1`` capture; it appears under its name when it is whole."""
    step = facts.capture_least_count
    header = fogcap.Header(facts.n_gyros, facts.sample_rate_hz, step, facts.start_us, facts.unit)
    with fogcap.CaptureWriter(path, header) as writer:
        for block in blocks:
            writer.append(block.time_us, block.pulse, block.counts)


def write_csv(path: Path, facts: RunFacts, blocks: Blocks) -> None:
    """Write a ``csv-1`` capture: whole microseconds, readings with the digits that give the count back."""
    with whole_file(path) as temporary, temporary.open("w", encoding="utf-8", newline="\n") as file:
        file.write(",".join(column_names(facts.n_gyros, facts.captured_in)) + "\n")
        for block in blocks:
            values = raw_from_counts(block.counts, facts.capture_least_count)
            for time_us, row in zip(block.time_us.tolist(), values.T.tolist(), strict=True):
                fields = ("" if value != value else f"{value:.15g}" for value in row)
                file.write(f"{time_us // 1_000_000}.{time_us % 1_000_000:06d}," + ",".join(fields) + "\n")


#: Format -> writer. A laboratory that adds a reader and wants to simulate its format adds a writer here.
WRITERS: dict[str, Callable[[Path, RunFacts, Blocks], None]] = {"fogcap-1": write_fogcap, "csv-1": write_csv}

#: What run.yaml says of a capture, whatever its format.
_ANY_FORMAT = ("sample_rate_hz", "raw_unit", "volts_per_count", "least_count", "polarity")


def simulated(run: Run) -> Run:
    """A run as it is simulated: with a fogcap-1 capture where no writer is there for its own format.

    What only a reader of the own format needs (columns, times, text) is then left out of run.yaml, and logs
    that are columns of the capture are named as files.
    """
    info = run.capture
    if info.format in WRITERS:
        return _with_capture(run, info.model_copy(update={"time_zero": None})) if info.time_zero else run
    kept = {key: getattr(info, key) for key in _ANY_FORMAT}
    return _with_capture(run, type(info)(file="capture.fogcap", format=fogcap.FORMAT, **kept))


def _with_capture(run: Run, capture: CaptureInfo) -> Run:
    """A run with another capture; logs that were columns of its own are files."""
    given = run.capture.columns.model_dump(exclude_none=True) if run.capture.columns else {}
    changed: dict[str, object] = {"capture": capture}
    if run.temperature is None and {"sensor_temperature", "electronics_temperature"} & set(given):
        changed["temperature"] = TEMPERATURE_FILE
    if run.table_log is None and "table_angle" in given:
        changed["table_log"] = TABLE_FILE
    return run.model_copy(update=changed)


def write_capture(path: Path, format_name: str, facts: RunFacts, blocks: Blocks) -> None:
    """Write a capture in a format of `WRITERS`."""
    WRITERS[format_name](path, facts, blocks)
