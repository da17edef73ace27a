"""The last node of a run, its checksums; and `archive`, a bag for each campaign (asked for by name)."""


rule checksums:
    input:
        manifest=rules.manifest.output[0],
        stages=STAGES,
        figures=run_file("figures") if CONFIG.figures.enabled else [],
        allan=rules.allan.output if CONFIG.allan.enabled else [],
        page=rules.run_page.output if CONFIG.pages.enabled else [],
    output:
        run_file("outputs.json"),
    log:
        run_file("logs/checksums.log"),
    params:
        edited=edited_outputs("checksums"),
        code=code_digest(
            "fogreduce.provenance.outputs", "fogreduce.provenance.versions"
        ),
        out=subpath(output[0], parent=True),
    shell:
        "fogreduce checksums {params.out:q} > {log:q} 2>&1"


rule bag:
    input:
        lambda wildcards: [
            f"{RESULTS}/{wildcards.campaign}/{run}/outputs.json"
            for campaign, run in RUNS
            if campaign == wildcards.campaign
        ],
        lambda wildcards: (
            [f"{RESULTS}/{wildcards.campaign}/_diagnosis/diagnosis.json"]
            if wildcards.campaign in DIAGNOSED
            else []
        ),
        lambda wildcards: (
            [f"{RESULTS}/{wildcards.campaign}/_calibration/derivation.json"]
            if wildcards.campaign in DERIVED
            else []
        ),
        lambda wildcards: (
            [f"{RESULTS}/{wildcards.campaign}/_report/report.json"]
            if wildcards.campaign in REPORTED
            else []
        ),
        f"{RESULTS}/{{campaign}}/index.html" if CONFIG.pages.enabled else [],
    output:
        # Not the bag's folder, into which Snakemake would put a file of its own, but its digest and its name.
        # The name has the digest in it, so that older bags stay.
        f"{RESULTS}/_archive/{{campaign}}.sha256",
    log:
        f"{RESULTS}/_archive/logs/{{campaign}}.log",
    benchmark:
        f"{RESULTS}/_archive/benchmarks/{{campaign}}.tsv"
    params:
        code=code_digest(
            "fogreduce.archive.contents",
            "fogreduce.archive.write",
            "fogreduce.pages.index_page",
        ),
        results=subpath(output[0], ancestor=2),
        campaigns=CONFIG.campaigns_dir,
        calibrations=CONFIG.calibrations_dir,
        source=SOURCE,
        out=subpath(output[0], parent=True),
    shell:
        "fogreduce archive {params.results:q} --only {wildcards.campaign} --campaigns {params.campaigns:q}"
        " --calibrations {params.calibrations:q} --source {params.source:q} --out {params.out:q} --by-digest"
        " > {output:q} 2> {log:q}"


rule selftest:
    output:
        f"{RESULTS}/_selftest/selftest.html",
        f"{RESULTS}/_selftest/selftest.json",
    log:
        f"{RESULTS}/_archive/logs/_selftest.log",
    params:
        code=code_digest("fogreduce.selftest.run"),
        lock=LOCK,
        out=subpath(output[0], parent=True),
    shell:
        "fogreduce selftest --out {params.out:q} > {log:q} 2>&1"


rule archive:
    input:
        expand(f"{RESULTS}/_archive/{{campaign}}.sha256", campaign=sorted(CAMPAIGNS)),
