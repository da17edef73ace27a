"""The unit's test report, of campaigns that ask for it (`report: true`); limits and definitions beside their runs."""


rule report:
    input:
        runs=diagnosed_inputs,
        limits=lambda wildcards: beside_runs(wildcards, "limits.yaml"),
        definitions=lambda wildcards: beside_runs(wildcards, "definitions.yaml"),
        calibrations=campaign_calibrations,
    output:
        document=f"{RESULTS}/{{campaign}}/_report/report.json",
        page=f"{RESULTS}/{{campaign}}/_report/index.html",
        print=f"{RESULTS}/{{campaign}}/_report/report.pdf",
    log:
        f"{RESULTS}/{{campaign}}/_report/report.log",
    params:
        code=code_digest(
            "fogreduce.characterise.report", "fogreduce.characterise.report_pdf"
        ),
        templates=data_digest(TEMPLATES),
        lock=LOCK,
        folder=diagnosed_folder,
        options=report_options,
        out=subpath(output.document, parent=True),
        calibrations=folder_of_records,
    shell:
        "fogreduce report {params.folder:q} --calibrations {params.calibrations:q} --out {params.out:q}"
        " {params.options} > {log:q} 2>&1"
