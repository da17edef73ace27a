"""Captures that are not kept but made, where campaign.yaml says `captures_from`."""


rule make_capture:
    input:
        campaign=lambda wildcards: f"{CONFIG.campaigns_dir}/{wildcards.campaign}/campaign.yaml",
        run=lambda wildcards: f"{CONFIG.campaigns_dir}/{wildcards.campaign}/runs/{wildcards.run}/run.yaml",
        calibrations=calibration_inputs,
    output:
        directory(f"{MADE}/{{campaign}}/runs/{{run}}"),
    log:
        run_file("logs/capture.log"),
    params:
        code=code_digest("fogreduce.simulate.campaign", "fogreduce.simulate.plan"),
        lock=LOCK,
        run=run_says,
        folder=f"{CONFIG.campaigns_dir}/{{campaign}}",
        calibrations=CONFIG.calibrations_dir,
        out=f"{MADE}/{{campaign}}",
    shell:
        "rm -rf {output:q} && "
        "fogreduce simulate {params.folder:q} --calibrations {params.calibrations:q} --out {params.out:q}"
        " --only-runs {wildcards.run} > {log:q} 2>&1"
