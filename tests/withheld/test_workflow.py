"""The rules, run as a person would run them."""

import hashlib
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from withheld.study.protocol import study

ROOT = Path(__file__).resolve().parents[2]
RULES = ROOT / "workflow" / "rules" / "withheld.smk"
SETTINGS = RULES.with_name("withheld_common.smk")


def rule(name):
    """The text of one rule."""
    return re.search(rf"^rule {name}:\n(.*?)(?=^\S|\Z)", RULES.read_text(), re.M | re.S)[1]


def test_only_scoring_is_given_labels():
    text = RULES.read_text()
    names = re.findall(r"^rule (\w+):", text, re.M)
    given = [n for n in names if re.search(r"sealed|seal_labels\.input", rule(n).split("output:")[0])]
    # sealing hashes the files and looks no further
    assert given == ["withheld_seal_labels", "withheld_score"]
    assert "diagnoses_seal=rules.withheld_seal_diagnoses.output" in rule("withheld_score")
    assert "label" not in rule("withheld_diagnose")
    assert "seed" not in rule("withheld_diagnose")


def test_the_number_of_cases_in_the_rules_is_the_study_s():
    found = dict(re.findall(r'"(small|full)": (\d+)', SETTINGS.read_text()))
    assert {k: int(v) for k, v in found.items()} == {k: study(k, 1_000_001).cases for k in ("small", "full")}


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    """The small study, run through its rules alone."""
    folder = tmp_path_factory.mktemp("withheld")
    (folder / "Snakefile").write_text(f'include: "{RULES}"\n')
    command = [sys.executable, "-m", "snakemake", "-s", str(folder / "Snakefile"), "withheld", "--cores", "2",
               "--workflow-profile", "none", "--config", f"results_dir={folder}/results"]  # fmt: skip
    environment = {
        **os.environ,
        "PATH": f"{Path(sys.executable).parent}:{os.environ['PATH']}",
        "OMP_NUM_THREADS": "1",
    }
    done = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr[-3000:]
    again = subprocess.run(
        [*command, "-n"], cwd=ROOT, env=environment, capture_output=True, text=True, check=False
    )
    assert "Nothing to be done" in again.stdout + again.stderr
    return folder / "results" / "withheld" / "small-1000001"


@pytest.mark.slow
def test_the_small_study_from_protocol_to_page(results):
    pages = sorted(path.parent.name for path in results.glob("report/*/index.md"))
    assert pages == ["guess", "no_gap", "one_group", "unexplained"]
    assert not list(results.rglob("*.fogcap"))  # deleted as they were diagnosed
    page = (results / "report" / "no_gap" / "index.md").read_text()
    assert "called a gap | 0 of 6" in page
    digest = hashlib.sha256((results / "labels.sha256").read_bytes()).hexdigest()
    assert digest in page
    for figure in re.findall(r"\((\w+\.png)\)", page):
        assert (results / "report" / "no_gap" / figure).stat().st_size > 5000


@pytest.mark.slow
def test_sealed_before_scored(results):
    age = {path: path.stat().st_mtime_ns for path in results.rglob("*") if path.is_file()}
    protocol, labels = age[results / "protocol.sha256"], age[results / "labels.sha256"]
    assert protocol <= min(age[path] for path in (results / "sealed").iterdir())
    for scores in results.glob("scores/*.json"):
        assert age[scores] >= max(labels, age[results / f"diagnoses-{scores.stem}.sha256"])
