"""From every cell back to bytes whose hash verifies."""

import json
import re
import shutil

import pytest
from archived_lab import CAMPAIGN, RUNS, sha256_of
from prov import model
from small_unit import call, succeed

from fogreduce.cli.stage import STAGES as STAGES_THAT_RUN
from fogreduce.errors import BadInput
from fogreduce.provenance.cell import CellName, error_columns, read_table, row_names
from fogreduce.provenance.code import code_digest
from fogreduce.provenance.stages import STAGES, stages_of
from fogreduce.trace.chain import Hashes, trace
from fogreduce.trace.places import run_places
from fogreduce.trace.prov import prov


def cells(results):
    """Names of all cells of all tables of a run."""
    for table in sorted((results / "tables").glob("*.csv")):
        header, rows = read_table(table)
        for row in row_names(header, rows):
            for column in header:
                yield f"{table.name}:{row}:{column}"


def places_of(archived, kind):
    """The runs as they lie in the bag, or in the results."""
    place = archived.bag if kind == "bag" else archived.results
    return run_places(place, archived.campaigns, archived.calibrations)


@pytest.mark.parametrize("kind", ["bag", "results"])
def test_every_cell_ends_at_bytes_whose_hash_verifies(archived, kind):
    hashes = Hashes()
    count = 0
    # Outside a bag the source at hand is the one that runs, which others may be working on.
    unsettled = kind == "results" and code_digest() != archived.code()
    for place in places_of(archived, kind):
        for name in cells(place.results):
            found = trace(place, CellName.parse(name), hashes)
            capture = found["capture"]
            assert capture["verified"]
            path = archived.campaigns / CAMPAIGN / "runs" / place.manifest.run_id / "capture.fogcap"
            assert capture["sha256"] == hashes.of(path)
            assert capture["bytes"] == path.stat().st_size
            assert found["calibration"]["verified"]
            assert found["code"]["source_at_hand"] or unsettled
            assert all(stage["code_sha256"] for stage in found["stages"]) or unsettled
            table, _, column = name.split(":")
            lines = (place.results / "tables" / table).read_text().splitlines()
            fields = dict(zip(lines[0].split(","), lines[found["cell"]["line"] - 1].split(","), strict=True))
            assert fields[column] == found["cell"]["value"]
            count += 1
    assert count > 300


def test_the_text_names_value_uncertainty_stages_record_and_capture(archived):
    out = succeed("trace", archived.bag, "r1:drift.csv:x@1:drift_deg_h")
    row = read_table(archived.results / CAMPAIGN / "r1" / "tables" / "drift.csv")
    fields = dict(zip(row[0], row[1][0], strict=True))
    capture = archived.bag / "data/campaigns" / CAMPAIGN / "runs/r1/capture.fogcap"
    for words in (
        fields["drift_deg_h"],
        fields["drift_err_deg_h"],
        fields["version_id"],
        "edge_guard_s",
        "certificate 7",
        "TETRA-01@2012a",
        sha256_of(capture),
        str(capture.stat().st_size),
        "2014-05-12T13:00:00Z",
        *(f"from stage {stage}" for stage in STAGES),
    ):
        assert words in out, words


def test_a_table_of_raw_volts_does_not_come_from_the_later_stages():
    assert stages_of("gyro_fit.csv") == ["ingest", "fit"]
    assert stages_of("drift.csv") == list(STAGES)


def test_the_stages_are_those_of_the_workflow(repository):
    """What each stage writes, as its rule says."""
    assert list(STAGES) == list(STAGES_THAT_RUN)
    rules = (repository / "workflow/rules/reduction.smk").read_text()
    for stage, facts in STAGES.items():
        rule = re.search(rf"^rule {stage}:.*?output:(.*?)log:", rules, re.DOTALL | re.MULTILINE)
        assert tuple(re.findall(r'run_file\("([^"]+)"\)', rule[1])) == facts.writes


