"""From raw captures to drift: every campaign of the configuration, a node for each run and stage."""

import os
import sys
from pathlib import Path

# The rules call `fogreduce` as installed beside this snakemake, whether or not that is on the PATH.
os.environ.update(
    PATH=os.pathsep.join([str(Path(sys.executable).parent), os.environ.get("PATH", "")])
)


#: This checkout, wherever the workflow that uses it lies.
SOURCE = Path(str(workflow.current_basedir)).absolute()


configfile: SOURCE / "workflow" / "config.yaml"


include: "workflow/rules/common.smk"
include: "workflow/rules/captures.smk"
include: "workflow/rules/reduction.smk"
include: "workflow/rules/figures.smk"
include: "workflow/rules/pages_common.smk"
include: "workflow/rules/pages.smk"
include: "workflow/rules/summary.smk"
include: "workflow/rules/archive.smk"
include: "workflow/rules/batches.smk"
include: "workflow/rules/diagnose.smk"
include: "workflow/rules/derive.smk"
include: "workflow/rules/report.smk"
include: "workflow/rules/withheld.smk"
include: "workflow/rules/begin_and_end.smk"


rule all:
    default_target: True
    input:
        summary_tables(),
        expand(run_file("outputs.json"), zip, **run_wildcards()),
        expand(f"{RESULTS}/{{campaign}}/_diagnosis/diagnosis.json", campaign=DIAGNOSED),
        expand(f"{RESULTS}/{{campaign}}/_calibration/derivation.json", campaign=DERIVED),
        expand(f"{RESULTS}/{{campaign}}/_report/report.json", campaign=REPORTED),
        [f"{RESULTS}/index.html"] if CONFIG.pages.enabled else [],


onstart:
    begin()


onsuccess:
    end_well()


onerror:
    end_badly()
