"""Settings and file names of the withheld-data bench."""

import hashlib
from pathlib import Path

WITHHELD_DEFAULTS = {
    "study": "small",  # small: tries the path; full: the first kinds; whole: and every class; quarter: of whole
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
    stop(
        f"configuration: withheld.{unknown[0]}: found an unknown key; expected one of {', '.join(WITHHELD_DEFAULTS)}"
    )
if WITHHELD["study"] not in ("small", "quarter", "full", "whole"):
    stop(
        f"configuration: withheld.study: found {WITHHELD['study']}; expected small, quarter, full or whole"
    )
# The protocol's command checks the number of cases.
WITHHELD_CASES = {"small": 20, "quarter": 386, "full": 1216, "whole": 1500}[
    WITHHELD["study"]
]
WITHHELD_OUT = f"{config.get('results_dir', 'results')}/withheld/{WITHHELD['study']}-{WITHHELD['seed']}"
WITHHELD_LEDGER = WITHHELD["ledger"] or (
    "docs/withheld-studies/ledger.json"
    if WITHHELD["study"] != "small"
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
        for path in sorted((root / part).rglob("*.py")):
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
