"""A bag is written whole, the same bytes for the same results, and only of results that are unchanged."""

import hashlib
import json
import re
import shutil
from pathlib import Path

import pytest
from archived_lab import CAMPAIGN, RUNS, sha256_of
from small_unit import call, succeed

from fogreduce.archive.software import source_files, source_folder
from fogreduce.provenance.code import code_digest, digest_of, reduction_parts


def test_the_same_results_give_the_same_bytes(archived, tmp_path):
    assert archived.archive(tmp_path) == archived.digest
    again = {p.relative_to(tmp_path / CAMPAIGN): sha256_of(p) for p in files(tmp_path / CAMPAIGN)}
    assert again == {p.relative_to(archived.bag): sha256_of(p) for p in files(archived.bag)}


def test_the_digest_is_that_of_the_tag_manifest(archived):
    raw = (archived.bag / "tagmanifest-sha256.txt").read_bytes()
    assert hashlib.sha256(raw).hexdigest() == archived.digest


def test_all_that_is_needed_to_redo_it_lies_there(archived):
    data = archived.bag / "data"
    for run_id in RUNS:
        for name in ("run.yaml", "capture.fogcap"):
            source = archived.campaigns / CAMPAIGN / "runs" / run_id / name
            kept = data / "campaigns" / CAMPAIGN / "runs" / run_id / name
            assert kept.read_bytes() == source.read_bytes()
        for name in (
            "manifest.json",
            "outputs.json",
            "tables/drift.csv",
            "datasets/ingest.nc",
            "reports/fit.json",
        ):
            kept = data / "results" / CAMPAIGN / run_id / name
            assert kept.read_bytes() == (archived.results / CAMPAIGN / run_id / name).read_bytes()
    for name in ("requirements.lock", "Snakefile", "workflow/rules/reduction.smk", "fogreduce/stages/fit.py"):
        assert (data / "software" / name).is_file()
    assert (data / "calibrations" / "TETRA-01" / "2012a.yaml").is_file()


def test_the_code_hash_can_be_told_from_archived_sources():
    root = source_folder(None)
    sources = {
        name.removeprefix("fogreduce/"): root / name
        for name in source_files(root)
        if name.startswith("fogreduce/")
    }
    assert digest_of(sources, reduction_parts()) == code_digest()


def test_the_archive_is_no_part_of_the_code_that_numbers_come_from():
    parts = reduction_parts()
    assert [part for part in parts if part.partition("/")[0] in ("archive", "reruns", "trace")] == []
    inside = [part for part in parts if part.startswith("provenance")]
    assert inside == [
        f"provenance/{name}.py" for name in ("__init__", "code", "digest", "manifest", "manifest_file")
    ]


@pytest.mark.parametrize(
    ("spoil", "said"),
    [
        (lambda lab: edit(lab / "tables" / "drift.csv", b"x,", b"y,"), "drift.csv"),
        (lambda lab: (lab / "tables" / "drift.csv").unlink(), "drift.csv"),
        (lambda lab: (lab / "tables" / "more.csv").write_text("a\n"), "more.csv"),
        (lambda lab: (lab / "outputs.json").unlink(), "outputs.json"),
        (
            lambda lab: edit(lab / "manifest.json", b'"edge_guard_s": 0.5', b'"edge_guard_s": 0.6'),
            "version_id",
        ),
    ],
)
def test_results_that_are_not_what_they_were_are_refused(archived, tmp_path, spoil, said):
    results = tmp_path / "results"
    shutil.copytree(archived.results, results)
    spoil(results / CAMPAIGN / "r2")
    arguments = [results if a == archived.results else a for a in archived.arguments(tmp_path / "bags")]
    status, out, err = call(*arguments)
    assert status == 2
    assert said in err
    assert "Traceback" not in err
    assert out == ""
    assert not list((tmp_path / "bags").rglob("*"))


