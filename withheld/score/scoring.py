"""Scores a study once: checks every seal, judges every case, sums up."""

from contextlib import suppress
from pathlib import Path
from typing import Any

from withheld.atomic import read_json, sha256
from withheld.errors import BadInput
from withheld.score.diagnosis_file import read_diagnosis
from withheld.score.judge import Outcome, judge
from withheld.score.summary import summarise
from withheld.study.ledger import enter
from withheld.study.protocol import Thresholds, code_hash, protocol_from
from withheld.study.seal import check_seal


def judge_batch(
    labels: list[dict[str, Any]], folder: Path, sealed: set[Path], thresholds: Thresholds
) -> list[Outcome]:
    """Outcomes of one batch; a diagnosis that was not sealed, or is not of the contract's form, is none."""
    timing = read_json(folder / "timing.json")
    outcomes = []
    for label in labels:
        path, diagnosis = folder / label["case"] / "diagnosis.json", None
        if path in sealed:
            with suppress(BadInput):
                diagnosis = read_diagnosis(path)
        outcomes.append(judge(label, diagnosis, thresholds, timing.get(label["case"], {}).get("wall_s")))
    return outcomes


def score(
    protocol_path: Path, protocol_seal: Path, labels_root: Path, labels_seal: Path,
    diagnoses_root: Path, diagnoses_seal: Path, candidate: str, ledger: Path,
) -> dict[str, Any]:  # fmt: skip
    """The scores of one candidate on one study.

    Raises
    ------
    BadInput
        Where a seal does not hold, where the bench's own code is not what the protocol was sealed with, or
        where the study has been scored before with other diagnoses.
    """
    check_seal(protocol_seal, protocol_path.parent)
    document = read_json(protocol_path)
    if document["code_sha256"] != code_hash():
        raise BadInput(
            f"{protocol_path}: the bench has changed since this protocol was sealed; start another study"
        )
    protocol = protocol_from(document)
    sealed = set(check_seal(diagnoses_seal, diagnoses_root))
    outcomes = []
    for path in check_seal(labels_seal, labels_root):
        outcomes += judge_batch(read_json(path), diagnoses_root / path.stem, sealed, protocol.thresholds)
    if len(outcomes) != protocol.cases:
        raise BadInput(f"{labels_seal}: labels of {len(outcomes)} cases; the protocol has {protocol.cases}")
    stood = enter(ledger, protocol, candidate, sha256(labels_seal), sha256(diagnoses_seal))
    return {
        "schema": "withheld/scores/1", "study": protocol.name, "seed": protocol.seed, "once": protocol.once,
        "candidate": candidate, "studies_before": stood["before"], "tries_before": stood["tries"],
        "seals": {
            "protocol": sha256(protocol_path), "labels": sha256(labels_seal),
            "diagnoses": sha256(diagnoses_seal),
        },
        "summary": summarise(outcomes, protocol.thresholds),
        "outcomes": [plain_outcome(outcome) for outcome in outcomes],
    }  # fmt: skip


def plain_outcome(outcome: Outcome) -> dict[str, Any]:
    """What the figures need of an outcome."""
    return {
        name: getattr(outcome, name)
        for name in ("case", "kind", "design", "effects", "snr", "separated", "flagged", "exact", "by_group",
                     "fate", "answer", "valid", "verdict_right", "pulls", "closure", "seconds")
    }  # fmt: skip
