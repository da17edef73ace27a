"""Figures of a run."""


rule figures:
    input:
        run=run_inputs,
        manifest=run_file("manifest.json"),
        stages=STAGES,
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
        folder=folder_of_run,
        out=subpath(output[0], parent=True),
        formats=",".join(CONFIG.figures.formats),
    shell:
        "fogreduce figures --run {params.folder:q} --out {params.out:q} --formats {params.formats}"
        " > {log:q} 2>&1"