def test_a_capture_that_changed_since_is_refused(archived, tmp_path):
    campaigns = tmp_path / "campaigns"
    shutil.copytree(archived.campaigns, campaigns)
    capture = campaigns / CAMPAIGN / "runs" / "r1" / "capture.fogcap"
    raw = bytearray(capture.read_bytes())
    raw[1000] ^= 1
    capture.write_bytes(raw)
    arguments = [campaigns if a == archived.campaigns else a for a in archived.arguments(tmp_path / "bags")]
    status, _, err = call(*arguments)
    assert status == 2
    assert str(capture) in err
    assert not list((tmp_path / "bags").rglob("*"))


def test_another_code_than_the_results_is_refused(archived, tmp_path):
    source = tmp_path / "source"
    shutil.copytree(archived.source, source)
    edit(source / "fogreduce" / "units.py", b"", b"ANOTHER = 1\n")
    arguments = [source if a == archived.source else a for a in archived.arguments(tmp_path / "bags")]
    status, _, err = call(*arguments)
    assert status == 2
    assert "code_sha256" in err
    assert not list((tmp_path / "bags").rglob("*"))


@pytest.mark.parametrize("name", ["Snakefile", "requirements.lock"])
def test_a_source_that_is_not_whole_is_refused(archived, tmp_path, name):
    source = tmp_path / "source"
    shutil.copytree(archived.source, source)
    (source / name).unlink()
    status, _, err = call(*archived.arguments(tmp_path / "bags"), "--source", source)
    assert status == 2
    assert f"no {name}" in err


@pytest.mark.parametrize("of_campaign", ["_diagnosis", "_report"])
def test_what_was_made_of_the_campaign_is_archived_with_its_pages(archived, tmp_path, of_campaign):
    results = tmp_path / "results"
    shutil.copytree(archived.results, results)
    made = results / CAMPAIGN / of_campaign
    made.mkdir()
    (made / "figures").mkdir()
    for name in ("made.json", "index.html", "figures/where.svg", "made.log"):
        (made / name).write_text(f"{name}\n")
    arguments = [results if a == archived.results else a for a in archived.arguments(tmp_path / "bags")]
    succeed(*arguments)
    bag = tmp_path / "bags" / CAMPAIGN
    kept = bag / "data/results" / CAMPAIGN / of_campaign
    names = {path.relative_to(kept).as_posix() for path in files(kept)}
    assert names == {"made.json", "index.html", "figures/where.svg"}
    succeed("verify", bag)


def test_bags_named_by_their_digest_stay(archived, tmp_path):
    name = f"{CAMPAIGN}-{archived.digest[:12]}"
    for _ in range(2):
        out = succeed(*archived.arguments(tmp_path), "--by-digest")
        assert out.split() == [archived.digest, str(tmp_path / name)]
        assert [path.name for path in tmp_path.iterdir()] == [name]
    assert succeed("verify", tmp_path / name, "--expect", archived.digest)


@pytest.mark.parametrize(
    ("more", "said"),
    [(["--only", "c2"], "c2"), (["--only", ""], "--only"), (["--campaigns", "nowhere"], "run.yaml")],
)
def test_what_is_not_there(archived, tmp_path, more, said):
    status, out, err = call(*archived.arguments(tmp_path / "bags"), *more)
    assert status == 2
    assert said in err
    assert "Traceback" not in err
    assert out == ""


def test_a_bag_is_never_written_over(archived):
    status, _, err = call(*archived.arguments(archived.bag.parent))
    assert status == 2
    assert str(archived.bag) in err
    assert succeed("verify", archived.bag, "--expect", archived.digest)


def test_what_a_killed_process_left_is_swept_away(archived, tmp_path):
    left = tmp_path / f".{CAMPAIGN}.999999999.tmp"
    left.mkdir()
    archived.archive(tmp_path)
    assert not left.exists()


def test_every_manifest_of_checksums_has_each_result(archived):
    out = archived.results / CAMPAIGN / "r1"
    outputs = json.loads((out / "outputs.json").read_text())
    named = {entry["name"]: entry["sha256"] for entry in outputs["files"]}
    there = {p.relative_to(out).as_posix() for p in files(out)}
    assert set(named) == {n for n in there if not n.startswith("versions/") and n != "outputs.json"}
    assert all(sha256_of(out / name) == digest for name, digest in named.items())
    assert outputs["machine"]["cpu_features"]
    assert {"numpy", "h5py"} <= set(outputs["machine"]["libraries"])


