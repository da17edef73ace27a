"""A capture as text: `table` against `csv-1` in alternation, and a record ten times as long."""

from __future__ import annotations

import os
import shutil
import statistics
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from measure import Measured, long_run, machine, parser, published_run, reduce, spread, workplace

from fogreduce.metadata.yaml12 import dump_yaml, load_yaml

GYROS = [f"gyro{k}_V" for k in range(1, 5)]
FORMATS = {
    "csv-1": {"format": "csv-1"},
    "table": {"format": "table", "columns": {"time": "time_s", "gyros": GYROS}},
}


def write_text(source: Path, target: Path) -> None:
    """A run in each format of text, in a child process: a caller that stays small measures memory."""
    if target.exists():
        return
    process = os.fork()
    if process == 0:
        try:
            _write(source, target)
        finally:
            os._exit(0)
    os.waitpid(process, 0)


def _write(source: Path, target: Path) -> None:
    import numpy as np
    from pandas import DataFrame

    from fogreduce.datasets.readers.fogcap import FogcapReader

    reader = FogcapReader(source / "capture.fogcap")
    data = load_yaml(source / "run.yaml")
    first, *others = [target / name / "runs" / source.name for name in FORMATS]
    for folder in (first, *others):
        folder.mkdir(parents=True)
    with (first / "log.csv").open("w", newline="") as file:
        file.write(",".join(["time_s", *GYROS]) + "\n")
        for block in reader.blocks(65_536):
            assert block.counts is not None
            volts = [
                np.char.mod("%.7f", one * data["capture"]["volts_per_count"])
                for one in np.where(block.counts == -(2**31), 0, block.counts)
            ]
            stamps = np.char.mod("%.6f", block.time_us / 1e6)
            DataFrame(dict(zip(range(5), [stamps, *volts], strict=True))).to_csv(
                file, header=False, index=False
            )
    for folder in others:
        os.link(first / "log.csv", folder / "log.csv")
    for folder, keys in zip((first, *others), FORMATS.values(), strict=True):
        capture = {**data["capture"], "file": "log.csv", **keys}
        (folder / "run.yaml").write_text(dump_yaml({**data, "capture": capture}))


@contextmanager
def package(folder: Path | None) -> Iterator[None]:
    """Commands run the package of another folder meanwhile."""
    before = os.environ.get("PYTHONPATH")
    if folder is not None:
        os.environ["PYTHONPATH"] = str(folder)
    try:
        yield
    finally:
        if folder is not None:
            os.environ.pop("PYTHONPATH")
            if before is not None:
                os.environ["PYTHONPATH"] = before


def main() -> None:
    """Ratio of whole processes, pair by pair; then the memory of both lengths."""
    options = parser(__doc__ or "", 7)
    options.add_argument("--against", type=Path, help="folder of the source whose csv-1 is measured")
    options.add_argument("--no-long", action="store_true", help="without the record ten times as long")
    arguments = options.parse_args()
    with workplace(arguments) as work:
        print(machine())
        short = published_run(work)
        write_text(short, work / "text")
        pairs: list[tuple[Measured, Measured]] = []
        for _ in range(arguments.repetitions):
            with package(arguments.against):
                before = reduce(work / "text" / "csv-1" / "runs" / short.name, work / "out")
            pairs.append((before, reduce(work / "text" / "table" / "runs" / short.name, work / "out")))
        print("768,000 records of four gyros; csv-1, then table")
        for name in ("wall_s", "cpu_s", "peak_mb"):
            for k in (0, 1):
                print(f"  {name:<8} {spread([getattr(pair[k], name) for pair in pairs], 2)}")
        for name in ("wall_s", "cpu_s"):
            ratios = [getattr(table, name) / getattr(csv, name) for csv, table in pairs]
            print(f"  ratio of {name} {spread(ratios, 2)}")
        if arguments.no_long:
            return
        shutil.rmtree(work / "out", ignore_errors=True)
        long = long_run(work, 60_000)
        write_text(long, work / "text-long")
        measured = reduce(work / "text-long" / "table" / "runs" / long.name, work / "out")
        middle = statistics.median(table.peak_mb for _, table in pairs)
        print(
            f"ten times as long: {measured.peak_mb:.0f} MB, against {middle:.0f} MB; {measured.wall_s:.1f} s"
        )


if __name__ == "__main__":
    main()
