"""One run's capture, simulated and written, in the format that its run.yaml names."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from pathlib import Path

from fogreduce.datasets.atomic import whole_file
from fogreduce.datasets.readers.fogcap import CaptureWriter, Header
from fogreduce.errors import BadInput
from fogreduce.metadata.facts import RunFacts
from fogreduce.physics.quantization import raw_from_counts
from fogreduce.simulate.forward import SimulatedBlock

Blocks = Iterable[SimulatedBlock]


def write_fogcap(path: Path, facts: RunFacts, blocks: Blocks) -> None:
    """Write a ``fogcap-1`` capture; it appears under its name when it is whole."""
    header = Header(facts.n_gyros, facts.sample_rate_hz, facts.least_count, facts.start_us, facts.unit)
    with CaptureWriter(path, header) as writer:
        for block in blocks:
            writer.append(block.time_us, block.pulse, block.counts)


def write_csv(path: Path, facts: RunFacts, blocks: Blocks) -> None:
    """Write a ``csv-1`` capture: whole microseconds, volts with the digits that give the count back."""
    with whole_file(path) as temporary, temporary.open("w", encoding="utf-8", newline="\n") as file:
        file.write(",".join(["time_s", *(f"gyro{i + 1}_V" for i in range(facts.n_gyros))]) + "\n")
        for block in blocks:
            volts = raw_from_counts(block.counts, facts.least_count)
            for time_us, row in zip(block.time_us.tolist(), volts.T.tolist(), strict=True):
                fields = ("" if volt != volt else f"{volt:.15g}" for volt in row)
                file.write(f"{time_us // 1_000_000}.{time_us % 1_000_000:06d}," + ",".join(fields) + "\n")


#: Format -> writer. A laboratory that adds a reader and wants to simulate its format adds a writer here.
WRITERS: dict[str, Callable[[Path, RunFacts, Blocks], None]] = {"fogcap-1": write_fogcap, "csv-1": write_csv}


def write_capture(path: Path, format_name: str, facts: RunFacts, blocks: Blocks) -> None:
    """Write a capture; BadInput for a format that cannot be written."""
    writer = WRITERS.get(format_name)
    if writer is None:
        raise BadInput.at(
            path.name, "capture.format", found=format_name, expected="one of " + ", ".join(WRITERS)
        )
    writer(path, facts, blocks)
