"""The reduction of a run: manifest, then a node for each stage, in the order of the data flow.

The manifest names the code, the environment, the parameters and every input, and its version id stands in each
output of the stages: so what changes one of them remakes the manifest and, with it, the run.
"""


rule manifest:
    input:
        run=run_inputs,
        about=campaign_file_of_runs,
        calibrations=calibration_inputs,
    output:
        run_file("manifest.json"),
    log:
        run_file("logs/manifest.log"),
    params:
        edited=edited_outputs("manifest"),
        code=code_digest(),
        lock=LOCK,
        readers=READERS,
        run=run_says,
        label=RUN_LABEL,
        folder=folder_of_run,
        out=subpath(output[0], parent=True),
        calibrations=folder_of_records,
        parameters=CONFIG.reduction.model_dump_json(),
    shell:
        "fogreduce manifest {params.folder:q} --calibrations {params.calibrations:q} --out {params.out:q}"
        " --parameters {params.parameters:q} > {log:q} 2>&1"


rule ingest:
    input:
        run=run_inputs,
        manifest=rules.manifest.output[0],
    output:
        run_file("datasets/ingest.nc"),
        run_file("reports/ingest.json"),
        run_file("tables/quality.csv"),
        run_file("tables/encoder.csv"),
        run_file("tables/warnings.csv"),
    log:
        run_file("logs/ingest.log"),
    params:
        edited=edited_outputs("ingest"),
        folder=folder_of_run,
        out=subpath(output[0], ancestor=2),
    shell:
        "fogreduce stage ingest --run {params.folder:q} --out {params.out:q} > {log:q} 2>&1"


rule calibrate:
    input:
        manifest=rules.manifest.output[0],
        dataset=rules.ingest.output[0],
    output:
        run_file("datasets/calibrate.nc"),
    log:
        run_file("logs/calibrate.log"),
    params:
        edited=edited_outputs("calibrate"),
        out=subpath(output[0], ancestor=2),
    shell:
        "fogreduce stage calibrate --out {params.out:q} > {log:q} 2>&1"


rule project:
    input:
        manifest=rules.manifest.output[0],
        dataset=rules.calibrate.output[0],
    output:
        run_file("datasets/project.nc"),
    log:
        run_file("logs/project.log"),
    params:
        edited=edited_outputs("project"),
        out=subpath(output[0], ancestor=2),
    shell:
        "fogreduce stage project --out {params.out:q} > {log:q} 2>&1"


rule remove_earth:
    input:
        run=run_inputs,
        manifest=rules.manifest.output[0],
        dataset=rules.project.output[0],
    output:
        run_file("datasets/remove_earth.nc"),
    log:
        run_file("logs/remove_earth.log"),
    params:
        edited=edited_outputs("remove_earth"),
        folder=folder_of_run,
        out=subpath(output[0], ancestor=2),
    shell:
        "fogreduce stage remove_earth --run {params.folder:q} --out {params.out:q} > {log:q} 2>&1"


rule fit:
    input:
        manifest=rules.manifest.output[0],
        raw=rules.ingest.output[0],
        rates=rules.remove_earth.output[0],
    output:
        run_file("datasets/bins.nc"),
        run_file("reports/fit.json"),
        run_file("tables/gyro_fit.csv"),
        run_file("tables/rate_fit.csv"),
        run_file("tables/unstable.csv"),
    log:
        run_file("logs/fit.log"),
    params:
        edited=edited_outputs("fit"),
        out=subpath(output[0], ancestor=2),
    shell:
        "fogreduce stage fit --out {params.out:q} > {log:q} 2>&1"


rule drift:
    input:
        manifest=rules.manifest.output[0],
        fit=rules.fit.output[1],
    output:
        run_file("tables/drift.csv"),
        run_file("tables/rates.csv"),
        run_file("tables/drift_by_records.csv"),
        run_file("tables/budget.csv"),
        run_file("tables/correlations.csv"),
        run_file("datasets/budget.nc"),
    log:
        run_file("logs/drift.log"),
    params:
        edited=edited_outputs("drift"),
        out=subpath(output[0], ancestor=2),
    shell:
        "fogreduce stage drift --out {params.out:q} > {log:q} 2>&1"


#: What the stages of a run leave.
STAGES = [
    *rules.ingest.output,
    *rules.calibrate.output,
    *rules.project.output,
    *rules.remove_earth.output,
    *rules.fit.output,
    *rules.drift.output,
]
