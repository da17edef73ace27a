"""Datasets on disk: the same through xarray, h5py, netCDF4 and ncdump, in each layout; whole or not at
all."""

from __future__ import annotations

import os
import re
import resource
import shutil
import signal
import subprocess
import sys
import textwrap
from pathlib import Path

import h5py
import numpy as np
import pytest

from fogreduce.datasets.atomic import write_text
from fogreduce.datasets.store import DatasetWriter, Storage
from fogreduce.datasets.templates import RECORD_FLAG, Variable

MISSING = -(2**31)
UNITS = "microseconds since 2014-05-12 13:00:00.000000"

#: In parts of a second that nanoseconds or doubles could spoil, in stamps beyond an hour.
STAMPS = np.array([0, 1, 7812, 15_625, 999_999, 1_000_000, 5_999_992_187, 5_999_992_188], np.int64)
COUNTS = np.array(
    [[1, -1, MISSING, 2**31 - 1, 0, 7, 8, 9], [MISSING, 2, 3, 4, 5, 6, 7, -(2**31) + 1]], np.int32
)
RATES = np.array([[0.06, np.nan, -np.inf, 1e-300, 5e-324, -0.0, 1 / 3, np.pi]])
FLAGS = np.array([0, 1, 2, 3, 4, 16, 32, 0], np.uint8)

VARIABLES = [
    Variable("time", ("time",), "<i8", {"units": UNITS, "calendar": "proleptic_gregorian"}),
    Variable(
        "volts",
        ("gyro", "time"),
        "<i4",
        {"units": "V", "scale_factor": np.float64(1e-7), "_FillValue": np.int32(MISSING)},
    ),
    Variable("axis_rate", ("axis", "time"), "<f8", {"units": "degree s-1"}),
    RECORD_FLAG,
]

LAYOUTS = {
    "contiguous": Storage(),
    "chunked": Storage(3),
    "gzip": Storage(3, 1),
    "one chunk": Storage(1000, 9),
}


def write(path: Path, storage: Storage, block: int = 3) -> None:
    sizes = {"time": STAMPS.size, "gyro": 2, "axis": 1}
    labels = {"gyro": ["gyro1", "gyro2"], "axis": ["x"]}
    attributes = {"Conventions": "CF-1.11", "version_id": "abc", "sample_rate_hz": 128.0}
    with DatasetWriter(path, sizes, labels, VARIABLES, attributes, storage) as writer:
        for start in range(0, STAMPS.size, block):
            part = slice(start, start + block)
            writer.write("time", start, STAMPS[part])
            writer.write("volts", start, COUNTS[:, part])
            writer.write("axis_rate", start, RATES[:, part])
            writer.write("flag", start, FLAGS[part])


@pytest.fixture(params=list(LAYOUTS))
def dataset(request, tmp_path) -> Path:
    path = tmp_path / "dataset.nc"
    write(path, LAYOUTS[request.param])
    return path


def expected_volts() -> np.ndarray:
    return np.where(COUNTS == MISSING, np.nan, COUNTS * 1e-7)


def test_by_h5py(dataset: Path) -> None:
    with h5py.File(dataset) as file:
        np.testing.assert_array_equal(file["time"][...], STAMPS)
        np.testing.assert_array_equal(file["volts"][...], COUNTS)
        np.testing.assert_array_equal(file["axis_rate"][...].view(np.int64), RATES.view(np.int64))
        np.testing.assert_array_equal(file["flag"][...], FLAGS)
        assert [label.decode() for label in file["gyro"][...]] == ["gyro1", "gyro2"]
        assert file["volts"].attrs["_FillValue"] == MISSING
        assert file["volts"].dims[0][0].name == "/gyro"
        assert file["volts"].dims[1][0].name == "/time"
        assert file.attrs["version_id"] == "abc"


def test_by_xarray(dataset: Path) -> None:
    import xarray as xr

    with xr.open_dataset(dataset, engine="h5netcdf") as data:
        exact = np.datetime64("2014-05-12T13:00:00", "us") + STAMPS.astype("timedelta64[us]")
        np.testing.assert_array_equal(data.time.values, exact)
        np.testing.assert_array_equal(data.volts.values, expected_volts())
        np.testing.assert_array_equal(data.axis_rate.values, RATES)
        assert data.volts.dims == ("gyro", "time")
        assert data.gyro.values.tolist() == ["gyro1", "gyro2"]
        assert data.axis_rate.attrs["units"] == "degree s-1"
        assert "time" not in data.data_vars
        masks = dict(
            zip(data.flag.attrs["flag_meanings"].split(), data.flag.attrs["flag_masks"], strict=True)
        )
        assert {name: int(mask) for name, mask in masks.items()} == {
            "missing_gyro": 1,
            "spurious_gyro": 2,
            "repeated": 4,
            "out_of_order": 8,
            "bad_stamp": 16,
            "beyond_profile": 32,
            "constant_gyro": 64,
            "accelerating": 128,
        }
        assert data.attrs["sample_rate_hz"] == 128.0


