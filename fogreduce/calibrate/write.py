"""What a derivation leaves: candidate record, certificate on paper and as XML, document and page."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from fogreduce.calibrate.certificate import certificate_facts
from fogreduce.calibrate.certificate_pdf import write_pdf
from fogreduce.calibrate.dcc import write_dcc
from fogreduce.calibrate.derive import Derivation
from fogreduce.calibrate.document import document
from fogreduce.calibrate.page import write_page
from fogreduce.calibrate.record import candidate
from fogreduce.datasets.atomic import write_text
from fogreduce.errors import BadInput
from fogreduce.metadata.certificate import Certificate
from fogreduce.metadata.folder import load_calibration, load_campaign
from fogreduce.metadata.yaml12 import dump_yaml
from fogreduce.provenance.digest import data_digest, file_digest
from fogreduce.stages.files import write_json

_DIGITS = 8  # of a digest that is part of a version's name


def write_derivation(
    found: Derivation, campaign: Path, calibrations: Path, version: str | None, out: Path
) -> tuple[dict[str, Any], list[Path]]:
    """Write everything that a derivation leaves; no record where something is not determined.

    Parameters
    ----------
    found : Derivation
    campaign, calibrations : Path
        Where it comes from.
    version : str or None
        The record's version; None: the present one's, with a digest of the new one's content after it.
    out : Path

    Returns
    -------
    dict
        The document (derivation.json).
    list of Path
        The candidate record and its certificates.

    Raises
    ------
    BadInput
        Where a record of this version is there with another content: records are never rewritten.
    """
    present = found.readings[0].record
    about = load_campaign(campaign).certificate or Certificate()
    paths: list[Path] = []
    candidate_id = None
    if not found.undetermined:
        record, text, version = _named(found, campaign, version)
        path = out / present.unit / f"{version}.yaml"
        if path.exists() and path.read_text(encoding="utf-8") != text:
            expected = "a version that is not there yet (records are never rewritten): --record-version"
            raise BadInput.at(path, "", found="another record of this version", expected=expected)
        candidate_id = f"{present.unit}@{version}"
        write_text(path, text)
        paths = [path, path.with_suffix(".pdf"), path.with_suffix(".dcc.xml")]
    data = document(found, campaign, candidate_id)
    if paths:
        _, present_path = load_calibration(calibrations, present.record_id)
        facts = certificate_facts(
            found,
            record,
            file_digest(paths[0]),
            file_digest(present_path),
            about,
            data["chi2"]["p_value"],
        )
        write_pdf(facts, paths[1])
        write_dcc(facts, paths[2])
    write_json(out / "derivation.json", data)
    write_page(found, data, out / "index.html")
    return data, paths


def _named(found: Derivation, campaign: Path, version: str | None) -> tuple[dict[str, Any], str, str]:
    """The record, its text and its version."""
    present = found.readings[0].record
    if version is None:
        content = candidate(found, campaign, present.version)
        version = f"{present.version}-{data_digest(content)[:_DIGITS]}"
    record = candidate(found, campaign, version)
    return record, dump_yaml(record), version
