"""Tables over all runs."""


rule summary:
    input:
        planned=planned(*CAMPAIGNS),
        manifests=of_runs("manifest.json", *CAMPAIGNS),
        drift=of_runs("tables/drift.csv", *CAMPAIGNS),
        rates=of_runs("tables/rate_fit.csv", *CAMPAIGNS),
        commanded=of_runs("tables/rates.csv", *CAMPAIGNS),
    output:
        summary_tables(),
    log:
        f"{SUMMARY}/logs/summary.log",
    benchmark:
        f"{SUMMARY}/benchmarks/summary.tsv"
    params:
        code=code_digest("fogreduce.stages.summary"),
        # Not the runs themselves: thousands do not fit on a command line.
        runs=hashlib.sha256(json.dumps(RUNS).encode()).hexdigest(),
        campaigns=folder_of_campaigns,
        names=CONFIG.campaigns,
        results=subpath(output[0], ancestor=2),
        out=subpath(output[0], parent=True),
    shell:
        "fogreduce summary --results {params.results:q} --out {params.out:q}"
        " --campaigns {params.campaigns:q} {params.names:q} > {log:q} 2>&1"
