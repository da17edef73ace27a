"""What the models make of faultless files."""

import ast
import math
from datetime import UTC, datetime, timedelta, timezone
from pathlib import Path

import pytest
from pydantic import ValidationError

import fogreduce
from fogreduce.errors import BadInput
from fogreduce.metadata import patterns as patterns_module
from fogreduce.metadata.base import Model
from fogreduce.metadata.calibration import DEFAULT_NOISE, DEFAULT_UNCERTAINTY, CalibrationRecord
from fogreduce.metadata.campaign import Campaign
from fogreduce.metadata.config import WorkflowConfig
from fogreduce.metadata.curves import Curves
from fogreduce.metadata.effects_file import EffectsFile
from fogreduce.metadata.faults import dotted
from fogreduce.metadata.instant import instant_text, parse_instant
from fogreduce.metadata.patterns import IN_WORDS
from fogreduce.metadata.run import Run
from fogreduce.metadata.yaml12 import dump_yaml, load_yaml
from fogreduce.units import instant_of

SHARED = Path("/work/shared")


def run_with(lab, **changes):
    return Run.from_data({**load_yaml(lab.files["run"]), **changes}, "run.yaml")


def test_run_defaults_are_the_contracts(lab):
    run = Run.from_yaml(lab.files["run"])
    assert run.site.latitude_uncertainty_deg == 0.001
    assert run.table.rate_uncertainty_ppm == 5
    assert run.azimuth_deg == 0
    assert run.azimuth_uncertainty_deg == 0.05
    assert run_with(lab, frame_signs=[1, 1, -1.0]).frame_signs == (1, 1, -1)
    assert run.orientation == {"x": "up", "z": "north"}
    assert run.capture.volts_per_count == 1e-7


def test_expected_records(lab):
    # the contract: record k, 0 <= k < round(duration x rate); 6000 s at 128 Hz are the paper's 768 000
    assert Run.from_yaml(lab.files["run"]).n_expected == 768_000
    steps = [{"rate_deg_s": 1, "duration_s": 0.1}] * 10
    run = run_with(lab, table={"axis": "z", "profile": steps})
    assert run.duration_s == 1.0  # ten times 0.1, exactly rounded
    assert run.n_expected == 128


@pytest.mark.parametrize(
    ("written", "axis"),
    [
        ("x", (1, 0, 0)),
        ("z", (0, 0, 1)),
        ([0, -2, 0], (0, -1, 0)),
        ([3, 0, 4], (0.6, 0, 0.8)),
        ([1e-9, 0, 0], (1, 0, 0)),
    ],
)
def test_axis_becomes_a_unit_vector(lab, written, axis):
    run = run_with(lab, table={"axis": written, "profile": [{"rate_deg_s": 1, "duration_s": 1}]})
    assert run.table.axis == pytest.approx(axis, abs=1e-15)


@pytest.mark.parametrize(
    ("text", "utc"),
    [
        ("2014-05-12T13:00:00Z", datetime(2014, 5, 12, 13, tzinfo=UTC)),
        ("2014-05-12T10:00:00-03:00", datetime(2014, 5, 12, 13, tzinfo=UTC)),
        ("2014-05-12t13:00:00.000001z", datetime(2014, 5, 12, 13, 0, 0, 1, tzinfo=UTC)),
        ("2014-05-12 13:00:00.5+00:00", datetime(2014, 5, 12, 13, 0, 0, 500_000, tzinfo=UTC)),
    ],
)
def test_instants(text, utc):
    assert parse_instant(text) == utc
    assert parse_instant(text).utcoffset() == timedelta(0)
    assert parse_instant(instant_text(parse_instant(text))) == utc


def test_a_zone_beyond_the_calendar_is_refused():
    with pytest.raises(ValueError, match="do not fit"):
        parse_instant(datetime(1, 1, 1, tzinfo=timezone(timedelta(hours=5))))


def test_start_is_exact_to_the_microsecond(lab):
    # 2014-05-12T13:00:00Z is 1 399 899 600 s after 1970 (`date -u -d ... +%s`)
    run = run_with(lab, started_at="2014-05-12T13:00:00.123457Z")
    assert run.start_us == 1_399_899_600_123_457
    assert instant_of(run.start_us) == run.started_at


