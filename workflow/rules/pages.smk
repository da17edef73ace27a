"""Pages for people: one a run, one a campaign, one over all campaigns."""


rule run_page:
    input:
        manifest=run_file("manifest.json"),
        stages=STAGES,
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
        out=subpath(output[0], parent=True),
    shell:
        "fogreduce page run {params.out:q} > {log:q} 2>&1"


rule campaign_page:
    input:
        planned=lambda wildcards: planned(wildcards.campaign),
        about=lambda wildcards: beside_runs(wildcards, "campaign.yaml"),
        runs=lambda wildcards: of_runs("index.html", wildcards.campaign),
        manifests=lambda wildcards: of_runs("manifest.json", wildcards.campaign),
        overviews=lambda wildcards: of_runs("reports/overview.json", wildcards.campaign),
        drift=lambda wildcards: of_runs("tables/drift.csv", wildcards.campaign),
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
        report=lambda wildcards: (
            [f"{RESULTS}/{wildcards.campaign}/_report/index.html"]
            if wildcards.campaign in REPORTED
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
        campaigns=folder_of_campaigns,
        folder=subpath(output[0], parent=True),
    shell:
        "fogreduce page campaign {params.folder:q} --campaigns {params.campaigns:q} > {log:q} 2>&1"


rule index_page:
    input:
        campaigns=campaign_pages(),
        units=expand(f"{RESULTS}/_units/{{unit}}.html", unit=UNITS),
        planned=planned(*CAMPAIGNS),
        manifests=of_runs("manifest.json", *CAMPAIGNS),
        overviews=of_runs("reports/overview.json", *CAMPAIGNS),
        drift=of_runs("tables/drift.csv", *CAMPAIGNS),
    output:
        f"{RESULTS}/index.html",
    log:
        f"{SUMMARY}/logs/page.log",
    benchmark:
        f"{SUMMARY}/benchmarks/page.tsv"
    params:
        code=code_digest("fogreduce.pages.gather", "fogreduce.pages.index_page"),
        templates=data_digest(TEMPLATES),
        campaigns=folder_of_campaigns,
        folder=subpath(output[0], parent=True),
    shell:
        "fogreduce page index {params.folder:q} --campaigns {params.campaigns:q} > {log:q} 2>&1"
