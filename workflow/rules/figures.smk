"""Figures of a run."""


rule figures:
    input:
        run=run_inputs,
        manifest=run_file("manifest.json"),
        bins=run_file("datasets/bins.nc"),
        fit=run_file("reports/fit.json"),
        ingest=run_file("reports/ingest.json"),
        drift=[run_file("tables/drift.csv"), run_file("tables/rates.csv")],
    output:
        directory(run_file("figures")),
    log:
        run_file("logs/figures.log"),
    params:
        edited=edited_outputs("figures"),
        code=code_digest(
            "fogreduce.figures.catalogue",
            "fogreduce.figures.results",
            "fogreduce.figures.save",
        ),
        lock=LOCK,
        folder=RUN_FOLDER,
        out=RUN,
        formats=",".join(CONFIG.figures.formats),
    shell:
        "fogreduce figures --run {params.folder:q} --out {params.out:q} --formats {params.formats}"
        " > {log:q} 2>&1"
