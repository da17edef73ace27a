"""A campaign simulated in every raw unit: captures from which the runs are reduced to the same rates."""

import csv
import math
from pathlib import Path

import pytest

from fogreduce.cli.main import main
from fogreduce.metadata.yaml12 import dump_yaml, load_yaml

#: Raw unit -> (suffix of keys, raw units in use per deg/s, rate by which increments are divided).
UNITS = {
    "V": ("V", 0.1, 1.0),
    "count": ("count", 1e6, 1.0),
    "deg/s": ("deg_s", 1.0, 1.0),
    "deg/h": ("deg_h", 3600.0, 1.0),
    "rad/s": ("rad_s", math.pi / 180, 1.0),
    "deg": ("deg_s", 1.0, 8.0),
    "rad": ("rad_s", math.pi / 180, 8.0),
}
LEAST_DEG_S = 1e-6
AXES = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]


def campaign(root: Path, name: str, capture: dict) -> Path:
    """One run of 200 s at 8 Hz of a unit of three gyros that reads in a raw unit."""
    suffix, per_deg_s, rate = UNITS[name]
    least = LEAST_DEG_S * per_deg_s / rate
    run = {
        "schema": "fogreduce/run/1",
        "run_id": "r1",
        "unit": "U",
        "started_at": "2024-05-12T13:00:00Z",
        "site": {"latitude_deg": 48.0},
        "table": {"axis": "z", "profile": [{"rate_deg_s": 2.0, "duration_s": 200.0}]},
        "orientation": {"z": "up", "x": "north"},
        "capture": {
            "sample_rate_hz": 8,
            "raw_unit": name,
            "volts_per_count" if name == "V" else "least_count": least,
            "polarity": [1, -1, 1],
            **capture,
        },
        "calibration": "U@1",
    }
    record = {
        "schema": "fogreduce/calibration/1",
        "unit": "U",
        "version": "1",
        "valid_from": "2020-01-01T00:00:00Z",
        "procedure": "by hand",
        "H": AXES,
        f"scale_factor_{suffix}_per_deg_s": [per_deg_s] * 3,
        f"bias_{suffix}": [0.01 * per_deg_s, 0.0, -0.02 * per_deg_s],
        "noise": {"angle_random_walk_deg_sqrt_h": [0.01] * 3},
    }
    for path, data in (("c1/runs/r1/run.yaml", run), ("calibrations/U/1.yaml", record)):
        (root / path).parent.mkdir(parents=True, exist_ok=True)
        (root / path).write_text(dump_yaml(data))
    return root / "c1"


def reduced(root: Path, name: str, capture: dict, *options: str) -> list[dict[str, str]]:
    """Rows of rate_fit.csv of the run, simulated and then reduced."""
    calibrations = ["--calibrations", str(root / "calibrations")]
    made = root / "made"
    plan = str(campaign(root, name, capture))
    assert main(["simulate", plan, *calibrations, "--out", str(made), *options]) == 0
    assert main(["check", str(made), *calibrations]) == 0
    assert main(["reduce", str(made / "runs" / "r1"), *calibrations, "--out", str(root / "out")]) == 0
    with (root / "out" / "tables" / "rate_fit.csv").open(encoding="utf-8") as file:
        return list(csv.DictReader(file))


FOGCAP = {"file": "capture.fogcap", "format": "fogcap-1"}
CSV = {"file": "capture.csv", "format": "csv-1"}
#: The unit's log in a format that no simulation writes.
COLUMNS = {"time": "t", "gyros": ["gx", "gy", "gz"]}
LOG = {"file": "log.h5", "format": "hdf5", "columns": COLUMNS, "time": {"unit": "ms"}, "time_zero": "first"}


@pytest.fixture(scope="module")
def in_volts(tmp_path_factory):
    return reduced(tmp_path_factory.mktemp("volts"), "V", FOGCAP, "--seed", "3")


