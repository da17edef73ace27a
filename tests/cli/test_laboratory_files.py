"""A logger's file becomes a run: `init`, `check`, `reduce`; the rates are those of the same data in fogcap-1.

Nothing is edited between but what nobody can read off a file: latitude, orientation and the table's profile.
"""

import json

import h5py
import numpy as np
import pytest
from laboratory_files import (
    CASES,
    DURATION_S,
    LATITUDE_DEG,
    LEAST_DEG_S,
    RATE_HZ,
    START,
    TURN_DEG_S,
    UNIX_S,
    recording,
)

from fogreduce.cli.main import main
from fogreduce.datasets.readers.fogcap import CaptureWriter, Header
from fogreduce.metadata.yaml12 import dump_yaml, load_yaml

SETTINGS = {
    "site": {"latitude_deg": LATITUDE_DEG},
    "orientation": {"x": "up", "z": "north"},
    "table": {"axis": "x", "profile": [{"rate_deg_s": TURN_DEG_S, "duration_s": DURATION_S}]},
}


def reduced(run, calibrations, out):
    """Time stamps [us] and gyros' rates [deg/s] of a run, checked and reduced."""
    assert main(["check", str(run), "--calibrations", str(calibrations)]) == 0
    assert main(["reduce", str(run), "--calibrations", str(calibrations), "--out", str(out)]) == 0
    with h5py.File(out / "datasets" / "calibrate.nc") as file:
        assert not file["flag"][:].any()
        return file["time"][:], file["gyro_rate"][:]


@pytest.fixture(scope="module")
def as_fogcap(tmp_path_factory):
    """The recording as fogcap-1, reduced with an ideal digital unit's record."""
    root = tmp_path_factory.mktemp("fogcap")
    run = root / "campaigns" / "bench" / "runs" / "r1"
    run.mkdir(parents=True)
    data = recording()
    with CaptureWriter(run / "r1.fogcap", Header(3, RATE_HZ, LEAST_DEG_S, UNIX_S * 10**6, "FOG")) as capture:
        capture.append(data.time_us, np.arange(data.time_us.size), data.steps.astype(np.int32))
    document = {
        "schema": "fogreduce/run/1",
        "run_id": "r1",
        "unit": "FOG",
        "started_at": START,
        "capture": {
            "file": "r1.fogcap",
            "format": "fogcap-1",
            "sample_rate_hz": RATE_HZ,
            "raw_unit": "deg/s",
            "least_count": LEAST_DEG_S,
            "polarity": [1, 1, 1],
        },
        "calibration": "FOG@ideal",
        **SETTINGS,
    }
    (run / "run.yaml").write_text(dump_yaml(document))
    record = {
        "schema": "fogreduce/calibration/1",
        "unit": "FOG",
        "version": "ideal",
        "valid_from": "2000-01-01T00:00:00Z",
        "procedure": "none",
        "H": np.eye(3).tolist(),
        "scale_factor_deg_s_per_deg_s": [1.0] * 3,
        "bias_deg_s": [0.0] * 3,
    }
    folder = root / "calibrations" / "FOG"
    folder.mkdir(parents=True)
    (folder / "ideal.yaml").write_text(dump_yaml(record))
    return reduced(run, folder.parent, root / "out")


def begun(files, campaign, options=()):
    """What `init` makes of files: the runs' folders and that of the calibration records."""
    assert main(["init", *map(str, files), "--out", str(campaign), *options]) == 0
    runs = sorted(path.parent for path in campaign.rglob("run.yaml"))
    places = {
        path.parents[1]
        for path in campaign.parent.parent.rglob("*.yaml")
        if "calibration/1" in path.read_text()
    }
    assert len(places) == 1
    return runs, places.pop()


def fill_in(run, **more):
    """The edit that is left to the user."""
    path = run / "run.yaml"
    path.write_text(dump_yaml({**load_yaml(path), **SETTINGS, **more}))


