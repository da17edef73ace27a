"""The withheld-data bench: protocol, campaigns, diagnoses, seals, scores, report.

The order is the point.  The protocol is sealed before a label exists; a diagnoser sees a batch's campaigns and
nothing else; the labels reach one rule, scoring, which needs the seal over all diagnoses first.
"""

import hashlib
from pathlib import Path

WITHHELD_DEFAULTS = {
    "study": "small",  # small: tries the path; full: the examination
    "seed": 1000001,  # a study's seeds start at 1 000 000
    "batch": 5,  # cases a job
    "window": 4,  # batches whose captures may lie on disk at once
    "candidates": {  # name: command; {campaign} {calibrations} {out}, or {batch} {out} for all at once
        name: f"python -m withheld candidate {name} --batch {{batch}} --out {{out}}"
        for name in ("no_gap", "one_group", "unexplained", "guess")
    },
    "ledger": None,  # the book of studies scored; by default with the kept reports (full) or results (small)
}
WITHHELD = {**WITHHELD_DEFAULTS, **config.get("withheld", {})}
if unknown := sorted(WITHHELD.keys() - WITHHELD_DEFAULTS.keys()):
    raise ValueError(
        f"withheld: no setting {', '.join(unknown)}; expected {', '.join(WITHHELD_DEFAULTS)}"
    )
if WITHHELD["study"] not in ("small", "full"):
    raise ValueError(f"withheld: study {WITHHELD['study']}; expected small or full")
# The protocol's command checks the number of cases.
WITHHELD_CASES = {"small": 20, "full": 1216}[WITHHELD["study"]]
WITHHELD_OUT = f"{config.get('results_dir', 'results')}/withheld/{WITHHELD['study']}-{WITHHELD['seed']}"
WITHHELD_LEDGER = WITHHELD["ledger"] or (
    "docs/withheld-studies/ledger.json"
    if WITHHELD["study"] == "full"
    else f"{config.get('results_dir', 'results')}/withheld/ledger.json"
)
WITHHELD_BATCHES = [
    f"{number:03d}" for number in range(-(-WITHHELD_CASES // WITHHELD["batch"]))
]


def withheld_code(*parts):
    """Digest of some of the bench's packages: what an edit of them makes anew."""
    root = Path(str(workflow.current_basedir)).resolve().parents[1] / "withheld"
    digest = hashlib.sha256()
    for part in parts:
        for path in sorted((root / part).glob("*.py")):
            digest.update(path.read_bytes())
    return digest.hexdigest()


def withheld_earlier(wildcards):
    """Diagnoses that have to be done, and their captures gone, before this batch is made."""
    number = int(wildcards.batch) - WITHHELD["window"]
    if number < 0:
        return []
    return [
        f"{WITHHELD_OUT}/diagnoses/{candidate}/batch-{number:03d}"
        for candidate in WITHHELD["candidates"]
    ]


rule withheld:
    input:
        expand(f"{WITHHELD_OUT}/report/{{candidate}}", candidate=WITHHELD["candidates"]),


rule withheld_protocol:
    output:
        protocol=f"{WITHHELD_OUT}/protocol.json",
        seal=f"{WITHHELD_OUT}/protocol.sha256",
    params:
        study=WITHHELD["study"],
        seed=WITHHELD["seed"],
        cases=WITHHELD_CASES,
        code=withheld_code("chain", "effects", "study", "clairvoyant", "score"),
    shell:
        "python -m withheld protocol --study {params.study} --seed {params.seed}"
        " --cases {params.cases} --out {output.protocol}"


rule withheld_make:
    input:
        protocol=rules.withheld_protocol.output.protocol,
        seal=rules.withheld_protocol.output.seal,
        earlier=withheld_earlier,
    output:
        campaigns=temp(directory(f"{WITHHELD_OUT}/campaigns/batch-{{batch}}")),
        labels=f"{WITHHELD_OUT}/sealed/batch-{{batch}}.json",
    wildcard_constraints:
        batch=r"\d{3}",
    params:
        size=WITHHELD["batch"],
    shell:
        "OPENBLAS_NUM_THREADS=1 python -m withheld make --protocol {input.protocol}"
        " --batch {wildcards.batch} --size {params.size} --out {output.campaigns} --labels {output.labels}"


rule withheld_seal_labels:
    input:
        expand(f"{WITHHELD_OUT}/sealed/batch-{{batch}}.json", batch=WITHHELD_BATCHES),
    output:
        f"{WITHHELD_OUT}/labels.sha256",
    params:
        root=f"{WITHHELD_OUT}/sealed",
    shell:
        "python -m withheld seal --root {params.root} --files 'batch-*.json' --out {output}"


rule withheld_diagnose:
    input:
        campaigns=rules.withheld_make.output.campaigns,
    output:
        directory(f"{WITHHELD_OUT}/diagnoses/{{candidate}}/batch-{{batch}}"),
    wildcard_constraints:
        batch=r"\d{3}",
    priority: 10
    params:
        diagnoser=lambda wildcards: WITHHELD["candidates"][wildcards.candidate],
    shell:
        "python -m withheld diagnose --diagnoser {params.diagnoser:q}"
        " --batch {input.campaigns} --out {output}"


rule withheld_seal_diagnoses:
    input:
        lambda wildcards: expand(
            f"{WITHHELD_OUT}/diagnoses/{wildcards.candidate}/batch-{{batch}}",
            batch=WITHHELD_BATCHES,
        ),
    output:
        f"{WITHHELD_OUT}/diagnoses-{{candidate}}.sha256",
    params:
        root=lambda wildcards: f"{WITHHELD_OUT}/diagnoses/{wildcards.candidate}",
    shell:
        "python -m withheld seal --root {params.root} --files 'batch-*/case-*/diagnosis.json' --out {output}"


rule withheld_score:
    input:
        protocol=rules.withheld_protocol.output.protocol,
        labels_seal=rules.withheld_seal_labels.output,
        diagnoses_seal=rules.withheld_seal_diagnoses.output,
        labels=rules.withheld_seal_labels.input,
    output:
        f"{WITHHELD_OUT}/scores/{{candidate}}.json",
    params:
        ledger=WITHHELD_LEDGER,
        labels=rules.withheld_seal_labels.params.root,
        diagnoses=rules.withheld_seal_diagnoses.params.root,
    shell:
        "python -m withheld score --protocol {input.protocol} --labels {params.labels}"
        " --labels-seal {input.labels_seal} --diagnoses {params.diagnoses}"
        " --diagnoses-seal {input.diagnoses_seal} --candidate {wildcards.candidate}"
        " --ledger {params.ledger} --out {output}"


rule withheld_report:
    input:
        rules.withheld_score.output,
    output:
        directory(f"{WITHHELD_OUT}/report/{{candidate}}"),
    params:
        code=withheld_code("report"),
    shell:
        "python -m withheld report --scores {input} --out {output}"
