"""The same motion captured in every raw unit: the same rates, tables that name the unit; mistakes refused."""

import csv
import math

import h5py
import numpy as np
import pytest

from fogreduce.cli.main import main
from tests.cli.small_lab import RECORDS, SAMPLE_RATE_HZ, SmallLab, header, records

#: Raw unit -> (suffix of its columns, raw units in use per deg/s, how many of them an increment of one is).
UNITS = {
    "V": ("V", 0.1, 1.0),
    "count": ("count", 2.5e4, 1.0),
    "deg/s": ("deg_s", 1.0, 1.0),
    "deg/h": ("deg_h", 3600.0, 1.0),
    "rad/s": ("rad_s", math.pi / 180, 1.0),
    "deg": ("deg_s", 1.0, SAMPLE_RATE_HZ),
    "rad": ("rad_s", math.pi / 180, SAMPLE_RATE_HZ),
}
LEAST_DEG_S = 4e-5  # what one count of the capture stands for, whatever the unit
STAGES = ("ingest", "calibrate", "project", "remove_earth", "fit", "drift")


def in_unit(lab: SmallLab, name: str) -> SmallLab:
    """The laboratory's counts, so its motion, as a unit puts them out that reads in a raw unit."""
    suffix, per_deg_s, rate = UNITS[name]
    least = 1.0 if name == "count" else LEAST_DEG_S * per_deg_s / rate
    step = {"capture.volts_per_count": least if name == "V" else None}
    if name not in ("V", "count"):  # that of counts is 1 by default
        step["capture.least_count"] = least
    lab.write_run({"capture.raw_unit": name, **step})
    keys = {} if name == "V" else {"scale_factor_V_per_deg_s": None, "bias_V": None}
    keys[f"scale_factor_{suffix}_per_deg_s"] = [per_deg_s] * 4
    keys[f"bias_{suffix}"] = [0.01 * k * per_deg_s for k in range(4)]
    lab.write_record({**keys, "uncertainty": {f"bias_{suffix}": [1e-4 * per_deg_s] * 4}})
    lab.write_capture(header(volts=least))
    return lab


def rows(lab: SmallLab, name: str) -> list[dict[str, str]]:
    with (lab.out / "tables" / f"{name}.csv").open(encoding="utf-8") as file:
        return list(csv.DictReader(file))


@pytest.fixture(scope="module")
def in_volts(tmp_path_factory):
    lab = in_unit(SmallLab(tmp_path_factory.mktemp("volts")), "V")
    assert main(lab.reduce()) == 0
    return lab


@pytest.mark.parametrize("name", list(UNITS)[1:])
def test_the_same_motion_gives_the_same_rates(in_volts, small_lab, name):
    lab = in_unit(small_lab, name)
    assert main(lab.reduce()) == 0
    for table in ("rate_fit", "drift"):
        for ours, theirs in zip(rows(lab, table), rows(in_volts, table), strict=True):
            for column in set(ours) - {"version_id", "undetermined"}:
                if column in ("axis", "segment"):
                    assert ours[column] == theirs[column]
                else:
                    # one count is exact in all; scale factors and rounding of doubles are good to 1e-12
                    assert float(ours[column] or 0) == pytest.approx(
                        float(theirs[column] or 0), rel=1e-9, abs=1e-13
                    ), (table, column)


@pytest.mark.parametrize("name", list(UNITS))
def test_fits_of_gyros_stand_in_the_unit_in_use(in_volts, small_lab, name):
    suffix, per_deg_s, _ = UNITS[name]
    lab = in_unit(small_lab, name)
    assert main(lab.reduce()) == 0
    slope = {"V": "V_s", "count": "count_s", "deg_s": "deg_s2", "deg_h": "deg_h_s", "rad_s": "rad_s2"}[suffix]
    stem = f"gyro,a_{suffix},a_err_{suffix},b_{suffix},b_err_{suffix},c_rad_s,d_rad,d_err_rad"
    head = (lab.out / "tables" / "gyro_fit.csv").read_text().splitlines()[0]
    assert head.startswith(f"{stem},e_{slope},e_err_{slope},sigma_{suffix},records,a_err_coloured_{suffix},")
    for ours, theirs in zip(rows(lab, "gyro_fit"), rows(in_volts, "gyro_fit"), strict=True):
        for column in ("a", "a_err", "b", "sigma", "a_err_coloured"):
            expected = float(theirs[f"{column}_V"]) / UNITS["V"][1] * per_deg_s
            assert float(ours[f"{column}_{suffix}"]) == pytest.approx(expected, rel=1e-9)
        expected = float(theirs["e_V_s"]) / UNITS["V"][1] * per_deg_s
        assert float(ours[f"e_{slope}"]) == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("name", ["deg/h", "rad"])