@pytest.mark.parametrize("name", list(UNITS)[1:])
@pytest.mark.parametrize("capture", [FOGCAP, CSV, LOG], ids=["fogcap", "csv", "other"])
def test_the_same_motion_and_noise_in_every_unit(in_volts, tmp_path, name, capture):
    """One count stands for 1e-6 deg/s in all. Where a reading lies half-way between two counts, the last bits
    of the unit's factor decide: a count here and there differs, so a mean by far less than one."""
    for ours, theirs in zip(reduced(tmp_path, name, capture, "--seed", "3"), in_volts, strict=True):
        assert float(ours["a_deg_s"]) == pytest.approx(float(theirs["a_deg_s"]), abs=1e-2 * LEAST_DEG_S)
        assert float(ours["sigma_deg_s"]) == pytest.approx(float(theirs["sigma_deg_s"]), rel=1e-5)


@pytest.mark.parametrize("name", ["deg/s", "rad"])
def test_another_format_becomes_fogcap_in_the_simulated_run(tmp_path, name):
    reduced(tmp_path, name, LOG)
    made = tmp_path / "made" / "runs" / "r1"
    assert sorted(path.name for path in made.iterdir()) == ["capture.fogcap", "run.yaml"]
    folders = (tmp_path / "c1", tmp_path / "made")
    plan, run = (load_yaml(folder / "runs" / "r1" / "run.yaml") for folder in folders)
    kept = {
        key: value for key, value in plan["capture"].items() if key not in ("columns", "time", "time_zero")
    }
    assert run["capture"] == {**kept, "file": "capture.fogcap", "format": "fogcap-1"}
    assert {**run, "capture": None} == {**plan, "capture": None}


def test_the_noise_of_a_unit_in_deg_s_is_the_stated_one(in_volts):
    """0.01 deg/sqrt(h) is 0.01 / 60 sqrt(8) deg/s a sample; of 1600 samples known to 1.8 % (one sigma)."""
    sigma = [float(row["sigma_deg_s"]) for row in in_volts]
    assert sigma == pytest.approx([0.01 / 60 * math.sqrt(8)] * 3, rel=4 * 0.018)


def test_csv_names_the_unit_in_its_header(tmp_path):
    reduced(tmp_path, "deg", CSV)
    head = (tmp_path / "made" / "runs" / "r1" / "capture.csv").read_text().splitlines()[0]
    assert head == "time_s,gyro1_deg,gyro2_deg,gyro3_deg"


def test_a_csv_in_another_unit_than_run_yaml_says_is_refused(tmp_path, capsys):
    reduced(tmp_path, "deg", CSV)
    made = tmp_path / "made" / "runs" / "r1"
    text = (made / "capture.csv").read_text()
    (made / "capture.csv").write_text(text.replace("_deg", "_deg_s"))
    capsys.readouterr()
    arguments = [str(made), "--calibrations", str(tmp_path / "calibrations")]
    assert main(["reduce", *arguments, "--out", str(tmp_path / "again")]) == 2
    said = capsys.readouterr().err
    assert "raw unit deg/s; expected deg, as capture.raw_unit of run.yaml says" in said
    assert said.count("\n") == 1


def test_curves_in_volts_make_no_run_in_another_unit(tmp_path, capsys):
    plan = campaign(tmp_path, "deg/s", FOGCAP)
    numbers = {key: [0.0] * 3 for key in ("a_V", "b_V", "c_rad_s", "d_rad", "e_V_s", "sigma_V")}
    (plan / "curves.yaml").write_text(
        dump_yaml({"schema": "fogreduce/curves/1", **numbers, "missing_fraction": 0.0, "unstable": []})
    )
    (plan / "campaign.yaml").write_text(
        dump_yaml({"schema": "fogreduce/campaign/1", "captures_from": {"curves": "curves.yaml"}})
    )
    calibrations = ["--calibrations", str(tmp_path / "calibrations")]
    assert main(["simulate", str(plan), *calibrations, "--out", str(tmp_path / "made")]) == 2
    assert "capture.raw_unit: found deg/s; expected V, as curves.yaml" in capsys.readouterr().err