@pytest.mark.parametrize("case", CASES, ids=str)
def test_the_rates_are_those_of_fogcap(case, as_fogcap, tmp_path, capsys):
    source = tmp_path / "logger"
    source.mkdir()
    file = case.write(source, recording())
    said = file.read_bytes()
    runs, calibrations = begun([file], tmp_path / "lab" / "campaigns" / "bench", case.options)
    assert len(runs) == 1
    assert file.read_bytes() == said
    # What nobody told: asked for, in one place, and named by `check`.
    assert main(["check", str(runs[0]), "--calibrations", str(calibrations)]) == 2
    asked = capsys.readouterr().err
    for key in ("latitude_deg", "orientation", "profile"):
        assert key in asked
    fill_in(runs[0])
    document = load_yaml(runs[0] / "run.yaml")
    assert document["capture"]["format"] == case.format
    assert document["capture"].get("raw_unit", "V") == case.raw_unit
    if case.started_at:
        assert document["started_at"] == case.started_at
    time_us, rates = reduced(runs[0], calibrations, tmp_path / "out")
    expected_us, expected = as_fogcap
    np.testing.assert_array_equal(time_us - time_us[0], expected_us)
    if case.raw_unit == "count":
        rates = rates * LEAST_DEG_S  # an ideal unit's count is a deg/s until a calibration says otherwise
    np.testing.assert_allclose(rates, expected, rtol=1e-12, atol=1.0001 * case.half_digit_deg_s)
    report = json.loads((tmp_path / "out" / "reports" / "ingest.json").read_text())
    assert report["records"] == report["expected"] == expected_us.size


def test_a_folder_becomes_a_campaign(tmp_path):
    """A run for each file, in one campaign with one record; a second call changes nothing."""
    source = tmp_path / "logger"
    source.mkdir()
    for seed, name in enumerate(("down 1", "up 1")):
        CASES[0].write(source, recording(seed)).rename(source / f"{name}.csv")
    campaign = tmp_path / "lab" / "campaigns" / "bench"
    runs, calibrations = begun([source], campaign)
    assert [run.name for run in runs] == ["down-1", "up-1"]
    for run in runs:
        fill_in(run)
    assert main(["check", str(campaign), "--calibrations", str(calibrations)]) == 0
    files = {path: path.read_bytes() for path in campaign.rglob("*") if path.is_file()}
    assert main(["init", str(source), "--out", str(campaign)]) == 2
    assert {path: path.read_bytes() for path in campaign.rglob("*") if path.is_file()} == files


def test_with_all_that_is_known_nothing_is_left_to_fill_in(tmp_path, capsys):
    file = CASES[0].write(tmp_path, recording())
    stated = ["--latitude", "48", "--orientation", "x=up,z=north", "--axis", "x", "--profile", "3:40"]
    runs, calibrations = begun([file], tmp_path / "lab" / "campaigns" / "bench", stated)
    reduced(runs[0], calibrations, tmp_path / "out")
    assert "TODO" not in "".join(
        line.split("#")[0] for line in (runs[0] / "run.yaml").read_text().splitlines()
    )


@pytest.mark.parametrize(
    ("text", "options", "said"),
    [
        ("a,b\n1,2\n3,4\n", (), "found columns a, b; expected --columns"),
        ("gx,gy,gz\n1.5,2,3\n1,2.5,3\n", (), "expected --rate HZ"),
        ("ticks,gx,gy,gz\n1,1,2,3\n2,1,2,3\n", (), "found ticks of a counter; expected --tick SECONDS"),
        ("nothing here\nbut words\n", (), "found a file of no known format"),
        ("t,gx\n0,1\n1,2\n", ("--columns", "gyro=gx"), "--columns: found gyro=gx"),
    ],
)
def test_what_only_the_user_can_say_is_asked_for(tmp_path, capsys, text, options, said):
    file = tmp_path / "log.csv"
    file.write_text(text)
    assert main(["init", str(file), "--out", str(tmp_path / "new"), *options]) == 2
    error = capsys.readouterr().err
    assert said in error
    assert error.count("\n") == 1
    assert not (tmp_path / "new").exists()
