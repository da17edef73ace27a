"""What the rules of pages share: their templates, their names, and the pages of what failed."""

import csv
import os
import subprocess
from pathlib import Path

import fogreduce
from fogreduce.provenance.digest import data_digest, file_digest

TEMPLATES = {
    path.name: file_digest(path)
    for path in sorted((Path(fogreduce.__file__).parent / "pages/templates").iterdir())
}


def campaign_pages():
    """The pages of the campaigns, if pages are asked for."""
    if not CONFIG.pages.enabled:
        return []
    return [f"{RESULTS}/{name}/index.html" for name in CAMPAIGNS if FOUND[name][0]]


def pages_of_failures():
    """The pages of campaigns of which runs failed: no rule makes them, as it lacks those runs' pages.

    Called once the summary is written, which says which those are. The pages are dated back, so that the next
    call makes them anew.
    """
    if not (CONFIG.pages.enabled and os.path.exists(f"{SUMMARY}/failed.csv")):
        return
    with open(f"{SUMMARY}/failed.csv", newline="") as file:
        failed = {row["campaign"] for row in csv.DictReader(file)}
    # Those too that wait for a figure, a run's page or a diagnosis that failed.
    pages = [(name, f"{RESULTS}/{name}/index.html") for name in CAMPAIGNS]
    pages += [(name, f"{RESULTS}/{name}/{run}/index.html") for name, run in RUNS]
    failed |= {name for name, page in pages if not os.path.exists(page)}
    pages = [("campaign", Path(RESULTS) / campaign) for campaign in sorted(failed)]
    for of, folder in [*pages, ("index", Path(RESULTS))]:
        if not folder.is_dir():
            continue
        command = ["fogreduce", "page", of, folder]
        subprocess.run([*command, "--campaigns", CONFIG.campaigns_dir], check=False)
        if (folder / "index.html").exists():
            os.utime(folder / "index.html", (1, 1))  # at 0 Snakemake sees no date
