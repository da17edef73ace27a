"""Layouts of the datasets: time to write, size, time to read whole and in part."""

from __future__ import annotations

import json
import statistics
import time
from pathlib import Path

import h5py
from measure import folder_mb, machine, parser, published_run, reduce, workplace

LAYOUTS = {
    "contiguous (default)": {"chunk_records": 0},
    "chunks of 65536": {"chunk_records": 65_536},
    "chunks of 4096": {"chunk_records": 4096},
    "chunks of 65536, gzip 1": {"chunk_records": 65_536, "compression": "gzip", "compression_level": 1},
    "chunks of 65536, gzip 4": {"chunk_records": 65_536, "compression": "gzip", "compression_level": 4},
}


def read_ms(path: Path, part: slice) -> float:
    """Time to read a part of the rates about x, y, z, the file opened anew [ms]."""
    began = time.perf_counter()
    with h5py.File(path) as file:
        file["axis_rate"][:, part].sum()
    return 1e3 * (time.perf_counter() - began)


def main() -> None:
    """A row a layout."""
    arguments = parser(__doc__ or "", 5).parse_args()
    with workplace(arguments) as work:
        print(machine())
        run_dir, out = published_run(work), work / "out"
        print(
            f"{'layout':<26}{'wall s':>8}{'cpu s':>8}{'peak MB':>9}{'size MB':>9}{'all ms':>8}{'60 s ms':>9}"
        )
        found: dict[str, list[tuple[float, ...]]] = {name: [] for name in LAYOUTS}
        for _ in range(arguments.repetitions):
            for name, layout in LAYOUTS.items():
                measured = reduce(run_dir, out, "--parameters", json.dumps({"storage": layout}))
                path = out / "datasets" / "remove_earth.nc"
                part = slice(384_000, 384_000 + 60 * 128)
                sizes = folder_mb(out / "datasets"), read_ms(path, slice(None)), read_ms(path, part)
                found[name].append((measured.wall_s, measured.cpu_s, measured.peak_mb, *sizes))
        for name, rows in found.items():
            wall, cpu, peak, size, whole, piece = (
                statistics.median(column) for column in zip(*rows, strict=True)
            )
            print(f"{name:<26}{wall:>8.2f}{cpu:>8.2f}{peak:>9.0f}{size:>9.1f}{whole:>8.1f}{piece:>9.2f}")


if __name__ == "__main__":
    main()
