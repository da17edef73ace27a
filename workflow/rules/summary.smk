"""Tables over all runs."""


rule summary_runs:
    output:
        f"{SUMMARY}/runs.json",
    log:
        f"{SUMMARY}/logs/runs.log",
    benchmark:
        f"{SUMMARY}/benchmarks/runs.tsv"
    params:
        runs=json.dumps(RUNS),
    shell:
        "printf '%s' {params.runs:q} > {output:q} 2> {log:q}"


rule summary:
    input:
        runs=f"{SUMMARY}/runs.json",
        drift=expand(run_file("tables/drift.csv"), zip, **run_wildcards()),
        rates=expand(run_file("tables/rate_fit.csv"), zip, **run_wildcards()),
    output:
        summary_tables(),
    log:
        f"{SUMMARY}/logs/summary.log",
    benchmark:
        f"{SUMMARY}/benchmarks/summary.tsv"
    params:
        code=code_digest(("stages/summary.py",)),
        results=lambda wildcards, output: Path(output[0]).parent.parent,
        out=lambda wildcards, output: Path(output[0]).parent,
    shell:
        "fogreduce summary --results {params.results:q} --runs {input.runs:q} --out {params.out:q} > {log:q} 2>&1"
