"""Tools that others wrote accept our bags: bagit, rocrate, a JSON-LD parser, and for traces prov."""

import json
import subprocess
import sys

import bagit
import pytest
import rdflib
from archived_lab import CAMPAIGN, RUNS
from rocrate.rocrate import ROCrate

SCHEMA = rdflib.Namespace("http://schema.org/")


def test_bagit_accepts_it(archived):
    bag = bagit.Bag(str(archived.bag))
    assert bag.is_valid()
    bag.validate()
    assert bag.version_info == (1, 0)
    assert bag.algorithms == ["sha256"]


def test_bagit_on_the_command_line_accepts_it(archived):
    done = subprocess.run([sys.executable, bagit.__file__, "--validate", archived.bag], check=False)
    assert done.returncode == 0


def test_bagit_refuses_a_bag_that_was_changed(bag):
    """So that its yes means something."""
    path = bag / "data" / "archive.json"
    path.write_bytes(path.read_bytes().replace(b"c1", b"c2", 1))
    with pytest.raises(bagit.BagValidationError):
        bagit.Bag(str(bag)).validate()


def test_rocrate_reads_the_crate(archived):
    crate = ROCrate(archived.bag / "data")
    assert crate.mainEntity.id == "software/Snakefile"
    assert "ComputationalWorkflow" in crate.mainEntity.type
    actions = [entity for entity in crate.contextual_entities if entity.type == "CreateAction"]
    assert len(actions) == len(RUNS)
    for action in actions:
        names = {entity.id for entity in action["object"]}
        assert any(name.endswith("capture.fogcap") for name in names)
        assert any(entity.id.endswith("tables/drift.csv") for entity in action["result"])
    parts = {entity.id for entity in crate.root_dataset["hasPart"]}
    there = {path.relative_to(archived.bag / "data").as_posix() for path in archived.bag.glob("data/**/*.*")}
    assert {name for name in there if "." in name.rpartition("/")[2]} - {"ro-crate-metadata.json"} <= parts


def test_a_json_ld_parser_reads_the_crate(archived):
    """The context lies on the web; here one that says no more than that the words are schema.org's."""
    data = json.loads((archived.bag / "data" / "ro-crate-metadata.json").read_text())
    assert data["@context"] == "https://w3id.org/ro/crate/1.1/context"
    data["@context"] = {"@vocab": str(SCHEMA), "File": str(SCHEMA.MediaObject)}
    graph = rdflib.Graph().parse(data=json.dumps(data), format="json-ld", publicID="file:///crate/")
    root = rdflib.URIRef("file:///crate/")
    files = set(graph.subjects(rdflib.RDF.type, SCHEMA.MediaObject))
    assert set(graph.objects(root, SCHEMA.hasPart)) == files
    for run_id in RUNS:
        table = rdflib.URIRef(f"file:///crate/results/{CAMPAIGN}/{run_id}/tables/drift.csv")
        (action,) = graph.subjects(SCHEMA.result, table)
        assert (action, rdflib.RDF.type, SCHEMA.CreateAction) in graph
        capture = rdflib.URIRef(f"file:///crate/campaigns/{CAMPAIGN}/runs/{run_id}/capture.fogcap")
        assert (action, SCHEMA.object, capture) in graph
        assert capture in files
