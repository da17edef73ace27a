"""`fogreduce summary`: what the tables of runs say is copied to the letter; a run without them is listed."""

import csv
import json
import time
from pathlib import Path

import pytest

from fogreduce.cli.main import main

DRIFT = "axis,duration_s,drift_deg_h,segment,version_id"
RATES = "axis,a_deg_s,records,segment,version_id"


def make_run(results: Path, campaign: str, run_id: str, *, label: str | None = None, version="v1") -> Path:
    """A run's results as the reduction leaves them, as far as the summary reads them."""
    folder = results / campaign / run_id
    (folder / "tables").mkdir(parents=True)
    manifest = {"schema": "fogreduce/manifest/1", "version_id": version, "campaign": campaign}
    (folder / "manifest.json").write_text(json.dumps(manifest | {"run_id": run_id, "label": label}))
    drift = [f"{axis},6000,2.76499304992087,1,{version}" for axis in "xyz"]
    (folder / "tables" / "drift.csv").write_text("\n".join([DRIFT, *drift]) + "\n")
    rates = [f"{axis},0.0621051926624891,767676,1,{version}" for axis in "xyz"]
    (folder / "tables" / "rate_fit.csv").write_text("\n".join([RATES, *rates]) + "\n")
    return folder


def make_failed(results: Path, campaign: str, run_id: str, **logs: str) -> Path:
    folder = results / campaign / run_id
    (folder / "logs").mkdir(parents=True)
    for stage, text in logs.items():
        (folder / "logs" / f"{stage}.log").write_text(text)
    return folder


def rows(path: Path) -> list[dict[str, str]]:
    with path.open(newline="") as file:
        return list(csv.DictReader(file))


def listed(path: Path, *runs: tuple[str, str]) -> str:
    path.write_text(json.dumps(runs))
    return str(path)


@pytest.mark.parametrize(("names", "failed"), [((), ["c1", "c2"]), (("c2",), ["c2"])])
def test_the_runs_of_campaigns_are_those_that_results_should_hold(tmp_path, names, failed):
    """However many runs there are, the command line stays short."""
    results, out, campaigns = tmp_path / "results", tmp_path / "out", tmp_path / "campaigns"
    for campaign in ("c1", "c2"):
        make_run(results, campaign, "r1")
        make_run(results, campaign, "not-asked-for")
        for run in ("r1", "r2"):
            (campaigns / campaign / "runs" / run).mkdir(parents=True)
    asked = ["--campaigns", str(campaigns), *names]
    assert main(["summary", "--results", str(results), "--out", str(out), *asked]) == 0
    assert {(row["campaign"], row["run_id"]) for row in rows(out / "drift_all.csv")} == {
        (campaign, "r1") for campaign in failed
    }
    assert [(row["campaign"], row["run_id"]) for row in rows(out / "failed.csv")] == [
        (campaign, "r2") for campaign in failed
    ]


def test_gathers_in_the_order_of_the_list(tmp_path):
    results, out = tmp_path / "results", tmp_path / "out"
    make_run(results, "c2", "r1", label="a reconstruction, not a recording")
    make_run(results, "c1", "r9")
    runs = listed(tmp_path / "runs.json", ("c2", "r1"), ("c1", "r9"))
    assert main(["summary", "--results", str(results), "--runs", runs, "--out", str(out)]) == 0
    drift = rows(out / "drift_all.csv")
    assert list(drift[0]) == ["campaign", "run_id", "label", *DRIFT.split(",")]
    assert [(row["campaign"], row["run_id"], row["axis"]) for row in drift] == [
        *(("c2", "r1", axis) for axis in "xyz"),
        *(("c1", "r9", axis) for axis in "xyz"),
    ]
    assert drift[0]["label"] == "a reconstruction, not a recording"
    assert drift[3]["label"] == ""
    assert drift[0]["drift_deg_h"] == "2.76499304992087"
    rates = rows(out / "rates_all.csv")
    assert list(rates[0]) == ["campaign", "run_id", "label", *RATES.split(",")]
    assert len(rates) == 6
    assert (out / "failed.csv").read_text() == "campaign,run_id,stage,reason\n"


def test_failed_runs_and_why(tmp_path, capsys):
    """By the first log that says something; several faults on one line; a traceback by its last line."""
    results, out = tmp_path / "results", tmp_path / "out"
    make_run(results, "c1", "good")
    make_failed(results, "c1", "bad", manifest="a.yaml: found 1; expected 2\nb.yaml: found 3; expected 4\n")
    make_failed(
        results, "c1", "burst", manifest="", ingest='Traceback (most recent)\n  File "x"\nKeyError: 1\n'
    )
    make_failed(results, "c1", "idle", manifest="")
    assert main(["summary", "--results", str(results), "--out", str(out)]) == 0
    assert capsys.readouterr().out == f"{out}: 1 runs gathered, 3 without tables (failed.csv)\n"
    found = [(row["run_id"], row["stage"], row["reason"]) for row in rows(out / "failed.csv")]
    manifest = f"{results}/c1/idle/manifest.json: found no such file; expected the run's manifest"
    assert found == [
        ("bad", "manifest", "a.yaml: found 1; expected 2 | b.yaml: found 3; expected 4"),
        ("burst", "ingest", "KeyError: 1"),
        ("idle", "", manifest),
    ]
    assert {row["run_id"] for row in rows(out / "drift_all.csv")} == {"good"}


