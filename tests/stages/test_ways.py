"""One run, two ways: stage by stage through files, and all in one pass. Tables are equal to the byte."""

from __future__ import annotations

import json
from pathlib import Path

import h5py
import numpy as np
import pytest

TABLES = ("gyro_fit", "rate_fit", "drift", "rates", "quality", "unstable", "encoder")
SEGMENTS = ((3.0, 40.0), (-6.0, 30.0), (0.0, 30.0))


def spoiled(time_us, pulse, counts):
    """Records lost, repeated and late; answers missing; spurious counts; a stamp that cannot be right."""
    generator = np.random.default_rng(3)
    counts = counts.copy()
    counts[0, generator.choice(pulse.size, 20, replace=False)] = -(2**31)
    counts[-1, generator.choice(pulse.size, 20, replace=False)] = 2**29
    order = np.delete(np.arange(pulse.size), [500, 501, 502, 3000])
    order = np.insert(order, 1000, [30, 501])
    time_us = time_us[order].copy()
    time_us[2000] += 10_000_000
    return time_us, pulse[order], counts[:, order]


def tables(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in sorted((folder / "tables").iterdir())}


def same_in_both_ways(bench, run: Path, parameters: dict | None = None) -> None:
    once, by_stages = bench.reduce(run, parameters), bench.reduce_by_stages(run, parameters)
    assert set(tables(once.out)) >= {f"{name}.csv" for name in TABLES}
    assert tables(once.out) == tables(by_stages.out)
    for report in ("ingest", "fit"):
        name = Path("reports") / f"{report}.json"
        assert (once.out / name).read_bytes() == (by_stages.out / name).read_bytes()
    for stage in ("ingest", "calibrate", "project", "remove_earth", "bins"):
        with h5py.File(once.dataset(stage)) as one, h5py.File(by_stages.dataset(stage)) as other:
            assert list(one) == list(other)
            for variable in one:
                np.testing.assert_array_equal(one[variable][()], other[variable][()], err_msg=variable)


@pytest.mark.parametrize("n", [1, 2, 3, 4, 6])
@pytest.mark.parametrize("file_format", ["fogcap-1", "csv-1"])
def test_any_number_of_gyros_and_either_format(bench, n: int, file_format: str) -> None:
    run = bench.run(n=n, profile=SEGMENTS, file_format=file_format, spoil=spoiled)
    same_in_both_ways(bench, run, {"block_records": 1000})


def test_alpha_from_the_encoder(bench) -> None:
    """A table that runs 1 % fast, as its encoder says; Earth's part follows the encoder, not the command."""
    run = bench.run(profile=[(3.0, 100.0)], encoder=lambda t: 17.0 + 3.03 * t, noise=False)
    parameters = {"alpha_source": "encoder"}
    same_in_both_ways(bench, run, parameters)
    by_encoder, by_command = bench.reduce(run, parameters), bench.reduce(run)
    with (
        h5py.File(by_encoder.dataset("remove_earth")) as one,
        h5py.File(by_command.dataset("remove_earth")) as other,
    ):
        apart = one["axis_rate"][:, -1] - other["axis_rate"][:, -1]
    earth = by_command.setup.facts.earth
    time_s = 100.0 - 1 / 64
    expected = earth.at(np.radians([3.0 * time_s])) - earth.at(np.radians([3.03 * time_s]))
    np.testing.assert_allclose(apart, expected[:, 0], atol=1e-12)
    row = by_encoder.row("encoder", "1")
    assert float(row["rate_deg_s"]) == pytest.approx(3.03, rel=1e-9)


def test_csv_equals_fogcap_in_its_result(bench) -> None:
    """The same counts, written as volts with 15 digits: all tables agree to 1e-9 (the text of a double's
    last digit)."""
    benches = [bench, type(bench)(bench.root / "other")]  # the noise goes by the run's name
    reduced = [
        one.reduce(one.run(file_format=name, profile=SEGMENTS, spoil=spoiled))
        for one, name in zip(benches, ("fogcap-1", "csv-1"), strict=True)
    ]
    for name in TABLES:
        one, other = (run.table(name) for run in reduced)
        assert len(one) == len(other)
        for row, same in zip(one, other, strict=True):
            assert list(row) == list(same)
            for column in set(row) - {"version_id"}:
                try:
                    expected = float(row[column])
                except ValueError:
                    assert same[column] == row[column]
                    continue
                # Numbers against the smallest that means anything in their column: an error's millionth.
                assert float(same[column]) == pytest.approx(expected, rel=1e-9, abs=1e-15), (name, column)


@pytest.mark.parametrize("profile", [[(3.0, 120.0)], SEGMENTS])
def test_the_size_of_blocks_does_not_matter(bench, profile) -> None:
    """To 1e-12 of each parameter or, where one is near zero, of 1e-9 of its error."""
    run = bench.run(profile=profile, spoil=spoiled)
    reference = bench.reduce(run, {"block_records": 65_536})
    for size in (512, 1000, 4096):
        other = bench.reduce(run, {"block_records": size})
        for name in ("quality", "drift"):
            one, two = reference.table(name), other.table(name)
            assert len(one) == len(two)
        assert [r["count"] for r in reference.table("quality")] == [
            r["count"] for r in other.table("quality")
        ]
        for mine, theirs in zip(
            reference.report("fit")["segments"], other.report("fit")["segments"], strict=True
        ):
            for channel, same in zip(mine["channels"], theirs["channels"], strict=True):
                error = np.sqrt(np.diag(channel["covariance"]))
                np.testing.assert_array_less(
                    np.abs(np.subtract(channel["theta"], same["theta"])),
                    1e-12 * np.abs(channel["theta"]) + 1e-9 * error + 1e-300,
                )
                assert same["sigma"] == pytest.approx(channel["sigma"], rel=1e-12)
                assert same["records"] == channel["records"]


