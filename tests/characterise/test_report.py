"""``fogreduce report`` and ``fogreduce plan`` as commands, with good and bad input."""

from __future__ import annotations

import csv
import json

import pytest
import yaml

from fogreduce.characterise.limits import Limits, verdict
from fogreduce.characterise.quantity import Quantity, normal
from fogreduce.cli.main import main


@pytest.fixture
def words(bench, tmp_path):
    campaign = bench.simulate([], ("1-xp", "2-xm", "7-st"))
    return [
        "report",
        str(campaign),
        "--calibrations",
        str(bench.calibrations),
        "--out",
        str(tmp_path / "out"),
    ]


def test_page_pdf_and_document_say_the_same_and_come_out_alike(words, tmp_path, capsys) -> None:
    limits = tmp_path / "limits.yaml"
    limits.write_text("schema: fogreduce/limits/1\nlimits: {bias: {max: 10, absolute: true}}\n")
    assert main([*words, "--limits", str(limits)]) == 0
    assert "2 pass, 2 fail" in capsys.readouterr().out  # biases of 9, 26, -7 and -20 deg/h
    out = tmp_path / "out"
    before = {path.name: path.read_bytes() for path in out.iterdir()}
    assert before["report.pdf"].startswith(b"%PDF-")
    document = json.loads(before["report.json"])
    page = before["index.html"].decode()
    for one in document["quantities"]:
        assert one["determined"] != bool(one["needs"])  # a value, or what would give one
        assert one["definition"]
    open_ones = {one["quantity"] for one in document["quantities"] if not one["determined"]}
    assert {"nonlinearity", "hysteresis", "magnetic_sensitivity", "bandwidth"} <= open_ones
    assert "Not determinable from these runs" in page
    assert "2 (K+ - K-) / (K+ + K-)" in page
    traces = [one["variance_trace"] for one in document["left_out"]]
    assert traces[4] < 1.3 * traces[0] < min(traces[1:4])
    assert main([*words, "--limits", str(limits)]) == 0
    assert {path.name: path.read_bytes() for path in out.iterdir()} == before


def test_a_campaign_without_noise_and_a_single_run_have_reports_too(bench, tmp_path) -> None:
    for k, options in enumerate((["--no-noise"], [])):
        campaign = bench.simulate([], ("1-xp",) if k else ("1-xp", "2-xm", "7-st"), options=options)
        place = ["--calibrations", str(bench.calibrations), "--out", str(tmp_path / f"o{k}")]
        assert main(["report", str(campaign), *place]) == 0


@pytest.mark.parametrize(
    ("option", "text", "said"),
    [
        ("--limits", "schema: fogreduce/limits/1\nlimits: {biass: {max: 1}}\n", "found biass"),
        ("--limits", "schema: fogreduce/limits/1\nlimits: {bias: {}}\n", "expected min, max or both"),
        ("--definitions", "nonlinearity: percent\n", "expected full_scale or reading"),
        ("--definitions", "bias_stability: 10\n", "bias_stability"),
    ],
)
def test_bad_files_are_one_line_and_nothing_is_written(words, tmp_path, capsys, option, text, said) -> None:
    file = tmp_path / "file.yaml"
    file.write_text(text)
    assert main([*words, option, str(file)]) == 2
    error = capsys.readouterr().err
    assert said in error
    assert str(file) in error
    assert not (tmp_path / "out").exists()


def test_verdicts_are_guard_banded() -> None:
    """JCGM 106: accepted within the tolerance less U, rejected beyond it plus U, else neither is proven."""
    limits = Limits.from_data(
        {"schema": "fogreduce/limits/1", "limits": {"bias": {"min": -10.0, "max": 10.0}}}, "limits.yaml"
    )

    def of(value: float) -> tuple[str, float]:
        found = verdict(normal("bias", "gyro1", "deg/h", value, 1.0), limits)
        assert found is not None
        return found

    assert [of(value)[0] for value in (7.9, 8.1, 10.0, 11.9, 12.1)] == [
        *("pass", "not proven", "not proven", "not proven", "fail")
    ]
    assert of(10.0)[1] == pytest.approx(0.5, abs=1e-6)
    assert of(-12.1)[0] == "fail"
    assert verdict(Quantity("bias", "gyro1", "deg/h", needs="a run"), limits) is None


@pytest.mark.parametrize(
    ("limit", "said"),
    [
        ({"min": 200.0}, "pass"),
        ({"min": 300.0}, "not proven"),
        ({"max": 200.0}, "fail"),
        ({"max": 300.0}, "not proven"),
    ],
)
def test_a_lower_bound_passes_a_least_value_only(limit, said) -> None:
    limits = Limits.from_data({"schema": "fogreduce/limits/1", "limits": {"bandwidth": limit}}, "limits.yaml")
    assert verdict(Quantity("bandwidth", "gyro1", "Hz", 240.0, 240.0), limits) == (said, None)


def test_a_plan_validates_and_says_what_it_will_know(bench, tmp_path, capsys) -> None:
    run = bench.simulate([], ("1-xp",)) / "runs" / "1-xp"
    place = ["--calibrations", str(bench.calibrations), "--out", str(tmp_path / "planned")]
    assert main(["plan", str(run), *place]) == 0
    said = capsys.readouterr().out
    assert "22 runs, 8.3 h" in said
    rows = list(csv.DictReader((tmp_path / "planned.expected.csv").open()))
    known = {row["quantity"] for row in rows if row["standard_uncertainty"]}
    assert {"scale_factor", "nonlinearity", "hysteresis", "threshold", "acceleration_sensitivity"} <= known
    assert {"bias_repeatability", "scale_factor_temperature", "asymmetry", "misalignment"} <= known
    assert "bandwidth" in known
    first = yaml.safe_load((tmp_path / "planned" / "runs" / "01-stairs-x-day1" / "run.yaml").read_text())
    assert first["calibration"] == "UNIT@a"
    assert main(["plan", str(run), *place]) == 2
    assert main(["plan", str(run), *place[:2], "--out", str(tmp_path / "p"), "--largest-rate", "-1"]) == 2