def test_a_long_reason_is_cut_and_says_so(tmp_path):
    make_failed(tmp_path, "c1", "r1", manifest="fault " * 200)
    assert main(["summary", "--results", str(tmp_path), "--out", str(tmp_path / "out")]) == 0
    (row,) = rows(tmp_path / "out" / "failed.csv")
    assert row["reason"].startswith("fault fault")
    assert row["reason"].endswith(" ...")


def test_a_run_that_never_began(tmp_path):
    """Listed, but without a folder."""
    runs = listed(tmp_path / "runs.json", ("c1", "r1"))
    out = tmp_path / "out"
    assert main(["summary", "--results", str(tmp_path), "--runs", runs, "--out", str(out)]) == 0
    assert [row["run_id"] for row in rows(out / "failed.csv")] == ["r1"]
    assert (out / "drift_all.csv").read_text() == "campaign,run_id,label\n"


def test_tables_of_another_version_are_not_mixed_in(tmp_path):
    results, out = tmp_path / "results", tmp_path / "out"
    folder = make_run(results, "c1", "r1", version="old")
    manifest = json.loads((folder / "manifest.json").read_text())
    (folder / "manifest.json").write_text(json.dumps(manifest | {"version_id": "new"}))
    assert main(["summary", "--results", str(results), "--out", str(out)]) == 0
    (row,) = rows(out / "failed.csv")
    assert row["reason"] == f"{folder}/tables/drift.csv: found rows of another version; expected new"


def test_another_header_is_refused(tmp_path, capsys):
    """Rows under one header must mean the same: nothing is written."""
    results, out = tmp_path / "results", tmp_path / "out"
    make_run(results, "c1", "r1")
    path = make_run(results, "c1", "r2") / "tables" / "drift.csv"
    path.write_text(path.read_text().replace("drift_deg_h", "drift_rad_s"))
    assert main(["summary", "--results", str(results), "--out", str(out)]) == 2
    found = DRIFT.replace("drift_deg_h", "drift_rad_s")
    assert capsys.readouterr().err == f"{path}: line 1: found {found}; expected {DRIFT}\n"
    assert list(out.iterdir()) == []


def test_results_of_single_runs(small_lab, capsys):
    """As `reduce --out` leaves them: campaign and run are told by the manifest."""
    assert main(small_lab.reduce()) == 0
    out = small_lab.root / "summary"
    assert main(["summary", str(small_lab.out), "--out", str(out)]) == 0
    drift = rows(out / "drift_all.csv")
    assert [(row["campaign"], row["run_id"], row["axis"]) for row in drift] == [
        ("c1", "r1", axis) for axis in "xyz"
    ]
    table = (small_lab.out / "tables" / "rate_fit.csv").read_text().splitlines()
    expected = [f"campaign,run_id,label,{table[0]}", *(f"c1,r1,,{line}" for line in table[1:])]
    assert (out / "rates_all.csv").read_text().splitlines() == expected


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("[1]", "[0]: found 1; expected [campaign, run_id]"),
        ('{"a": 1}', "found dict; expected a JSON list of [campaign, run_id]"),
        ("[", "found Expecting value: line 1 column 2 (char 1); expected a JSON list of [campaign, run_id]"),
    ],
)
def test_bad_list(tmp_path, capsys, text, said):
    path = tmp_path / "runs.json"
    path.write_text(text)
    assert (
        main(["summary", "--results", str(tmp_path), "--runs", str(path), "--out", str(tmp_path / "o")]) == 2
    )
    assert capsys.readouterr().err == f"{path}: {said}\n"


def test_nothing_to_gather(tmp_path, capsys):
    assert main(["summary", "--results", str(tmp_path), "--out", str(tmp_path / "o")]) == 2
    assert capsys.readouterr().err == "RESULTS: found no run; expected results of at least one run\n"


def test_a_thousand_runs(tmp_path):
    """Well under two seconds: processor time, so that a busy machine does not fail the test."""
    results = tmp_path / "results"
    for number in range(1000):
        make_run(results, "c1", f"r{number:04}")
    before = time.process_time()
    assert main(["summary", "--results", str(results), "--out", str(tmp_path / "out")]) == 0
    assert time.process_time() - before < 1.5
    assert len(rows(tmp_path / "out" / "drift_all.csv")) == 3000
