"""The workflow as its user meets it: small campaigns through Snakemake, one run of them spoilt."""

import csv
import json
import shlex
import shutil
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

import pytest
from small_campaign import RUN_YAML

ROOT = Path(__file__).parents[2]
SNAKEMAKE = Path(sys.executable).with_name("snakemake")
FOGREDUCE = Path(sys.executable).with_name("fogreduce")

PROFILES = {
    "a-steady": "[{rate_deg_s: 10, duration_s: 20}]",
    "b-steps": "[{rate_deg_s: 0, duration_s: 15}, {rate_deg_s: -10, duration_s: 15}]",
    "c-broken": "[{rate_deg_s: 1, duration_s: 10}]",
}


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Campaign `lab` with captures (one of them spoilt) and campaign `made`, whose captures a rule makes."""
    place = tmp_path_factory.mktemp("workflow")
    for campaign, runs in (("plan", PROFILES), ("made", {"a-steady": PROFILES["a-steady"]})):
        for run_id, profile in runs.items():
            folder = place / "campaigns" / campaign / "runs" / run_id
            folder.mkdir(parents=True)
            (folder / "run.yaml").write_text(RUN_YAML.format(run_id=run_id, profile=profile))
    (place / "campaigns" / "made" / "campaign.yaml").write_text("captures_from: {simulate: {seed: 5}}\n")
    subprocess.run(
        [
            *(FOGREDUCE, "simulate", place / "campaigns" / "plan"),
            *("--calibrations", ROOT / "calibrations"),
            *("--out", place / "campaigns" / "lab", "--seed", "1"),
        ],
        check=True,
        capture_output=True,
    )
    shutil.rmtree(place / "campaigns" / "plan")
    capture = place / "campaigns" / "lab" / "runs" / "c-broken" / "capture.fogcap"
    capture.write_bytes(b"NOT A CAPTURE" + capture.read_bytes()[13:])
    return place


#: How lines begin that Snakemake says before it reads the Snakefile.
OF_SNAKEMAKE = ("Using workflow specific profile", "Config file ")


def snakemake(
    place: Path, *settings: str, dry: bool = False, more: Sequence[str] = ()
) -> subprocess.CompletedProcess[str]:
    """The workflow over the campaigns in `place`, its state kept there too."""
    return subprocess.run(
        [SNAKEMAKE, "--cores", "2", "--snakefile", ROOT / "Snakefile", "--directory", place]
        + ["--workflow-profile", ROOT / "profiles" / "default"]
        + ["--dry-run"] * dry
        + [*more]
        + ["--config", "campaigns_dir=campaigns", f"calibrations_dir={ROOT / 'calibrations'}", *settings],
        capture_output=True,
        text=True,
        check=False,
    )


@pytest.fixture(scope="module")
def first(place: Path) -> subprocess.CompletedProcess[str]:
    return snakemake(place)


def test_a_failed_run_stops_no_other_and_the_end_says_why(
    place: Path, first: subprocess.CompletedProcess[str]
) -> None:
    assert first.returncode == 1
    results = place / "results"
    for run in ("lab/a-steady", "lab/b-steps", "made/a-steady"):
        assert (results / run / "tables" / "drift.csv").exists(), first.stderr
        assert list((results / run / "figures").glob("*.png"))
    assert not (results / "lab/c-broken/tables").exists()
    end = first.stderr[first.stderr.index("These runs are not reduced:") :]
    (line,) = [line for line in end.splitlines() if "lab/c-broken" in line and "found" in line]
    assert "byte 0" in line
    assert "FOGCAP1" in line
    # The campaign's page has it too; runs that are reduced have pages of their own.
    page = (results / "lab/index.html").read_text()
    assert "1 failed" in page
    assert "byte 0: found" in page
    assert '"../../index.html#unit-TETRA-01"' in (results / "lab/a-steady/index.html").read_text()
    assert (results / "_units/TETRA-01.html").is_file()
    assert not (results / "lab/c-broken/index.html").exists()
    assert "lab/index.html" in (results / "index.html").read_text()


def test_tables_are_those_of_reduce_to_the_byte(
    place: Path, first: subprocess.CompletedProcess[str], tmp_path: Path
) -> None:
    for run in ("a-steady", "b-steps"):
        out = tmp_path / run
        subprocess.run(
            [
                *(FOGREDUCE, "reduce", place / "campaigns/lab/runs" / run),
                *("--calibrations", ROOT / "calibrations", "--out", out),
            ],
            check=True,
        )
        tables = sorted((out / "tables").iterdir())
        assert len(tables) >= 6
        for table in tables:
            assert table.read_bytes() == (place / "results/lab" / run / "tables" / table.name).read_bytes()
        manifest = json.loads((out / "manifest.json").read_text())
        assert manifest == json.loads((place / "results/lab" / run / "manifest.json").read_text())


def test_segments_have_rows_of_their_own_and_the_whole_run_has_one(
    place: Path, first: subprocess.CompletedProcess[str]
) -> None:
    with (place / "results/lab/b-steps/tables/drift.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [row["segment"] for row in rows] == ["1"] * 3 + ["2"] * 3 + ["all"] * 3
    whole = next(row for row in rows if row["segment"] == "all" and row["axis"] == "x")
    # 15 s at rest, then 15 s at -10 deg/s about x.
    assert float(whole["nominal_deg"]) == -150.0
    assert float(whole["duration_s"]) == 30.0


@pytest.mark.slow
def test_an_archive_names_what_it_lacks(place: Path, first: subprocess.CompletedProcess[str]) -> None:
    done = snakemake(place, more=["archive"])
    assert done.returncode == 1
    (line,) = [line for line in done.stderr.splitlines() if line.startswith("No bag of ")]
    told, _, command = line.partition("; one without: ")
    assert told == "No bag of lab, since c-broken failed"
    words = [FOGREDUCE, *shlex.split(command)[1:]]
    subprocess.run(words, cwd=place, check=True, capture_output=True)
    (record,) = place.glob("results/_archive/lab-*/data/archive.json")
    assert [run["run_id"] for run in json.loads(record.read_text())["left_out"]] == ["c-broken"]


def test_once_mended_only_what_was_missing_is_made_and_a_further_call_does_nothing(
    place: Path, first: subprocess.CompletedProcess[str]
) -> None:
    untouched = place / "results/lab/a-steady/datasets/ingest.nc"
    before = untouched.stat().st_mtime_ns
    shutil.rmtree(place / "campaigns/lab/runs/c-broken")
    second = snakemake(place)
    assert second.returncode == 0, second.stderr
    assert untouched.stat().st_mtime_ns == before
    with (place / "results/_summary/drift_all.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert {(row["campaign"], row["run_id"]) for row in rows} == {
        ("lab", "a-steady"),
        ("lab", "b-steps"),
        ("made", "a-steady"),
    }
    page = (place / "results/lab/index.html").read_text()
    assert "0 failed" in page
    assert "c-broken" not in page
    third = snakemake(place)
    assert "Nothing to be done" in third.stderr
    assert third.stderr.splitlines()[-2:] == [
        "3 runs: 3 reduced, of these 0 flagged",
        "Open results/index.html",
    ]


@pytest.mark.parametrize(
    ("setting", "told"),
    [
        (
            "reduction={block_records: none}",
            "configuration: reduction.block_records: found the text 'none'; expected a whole number",
        ),
        (
            "withheld={study: huge}",
            "configuration: withheld.study: found huge; expected small, quarter, full or whole",
        ),
        (
            "campaigns_dir=nowhere",
            "nowhere: found no such folder; expected a folder with one folder a campaign",
        ),
    ],
)
@pytest.mark.parametrize("quiet", [[], ["--quiet", "all"]])
def test_a_configuration_that_cannot_be_is_refused_in_one_line(
    place: Path, setting: str, told: str, quiet: list[str]
) -> None:
    done = snakemake(place, setting, more=quiet)
    assert done.returncode == 2
    assert done.stdout == ""
    (line,) = [line for line in done.stderr.splitlines() if not line.startswith(OF_SNAKEMAKE)]
    assert line == told


def test_a_terminal_sees_the_end_and_the_log_has_all(
    place: Path, first: subprocess.CompletedProcess[str]
) -> None:
    said = [line for line in first.stderr.splitlines() if line.strip()]
    assert first.stdout == ""
    assert len(said) < 20, first.stderr  # of 29 jobs
    assert "4 runs: 3 reduced, of these 0 flagged; 1 not reduced" in said
    assert "Open results/index.html" in said
    assert not [line for line in said if line.startswith("Warning")]
    log = min((place / ".snakemake" / "log").glob("*.log"))  # their names begin with the time
    kept = log.read_text()
    assert kept.count("rule drift:") == 3
    assert "Error in rule ingest" in kept


def test_a_dry_run_says_what_it_would_do(place: Path, first: subprocess.CompletedProcess[str]) -> None:
    done = snakemake(place, dry=True, more=["--forceall"])
    assert "rule ingest:" in done.stdout + done.stderr


def test_lint_has_nothing_to_wish_for() -> None:
    done = subprocess.run(
        [sys.executable, ROOT / "workflow" / "lint.py"], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
