"""The real recording, exported to each format: the same tables as from fogcap-1."""

from __future__ import annotations

import csv
import shutil

import h5py
import numpy as np
import pytest

from fogreduce.cli.main import main
from fogreduce.datasets.readers.fogcap import FogcapReader
from fogreduce.metadata.yaml12 import dump_yaml, load_yaml

NAMES = ["time_us", "a", "b", "c"]


def as_table(path, columns):
    lines = [
        ",".join(NAMES),
        *(",".join(map(repr, row)) for row in zip(*(c.tolist() for c in columns), strict=True)),
    ]
    path.write_text("\n".join(lines) + "\n")


def as_hdf5(path, columns):
    with h5py.File(path, "w") as file:
        for name, column in zip(NAMES, columns, strict=True):
            file[name] = column


def as_mat(path, columns):
    from scipy.io import savemat

    savemat(path, dict(zip(NAMES, columns, strict=True)))


def as_npz(path, columns):
    np.savez(path.with_suffix(".npz"), **dict(zip(NAMES, columns, strict=True)))
    path.with_suffix(".npz").rename(path)


def as_npy(path, columns):
    table = np.zeros(
        columns[0].size, [(name, column.dtype) for name, column in zip(NAMES, columns, strict=True)]
    )
    for name, column in zip(NAMES, columns, strict=True):
        table[name] = column
    with path.open("wb") as file:
        np.save(file, table)


def as_parquet(path, columns):
    import pyarrow
    import pyarrow.parquet

    pyarrow.parquet.write_table(pyarrow.table(dict(zip(NAMES, columns, strict=True))), path)


def as_tdms(path, columns):
    from nptdms import ChannelObject, TdmsWriter

    with TdmsWriter(path) as writer:
        writer.write_segment([ChannelObject("g", n, c) for n, c in zip(NAMES, columns, strict=True)])


WRITERS = {
    "table": as_table,
    "hdf5": as_hdf5,
    "mat": as_mat,
    "npz": as_npz,
    "npy": as_npy,
    "parquet": as_parquet,
    "tdms": as_tdms,
}
TABLES = ("gyro_fit", "rate_fit", "drift")


def tables_of(run, calibrations, out):
    assert main(["reduce", str(run), "--calibrations", str(calibrations), "--out", str(out)]) == 0
    found = {}
    for name in TABLES:
        with (out / "tables" / f"{name}.csv").open(newline="") as file:
            found[name] = [
                {k: v for k, v in row.items() if k != "version_id"} for row in csv.DictReader(file)
            ]
    return found


@pytest.fixture(scope="module")
def original(shared, tmp_path_factory):
    root = shared / "real"
    run = root / "campaigns" / "ln100" / "runs" / "x-up"
    return run, root / "calibrations", tables_of(run, root / "calibrations", tmp_path_factory.mktemp("real"))


@pytest.mark.parametrize("name", WRITERS)
def test_the_same_tables(original, name, tmp_path):
    """Counts times 1e-7 V as doubles: what arithmetic makes of that differs in the last digits."""
    source, calibrations, expected = original
    run = tmp_path / "ln100" / "runs" / "x-up"
    shutil.copytree(source, run)
    blocks = list(FogcapReader(run / "capture.fogcap").blocks(1 << 20))
    data = load_yaml(run / "run.yaml")
    volts = blocks[0].counts * data["capture"]["volts_per_count"]
    WRITERS[name](run / "log", [blocks[0].time_us, *volts])
    prefix = "g/" if name == "tdms" else ""
    data["capture"] |= {
        "file": "log",
        "format": name,
        "columns": {"time": prefix + "time_us", "gyros": [prefix + n for n in NAMES[1:]]},
        "time": {"unit": "us"},
    }
    (run / "run.yaml").write_text(dump_yaml(data))
    found = tables_of(run, calibrations, tmp_path / "out")
    for table in TABLES:
        assert len(found[table]) == len(expected[table])
        for ours, theirs in zip(found[table], expected[table], strict=True):
            for key, value in theirs.items():
                try:
                    assert float(ours[key]) == pytest.approx(float(value), rel=1e-6, abs=1e-12), (table, key)
                except ValueError:
                    assert ours[key] == value, (table, key)
