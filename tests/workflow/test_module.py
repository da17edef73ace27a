"""A laboratory's own Snakefile that uses the workflow as a module, as workflow/README.md shows it."""

from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path

import pytest
from small_campaign import BIN, PATIENCE_S, ROOT, write_captures

from fogreduce.datasets.sole_writer import sole_writer

#: A rule of the laboratory's own, after the tables over all runs.
OWN = """
rule count:
    input:
        "out/_summary/drift_all.csv",
    output:
        "count.txt",
    shell:
        "wc -l < {input} > {output}"
"""


def call(place: Path, *words: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [BIN / "snakemake", "--cores", "2", *words],
        cwd=place,
        capture_output=True,
        text=True,
        timeout=PATIENCE_S,
        check=False,
    )


@pytest.fixture
def place(tmp_path: Path) -> Path:
    """Captures, records, and the Snakefile and settings of the README, its paths filled in."""
    write_captures(tmp_path, ["a"])
    shutil.copytree(ROOT / "calibrations", tmp_path / "calibrations")
    text = (ROOT / "workflow" / "README.md").read_text()
    snakefile, settings = re.findall(r"```(?:python|yaml)\n(.*?)```", text, re.DOTALL)
    (tmp_path / "Snakefile").write_text(snakefile.replace("/opt/fogreduce", str(ROOT)) + OWN)
    (tmp_path / "lab.yaml").write_text(settings)
    return tmp_path


def test_the_rules_are_there_under_the_name_of_the_module(place: Path) -> None:
    done = call(place, "--dry-run", "count.txt")
    assert done.returncode == 0, done.stderr
    planned = re.findall(r"^(?:local)?rule (\w+):", done.stdout + done.stderr, re.MULTILINE)
    assert {"fogreduce_manifest", "fogreduce_drift", "fogreduce_summary", "count"} <= set(planned)


@pytest.mark.slow
def test_results_are_those_of_the_plain_command(place: Path) -> None:
    done = call(place, "all", "count.txt")
    assert done.returncode == 0, done.stderr
    assert (place / "count.txt").read_text().strip() == "4"
    assert "1 run: 1 reduced" in done.stderr
    plain = call(place, "--snakefile", f"{ROOT}/Snakefile", "--config", "results_dir=plain")
    assert plain.returncode == 0, plain.stderr
    tables = sorted((place / "plain/lab/a/tables").iterdir())
    assert len(tables) >= 6
    for table in tables:
        assert (place / "out/lab/a/tables" / table.name).read_bytes() == table.read_bytes()


@pytest.mark.slow
def test_another_writer_is_told(place: Path) -> None:
    with sole_writer(place / "out"):
        done = call(place)
    assert done.returncode == 2
    assert "expected one writer at a time" in done.stderr
    assert not (place / "out").exists()
