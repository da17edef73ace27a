"""Figures of a run; its Allan deviation where it is asked for."""


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


rule allan:
    input:
        manifest=run_file("manifest.json"),
        stages=STAGES,
    output:
        run_file("allan/allan.csv"),
        run_file("allan/noise.csv"),
        run_file("allan/spectrum.csv"),
        run_file("allan/allan.png"),
        run_file("allan/allan.svg"),
    log:
        run_file("logs/allan.log"),
    params:
        edited=edited_outputs("allan"),
        code=code_digest(
            "fogreduce.characterise.allan_run",
            "fogreduce.characterise.allan_tables",
            "fogreduce.characterise.allan_figure",
        ),
        lock=LOCK,
        out=subpath(output[0], ancestor=2),
    shell:
        "fogreduce allan {params.out:q} > {log:q} 2>&1"
