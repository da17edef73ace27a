"""Pages for people: one a run, one a campaign, one over all campaigns."""


rule run_page:
    input:
        manifest=run_file("manifest.json"),
        ingest=run_file("datasets/ingest.nc"),
        reports=[run_file("reports/ingest.json"), run_file("reports/fit.json")],
        drift=[run_file("tables/drift.csv"), run_file("tables/rates.csv")],
        figures=run_file("figures") if CONFIG.figures.enabled else [],
    output:
        run_file("index.html"),
        run_file("reports/overview.json"),
    log:
        run_file("logs/page.log"),
    params:
        edited=edited_outputs("run_page"),
        code=code_digest("fogreduce.pages.overview", "fogreduce.pages.run_page"),
        templates=data_digest(TEMPLATES),
        out=RUN,
    shell:
        "fogreduce page run {params.out:q} > {log:q} 2>&1"


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
        derivation=lambda wildcards: (
            [f"{RESULTS}/{wildcards.campaign}/_calibration/index.html"]
            if wildcards.campaign in DERIVED
            else []
        ),
    output:
        f"{RESULTS}/{{campaign}}/index.html",
    log:
        f"{SUMMARY}/logs/page-{{campaign}}.log",
    benchmark:
        f"{SUMMARY}/benchmarks/page-{{campaign}}.tsv"
    params:
        code=code_digest("fogreduce.pages.gather", "fogreduce.pages.campaign_page"),
        templates=data_digest(TEMPLATES),
        campaigns=CONFIG.campaigns_dir,
        folder=lambda wildcards, output: Path(output[0]).parent,
    shell:
        "fogreduce page campaign {params.folder:q} --campaigns {params.campaigns:q} > {log:q} 2>&1"


rule index_page:
    input:
        campaign_pages(),
        expand(f"{RESULTS}/_units/{{unit}}.html", unit=UNITS),
    output:
        f"{RESULTS}/index.html",
    log:
        f"{SUMMARY}/logs/page.log",
    benchmark:
        f"{SUMMARY}/benchmarks/page.tsv"
    params:
        code=code_digest("fogreduce.pages.gather", "fogreduce.pages.index_page"),
        templates=data_digest(TEMPLATES),
        campaigns=CONFIG.campaigns_dir,
        folder=lambda wildcards, output: Path(output[0]).parent,
    shell:
        "fogreduce page index {params.folder:q} --campaigns {params.campaigns:q} > {log:q} 2>&1"
