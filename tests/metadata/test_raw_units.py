"""Raw units of runs and calibration records: which keys go with which unit, and what does not fit."""

import re
from pathlib import Path

import numpy as np
import pytest

from fogreduce.errors import BadInput
from fogreduce.metadata.calibration import DEFAULT_UNCERTAINTY, CalibrationRecord
from fogreduce.metadata.facts import RunFacts
from fogreduce.metadata.folder import cross_check, load_calibration, load_run
from fogreduce.metadata.run import Run
from fogreduce.metadata.yaml12 import load_yaml
from fogreduce.physics.raw_quantity import RAW_UNITS, UNITS_IN_USE, unit_in_use

SCALES = "scale_factor_V_per_deg_s: [0.075, 0.09, 0.092, 0.075]\nbias_V: [1e-4, 6e-4, 2e-4, -4e-4]\n"
STEP = "  volts_per_count: 1e-07\n"


def in_unit(lab, name):
    """The laboratory's run captured in a unit, its record in the one in use; the facts of both."""
    suffix = unit_in_use(name).suffix
    keys = f"scale_factor_{suffix}_per_deg_s: [2, 2, 2, 2]\nbias_{suffix}: [1, 2, 3, 4]\n"
    lab.edit("calibration", SCALES, keys)
    step = "volts_per_count" if name == "V" else "least_count"
    lab.edit("run", STEP, f"  raw_unit: {name}\n  {step}: 0.5\n")
    run = load_run(lab.run)
    record, _ = load_calibration(lab.calibrations, run.calibration)
    cross_check(run, record)
    return run, record


@pytest.mark.parametrize("name", RAW_UNITS)
def test_run_and_record_in_a_unit(lab, name):
    run, record = in_unit(lab, name)
    unit = unit_in_use(name)
    assert record.raw_unit == unit
    assert (record.scale_factor, record.bias) == ((2.0,) * 4, (1.0, 2.0, 3.0, 4.0))
    facts = RunFacts.of(run.model_dump(mode="json"), record.model_dump(mode="json"))
    assert facts.raw_unit == unit
    np.testing.assert_array_equal(facts.bias, record.bias)
    # an increment of 0.5 deg over a sample of 1/128 s is 64 deg/s
    assert facts.least_count == (64.0 if name in ("deg", "rad") else 0.5)


def test_defaults_of_uncertainty_go_through_the_scale_factor(lab):
    _, record = in_unit(lab, "deg/h")
    stated = record.stated_uncertainty
    one_deg_h = DEFAULT_UNCERTAINTY["bias_deg_h"].value
    # 2 deg/h of reading for each deg/s of rate: 1 deg/h of rate is 2/3600 of reading
    assert stated.bias == pytest.approx((one_deg_h * 2 / 3600,) * 4, rel=1e-14)
    assert stated.scale_factor_rel == (2e-5,) * 4  # the record's own
    assert set(stated.model_dump()) >= {"bias_deg_h", "scale_factor_rel"}


def test_uncertainty_of_the_bias_stands_in_the_records_unit(lab):
    lab.edit("calibration", "uncertainty:\n", "uncertainty:\n  bias_rad_s: [1, 1, 1, 1]\n")
    _, record = in_unit(lab, "rad/s")
    assert record.stated_uncertainty.bias == (1.0,) * 4


def test_counts_have_a_least_count_of_one(lab):
    suffixed = SCALES.replace("_V", "_count")
    lab.edit("calibration", SCALES, suffixed)
    lab.edit("run", STEP, "  raw_unit: count\n")
    run = load_run(lab.run)
    record, _ = load_calibration(lab.calibrations, run.calibration)
    assert RunFacts.of(run.model_dump(mode="json"), record.model_dump(mode="json")).least_count == 1.0