def files(folder):
    return sorted(path for path in folder.rglob("*") if path.is_file())


def edit(path, old, new):
    raw = path.read_bytes()
    assert old in raw
    path.write_bytes(raw.replace(old, new, 1))


@pytest.fixture
def incomplete(archived, tmp_path):
    """Campaign and results of which a run failed and another was taken out since; where they lie."""
    campaigns, results = tmp_path / "campaigns", tmp_path / "results"
    shutil.copytree(archived.campaigns, campaigns)
    shutil.copytree(archived.results, results)
    shutil.copytree(campaigns / CAMPAIGN / "runs" / "r1", campaigns / CAMPAIGN / "runs" / "r0")
    log = results / CAMPAIGN / "r0" / "logs" / "ingest.log"
    log.parent.mkdir(parents=True)
    log.write_text(f"{campaigns}/{CAMPAIGN}/runs/r0/capture.fogcap: byte 0: found b'X'; expected the magic\n")
    (results / CAMPAIGN / "r0" / "manifest.json").write_text("{}")
    shutil.rmtree(campaigns / CAMPAIGN / "runs" / "r2")
    return campaigns, results


def of_incomplete(archived, campaigns, results, out):
    places = ["--campaigns", campaigns, "--calibrations", archived.calibrations]
    return call("archive", results, *places, "--source", archived.source, "--out", out)


def test_failed_and_removed_runs_are_left_out_and_named(archived, incomplete, tmp_path):
    status, out, err = of_incomplete(archived, *incomplete, tmp_path / "bags")
    assert status == 0, err
    failed = f"ingest: campaigns/{CAMPAIGN}/runs/r0/capture.fogcap: byte 0: found b'X'; expected the magic"
    removed = "taken out of the campaign since it was reduced"
    assert err.splitlines() == [
        f"{CAMPAIGN}: without results of r0: {failed}",
        f"{CAMPAIGN}: without results of r2: {removed}",
    ]
    bag = tmp_path / "bags" / CAMPAIGN
    succeed("verify", bag, "--expect", out.split()[0])
    record = json.loads((bag / "data" / "archive.json").read_text())
    assert [run["run_id"] for run in record["runs"]] == ["r1"]
    assert record["left_out"] == [{"run_id": "r0", "reason": failed}, {"run_id": "r2", "reason": removed}]
    assert f"campaign {CAMPAIGN}, without results of r0, r2" in (bag / "bag-info.txt").read_text()
    # What the campaign has of the failed one is there, and no results of either.
    assert (bag / "data" / "campaigns" / CAMPAIGN / "runs" / "r0" / "capture.fogcap").is_file()
    assert [path.name for path in (bag / "data" / "results" / CAMPAIGN).iterdir()] == ["r1"]


def test_results_whose_checksums_were_not_taken_have_not_failed(archived, incomplete, tmp_path):
    campaigns, results = incomplete
    (results / CAMPAIGN / "r1" / "outputs.json").unlink()
    status, _, err = of_incomplete(archived, campaigns, results, tmp_path / "bags")
    assert status == 2
    assert "r1/outputs.json: found no such file" in err
    assert not (tmp_path / "bags").exists()


def test_the_links_of_its_pages_lead_somewhere(archived, tmp_path):
    results = Path(shutil.copytree(archived.results, tmp_path / "results"))
    succeed("page", "campaign", results / CAMPAIGN, "--campaigns", archived.campaigns)
    succeed(*(results if a == archived.results else a for a in archived.arguments(tmp_path / "bags")))
    kept = tmp_path / "bags" / CAMPAIGN / "data" / "results"
    for page in (kept / "index.html", kept / CAMPAIGN / "index.html"):
        links = re.findall(r'href="([^"#:]+)["#]', page.read_text())
        assert [link for link in links if not (page.parent / link).is_file()] == []
    assert f"{CAMPAIGN}/index.html" in (kept / "index.html").read_text()
    succeed("verify", tmp_path / "bags" / CAMPAIGN)
