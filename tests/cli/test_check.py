"""`fogreduce check`: every fault at once, exit status by way of BadInput, a summary when all is well."""

import argparse
import struct
from pathlib import Path

import pytest
from small_unit import RECORD, run_yaml

from fogreduce.cli import check
from fogreduce.errors import BadInput
from fogreduce.metadata.yaml12 import dump_yaml

START_US = 1_399_899_600_000_000  # 2014-05-12T13:00:00Z


def fogcap(n=4, rate=128.0, volts=1e-7, start=START_US, unit=b"TETRA-01", magic=b"FOGCAP1\n") -> bytes:
    """A capture of half a second, laid out as the contract's table says."""
    header = struct.pack("<8sIHHddq24s", magic, 64, n, 12 + 4 * n, rate, volts, start, unit)
    records = (
        struct.pack(f"<QI{n}i", round(1e6 * k / rate), k, *(1000 * (k * k % 7) + i for i in range(n)))
        for k in range(64)
    )
    return header + b"".join(records)


def run_data(run_id: str) -> dict:
    return run_yaml(run_id, [(10.0, 0.5)], 128.0)


class Lab:
    def __init__(self, root: Path) -> None:
        self.calibrations = root / "calibrations"
        self.record = self.calibrations / "TETRA-01" / "2012a.yaml"
        self.campaign = root / "c1"
        self.runs = [self.campaign / "runs" / name for name in ("r1", "r2", "r3")]
        self.record.parent.mkdir(parents=True)
        self.record.write_text(dump_yaml(RECORD))
        for run in self.runs:
            run.mkdir(parents=True)
            (run / "run.yaml").write_text(dump_yaml(run_data(run.name)))
            (run / "capture.fogcap").write_bytes(fogcap())

    def check(self, path) -> int:
        parser = argparse.ArgumentParser()
        check.add_arguments(parser)
        return check.run(parser.parse_args([str(path), "--calibrations", str(self.calibrations)]))

    def faults(self, path) -> list[str]:
        with pytest.raises(BadInput) as error:
            self.check(path)
        return [str(fault) for fault in error.value.faults]


@pytest.fixture
def lab(tmp_path):
    return Lab(tmp_path)


def test_faultless_campaign(lab, capsys):
    assert lab.check(lab.campaign) == 0
    assert capsys.readouterr().out.startswith(f"{lab.campaign}: no faults; 3 runs\n")


@pytest.mark.parametrize("below", ["", "run.yaml"])
def test_faultless_run(lab, capsys, below):
    assert lab.check(lab.runs[0] / below) == 0
    assert "4 gyros, 64 records expected, calibration TETRA-01@2012a" in capsys.readouterr().out


def test_faultless_record(lab, capsys):
    assert lab.check(lab.record) == 0
    assert "calibration record of 4 gyros" in capsys.readouterr().out


def test_other_metadata_files(lab, tmp_path, capsys):
    effects = {"schema": "fogreduce/effects/1", "effects": []}
    (tmp_path / "effects.yaml").write_text(dump_yaml(effects))
    (lab.campaign / "campaign.yaml").write_text("title: one\n")
    assert lab.check(tmp_path / "effects.yaml") == 0
    assert lab.check(lab.campaign / "campaign.yaml") == 0
    assert "fogreduce/effects/1" in capsys.readouterr().out
    (tmp_path / "effects.yaml").write_text(dump_yaml({**effects, "effect": 1}))
    (line,) = lab.faults(tmp_path / "effects.yaml")
    assert "effect: found an unknown key (did you mean effects?)" in line


def test_every_fault_of_every_run_at_once(lab):
    bad = run_data("r1")
    bad["site"] = {"latitude_deg": 91.0, "lattitude": 1.0}
    (lab.runs[0] / "run.yaml").write_text(dump_yaml(bad))
    bad = run_data("r2")
    bad["capture"]["polarity"] = [1, 1, 1]
    bad["started_at"] = "2011-01-01T00:00:00Z"
    (lab.runs[1] / "run.yaml").write_text(dump_yaml(bad))
    (lab.runs[2] / "run.yaml").write_text("[")
    (lab.campaign / "runs" / "run 4").mkdir()
    (lab.campaign / "campaign.yaml").write_text("titel: x\n")
    lines = lab.faults(lab.campaign)
    for file, key in [
        (lab.campaign / "campaign.yaml", "titel"),
        (lab.runs[0] / "run.yaml", "site.latitude_deg"),
        (lab.runs[0] / "run.yaml", "site.lattitude"),
        (lab.runs[1] / "run.yaml", "capture.polarity"),
        (lab.runs[1] / "run.yaml", "started_at"),
        (lab.runs[1] / "capture.fogcap", "header"),
        (lab.runs[2] / "run.yaml", "line "),
        (lab.campaign / "runs" / "run 4", "found this folder's name"),
    ]:
        assert sum(line.startswith(f"{file}: {key}") for line in lines) == 1, (file, key)
    assert len(lines) == 8