def test_stage_by_stage_is_the_same_to_the_byte(small_lab, name):
    lab = in_unit(small_lab, name)
    assert main(lab.reduce()) == 0
    once = {path.name: path.read_bytes() for path in (lab.out / "tables").iterdir()}
    lab.out = lab.root / "by-stages"
    assert main(lab.manifest()) == 0
    for stage in STAGES:
        assert main(lab.stage(stage, run=stage == "ingest")) == 0
    assert {path.name: path.read_bytes() for path in (lab.out / "tables").iterdir()} == once


@pytest.mark.parametrize(
    ("name", "variable", "units", "packed"),
    [
        ("V", "volts", "V", True),
        ("count", "raw", "1", True),
        ("deg/s", "raw", "degree s-1", True),
        ("rad", "raw", "radian s-1", False),
    ],
)
def test_datasets_name_the_unit(small_lab, name, variable, units, packed):
    lab = in_unit(small_lab, name)
    assert main(lab.reduce()) == 0
    with h5py.File(lab.out / "datasets" / "ingest.nc") as file:
        assert file[variable].attrs["units"] == units
        assert (file[variable].dtype == np.int32) == packed
    with h5py.File(lab.out / "datasets" / "bins.nc") as file:
        assert file[f"{variable}_mean"].attrs["units"] == units
    from fogreduce.datasets.view import open_run

    with open_run(lab.out) as run:
        _, per_deg_s, _ = UNITS[name]
        rates = (run[variable].values / per_deg_s) * np.array([1, -1, 1, 1])[:, None]
        biases = 0.01 * np.arange(4)[:, None]
        np.testing.assert_allclose(rates - biases, run.gyro_rate.values, rtol=0, atol=1e-12)


def test_the_curve_in_the_unit_in_use(small_lab, capsys):
    lab = in_unit(small_lab, "deg")
    assert main(lab.reduce()) == 0
    capsys.readouterr()
    assert main(["curve", str(lab.out), "--channel", "gyro2"]) == 0
    said = capsys.readouterr().out
    assert "a_deg_s " in said
    assert "e_deg_s2 " in said
    assert "_V" not in said
    assert main(["curve", str(lab.out), "--channel", "x"]) == 0


def test_runs_in_different_units_are_gathered(tmp_path):
    labs = [in_unit(SmallLab(tmp_path / name.replace("/", "_")), name) for name in ("V", "deg/s", "count")]
    for k, lab in enumerate(labs):
        lab.out = tmp_path / "results" / f"c{k + 2}" / "r1"  # (each lab has a record of the same id)
        assert main(lab.reduce()) == 0
    outs = [str(lab.out) for lab in labs]
    assert main(["summary", *outs, "--out", str(tmp_path / "summary")]) == 0
    gathered = (tmp_path / "summary" / "rates_all.csv").read_text().splitlines()
    assert len(gathered) == 1 + 3 * 3


def faults_of(lab: SmallLab, capsys, arguments: list[str]) -> list[str]:
    capsys.readouterr()
    assert main(arguments) == 2
    said = capsys.readouterr().err
    assert "Traceback" not in said
    return said.strip().splitlines()


def test_a_record_in_another_unit_is_one_line(small_lab, capsys):
    in_unit(small_lab, "deg/s")
    small_lab.write_record()  # in volts
    for arguments in (
        small_lab.reduce(),
        ["check", str(small_lab.run), "--calibrations", str(small_lab.calibrations)],
    ):
        (line, *_) = faults_of(small_lab, capsys, arguments)
        assert "capture.raw_unit: found deg/s; expected V, as TETRA-01@2012a is in V" in line
    assert not small_lab.out.exists()


def test_volts_per_count_of_another_unit_is_one_line(small_lab, capsys):
    in_unit(small_lab, "deg/s")
    small_lab.write_run({"capture.raw_unit": "deg/s"})  # volts_per_count is still there
    lines = faults_of(small_lab, capsys, small_lab.reduce())
    assert len(lines) == 1
    assert "capture.volts_per_count: found 1e-07; expected least_count in its place" in lines[0]


def test_a_header_of_another_least_count_is_refused(small_lab, capsys):
    in_unit(small_lab, "deg/s")
    small_lab.write_capture(header(volts=1e-7))
    lines = faults_of(small_lab, capsys, small_lab.reduce())
    assert len(lines) == 1
    assert "least count 1e-07; expected 4e-05, as capture.least_count of run.yaml says" in lines[0]


def test_increments_go_by_the_interval_that_the_stamps_show(small_lab):
    """The stamps show 16.16 Hz where run.yaml says 16: increments are over 1/16.16 s."""
    lab = in_unit(small_lab, "rad")
    body = records()
    body["time"] = np.rint(np.arange(RECORDS) / 16.16 * 1e6)
    least = LEAST_DEG_S * math.pi / 180 / SAMPLE_RATE_HZ
    lab.write_capture(header(volts=least), body.tobytes())
    assert main(lab.reduce()) == 0
    with h5py.File(lab.out / "datasets" / "ingest.nc") as file:
        # stamps of whole microseconds, half a minute apart: to 1e-7
        np.testing.assert_allclose(file["raw"][()], body["counts"].T * least * 16.16, rtol=1e-7)
