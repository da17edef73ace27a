"""The withheld-data bench: protocol, campaigns, diagnoses, seals, scores, report.

The order is the point.  The protocol is sealed before a label exists; a diagnoser sees a batch's campaigns and
nothing else; the labels reach one rule, scoring, which needs the seal over all diagnoses first.
"""


include: "withheld_common.smk"


rule withheld:
    input:
        expand(f"{WITHHELD_OUT}/report/{{candidate}}", candidate=WITHHELD["candidates"]),


rule withheld_protocol:
    output:
        protocol=f"{WITHHELD_OUT}/protocol.json",
        seal=f"{WITHHELD_OUT}/protocol.sha256",
    log:
        f"{WITHHELD_OUT}/logs/protocol.log",
    params:
        study=WITHHELD["study"],
        seed=WITHHELD["seed"],
        cases=WITHHELD_CASES,
        code=withheld_code("chain", "effects", "study", "clairvoyant", "score"),
    shell:
        "python -m withheld protocol --study {params.study} --seed {params.seed}"
        " --cases {params.cases} --out {output.protocol} > {log} 2>&1"


rule withheld_make:
    input:
        protocol=rules.withheld_protocol.output.protocol,
        seal=rules.withheld_protocol.output.seal,
        earlier=withheld_earlier,
    output:
        campaigns=temp(directory(f"{WITHHELD_OUT}/campaigns/batch-{{batch}}")),
        labels=f"{WITHHELD_OUT}/sealed/batch-{{batch}}.json",
    log:
        f"{WITHHELD_OUT}/logs/make-{{batch}}.log",
    wildcard_constraints:
        batch=r"\d{3}",
    params:
        size=WITHHELD["batch"],
    shell:
        "OPENBLAS_NUM_THREADS=1 python -m withheld make --protocol {input.protocol}"
        " --batch {wildcards.batch} --size {params.size} --out {output.campaigns} --labels {output.labels} > {log} 2>&1"


rule withheld_seal_labels:
    input:
        expand(f"{WITHHELD_OUT}/sealed/batch-{{batch}}.json", batch=WITHHELD_BATCHES),
    output:
        f"{WITHHELD_OUT}/labels.sha256",
    log:
        f"{WITHHELD_OUT}/logs/seal_labels.log",
    params:
        root=lambda wildcards, input: Path(input[0]).parent,
    shell:
        "python -m withheld seal --root {params.root} --files 'batch-*.json' --out {output} > {log} 2>&1"


rule withheld_diagnose:
    input:
        campaigns=rules.withheld_make.output.campaigns,
    output:
        directory(f"{WITHHELD_OUT}/diagnoses/{{candidate}}/batch-{{batch}}"),
    log:
        f"{WITHHELD_OUT}/logs/diagnose-{{candidate}}-{{batch}}.log",
    wildcard_constraints:
        batch=r"\d{3}",
    priority: 10
    params:
        diagnoser=lambda wildcards: WITHHELD["candidates"][wildcards.candidate],
    shell:
        "python -m withheld diagnose --diagnoser {params.diagnoser:q}"
        " --batch {input.campaigns} --out {output} > {log} 2>&1"


rule withheld_seal_diagnoses:
    input:
        lambda wildcards: expand(
            f"{WITHHELD_OUT}/diagnoses/{wildcards.candidate}/batch-{{batch}}",
            batch=WITHHELD_BATCHES,
        ),
    output:
        f"{WITHHELD_OUT}/diagnoses-{{candidate}}.sha256",
    log:
        f"{WITHHELD_OUT}/logs/seal-{{candidate}}.log",
    params:
        root=lambda wildcards: f"{WITHHELD_OUT}/diagnoses/{wildcards.candidate}",
    shell:
        "python -m withheld seal --root {params.root} --files 'batch-*/case-*/diagnosis.json' --out {output} > {log} 2>&1"


rule withheld_score:
    input:
        protocol=rules.withheld_protocol.output.protocol,
        labels_seal=rules.withheld_seal_labels.output,
        diagnoses_seal=rules.withheld_seal_diagnoses.output,
        labels=rules.withheld_seal_labels.input,
    output:
        f"{WITHHELD_OUT}/scores/{{candidate}}.json",
    log:
        f"{WITHHELD_OUT}/logs/score-{{candidate}}.log",
    params:
        ledger=WITHHELD_LEDGER,
        labels=lambda wildcards, input: Path(input.labels[0]).parent,
        diagnoses=lambda wildcards: f"{WITHHELD_OUT}/diagnoses/{wildcards.candidate}",
    shell:
        "python -m withheld score --protocol {input.protocol} --labels {params.labels}"
        " --labels-seal {input.labels_seal} --diagnoses {params.diagnoses}"
        " --diagnoses-seal {input.diagnoses_seal} --candidate {wildcards.candidate}"
        " --ledger {params.ledger} --out {output} > {log} 2>&1"


rule withheld_report:
    input:
        rules.withheld_score.output,
    output:
        directory(f"{WITHHELD_OUT}/report/{{candidate}}"),
    log:
        f"{WITHHELD_OUT}/logs/report-{{candidate}}.log",
    params:
        code=withheld_code("report"),
    shell:
        "python -m withheld report --scores {input} --out {output} > {log} 2>&1"
