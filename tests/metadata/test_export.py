"""Generated files are in sync with the models, and say the same."""

import itertools
import json
from pathlib import Path

import jsonschema
import pytest
import yaml

from fogreduce.metadata.config import WorkflowConfig
from fogreduce.metadata.export import SCHEMAS, default_config_text, generated_files, schema_text, write
from fogreduce.metadata.yaml12 import load_yaml

ROOT = Path(__file__).resolve().parents[2]


@pytest.mark.parametrize("path", sorted(generated_files()))
def test_committed_files_are_in_sync(path):
    again = "run `python -m fogreduce.metadata.export`"
    assert (ROOT / path).read_text(encoding="utf-8") == generated_files()[path], again


def test_default_configuration_holds_the_defaults():
    data = yaml.safe_load(default_config_text())  # Snakemake reads it as YAML 1.1
    assert WorkflowConfig.from_data(data, "config.yaml") == WorkflowConfig()
    assert load_yaml(ROOT / "workflow" / "config.yaml") == data


def test_every_key_of_the_configuration_has_its_comment():
    lines = default_config_text().splitlines()
    for before, line in itertools.pairwise(lines):
        if ":" in line and not line.lstrip().startswith("#"):
            assert before.lstrip().startswith("# ")


@pytest.mark.parametrize("kind", ["run", "calibration", "campaign", "curves"])
def test_schemas_take_what_the_models_take(lab, kind):
    schema = json.loads(schema_text(SCHEMAS[kind]))
    jsonschema.Draft202012Validator.check_schema(schema)
    data = load_yaml(lab.files[kind])
    jsonschema.validate(data, schema)
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate({**data, "unknown": 1}, schema)


def test_schema_lets_a_run_leave_its_calibration_to_the_campaign(lab):
    data = load_yaml(lab.files["run"])
    del data["calibration"]
    jsonschema.validate(data, json.loads(schema_text(SCHEMAS["run"])))


def test_write(tmp_path):
    write(tmp_path)
    assert all(
        (tmp_path / path).read_text(encoding="utf-8") == text for path, text in generated_files().items()
    )