def test_a_unit_of_one_or_two_gyros_says_what_is_left_out(bench) -> None:
    reduced = bench.reduce(bench.run(n=2))
    assert reduced.table("rate_fit") == []
    assert reduced.table("drift") == []
    assert [row["gyro"] for row in reduced.table("gyro_fit")] == ["gyro1", "gyro2"]
    with h5py.File(reduced.dataset("remove_earth")) as file:
        assert "axis_rate" not in file
        assert "one or two gyros" in file.attrs["left_out"]


def test_several_segments_have_rows_each_and_one_for_all(bench) -> None:
    reduced = bench.reduce(bench.run(profile=SEGMENTS))
    rows = [row for row in reduced.table("drift") if row["axis"] == "x"]
    assert [row["segment"] for row in rows] == ["1", "2", "3", "all"]
    assert float(rows[-1]["nominal_deg"]) == pytest.approx(3.0 * 40 - 6.0 * 30)
    errors = [float(row["accumulated_error_deg"]) for row in rows]
    assert errors[-1] == pytest.approx(sum(errors[:-1]))
    still = next(row for row in reduced.table("rate_fit") if row["segment"] == "3" and row["axis"] == "x")
    assert still["b_deg_s"] == still["c_rad_s"] == still["d_rad"] == ""


@pytest.mark.parametrize("profile", [[(3.0, 100.0)], SEGMENTS])
@pytest.mark.parametrize("n", [3, 4, 6])
def test_a_run_without_noise_reduces_to_its_command(bench, n: int, profile) -> None:
    """Only rounding is left: half a count of 1e-7 V is 6.7e-7 deg/s through C, at a steady rate in mean, too;
    through H, whose rows' sizes sum to 1.7 at most, 1.15e-6. No sample is off by more than that."""
    reduced = bench.reduce(bench.run(n=n, profile=profile, noise=False))
    signs = reduced.setup.facts.commanded_signs
    for row in reduced.table("rate_fit"):
        expected = signs["xyz".index(row["axis"])] * float(row["table_rate_deg_s"])
        assert float(row["a_deg_s"]) == pytest.approx(expected, abs=1.15e-6)
        assert float(row["sigma_deg_s"]) < 1.15e-6
    for row in reduced.table("drift"):
        assert float(row["final_angle_deg"]) == pytest.approx(float(row["nominal_deg"]), abs=1e-4)


@pytest.mark.parametrize("stamp", [2**62, 2**63 - 1, 0])
def test_a_wild_stamp_moves_no_result(bench, stamp: int) -> None:
    """Whatever a wrong stamp says (the year 148 000; t = 0), the tables are those of a stamp wrong by 10
    s: the record is left out, and its bin stays where it is."""

    def wild(time_us, pulse, counts, to=stamp):
        time_us = time_us.copy()
        time_us[3000] = to
        return time_us, pulse, counts

    def off(time_us, pulse, counts):
        return wild(time_us, pulse, counts, int(time_us[3000]) + 10_000_000)

    found = []
    for one, spoil in ((bench, wild), (type(bench)(bench.root / "other"), off)):
        reduced = one.reduce(one.run(spoil=spoil))
        counts = {row["what"]: int(row["count"]) for row in reduced.table("quality")}
        assert (counts["bad_stamp"], counts["lost"]) == (1, 1)
        rows = [row for name in ("gyro_fit", "rate_fit", "drift", "unstable") for row in reduced.table(name)]
        found.append([{key: value for key, value in row.items() if key != "version_id"} for row in rows])
    assert found[0] == found[1]


def test_an_edge_between_rates_is_no_instability(bench) -> None:
    """A bin that holds the edge (here 40.03 s) scatters by the step, thousands of times the noise."""
    run = bench.run(profile=[(3.0, 40.03), (-6.0, 30.0), (0.0, 30.0)])
    assert bench.reduce(run).table("unstable") == []


def test_what_was_flagged_is_what_was_spoiled(bench) -> None:
    reduced = bench.reduce(bench.run(spoil=spoiled))
    counts = {row["what"]: int(row["count"]) for row in reduced.table("quality")}
    assert counts["repeated"] == 1
    assert counts["out_of_order"] == 1
    assert counts["bad_stamp"] == 1
    assert counts["lost"] == 4  # 500, 502, 3000, and the pulse whose stamp is wrong
    assert counts["missing_gyro1"] == pytest.approx(20, abs=1)
    assert counts["spurious_gyro4"] == pytest.approx(20, abs=1)
    places = json.loads((reduced.out / "reports" / "ingest.json").read_text())["places"]
    assert places["bad_stamp"][0]["record"] == 2000
    assert places["bad_stamp"][0]["place"] == f"byte {64 + 28 * 2000}"


def test_a_torn_last_record_is_reported(bench) -> None:
    run = bench.run()
    path = run / "capture.fogcap"
    path.write_bytes(path.read_bytes()[:-10])
    report = bench.reduce(run).report("ingest")
    assert report["torn_bytes"] == 18
    assert report["lost"] == 1
    assert report["torn_at"] == f"byte {64 + 28 * report['records']}"
