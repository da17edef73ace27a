"""The gap between a campaign's runs and the simulator, for campaigns that ask for it (`diagnose: true`)."""


rule diagnose:
    input:
        runs=diagnosed_inputs,
        about=old_campaign_file,
        calibrations=campaign_calibrations,
    output:
        document=f"{RESULTS}/{{campaign}}/_diagnosis/diagnosis.json",
        simulator=f"{RESULTS}/{{campaign}}/_diagnosis/simulator.yaml",
        page=f"{RESULTS}/{{campaign}}/_diagnosis/index.html",
    log:
        f"{RESULTS}/{{campaign}}/_diagnosis/diagnose.log",
    params:
        code=code_digest(
            "fogreduce.diagnosis.diagnose", "fogreduce.diagnosis.report.write"
        ),
        lock=LOCK,
        folder=diagnosed_folder,
        out=subpath(output.document, parent=True),
        calibrations=folder_of_records,
    shell:
        "fogreduce diagnose {params.folder:q} --calibrations {params.calibrations:q} --out {params.out:q}"
        " > {log:q} 2>&1"
