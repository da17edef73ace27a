"""``fogreduce diagnose`` from outside: what it writes, what it says of what was put in, and what it
refuses."""

from __future__ import annotations

import pytest
from bench_lab import ONE_GYRO, RECORD, diagnosed, lab, simulated

from fogreduce.cli.main import main

RAMP = {"effect": "bias_ramp", "channels": ["gyro2"], "runs": ["*"], "parameters": {"deg_h_per_h": 40.0}}


def test_what_was_put_in_is_found_and_closes_the_gap(tmp_path) -> None:
    lab(tmp_path)
    found = diagnosed(tmp_path, simulated(tmp_path, [RAMP]))
    assert found["verdict"] == "explained"
    (cause,) = found["causes"]
    assert (cause["effect"], cause["channels"], cause["runs"]) == ("bias_ramp", ["gyro2"], ["*"])
    value = cause["parameters"]["deg_h_per_h"]
    # 4 standard deviations: once in 16000
    assert abs(value["value"] - 40.0) < 4.0 * value["std"]
    assert found["where"][0]["channels"] == ["gyro2"]
    assert found["closure"]["fraction"] > 0.9
    assert abs(found["closure"].get("placebo_fraction", 0.0)) < 0.2
    assert sum(place["share"] for place in found["where"]) <= 1.0
    out = tmp_path / "out-bench"
    assert (out / "index.html").read_text().startswith("<!DOCTYPE html>")
    # simulator.yaml runs as it stands
    arguments = ["simulate", str(tmp_path / "plan"), "--calibrations", str(tmp_path / "cal")]
    assert main([*arguments, "--effects", str(out / "simulator.yaml"), "--out", str(tmp_path / "again")]) == 0


def test_nothing_put_in_is_no_gap(tmp_path) -> None:
    lab(tmp_path)
    found = diagnosed(tmp_path, simulated(tmp_path, []))
    assert (found["verdict"], found["causes"], found["closure"]) == ("no_gap", [], None)
    assert found["gap_probability"] < 0.5


def test_an_effect_left_out_is_not_named(tmp_path) -> None:
    lab(tmp_path)
    found = diagnosed(tmp_path, simulated(tmp_path, [RAMP]), "--without", "bias_ramp")
    assert "bias_ramp" not in found["catalogue"]
    assert found["verdict"] != "no_gap"
    assert all(cause["effect"] != "bias_ramp" for cause in found["causes"])
    assert found["where"][0]["channels"] == ["gyro2"]


@pytest.mark.parametrize(
    ("effect", "channels", "parameters"),
    [
        ("polarity_error", ["gyro3"], {}),
        ("rotation_sense", ["table"], {}),
        ("dropouts", ["gyro1"], {"fraction": 0.01}),
        ("lost_bits", ["gyro4"], {"bits": 5}),
        ("clock_error", ["clock"], {"ppm": 20.0}),
        ("common_noise", ["gyro1", "gyro2", "gyro3", "gyro4"], {"correlation": 0.2}),
    ],
)
def test_faults_of_every_kind(tmp_path, effect, channels, parameters) -> None:
    lab(tmp_path)
    entry = {"effect": effect, "channels": channels, "runs": ["*"], "parameters": parameters}
    found = diagnosed(tmp_path, simulated(tmp_path, [entry]))
    assert found["verdict"] == "explained"
    assert [(c["effect"], c["channels"]) for c in found["causes"]] == [(effect, channels)]


def test_another_simulators_captures_as_the_prediction(tmp_path) -> None:
    lab(tmp_path)
    bench = simulated(tmp_path, [RAMP])
    same = diagnosed(tmp_path, bench, "--simulated", str(bench))
    assert same["verdict"] == "no_gap"


@pytest.mark.parametrize(
    ("effect", "channels", "run", "looks_like"),
    [
        ("rotation_sense", ["table"], "r1", "the table turning the other way"),
        ("polarity_error", ["gyro3"], "r2", "the other sign: gyro3"),
    ],
)
def test_a_wrong_sign_in_one_run_is_named_for_that_run(
    tmp_path, capsys, effect, channels, run, looks_like
) -> None:
    lab(tmp_path)
    entry = {"effect": effect, "channels": channels, "runs": [run], "parameters": {}}
    bench = simulated(tmp_path, [entry])
    capsys.readouterr()
    found = diagnosed(tmp_path, bench)
    assert [one["run"] for one in found["mistakes"]] == [run]
    assert looks_like in found["mistakes"][0]["looks_like"][0]
    assert f"{run} looks like" in capsys.readouterr().out
    page = (tmp_path / "out-bench" / "index.html").read_text()
    assert f"{run} looks like" in page
    assert "The calibration record is stale" not in page