def test_prov_names_only_what_it_declares(archived):
    document = json.loads(succeed("trace", archived.bag, "r1:rate_fit.csv:y@2:a_deg_s", "--format", "prov"))
    for relation, one, other in (
        ("used", ("prov:activity", "activity"), ("prov:entity", "entity")),
        ("wasGeneratedBy", ("prov:entity", "entity"), ("prov:activity", "activity")),
        ("wasAssociatedWith", ("prov:activity", "activity"), ("prov:agent", "agent")),
        ("wasDerivedFrom", ("prov:generatedEntity", "entity"), ("prov:usedEntity", "entity")),
    ):
        assert document[relation]
        for item in document[relation].values():
            for key, kind in (one, other):
                assert item[key] in document[kind]
    # From the cell, each step made by one activity out of what it used, down to the capture.
    made = {item["prov:entity"]: item["prov:activity"] for item in document["wasGeneratedBy"].values()}
    reached, todo = set(), [next(e for e in document["entity"] if "/cell/" in e)]
    while todo:
        entity = todo.pop()
        if entity in reached:
            continue
        reached.add(entity)
        todo += [
            item["prov:usedEntity"]
            for item in document["wasDerivedFrom"].values()
            if item["prov:generatedEntity"] == entity and "/cell/" in entity
        ]
        todo += [
            item["prov:entity"]
            for item in document["used"].values()
            if item["prov:activity"] == made.get(entity)
        ]
    assert any(document["entity"][entity].get("prov:type") == "fog:capture" for entity in reached)


def test_prov_is_read_by_a_third_party(archived):
    place = places_of(archived, "bag")[0]
    text = json.dumps(prov(trace(place, CellName.parse("drift.csv:x@1:drift_deg_h"))))
    document = model.ProvDocument.deserialize(content=text, format="json")
    assert len(list(document.get_records(model.ProvActivity))) == 6


def test_one_run_s_own_folder_will_do(archived):
    out = succeed(
        *("trace", archived.results / CAMPAIGN / "r1", "quality.csv:records:count"),
        *("--campaigns", archived.campaigns, "--calibrations", archived.calibrations),
    )
    assert "1120" in out


@pytest.mark.parametrize(
    ("cell", "said"),
    [
        ("drift.csv:x@1:drift_deg_h", "2 runs"),
        ("r3:drift.csv:x@1:drift_deg_h", "r3"),
        ("r1:drift.csv:x:drift_deg_h", "x@1"),
        ("r1:drift.csv:w:drift_deg_h", "0 rows w"),
        ("r1:drift.csv:x@1:drift", "no column drift"),
        ("r1:more.csv:x:a", "gyro_fit.csv"),
        ("r1:../drift.csv:x:a", "CELL"),
        ("drift", "CELL"),
        ("r1:drift.csv:x@1#2:drift_deg_h", "x@1#2"),
    ],
)
def test_a_cell_that_is_not_there(archived, cell, said):
    status, out, err = call("trace", archived.bag, cell)
    assert status == 2
    assert said in err
    assert len(err.splitlines()) == 1
    assert out == ""


@pytest.mark.parametrize(
    "name",
    [
        "results/c1/r1/tables/drift.csv",
        "campaigns/c1/runs/r1/capture.fogcap",
        "calibrations/TETRA-01/2012a.yaml",
    ],
)
def test_a_chain_that_is_broken_is_said_to_be(bag, name):
    path = bag / "data" / name
    raw = bytearray(path.read_bytes())
    raw[-2] ^= 1
    path.write_bytes(raw)
    place = run_places(bag, bag, bag)[0]
    with pytest.raises(BadInput, match=re.escape(str(path))):
        trace(place, CellName.parse("drift.csv:x@1:drift_deg_h"))


def test_results_whose_inputs_are_gone(archived, tmp_path):
    shutil.copytree(archived.results, tmp_path / "results")
    places = ("--campaigns", tmp_path / "none", "--calibrations", archived.calibrations)
    status, _, err = call("trace", tmp_path / "results", f"{RUNS[0]}:quality.csv:records:count", *places)
    assert status == 2
    assert "no such file" in err


def test_each_column_finds_its_errors():
    header = [
        "axis",
        "a_V",
        "a_err_V",
        "a_err_coloured_V",
        "e_V_s",
        "e_err_V_s",
        "accumulated_error_deg",
        "accumulated_err_deg",
    ]
    assert error_columns("a_V", header) == ["a_err_V", "a_err_coloured_V"]
    assert error_columns("e_V_s", header) == ["e_err_V_s"]
    assert error_columns("accumulated_error_deg", header) == ["accumulated_err_deg"]
    assert error_columns("a_err_V", header) == []


def test_rows_that_share_a_name_are_numbered():
    rows = [["gyro1", "0"], ["gyro1", "5"], ["gyro2", "1"]]
    assert row_names(["gyro", "start_s"], rows) == ["gyro1#1", "gyro1#2", "gyro2"]