def test_models_are_frozen_and_come_back_from_what_they_write(lab):
    run = Run.from_yaml(lab.files["run"])
    with pytest.raises(ValidationError, match="frozen"):
        run.unit = "B"
    assert Run.from_data(run.model_dump(mode="json"), "run.yaml") == run
    record = CalibrationRecord.from_yaml(lab.files["calibration"])
    written = lab.files["calibration"].with_name("again.yaml")
    written.write_text(dump_yaml(record.model_dump(mode="json")))
    assert CalibrationRecord.from_yaml(written) == record


def test_record_states_defaults_where_it_is_silent(lab):
    record = CalibrationRecord.from_yaml(lab.files["calibration"])
    stated = record.stated_uncertainty
    assert stated.scale_factor_rel == (2e-5,) * 4  # the record's own
    assert stated.axis_rad == (DEFAULT_UNCERTAINTY["axis_rad"].value,) * 4
    # 1 deg/h through 0.075 V/(deg/s) is 0.075 / 3600 V
    assert stated.bias[0] == pytest.approx(0.075 / 3600, rel=1e-15)
    assert record.stated_noise.bias_instability_deg_h == (DEFAULT_NOISE["bias_instability_deg_h"].value,) * 4
    assert record.noise is None
    assert record.n == 4


def test_a_record_of_negative_scale_factor_has_a_positive_default_uncertainty():
    data = record_of([[1, 0, 0]], None)
    data["scale_factor_V_per_deg_s"] = [-2.0]
    assert CalibrationRecord.from_data(data, "f").stated_uncertainty.bias == (2.0 / 3600,)


def record_of(axes, matrix):
    n = len(axes) if axes else len(matrix[0])
    data = {
        "schema": "fogreduce/calibration/1",
        "unit": "U",
        "version": "1a",
        "valid_from": "2012-06-01T00:00:00Z",
        "procedure": "none",
        "scale_factor_V_per_deg_s": [1.0] * n,
        "bias_V": [0.0] * n,
    }
    return data | ({"axes": axes} if axes else {}) | ({"H": matrix} if matrix else {})


@pytest.mark.parametrize(
    ("axes", "matrix"),
    [
        ([[0, 0.6, 0.8]], None),
        ([[1, 0, 0], [0, 1, 0]], None),
        (None, [[1, 0, 0], [0, 1, 0], [0, 0, 1]]),
        (None, [[0.5] * 6, [0.5, -0.5] * 3, [0.5, 0.5, -0.5] * 2]),
        (None, [[1e-6, 0, 0], [0, 1e6, 0], [1, 1, 1e-3]]),  # badly scaled, yet of rank 3
    ],
)
def test_any_number_of_gyros(axes, matrix):
    record = CalibrationRecord.from_data(record_of(axes, matrix), "f")
    assert record.n == len(axes or matrix[0])


@pytest.mark.parametrize(
    ("axes", "matrix", "key"),
    [
        ([[0, 0.6, 0.7]], None, "axes[0]"),
        ([[1, 0, 0], [0, 1, 0], [0, 0, 1]], None, "axes"),
        (None, [[1, 0], [0, 1], [0, 0]], "H"),
        ([[1, 0, 0]], [[1], [0], [0]], "H"),
        (None, [[1, 2, 3], [4, 5, 6], [7, 8, 9]], "H"),  # rank 2: the middle row is the mean of the others
    ],
)
def test_geometry_that_does_not_fit(axes, matrix, key):
    with pytest.raises(BadInput) as error:
        CalibrationRecord.from_data(record_of(axes, matrix), "f")
    assert key in [fault.where for fault in error.value.faults]


def test_validity_includes_both_ends(lab):
    record = CalibrationRecord.from_yaml(lab.files["calibration"])
    tick = timedelta(microseconds=1)
    assert record.is_valid_at(record.valid_from)
    assert record.is_valid_at(record.valid_until)
    assert not record.is_valid_at(record.valid_from - tick)
    assert not record.is_valid_at(record.valid_until + tick)


def test_campaign_and_curves(lab):
    campaign = Campaign.from_yaml(lab.files["campaign"])
    assert campaign.captures_from.simulate.seed == 3
    assert campaign.label == "reconstruction"
    assert Campaign.from_data({}, "f") == Campaign()
    curves = Curves.from_yaml(lab.files["curves"])
    assert curves.n == 2
    assert curves.unstable[0].gyros == (1, 2)