def test_the_next_run_is_ready_to_use(tmp_path, capsys) -> None:
    lab(tmp_path)
    offset = {"effect": "bias_offset", "channels": ["gyro2"], "runs": ["*"], "parameters": {"deg_h": 40.0}}
    bench = simulated(tmp_path, [offset])
    limits = tmp_path / "limits.yaml"
    limits.write_text("schema: fogreduce/bench/1\ntable: {largest_rate_deg_s: 3}\n")
    capsys.readouterr()
    found = diagnosed(tmp_path, bench, "--only-runs", "r0", "--bench", str(limits))
    out = tmp_path / "out-bench"
    assert "next run: turning at" in (said := capsys.readouterr().out)
    assert f"{out / 'next-run' / 'run.yaml'}" in said
    assert abs(found["next_run"]["table"]["profile"][0]["rate_deg_s"]) <= 3.0
    folder = tmp_path / "next" / "runs" / "next-run"
    folder.mkdir(parents=True)
    (folder / "run.yaml").write_bytes((out / "next-run" / "run.yaml").read_bytes())
    arguments = ["simulate", str(tmp_path / "next"), "--calibrations", str(tmp_path / "cal")]
    assert main([*arguments, "--out", str(tmp_path / "made")]) == 0


def test_one_gyro_and_a_slow_log(tmp_path) -> None:
    lab(tmp_path, ONE_GYRO, rate_hz=0.2, duration_s=1200.0)
    entry = {"effect": "bias_step", "channels": ["gyro1"], "runs": ["r5"]}
    entry["parameters"] = {"deg_h": 60.0, "time_s": 600.0}
    found = diagnosed(tmp_path, simulated(tmp_path, [entry]))
    # The record in which it steps lies in one half alone: held out, its time is not known to the record.
    closes = found["closure"]["interval_95"][1] >= 0.97
    assert found["verdict"] == ("explained" if closes else "partly_explained")
    assert found["closure"]["fraction"] > 0.9
    assert found["causes"][0]["effect"] == "bias_step"
    assert found["causes"][0]["runs"] == ["r5"]


@pytest.mark.parametrize(
    ("more", "says"),
    [
        (["--bench", "limits.yaml"], "limits.yaml"),
        (["--without", "gremlins"], "--without: found gremlins; expected an effect of the catalogue"),
        (["--only-runs", "r9"], "--only-runs: found r9; expected one of r0"),
    ],
)
def test_bad_input_is_one_clear_line(tmp_path, capsys, more, says) -> None:
    lab(tmp_path)
    out = tmp_path / "out"
    arguments = [
        "diagnose",
        str(tmp_path / "plan"),
        "--calibrations",
        str(tmp_path / "cal"),
        "--out",
        str(out),
    ]
    assert main([*arguments, *more]) == 2
    assert says in capsys.readouterr().err
    assert not out.exists()


def test_a_campaign_without_captures_is_refused(tmp_path, capsys) -> None:
    lab(tmp_path)
    arguments = ["diagnose", str(tmp_path / "plan"), "--calibrations", str(tmp_path / "cal")]
    assert main([*arguments, "--out", str(tmp_path / "out")]) == 2
    assert "capture.fogcap, which is not there" in capsys.readouterr().err


def test_a_data_sheet_stands_in_for_what_no_record_states(tmp_path) -> None:
    silent = {key: value for key, value in RECORD.items() if key not in ("uncertainty", "noise")}
    lab(tmp_path, silent, duration_s=60.0)
    sheet = tmp_path / "sheet.yaml"
    sheet.write_text(
        "schema: fogreduce/part/1\nproduct: P\nsource: S\n"
        "angle_random_walk_deg_sqrt_h: {value: 0.01, meaning: maximum}\n"
        "acceleration_deg_h_per_g: {value: 90, meaning: one_sigma}\n"
    )
    arguments = [str(tmp_path / "plan"), "--calibrations", str(tmp_path / "cal"), "--part", str(sheet)]
    assert main(["simulate", *arguments, "--out", str(tmp_path / "made")]) == 0
    found = diagnosed(tmp_path, tmp_path / "made", "--part", str(sheet))
    assert found["part"]["sizes"] == {"acceleration_bias": pytest.approx([9.0, 270.0])}
    (white,) = [a["value"] for a in found["assumed"] if a["key"] == "noise.angle_random_walk_deg_sqrt_h"]
    # 3840 samples a run, six runs: known to half a per cent
    assert white == pytest.approx([0.01] * 4, rel=0.05)
