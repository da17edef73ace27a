"""Captures that are not kept but made, where campaign.yaml says `captures_from`."""


rule make_campaign:
    input:
        about=files_of_campaign,
    output:
        f"{MADE}/{{campaign}}/campaign.yaml",
    log:
        f"{SUMMARY}/logs/campaign-{{campaign}}.log",
    params:
        folder=folder_of_campaign,
        calibrations=CONFIG.calibrations_dir,
        out=subpath(output[0], parent=True),
    shell:
        "fogreduce simulate {params.folder:q} --calibrations {params.calibrations:q} --out {params.out:q}"
        " --no-captures > {log:q} 2>&1"


rule make_capture:
    input:
        about=files_of_campaign,
        # Simulating writes it too: not before its own rule, which would find a file that it did not expect.
        written=ancient(f"{MADE}/{{campaign}}/campaign.yaml"),
        run=lambda wildcards: files_of_run(wildcards.campaign, wildcards.run),
        calibrations=calibration_inputs,
    output:
        directory(f"{MADE}/{{campaign}}/runs/{{run}}"),
    log:
        run_file("logs/capture.log"),
    params:
        code=code_digest("fogreduce.simulate.campaign", "fogreduce.simulate.plan"),
        lock=LOCK,
        run=run_says,
        folder=folder_of_campaign,
        calibrations=folder_of_records,
        out=subpath(output[0], ancestor=2),
    shell:
        "rm -rf {output:q} && "
        "fogreduce simulate {params.folder:q} --calibrations {params.calibrations:q} --out {params.out:q}"
        " --only-runs {wildcards.run} > {log:q} 2>&1"
