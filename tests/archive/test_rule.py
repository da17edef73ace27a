"""The archive as a node of the workflow: made once, made anew when results are; what is older stays."""

import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from archived_lab import CAMPAIGN, RUNS
from small_unit import succeed

from fogreduce.provenance.versions import kept_versions

_RULES = 'include: "workflow/rules/archive.smk"\n'


def snakemake(lab, archived, results, *more, **settings):
    """Ask for the archive; what snakemake said."""
    config = {
        "campaigns_dir": archived.campaigns,
        "calibrations_dir": archived.calibrations,
        "results_dir": results,
        "figures": '{"enabled": false}',
        **settings,
    }
    command = [Path(sys.executable).with_name("snakemake"), "archive", "--cores", "1", *more, "--config"]
    command += [f"{key}={value}" for key, value in config.items()]
    environment = {**os.environ, "PYTHONPATH": str(lab), "OPENBLAS_NUM_THREADS": "1"}
    done = subprocess.run(command, cwd=lab, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, (done.stdout + done.stderr)[-3000:]
    return done.stdout + done.stderr


@pytest.mark.slow
def test_the_workflow_archives(archived, tmp_path):
    lab = Path(shutil.copytree(archived.source, tmp_path / "lab"))
    snakefile = lab / "Snakefile"
    if _RULES not in snakefile.read_text():
        snakefile.write_text(snakefile.read_text() + "\n\n" + _RULES)
    results = tmp_path / "results"
    snakemake(lab, archived, results)
    digest, bag = (results / "_archive" / f"{CAMPAIGN}.sha256").read_text().split()
    assert succeed("verify", bag, "--expect", digest)
    page = Path(bag) / "data" / "results" / CAMPAIGN / "index.html"
    links = [link for link in re.findall(r'href="([^"#]*)', page.read_text()) if "index.html" in link]
    assert sorted(links) == ["../index.html", *(f"{run_id}/index.html" for run_id in RUNS)]
    assert all((page.parent / link).is_file() for link in links)
    assert "Nothing to be done" in snakemake(lab, archived, results, "--dry-run")

    snakemake(lab, archived, results, reduction=json.dumps({"edge_guard_s": 1.5}))
    other_digest, other_bag = (results / "_archive" / f"{CAMPAIGN}.sha256").read_text().split()
    assert other_digest != digest
    for kept, expected in ((bag, digest), (other_bag, other_digest)):
        assert succeed("verify", kept, "--expect", expected)
    for run_id in RUNS:
        assert len(kept_versions(results / CAMPAIGN / run_id)) == 2
    assert "because  parameters: edge_guard_s: 0.5 -> 1.5" in succeed("history", other_bag, "--run", RUNS[0])
