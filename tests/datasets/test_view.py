"""open_run: lazy, exact, and clear about folders that are no results."""

from __future__ import annotations

import h5py
import numpy as np
import pytest

import fogreduce
from fogreduce.errors import BadInput

LAZY = ("volts", "pulse", "flag", "gyro_flag", "gyro_rate", "axis_rate_with_earth", "axis_rate")


def test_everything_is_there_and_nothing_is_loaded(published) -> None:
    with fogreduce.open_run(published.reduced.out) as run:
        assert set(run.data_vars) == set(LAZY)
        assert {name: run.sizes[name] for name in run.sizes} == {"time": 768_000, "gyro": 4, "axis": 3}
        for name in LAZY:
            assert not run[name].variable._in_memory, name
        first = run.volts.isel(time=slice(0, 5)).values
        assert first.shape == (4, 5)
        assert not run.volts.variable._in_memory
        assert run.attrs["version_id"] == published.reduced.setup.version_id
        assert run.attrs["calibration"] == "TETRA-01@2012a"


def test_values_are_those_of_the_datasets(published) -> None:
    part = slice(1000, 20_000)
    with fogreduce.open_run(str(published.reduced.out)) as run:
        here = run.isel(time=part).load()
    for stage, name, ours in (
        ("calibrate", "gyro_rate", "gyro_rate"),
        ("project", "axis_rate", "axis_rate_with_earth"),
        ("remove_earth", "axis_rate", "axis_rate"),
        ("ingest", "flag", "flag"),
        ("ingest", "pulse", "pulse"),
    ):
        with h5py.File(published.reduced.dataset(stage)) as file:
            np.testing.assert_array_equal(here[ours].values, file[name][..., part])
    with h5py.File(published.reduced.dataset("ingest")) as file:
        counts = file["volts"][:, part]
    np.testing.assert_array_equal(here.volts.values, np.where(counts == -(2**31), np.nan, counts * 1e-7))
    assert np.isnan(here.volts.values).any()
    earth = (here.axis_rate_with_earth - here.axis_rate).values
    assert np.nanmax(np.abs(earth)) == pytest.approx(
        np.degrees(7.2921151467e-5) * np.cos(np.radians(23.2113)), rel=1e-2
    )


def test_times_are_exact_to_the_microsecond(published) -> None:
    """Record k at k / 128 s, rounded to the microsecond (contract, step 6), after 13:00 UTC."""
    with fogreduce.open_run(published.reduced.out) as run:
        times = run.time.values
    k = np.arange(768_000)
    expected = np.datetime64("2014-05-12T13:00:00", "us") + np.rint(k / 128 * 1e6).astype("timedelta64[us]")
    np.testing.assert_array_equal(times, expected)
    assert times[1] == np.datetime64("2014-05-12T13:00:00.007812", "us")


def test_selection_by_time_and_by_name(published) -> None:
    with fogreduce.open_run(published.reduced.out) as run:
        second = run.sel(time=slice("2014-05-12T13:00:10", "2014-05-12T13:00:10.999"), axis="x").axis_rate
        assert second.size == 128
        assert float(second.mean()) == pytest.approx(0.0619, abs=5 * 2.7e-4 / np.sqrt(128))
        assert run.axis_rate.attrs["units"] == "degree s-1"
        assert "flag_meanings" in run.flag.attrs


def test_a_unit_of_two_gyros_has_no_axes(bench) -> None:
    reduced = bench.reduce(bench.run(n=2, profile=[(3.0, 10.0)]))
    with fogreduce.open_run(reduced.out) as run:
        assert "axis_rate" not in run
        assert "axis" not in run.sizes
        assert run.gyro_rate.shape == (2, 640)


def test_a_stamp_that_no_calendar_holds(bench) -> None:
    """A corrupt stamp of 2^62 us is the year 148 000, one of 2^63 - 1 more than fits: its record's time is
    NaT."""

    def spoil(time_us, pulse, counts):
        time_us = time_us.copy()
        time_us[100], time_us[200] = 2**62, 2**63 - 1
        return time_us, pulse, counts

    reduced = bench.reduce(bench.run(profile=[(3.0, 10.0)], spoil=spoil))
    with fogreduce.open_run(reduced.out) as run:
        times, flags = run.time.values, run.flag.values
    assert flags[100] == flags[200] == 16
    assert np.isnat(times[200])
    assert times[100] == np.datetime64("2014-05-12T13:00:00", "us") + np.timedelta64(2**62, "us")
    assert times[101] == np.datetime64("2014-05-12T13:00:01.578125", "us")


@pytest.mark.parametrize("n", [2, 4])
def test_csv_volts_are_read_as_well(bench, n: int) -> None:
    reduced = bench.reduce(bench.run(n=n, profile=[(3.0, 10.0)], file_format="csv-1"))
    with fogreduce.open_run(reduced.out) as run:
        assert np.isfinite(run.volts.values).all()


def test_folders_that_are_no_results(bench, tmp_path) -> None:
    (tmp_path / "file").write_text("")
    (tmp_path / "empty").mkdir()
    for path, found in ((tmp_path / "none", "no such folder"), (tmp_path / "file", "a file")):
        with pytest.raises(BadInput, match=found):
            fogreduce.open_run(path)
    with pytest.raises(BadInput, match=r"ingest\.nc: found no such file"):
        fogreduce.open_run(tmp_path / "empty")


def test_results_that_are_not_whole(bench) -> None:
    run = bench.run(profile=[(3.0, 10.0)])
    reduced, other = bench.reduce(run), bench.reduce(run, {"edge_guard_s": 0.1})
    good = reduced.dataset("project").read_bytes()
    reduced.dataset("project").write_bytes(other.dataset("project").read_bytes())
    with pytest.raises(BadInput, match="version_id"):
        fogreduce.open_run(reduced.out)
    reduced.dataset("project").write_bytes(good[:1000])
    with pytest.raises(BadInput, match=r"project\.nc"):
        fogreduce.open_run(reduced.out)
    reduced.dataset("project").unlink()
    with pytest.raises(BadInput, match="no such file"):
        fogreduce.open_run(reduced.out)
    reduced.dataset("project").write_bytes(good)
    fogreduce.open_run(reduced.out).close()