def test_a_records_fault_is_told_once_for_all_runs(lab):
    lab.record.write_text(dump_yaml({**RECORD, "bias_V": [1.0]}))
    (line,) = lab.faults(lab.campaign)
    assert line.startswith(f"{lab.record}: bias_V: found 1 values; expected 4")


def test_a_records_fault_is_told_beside_those_of_the_run_that_names_it(lab):
    lab.record.write_text(dump_yaml({**RECORD, "bias_V": [1.0]}))
    (lab.runs[0] / "run.yaml").write_text(dump_yaml({**run_data("r1"), "azimuth_deg": "5"}))
    lines = lab.faults(lab.runs[0])
    assert [": bias_V: " in line or ": azimuth_deg: " in line for line in lines] == [True, True]


@pytest.mark.parametrize(
    ("changed", "found", "expected"),
    [
        ({"rate": 64.0}, "64", "128"),
        ({"volts": 2e-7}, "2e-07", "1e-07"),
        ({"start": START_US + 1}, "13:00:00.000001", "13:00:00+00:00"),
        ({"unit": b"TETRA-02"}, "TETRA-02", "TETRA-01"),
        ({"n": 3}, "3", "4"),
    ],
)
def test_header_against_run_yaml(lab, changed, found, expected):
    (lab.runs[0] / "capture.fogcap").write_bytes(fogcap(**changed))
    (line,) = lab.faults(lab.runs[0])
    head, tail = line.split("; expected ")
    assert head.startswith(f"{lab.runs[0] / 'capture.fogcap'}: ")
    assert found in head
    assert expected in tail


@pytest.mark.parametrize("content", [b"", fogcap()[:40], fogcap(magic=b"FOGCAP2\n"), fogcap(n=0)])
def test_captures_that_are_none(lab, content):
    (lab.runs[0] / "capture.fogcap").write_bytes(content)
    lines = lab.faults(lab.runs[0])
    assert all(line.startswith(f"{lab.runs[0] / 'capture.fogcap'}: ") for line in lines)


def test_unknown_capture_format(lab):
    data = run_data("r1")
    data["capture"]["format"] = "fogcap-9"
    (lab.runs[0] / "run.yaml").write_text(dump_yaml(data))
    (line,) = lab.faults(lab.runs[0])
    assert line.startswith(
        f"{lab.runs[0] / 'run.yaml'}: capture.format: found fogcap-9; expected one of fogcap-1"
    )


def test_logs_are_read(lab):
    (lab.runs[0] / "run.yaml").write_text(
        dump_yaml({**run_data("r1"), "temperature": "t.csv", "table_log": "table.csv"})
    )
    (lab.runs[0] / "t.csv").write_text("time_s,electronics_degC,sensor_degC\n0,20,hot\n")
    (lab.runs[0] / "table.csv").write_text("time_s,angle\n0,0\n")
    lines = lab.faults(lab.runs[0])
    assert [line.split(": ")[:2] for line in lines] == [
        [str(lab.runs[0] / "t.csv"), "line 2"],
        [str(lab.runs[0] / "table.csv"), "line 1"],
    ]


def test_captures_may_be_absent_where_the_campaign_makes_them(lab):
    for run in lab.runs:
        (run / "capture.fogcap").unlink()
    assert len(lab.faults(lab.campaign)) == 3
    (lab.campaign / "campaign.yaml").write_text("captures_from: {simulate: {seed: 1}}\n")
    assert lab.check(lab.campaign) == 0


def test_curves_file_of_a_campaign_is_checked(lab):
    (lab.campaign / "campaign.yaml").write_text("captures_from: {curves: curves.yaml}\n")
    (line,) = lab.faults(lab.campaign)
    assert line == f"{lab.campaign / 'curves.yaml'}: found no such file; expected a YAML file"


def test_calibration_that_is_not_there(lab):
    lab.record.unlink()
    (line,) = lab.faults(lab.campaign)
    assert line == f"{lab.record}: found no such file; expected the calibration record TETRA-01@2012a"


def test_paths_that_are_nothing_of_ours(lab, tmp_path):
    (line,) = lab.faults(tmp_path / "absent")
    assert line.endswith("absent: found no such file; expected a YAML file")
    (tmp_path / "empty").mkdir()
    (line,) = lab.faults(tmp_path / "empty")
    assert line.endswith(
        "empty: found a folder without run.yaml or runs; expected a run, a campaign or a folder of campaigns"
    )
    (line,) = lab.faults(lab.runs[0] / "capture.fogcap")
    assert "capture.fogcap: " in line


def test_campaign_without_a_name(lab, tmp_path):
    lab.campaign.rename(tmp_path / "my campaign")
    (line,) = lab.faults(tmp_path / "my campaign")
    assert "found a campaign called my campaign; expected a name of 1 to 64 letters" in line


def test_a_folder_of_campaigns(lab, capsys):
    assert lab.check(lab.campaign.parent) == 0
    assert f"{lab.campaign.name}: 3 runs" in capsys.readouterr().out
    (lab.runs[1] / "run.yaml").unlink()
    assert len(lab.faults(lab.campaign.parent)) == 1
