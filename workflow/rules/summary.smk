"""Tables over all runs."""


rule summary:
    input:
        drift=expand(run_file("tables/drift.csv"), zip, **run_wildcards()),
        rates=expand(run_file("tables/rate_fit.csv"), zip, **run_wildcards()),
        commanded=expand(run_file("tables/rates.csv"), zip, **run_wildcards()),
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
        command=SUMMARY_COMMAND,
    shell:
        "{params.command} > {log:q} 2>&1"
