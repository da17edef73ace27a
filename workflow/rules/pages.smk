"""Pages for people: one a run, one a campaign, one over all campaigns."""

import os
import subprocess
from pathlib import Path

import fogreduce
from fogreduce.archive.digest import data_digest, file_digest

TEMPLATES = {
    path.name: file_digest(path)
    for path in sorted((Path(fogreduce.__file__).parent / "pages/templates").iterdir())
}


rule run_page:
    input:
        manifest=run_file("manifest.json"),
        ingest=run_file("datasets/ingest.nc"),
        reports=[run_file("reports/ingest.json"), run_file("reports/fit.json")],
        drift=run_file("tables/drift.csv"),
        figures=run_file("figures") if CONFIG.figures.enabled else [],
    output:
        run_file("index.html"),
        run_file("reports/overview.json"),
    log:
        run_file("logs/page.log"),
    benchmark:
        run_file("benchmarks/page.tsv")
    params:
        edited=edited_outputs("run_page"),
        code=code_digest("fogreduce.pages.overview", "fogreduce.pages.run_page"),
        templates=data_digest(TEMPLATES),
        out=run_results,
    shell:
        "fogreduce page run {params.out:q} > {log:q} 2>&1"


def campaign_pages():
    """The pages of the campaigns and that over all of them, if pages are asked for."""
    if not CONFIG.pages.enabled:
        return []
    names = [name for name in CAMPAIGNS if FOUND[name][0]]
    return [f"{RESULTS}/{name}/index.html" for name in names]


def pages_of_failures():
    """The pages of campaigns of which runs failed: no rule makes them, as it lacks those runs' pages.

    They are dated back, so that the next call makes them anew.
    """
    if not CONFIG.pages.enabled:
        return
    failed = {
        campaign
        for campaign, run in RUNS
        if not is_reduced(Path(RESULTS) / campaign / run)
    }
    for folder in [Path(RESULTS) / campaign for campaign in sorted(failed)]:
        if not folder.is_dir():
            continue
        command = ["fogreduce", "page", "campaign", folder]
        subprocess.run([*command, "--campaigns", CONFIG.campaigns_dir], check=False)
        if (folder / "index.html").exists():
            os.utime(folder / "index.html", (0, 0))


rule campaign_page:
    input:
        runs=lambda wildcards: [
            f"{RESULTS}/{wildcards.campaign}/{run}/index.html"
            for campaign, run in RUNS
            if campaign == wildcards.campaign
        ],
        about=lambda wildcards: [
            path
            for path in [f"{CONFIG.campaigns_dir}/{wildcards.campaign}/campaign.yaml"]
            if os.path.exists(path)
        ],
        diagnosis=lambda wildcards: (
            [f"{RESULTS}/{wildcards.campaign}/_diagnosis/index.html"]
            if wildcards.campaign in DIAGNOSED
            else []
        ),
    output:
        f"{RESULTS}/{{campaign}}/index.html",
    log:
        f"{RESULTS}/_summary/logs/page-{{campaign}}.log",
    benchmark:
        f"{RESULTS}/_summary/benchmarks/page-{{campaign}}.tsv"
    params:
        code=code_digest(("pages",)),
        templates=data_digest(TEMPLATES),
        campaigns=CONFIG.campaigns_dir,
        folder=lambda wildcards, output: Path(output[0]).parent,
    shell:
        "fogreduce page campaign {params.folder:q} --campaigns {params.campaigns:q} > {log:q} 2>&1"
