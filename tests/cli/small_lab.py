"""A laboratory on disk small enough to be spoilt in sixty ways: one run of one minute at 16 Hz."""

import copy
import json
import struct
from contextlib import suppress
from pathlib import Path

import h5py
import numpy as np
from small_unit import RECORD, run_yaml

from fogreduce.metadata.yaml12 import dump_yaml

START_US = 1_399_899_600_000_000  # 2014-05-12T13:00:00Z
SAMPLE_RATE_HZ = 16.0
DURATION_S = 60.0
RECORDS = 960
VOLTS_PER_COUNT = 1e-7

RUN = run_yaml("r1", [(10.0, DURATION_S)], SAMPLE_RATE_HZ)


def header(
    *,
    magic=b"FOGCAP1\n",
    length=64,
    n=4,
    record=None,
    rate=16.0,
    volts=1e-7,
    start=START_US,
    unit=b"TETRA-01",
) -> bytes:
    """The 64 bytes at the head of a capture, laid out as the contract's table says."""
    record = 12 + 4 * n if record is None else record
    return struct.pack("<8sIHHddq24s", magic, length, n, record, rate, volts, start, unit)


def records(count: int = RECORDS, n: int = 4) -> np.ndarray:
    """`count` records: stamps at 16 Hz, pulses in order, counts that wander a little."""
    table = np.zeros(count, [("time", "<u8"), ("pulse", "<u4"), ("counts", "<i4", (n,))])
    table["pulse"] = np.arange(count)
    table["time"] = np.arange(count) * 62_500
    noise = np.random.default_rng(1).normal(0.0, 300.0, (count, n))
    table["counts"] = np.rint(50_000 * (1 + np.arange(n)) + noise)
    return table


def csv_lines(count: int = RECORDS) -> list[str]:
    """The same capture as csv-1."""
    lines = ["time_s,gyro1_V,gyro2_V,gyro3_V,gyro4_V"]
    for row in records(count):
        fields = [f"{row['time'] / 1e6:.6f}", *(f"{value * 1e-7:.7f}" for value in row["counts"])]
        lines.append(",".join(fields))
    return lines


class SmallLab:
    """Paths of the laboratory, and ways to write its files anew."""

    def __init__(self, root: Path) -> None:
        self.root = root
        self.calibrations = root / "calibrations"
        self.record = self.calibrations / "TETRA-01" / "2012a.yaml"
        self.campaign = root / "c1"
        self.run = self.campaign / "runs" / "r1"
        self.yaml = self.run / "run.yaml"
        self.capture = self.run / "capture.fogcap"
        self.out = root / "out"
        self.record.parent.mkdir(parents=True)
        self.run.mkdir(parents=True)
        self.write_record()
        self.write_run()
        self.write_capture()

    def write_run(self, changes: dict | None = None) -> None:
        """run.yaml with some keys changed, each a dotted path; the value None takes a key out."""
        self.yaml.write_text(dump_yaml(_changed(RUN, changes)))

    def write_record(self, changes: dict | None = None) -> None:
        """The calibration record, likewise."""
        self.record.write_text(dump_yaml(_changed(RECORD, changes)))

    def write_capture(self, head: bytes | None = None, body: bytes | None = None) -> None:
        """The capture from a header and records, good ones unless given."""
        head = header() if head is None else head
        self.capture.write_bytes(head + (records().tobytes() if body is None else body))

    def write_csv(self, lines: list[str]) -> Path:
        """A csv-1 capture in place of the other."""
        self.capture.unlink()
        path = self.run / "capture.csv"
        path.write_text("\n".join(lines) + "\n")
        self.write_run({"capture.file": "capture.csv", "capture.format": "csv-1"})
        return path

    def write_log(self, key: str, text: str) -> Path:
        """A log beside the capture, named in run.yaml under `key`."""
        path = self.run / f"{key}.csv"
        path.write_text(text)
        self.write_run({key: path.name})
        return path

    def reduce(self, *more: str) -> list[str]:
        """Arguments that reduce the run."""
        return [
            "reduce",
            str(self.run),
            "--calibrations",
            str(self.calibrations),
            "--out",
            str(self.out),
            *more,
        ]

    def versions(self) -> dict[str, str]:
        """Version ids of the manifest and of the dataset of ingest, as far as they are there."""
        manifest, dataset = self.out / "manifest.json", self.out / "datasets" / "ingest.nc"
        found = {}
        if manifest.is_file() and '"version_id"' in manifest.read_text():
            found["version"] = json.loads(manifest.read_text())["version_id"]
        if dataset.is_file():
            with suppress(OSError), h5py.File(dataset) as file:
                found["stale"] = file.attrs["version_id"]
        return found

    def manifest(self) -> list[str]:
        """Arguments that write the run's manifest."""
        return ["manifest", *self.reduce()[1:]]

    def stage(self, name: str, *, run: bool = False) -> list[str]:
        """Arguments that run one stage."""
        return ["stage", name, "--out", str(self.out), *(["--run", str(self.run)] if run else [])]


def _changed(data: dict, changes: dict | None) -> dict:
    data = copy.deepcopy(data)
    for path, value in (changes or {}).items():
        *parents, key = path.split(".")
        place = data
        for parent in parents:
            place = place[parent]
        if value is None:
            del place[key]
        else:
            place[key] = value
    return data