def test_by_netcdf4(dataset: Path) -> None:
    """The C library itself, as ncdump and most other tools use it."""
    import netCDF4

    with netCDF4.Dataset(dataset) as data:
        assert data.data_model == "NETCDF4"
        assert {name: len(dim) for name, dim in data.dimensions.items()} == {"time": 8, "gyro": 2, "axis": 1}
        np.testing.assert_array_equal(data["time"][:], STAMPS)
        volts = data["volts"][:]
        np.testing.assert_array_equal(np.ma.getmaskarray(volts), COUNTS == MISSING)
        np.testing.assert_array_equal(volts.filled(np.nan), expected_volts())
        np.testing.assert_array_equal(np.ma.getdata(data["axis_rate"][:]), RATES)
        assert data["gyro"][:].tolist() == ["gyro1", "gyro2"]
        assert data["flag"].getncattr("flag_meanings").startswith("missing_gyro ")
        assert data["volts"].dimensions == ("gyro", "time")


def test_by_ncdump(dataset: Path) -> None:
    if shutil.which("ncdump") is None:
        pytest.skip("ncdump (Debian: netcdf-bin) is not installed; test_by_netcdf4 uses the same library")
    text = subprocess.run(
        ["ncdump", "-p", "9,17", dataset], capture_output=True, text=True, check=True
    ).stdout
    assert "netcdf dataset {" in text
    assert re.search(r"time = 8 ;", text)
    assert "int volts(gyro, time) ;" in text
    assert "volts:_FillValue = -2147483648 ;" in text
    assert f'time:units = "{UNITS}" ;' in text
    assert '"gyro1", "gyro2" ;' in text
    data = text[text.index("data:") :]
    (times,) = re.findall(r"\n time = ([^;]*);", data)
    assert [int(word.rstrip("L")) for word in times.replace(",", " ").split()] == STAMPS.tolist()
    (volts,) = re.findall(r"\n volts =([^;]*);", data)
    found = [MISSING if word == "_" else int(word) for word in volts.replace(",", " ").split()]
    assert found == COUNTS.ravel().tolist()
    (rates,) = re.findall(r"\n axis_rate =([^;]*);", data)
    words = [word.strip().lower() for word in rates.split(",")]
    np.testing.assert_array_equal([float(word.replace("_", "nan")) for word in words], RATES[0])


def test_layouts_are_what_was_asked_for(tmp_path) -> None:
    for name, storage in LAYOUTS.items():
        write(tmp_path / f"{name}.nc", storage)
        with h5py.File(tmp_path / f"{name}.nc") as file:
            volts = file["volts"]
            assert (volts.chunks is None) == (storage.chunk_records == 0)
            assert volts.compression == ("gzip" if storage.gzip_level else None)


def test_the_same_dataset_is_the_same_bytes(tmp_path) -> None:
    """No time of day within; and whatever the blocks, where chunks do not ask for them."""
    write(tmp_path / "a.nc", Storage())
    write(tmp_path / "b.nc", Storage(), block=5)
    assert (tmp_path / "a.nc").read_bytes() == (tmp_path / "b.nc").read_bytes()


@pytest.mark.parametrize("layout", ["contiguous", "chunked", "gzip"])
def test_a_runs_results_are_the_same_in_every_layout(bench, layout: str) -> None:
    """Through the whole product, as the configuration asks for it."""
    storage = LAYOUTS[layout]
    asked = {"chunk_records": storage.chunk_records and 500}
    if storage.gzip_level:
        asked |= {"compression": "gzip", "compression_level": storage.gzip_level}
    run = bench.run(profile=[(3.0, 20.0)])
    reduced, plain = bench.reduce(run, {"storage": asked}), bench.reduce(run)
    for stage in ("ingest", "calibrate", "project", "remove_earth", "bins"):
        with h5py.File(reduced.dataset(stage)) as one, h5py.File(plain.dataset(stage)) as other:
            assert (one["time"].chunks is None) == (layout == "contiguous")
            for name in other:
                np.testing.assert_array_equal(one[name][()], other[name][()])


