"""Values that nobody stated: by check, in the manifest, on the run's and the campaign's page."""

import json

import pytest
from small_unit import RECORD
from test_check import Lab, run_data

from fogreduce.metadata.assumed import assumed_of_record, assumed_of_run
from fogreduce.metadata.calibration import DEFAULT_NOISE, DEFAULT_UNCERTAINTY, CalibrationRecord
from fogreduce.metadata.run import Run
from fogreduce.metadata.yaml12 import dump_yaml

UNCERTAINTY = {
    "scale_factor_rel": [5e-5] * 4,
    "bias_V": [1e-6] * 4,
    "axis_rad": [5e-5] * 4,
    "turn_on_bias_deg_h": [0.1] * 4,
}
NOISE = {
    "angle_random_walk_deg_sqrt_h": [0.002] * 4,
    "bias_instability_deg_h": [0.01] * 4,
    "rate_random_walk_deg_h_sqrt_h": [0.0] * 4,
}
OF_RUN = {"site.latitude_uncertainty_deg", "table.rate_uncertainty_ppm", "azimuth_uncertainty_deg"}


def record(**more):
    return CalibrationRecord.from_data(RECORD | more, "record")


def keys(found):
    return {item.key for item in found}


def full_run(run_id):
    data = run_data(run_id)
    data["site"]["latitude_uncertainty_deg"] = 0.01
    data["table"]["rate_uncertainty_ppm"] = 2.0
    data["azimuth_uncertainty_deg"] = 0.1
    return data


def test_a_record_that_states_everything_assumes_nothing():
    assert assumed_of_record(record(uncertainty=UNCERTAINTY, noise=NOISE)) == []


def test_a_record_that_states_nothing():
    found = assumed_of_record(record())
    uncertain = {"uncertainty." + key for key in UNCERTAINTY}
    assert keys(found) == uncertain | {"noise." + key for key in NOISE}
    said = {item.key: item.said for item in found}
    assert said["uncertainty.bias_V"].startswith("1 deg/h")
    assert said["noise.angle_random_walk_deg_sqrt_h"].startswith("0.05 deg/sqrt(h)")


@pytest.mark.parametrize("block", ["uncertainty", "noise"])
def test_each_key_left_out_is_the_one_that_is_named(block):
    whole = {"uncertainty": UNCERTAINTY, "noise": NOISE}
    for key in whole[block]:
        parts = {name: value for name, value in whole[block].items() if name != key}
        assert keys(assumed_of_record(record(**(whole | {block: parts})))) == {f"{block}.{key}"}


def test_every_default_has_a_line():
    assert len(assumed_of_record(record())) == len(DEFAULT_UNCERTAINTY) + len(DEFAULT_NOISE)


def test_a_record_in_another_unit_names_its_own_key():
    data = {key: value for key, value in RECORD.items() if not key.endswith(("_V", "_V_per_deg_s"))}
    data |= {"scale_factor_deg_s_per_deg_s": [1.0] * 4, "bias_deg_s": [0.0] * 4}
    found = assumed_of_record(CalibrationRecord.from_data(data, "record"))
    assert "uncertainty.bias_deg_s" in keys(found)


def test_what_a_run_leaves_out():
    run = Run.from_data(run_data("r1"), "run.yaml")
    assert keys(assumed_of_run(run)) == OF_RUN
    assert assumed_of_run(Run.from_data(full_run("r1"), "run.yaml")) == []


def test_a_value_that_equals_the_default_is_stated():
    data = run_data("r1") | {"azimuth_uncertainty_deg": 0.05}
    assert keys(assumed_of_run(Run.from_data(data, "run.yaml"))) == OF_RUN - {"azimuth_uncertainty_deg"}


@pytest.fixture
def lab(tmp_path):
    return Lab(tmp_path)


def test_check_says_it_once_for_many_runs(lab, capsys):
    (lab.runs[0] / "run.yaml").write_text(dump_yaml(full_run("r1")))
    assert lab.check(lab.campaign) == 0
    captured = capsys.readouterr()
    lines = captured.out.splitlines()[1:]
    assert captured.err == ""
    assert len(lines) == len(set(lines)) == 10
    assert sum("(2 of 3 runs)" in line for line in lines) == 3
    assert all("assumed" in line for line in lines)


def test_check_of_a_record_says_what_it_leaves_out(lab, capsys):
    assert lab.check(lab.record) == 0
    assert capsys.readouterr().out.count("assumed") == 7


def test_check_of_what_states_everything_says_nothing_more(lab, capsys):
    lab.record.write_text(dump_yaml(RECORD | {"uncertainty": UNCERTAINTY, "noise": NOISE}))
    (lab.runs[0] / "run.yaml").write_text(dump_yaml(full_run("r1")))
    assert lab.check(lab.runs[0]) == 0
    assert len(capsys.readouterr().out.splitlines()) == 1


def test_the_manifest_lists_it(lab):
    from fogreduce.provenance.manifest import manifest

    made = manifest(lab.runs[0], lab.calibrations, {})
    assert {entry["key"] for entry in made["assumed"]} >= OF_RUN | {"uncertainty.bias_V"}
    assert {entry["file"] for entry in made["assumed"]} == {"run.yaml", "TETRA-01@2012a"}
    json.dumps(made, allow_nan=False)
