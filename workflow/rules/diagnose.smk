"""The gap between a campaign's runs and the simulator, for campaigns that ask for it (`diagnose: true`)."""


rule diagnose:
    input:
        runs=diagnosed_inputs,
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
        out=lambda wildcards: f"{RESULTS}/{wildcards.campaign}/_diagnosis",
        calibrations=CONFIG.calibrations_dir,
    shell:
        "fogreduce diagnose {params.folder:q} --calibrations {params.calibrations:q} --out {params.out:q}"
        " > {log:q} 2>&1"
