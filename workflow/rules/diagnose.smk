"""The gap between a campaign's runs and the simulator, for campaigns that ask for it (`diagnose: true`)."""

DIAGNOSED = [
    name
    for name, folder in CAMPAIGNS.items()
    if checked(load_campaign, folder).diagnose and FOUND[name][0]
]


def diagnosed_inputs(wildcards):
    """Metadata, logs and captures of every run of a campaign; folders where a rule makes them."""
    if wildcards.campaign in MADE_CAMPAIGNS:
        return [
            f"{MADE}/{wildcards.campaign}/runs/{run.name}"
            for run in FOUND[wildcards.campaign][0]
        ]
    return sorted(
        str(path)
        for run in FOUND[wildcards.campaign][0]
        for path in run.iterdir()
        if path.is_file()
    )


def diagnosed_folder(wildcards):
    """The campaign's folder with its captures."""
    parent = MADE if wildcards.campaign in MADE_CAMPAIGNS else CONFIG.campaigns_dir
    return f"{parent}/{wildcards.campaign}"


rule diagnose:
    input:
        runs=diagnosed_inputs,
        calibrations=calibration_inputs,
    output:
        document=f"{RESULTS}/{{campaign}}/_diagnosis/diagnosis.json",
        simulator=f"{RESULTS}/{{campaign}}/_diagnosis/simulator.yaml",
        page=f"{RESULTS}/{{campaign}}/_diagnosis/index.html",
    log:
        f"{RESULTS}/{{campaign}}/_diagnosis/diagnose.log",
    params:
        code=code_digest(
            (
                "gap",
                "simulate",
                "effects",
                "stages",
                "estimate",
                "datasets",
                "physics",
                "metadata",
                "constants.py",
                "units.py",
            )
        ),
        folder=diagnosed_folder,
        out=lambda wildcards: f"{RESULTS}/{wildcards.campaign}/_diagnosis",
        calibrations=CONFIG.calibrations_dir,
    shell:
        "fogreduce diagnose {params.folder:q} --calibrations {params.calibrations:q} --out {params.out:q}"
        " > {log:q} 2>&1"
