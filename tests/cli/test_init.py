"""`fogreduce init`: what a capture says stands in run.yaml, the rest is marked, nothing is overwritten."""

import argparse
import shlex
import struct

import pytest

from fogreduce.cli import init
from fogreduce.cli.main import main
from fogreduce.errors import BadInput
from fogreduce.metadata.folder import load_run
from fogreduce.metadata.yaml12 import load_yaml


@pytest.fixture
def folder(tmp_path):
    run = tmp_path / "c1" / "runs" / "x-plus"
    run.mkdir(parents=True)
    header = struct.pack(
        "<8sIHHddq24s", b"FOGCAP1\n", 64, 3, 24, 128.0, 1e-7, 1_399_899_600_000_000, b"TETRA-01"
    )
    (run / "capture.fogcap").write_bytes(header + bytes(24 * 256))
    (run / "capture.csv").write_text("time_s,gyro1_V,gyro2_V\n0,1e-3,2e-3\n")
    return run


def start(*args) -> int:
    parser = argparse.ArgumentParser()
    init.add_arguments(parser)
    return init.run(parser.parse_args([str(arg) for arg in args]))


def test_from_a_fogcap_header(folder, capsys):
    assert start(folder / "capture.fogcap") == 0
    data = load_yaml(folder / "run.yaml")
    assert data["run_id"] == "x-plus"
    assert data["unit"] == "TETRA-01"
    assert data["started_at"] == "2014-05-12T13:00:00Z"
    assert data["capture"] == {
        "file": "capture.fogcap",
        "format": "fogcap-1",
        "sample_rate_hz": 128.0,
        "volts_per_count": 1e-7,
        "polarity": ["TODO"] * 3,
    }
    assert data["table"]["profile"] == [{"rate_deg_s": "TODO", "duration_s": 2.0}]  # 256 records at 128 Hz
    assert "temperature" not in data
    assert "run.yaml: 7 lines marked TODO" in capsys.readouterr().out


def test_from_csv_columns_with_logs_beside_it(folder):
    (folder / "temperature.csv").write_text("")
    (folder / "table.csv").write_text("")
    assert start(folder / "capture.csv", "--out", folder / "run.yaml") == 0
    data = load_yaml(folder / "run.yaml")
    assert data["capture"]["format"] == "csv-1"
    assert data["capture"]["polarity"] == ["TODO"] * 2
    assert data["capture"]["sample_rate_hz"] == "TODO"
    assert data["unit"] == "TODO"
    assert (data["temperature"], data["table_log"]) == ("temperature.csv", "table.csv")


def test_what_is_left_to_do_is_told_and_only_that(folder):
    start(folder / "capture.fogcap")
    with pytest.raises(BadInput) as error:
        load_run(folder)
    assert {fault.where for fault in error.value.faults} == {
        "site.latitude_deg",
        "table.axis",
        "table.profile[0].rate_deg_s",
        "orientation.x",
        "orientation.z",
        "capture.polarity[0]",
        "capture.polarity[1]",
        "capture.polarity[2]",
    }


def test_filled_in_it_is_a_run(folder):
    start(folder / "capture.fogcap")
    path = folder / "run.yaml"
    text = path.read_text()
    for old, new in (
        ("latitude_deg: TODO", "latitude_deg: 48.1"),
        ("axis: TODO", "axis: z"),
        ("rate_deg_s: TODO", "rate_deg_s: 10"),
        ("x: TODO", "x: up"),
        ("z: TODO", "z: north"),
        ("[TODO, TODO, TODO]", "[1, 1, 1]"),
        ("@TODO", "@2012a"),
    ):
        assert text.count(old) == 1
        text = text.replace(old, new)
    for optional in (
        "latitude_uncertainty_deg",
        "rate_uncertainty_ppm",
        "azimuth_deg",
        "frame_signs",
        "notes",
    ):
        assert text.count(f"# {optional}: ") == 1
        text = text.replace(f"# {optional}: ", f"{optional}: ")  # the commented keys are right as they stand
    path.write_text(text)
    run = load_run(folder)
    assert run.n_expected == 256
    assert run.notes == "free text"


def test_an_existing_file_is_left_alone(folder):
    (folder / "run.yaml").write_text("mine")
    with pytest.raises(BadInput, match=r"run\.yaml: found a file already there; expected a new file"):
        start(folder / "capture.fogcap")
    assert (folder / "run.yaml").read_text() == "mine"


def test_a_dangling_link_is_left_alone(folder, tmp_path):
    (folder / "run.yaml").symlink_to(tmp_path / "elsewhere")
    with pytest.raises(BadInput, match="already there"):
        start(folder / "capture.fogcap")
    assert not (tmp_path / "elsewhere").exists()


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("absent", None),
        ("empty", b""),
        ("text", b"a,b\n"),
        ("torn", b"FOGCAP1\n\0\0"),
        ("bytes", b"\xff\xfe\x00"),
    ],
)
def test_what_is_no_capture(folder, name, content):
    if content is not None:
        (folder / name).write_bytes(content)
    with pytest.raises(BadInput) as error:
        start(folder / name)
    assert str(error.value).startswith(f"{folder / name}: ")
    assert sorted(path.name for path in folder.iterdir() if path.name not in (name,)) == [
        "capture.csv",
        "capture.fogcap",
    ]


def test_a_folder_that_is_not_there(folder):
    with pytest.raises(BadInput, match="expected a folder that can be written to"):
        start(folder / "capture.fogcap", "--out", folder / "absent" / "run.yaml")


def test_a_start_beyond_the_calendar_is_left_to_do(folder):
    data = bytearray((folder / "capture.fogcap").read_bytes())
    data[32:40] = struct.pack("<q", 2**62)
    (folder / "capture.fogcap").write_bytes(data)
    start(folder / "capture.fogcap")
    assert load_yaml(folder / "run.yaml")["started_at"] == "TODO"


def test_odd_names_are_quoted(folder):
    odd = folder.with_name("1e5")
    folder.rename(odd)
    (odd / "capture.fogcap").rename(odd / "a: #b")
    start(odd / "a: #b")
    data = load_yaml(odd / "run.yaml")
    assert (data["run_id"], data["capture"]["file"]) == ("1e5", "a: #b")


def test_rate_and_length_of_a_csv(folder):
    """Of times rounded to microseconds, one line lost: 128 Hz, two seconds."""
    lines = [f"{k / 128.0:.6f},1e-3,2e-3" for k in range(256) if k != 100]
    (folder / "capture.csv").write_text("\n".join(["time_s,gyro1_V,gyro2_V", *lines]) + "\n")
    assert start(folder / "capture.csv") == 0
    data = load_yaml(folder / "run.yaml")
    assert data["capture"]["sample_rate_hz"] == 128.0
    assert data["table"]["profile"][0]["duration_s"] == 2.0


def test_what_is_left_to_do_in_a_name_is_a_fault_too(folder, capsys):
    """The unit's name may be any word; the hint runs as it is printed and finds it."""
    (folder.parents[2] / "calibrations").mkdir()
    start(folder / "capture.csv")
    hint = capsys.readouterr().out.partition("then run: fogreduce ")[2]
    assert main(shlex.split(hint)) == 2
    said = capsys.readouterr().err
    assert f"{folder}/run.yaml: unit: found TODO; expected the value itself, filled in\n" in said
    assert f"{folder}/run.yaml: calibration: found TODO; expected the value itself, filled in\n" in said