# ----------------------------------------------------------------------------- whole or not at all


@pytest.mark.parametrize("layout", ["contiguous", "gzip"])
def test_an_error_in_the_middle_leaves_nothing(tmp_path, layout: str) -> None:
    path = tmp_path / "dataset.nc"
    sizes = {"time": 1000}
    variables = [Variable("time", ("time",), "<i8", {"units": UNITS})]
    storage = LAYOUTS[layout]
    with pytest.raises(RuntimeError), DatasetWriter(path, sizes, {}, variables, {}, storage) as writer:  # noqa: PT012
        writer.write("time", 0, np.arange(500))
        raise RuntimeError
    assert list(tmp_path.iterdir()) == []


def test_an_error_leaves_what_was_there_before(tmp_path) -> None:
    path = tmp_path / "dataset.nc"
    write(path, Storage())
    before = path.read_bytes()
    variables = [Variable("time", ("time",), "<i8", {"units": UNITS})]
    with pytest.raises(RuntimeError), DatasetWriter(path, {"time": 10}, {}, variables, {}, Storage()):
        raise RuntimeError
    assert path.read_bytes() == before
    assert list(tmp_path.iterdir()) == [path]


def child(code: str, **limits) -> subprocess.CompletedProcess:
    return subprocess.run(
        [sys.executable, "-c", textwrap.dedent(code)], capture_output=True, text=True, **limits
    )


@pytest.mark.parametrize("storage", ["Storage()", "Storage(1000)", "Storage(1000, 1)"])
def test_a_process_killed_in_the_middle_leaves_no_dataset(tmp_path, storage: str) -> None:
    """What it leaves is its temporary file, whose name starts with a dot and ends in .tmp."""
    path = tmp_path / "dataset.nc"
    answer = child(
        f"""
        import os, signal
        from pathlib import Path
        import numpy as np
        from fogreduce.datasets.store import DatasetWriter, Storage
        from fogreduce.datasets.templates import Variable
        variables = [Variable("time", ("time",), "<i8", {{}})]
        path, sizes = Path({str(path)!r}), {{"time": 100_000}}
        with DatasetWriter(path, sizes, {{}}, variables, {{}}, {storage}) as writer:
            writer.write("time", 0, np.arange(50_000))
            os.kill(os.getpid(), signal.SIGKILL)
        """
    )
    assert answer.returncode == -signal.SIGKILL
    assert not path.exists()
    assert all(left.name.startswith(".") and left.suffix == ".tmp" for left in tmp_path.iterdir())


def small_files() -> None:
    """No file beyond 200 kB: a write further fails with EFBIG, as one on a full disk with ENOSPC."""
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (200_000, 200_000))


@pytest.mark.parametrize(
    "storage", ["{}", '{"chunk_records": 500}', '{"chunk_records": 500, "compression": "gzip"}']
)
def test_a_disk_that_is_full_leaves_no_dataset(bench, storage: str) -> None:
    """The command says so in one line, without a traceback, and the datasets that did not fit do not
    appear."""
    run = bench.run(profile=[(3.0, 200.0)])
    out = bench.root / "out"
    code = "from fogreduce.cli.main import console; console()"
    words = [sys.executable, "-c", code, "reduce", run, "--out", out, "--calibrations", bench.calibrations]
    words += ["--parameters", f'{{"storage": {storage}}}']
    answer = subprocess.run(words, capture_output=True, text=True, preexec_fn=small_files)
    assert answer.returncode in (1, 2)
    assert "Traceback" not in answer.stderr
    assert len(answer.stderr.strip().splitlines()) == 1
    assert ".nc" in answer.stderr
    assert not list(out.rglob("*.nc"))
    assert not list(out.rglob("*.tmp"))
    assert not (out / "tables" / "drift.csv").exists()


def test_a_full_device(tmp_path) -> None:
    """/dev/full answers every write with ENOSPC."""
    if not Path("/dev/full").exists():
        pytest.skip("no /dev/full on this system")
    target = tmp_path / "table.csv"
    target.write_text("before")
    temporary = tmp_path / f".table.csv.{os.getpid()}.tmp"
    temporary.symlink_to("/dev/full")
    with pytest.raises(OSError, match="No space left"):
        write_text(target, "x" * 100_000)
    assert target.read_text() == "before"
    assert list(tmp_path.iterdir()) == [target]
