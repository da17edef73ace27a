"""Pages for people: one a run."""

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
