"""Calibrations: derived from campaigns that ask for it (`derive: true`), and the page of each unit's records.

Deriving and applying are apart: what is derived lies in the results, where no reduction looks for records. A
person puts it among the calibration records and names it.
"""


rule derive_calibration:
    input:
        runs=diagnosed_inputs,
        about=old_campaign_file,
        calibrations=campaign_calibrations,
    output:
        # The record has its content's digest in its name, so that older candidates stay; there is none where
        # the campaign does not determine one.
        document=f"{RESULTS}/{{campaign}}/_calibration/derivation.json",
        page=f"{RESULTS}/{{campaign}}/_calibration/index.html",
    log:
        f"{RESULTS}/{{campaign}}/_calibration/derive.log",
    params:
        code=code_digest("fogreduce.calibrate.write"),
        lock=LOCK,
        folder=diagnosed_folder,
        about=lambda wildcards: ABOUT[wildcards.campaign].model_dump_json(),
        out=subpath(output.document, parent=True),
        calibrations=folder_of_records,
    shell:
        "fogreduce derive-calibration {params.folder:q} --calibrations {params.calibrations:q}"
        " --out {params.out:q} --by-digest > {log:q} 2>&1"


rule unit_page:
    input:
        lambda wildcards: [
            path for path in CALIBRATIONS if Path(path).parts[-2] == wildcards.unit
        ],
    output:
        f"{RESULTS}/_units/{{unit}}.html",
    log:
        f"{SUMMARY}/logs/unit-{{unit}}.log",
    params:
        code=code_digest("fogreduce.calibrate.unit_page"),
        templates=data_digest(TEMPLATES),
        calibrations=subpath(input[0], ancestor=2),
    shell:
        "fogreduce calibrations page {wildcards.unit} --calibrations {params.calibrations:q} --out {output:q}"
        " > {log:q} 2>&1"