def test_effects_file_of_the_contract():
    entries = [
        {"effect": "bias_ramp", "channels": ["gyro2"], "runs": ["*"], "parameters": {"deg_h_per_h": 1.2}},
        {"effect": "table_rate_error", "channels": ["table"], "runs": ["*"], "parameters": {"ppm": 35}},
    ]
    effects = EffectsFile.from_data({"schema": "fogreduce/effects/1", "effects": entries}, "f")
    assert effects.effects[1].parameters == {"ppm": 35}
    assert EffectsFile.from_data({"schema": "fogreduce/effects/1", "effects": []}, "f").effects == ()


def test_config_reads_the_text_that_snakemake_hands_on():
    config = WorkflowConfig.from_data(
        {
            "results_dir": "r",
            "figures": {"enabled": "false"},
            "reduction": {"outliers": {"threshold_sigma": "9"}},
        },
        "--config",
    )
    assert config.figures.enabled is False
    assert config.reduction.outliers.threshold_sigma == 9
    assert config.reduction.block_records == 65536


def test_config_faults_are_all_told():
    data = {
        "campaign_dir": "x",
        "campaigns": ["../x"],
        "figures": {"formats": ["pdf"]},
        "reduction": {
            "block_records": 0,
            "storage": {"compression": "gzip"},
            "outliers": {"threshold_sigma": math.nan},
            "unstable": {"threshold": 1},
        },
    }
    with pytest.raises(BadInput) as error:
        WorkflowConfig.from_data(data, "config.yaml")
    assert {fault.where for fault in error.value.faults} == {
        "campaign_dir",
        "campaigns[0]",
        "figures.formats[0]",
        "reduction.block_records",
        "reduction.storage.chunk_records",
        "reduction.outliers.threshold_sigma",
        "reduction.unstable.threshold",
    }


def test_withheld_settings_are_handed_on():
    assert WorkflowConfig.from_data({"withheld": {"any": [1]}}, "f").withheld == {"any": [1]}


def models(cls=Model):
    for child in cls.__subclasses__():
        yield child
        yield from models(child)


def test_every_key_that_a_user_writes_is_described():
    silent = [
        dotted((model.__name__, name))
        for model in models()
        if model.__module__.startswith("fogreduce.metadata.") and not model.__name__.startswith("Stated")
        for name, info in model.model_fields.items()
        if not info.description
    ]
    assert silent == []


@pytest.mark.skipif(not SHARED.is_dir(), reason="the shared example campaigns are not on this machine")
def test_the_example_campaigns_load():
    from fogreduce.metadata.folder import cross_check, list_campaigns, list_runs, load_calibration, load_run

    seen = 0
    for name in ("practice", "real"):
        for campaign in list_campaigns(SHARED / name / "campaigns"):
            for folder in list_runs(campaign):
                run = load_run(folder)
                record, _ = load_calibration(SHARED / name / "calibrations", run.calibration)
                cross_check(run, record, folder)
                seen += 1
    assert seen == 42


@pytest.mark.parametrize(
    ("results", "raw"),
    [("data/results", "campaigns_dir"), ("data", "campaigns_dir"), ("records/results", "calibrations_dir")],
)
def test_results_among_the_raw_data_are_refused(results: str, raw: str) -> None:
    data = {"campaigns_dir": "./data/", "calibrations_dir": "records", "results_dir": results}
    with pytest.raises(BadInput) as told:
        WorkflowConfig.from_data(data, "configuration")
    expected = f"a folder of its own, apart from {raw}"
    assert str(told.value) == f"configuration: results_dir: found {results}; expected {expected}"


def test_every_pattern_is_told_in_words() -> None:
    """Schemas take patterns from one place, which has words for each."""
    patterns = {value for name, value in vars(patterns_module).items() if name.endswith("_PATTERN")}
    assert patterns == set(IN_WORDS)
    for path in Path(fogreduce.__file__).parent.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.Call) and ast.unparse(node.func).endswith("Field"):
                given = [word.value for word in node.keywords if word.arg == "pattern"]
                assert all(isinstance(value, ast.Name) for value in given), (path, node.lineno)
