"""One kind of campaigns, made, diagnosed and scored in one go, with open labels: training, not evidence.

Captures lie on disk one batch at a time.  What is done stays done: the same command again goes on.
"""

import shutil
from dataclasses import replace
from pathlib import Path
from typing import Any

from withheld.atomic import read_json, write_json, write_text
from withheld.errors import BadInput
from withheld.report.page import tables
from withheld.score.scoring import judge_batch
from withheld.score.summary import summarise
from withheld.study.batch import batch_plans, check_training, make_batch
from withheld.study.classes import CLASSES
from withheld.study.protocol import Protocol, study
from withheld.study.run_diagnoser import run_batch

# The first studies' kinds, and the number in a protocol that counts them.
_COUNTS = {
    "nothing": "nothing_wrong", "single": "singles_each", "pair": "pairs", "triple": "triples",
    "without": "without_each", "stranger": "strangers_each",
}  # fmt: skip
KINDS = (*_COUNTS, *CLASSES)
DIAGNOSER = (
    "fogreduce diagnose {batch}/campaigns --calibrations {calibrations} --out {out}"
    " --each {batch}/public.json"
)


def only(kind: str, seed: int, campaigns: int) -> Protocol:
    """A protocol of one kind; of `single`, `without` and `stranger` that many for each effect."""
    empty = replace(
        study("full", seed), name=f"training-{kind}", once=False, nothing_wrong=0, singles_each=0,
        pairs=0, triples=0, without_each=0, strangers_each=0, classes={},
    )  # fmt: skip
    if kind in CLASSES:
        return replace(empty, classes={kind: campaigns})
    if kind in _COUNTS:
        return replace(empty, **{_COUNTS[kind]: campaigns})  # type: ignore[arg-type]
    raise BadInput(f"kind {kind}: expected one of {', '.join(KINDS)}")


def examine(
    kind: str, seed: int, campaigns: int, diagnoser: str, out: Path, size: int = 4, keep: bool = False
) -> dict[str, Any]:
    """Make, diagnose and score `campaigns` campaigns of a kind, `size` at a time; `keep` leaves the captures.

    Returns
    -------
    dict
        As `summarise` gives it; also written to `out/scores.json`, and its tables to `out/index.md`.
    """
    check_training(seed)
    protocol = only(kind, seed, campaigns)
    outcomes = []
    for number in range(-(-protocol.cases // size)):
        name = f"batch-{number:03d}"
        batch, labels, said = (
            out / "batches" / name,
            out / "labels" / f"{name}.json",
            out / "diagnoses" / name,
        )
        if not labels.exists() or not said.exists():
            make_batch(protocol, batch_plans(protocol, number, size), batch, labels)
            run_batch(diagnoser, batch, said)
        if not keep:
            shutil.rmtree(batch, ignore_errors=True)
        every = {path for path in said.glob("*/diagnosis.json")}
        outcomes += judge_batch(read_json(labels), said, every, protocol.thresholds)
    summary = summarise(outcomes, protocol.thresholds)
    write_json(out / "scores.json", summary)
    head = (
        f"# {kind}: {campaigns} campaigns, training seed {seed}\n\nLabels were open: this is no evidence.\n"
    )
    write_text(out / "index.md", "\n".join([head, *tables(summary)]))
    return summary