@pytest.mark.parametrize(
    ("capture", "key", "found", "expected"),
    [
        ("", "capture.volts_per_count", "nothing", "volts a count stands for"),
        (
            "  raw_unit: deg/s\n  volts_per_count: 1e-7\n",
            "capture.volts_per_count",
            "1e-07",
            "least_count in its place, for raw_unit deg/s",
        ),
        ("  raw_unit: count\n  volts_per_count: 1\n", "capture.volts_per_count", "1", "least_count"),
        ("  raw_unit: rad\n", "capture.least_count", "nothing", "least step of a raw reading [rad]"),
        (
            "  volts_per_count: 1e-7\n  least_count: 1e-7\n",
            "capture.least_count",
            "1e-07",
            "volts_per_count in its place, for raw_unit V",
        ),
        ("  raw_unit: dps\n  least_count: 1\n", "capture.raw_unit", "the text 'dps'", "V, count, deg/s"),
        ("  raw_unit: deg/s\n  least_count: 0\n", "capture.least_count", "0", "more than 0"),
    ],
)
def test_a_runs_keys_that_do_not_fit_its_unit(lab, capture, key, found, expected):
    lab.edit("run", STEP, capture)
    with pytest.raises(BadInput) as caught:
        load_run(lab.run)
    (fault,) = caught.value.faults
    assert (fault.where, fault.found) == (key, found)
    assert expected in fault.expected


@pytest.mark.parametrize(
    ("old", "new", "key"),
    [
        ("bias_V: [1e-4", "bias_deg_s: [1e-4", {"bias_V", "bias_deg_s"}),
        ("uncertainty:\n", "uncertainty:\n  bias_deg_s: [1, 1, 1, 1]\n", {"uncertainty.bias_deg_s"}),
        ("bias_V: [1", "bias_deg_s: [1, 1, 1, 1]\nbias_V: [1", {"bias_deg_s"}),
    ],
)
def test_a_record_of_two_units(lab, old, new, key):
    lab.edit("calibration", old, new)
    with pytest.raises(BadInput) as caught:
        load_calibration(lab.calibrations, "TETRA-01@2012a")
    assert {fault.where for fault in caught.value.faults} == key


@pytest.mark.parametrize("captured_in", [name for name in RAW_UNITS if name != "V"])
def test_a_run_in_another_unit_than_its_record(lab, captured_in):
    lab.edit("run", STEP, f"  raw_unit: {captured_in}\n  least_count: 1\n")
    run = load_run(lab.run)
    record, _ = load_calibration(lab.calibrations, run.calibration)
    with pytest.raises(BadInput) as caught:
        cross_check(run, record)
    (fault,) = caught.value.faults
    assert (fault.where, fault.found) == ("capture.raw_unit", captured_in)
    assert fault.expected == "V, as TETRA-01@2012a is in V"


def test_a_record_in_a_rate_fits_increments_too(lab):
    suffix = UNITS_IN_USE["deg/s"].suffix
    lab.edit("calibration", SCALES, SCALES.replace("_V", f"_{suffix}"))
    run = load_run(lab.run)  # in volts
    record, _ = load_calibration(lab.calibrations, run.calibration)
    with pytest.raises(BadInput, match="expected deg/s or deg, as TETRA-01@2012a is in deg/s"):
        cross_check(run, record)


def test_the_page_on_raw_units_says_what_is_so(lab):
    """Its examples are a run and a record that fit each other; its table names columns as they are."""
    page = Path(__file__).parents[2] / "docs" / "raw-units.md"
    text = page.read_text(encoding="utf-8")
    capture, scales = re.findall(r"```yaml\n(.*?)```", text, re.DOTALL)
    run = {**load_yaml(lab.files["run"]), **_yaml(lab, capture)}
    record = {key: value for key, value in load_yaml(lab.files["calibration"]).items() if "_V" not in key}
    record |= {**_yaml(lab, scales), "H": [[1, 0, 0], [0, 1, 0], [0, 0, 1]]}
    cross_check(Run.from_data(run, page), CalibrationRecord.from_data(record, page))
    rows = [line for line in text.splitlines() if line.startswith("| `")]
    for name in UNITS_IN_USE:
        (row,) = (line for line in rows if f"`{name}`" in line.split("|")[1])
        unit = UNITS_IN_USE[name]
        assert f"`a_{unit.suffix}`, `e_{unit.slope_suffix}` | `{unit.variable}`" in row


def _yaml(lab, text):
    (path := lab.run / "fragment.yaml").write_text(text)
    return load_yaml(path)
