"""What a calibration record has gone into: results of runs, what is made of these, and later records."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from fogreduce.archive.contents import OF_CAMPAIGN
from fogreduce.calibrate.registry import read_registry
from fogreduce.errors import BadInput
from fogreduce.reruns.uses import uses_below


def impact(record_id: str, results: Path, calibrations: Path) -> dict[str, Any]:
    """What used a record.

    Parameters
    ----------
    record_id : str
        ``<unit>@<version>``; its file need not be there any more.
    results : Path
        ``<results>/<campaign>/<run>``.
    calibrations : Path
        The records, among which may be some derived from this one; passed over where there is no such folder.

    Returns
    -------
    dict
        ``runs``: results of the newest version, which are what a rerun with another record would change.
        ``of_runs``: diagnoses and derivations of campaigns. ``kept``: older versions, which stay as they are.
        ``records``: records that supersede it or were derived from it. ``sha256``: bytes that were used.
    """
    uses = [use for use in uses_below(results) if use.record_id == record_id]
    newest = [use.results for use in uses if not use.version]
    campaigns = dict.fromkeys(name.partition("/")[0] for name in newest)
    of_runs = [
        f"{campaign}/{name}"
        for campaign in campaigns
        for name in OF_CAMPAIGN
        if (results / campaign / name / "index.html").is_file()
    ]
    of_runs += [name for name in _derivations(record_id, results) if name not in of_runs]
    if not uses and not (calibrations / f"{record_id.replace('@', '/')}.yaml").is_file():
        expected = "a record of this folder, or one that results used"
        raise BadInput.at(calibrations, "", found=f"no record {record_id}", expected=expected)
    same = {(use.results, use.sha256) for use in uses if not use.version}
    return {
        "record": record_id,
        "sha256": list(dict.fromkeys(use.sha256 for use in uses)),
        "runs": newest,
        "of_runs": of_runs,
        "kept": [str(use) for use in uses if use.version and (use.results, use.sha256) not in same],
        "records": _records(record_id, calibrations),
    }


def _derivations(record_id: str, results: Path) -> list[str]:
    """Derivations that started from the record."""
    found = []
    for path in sorted(results.glob("*/_calibration/derivation.json")):
        try:
            started = json.loads(path.read_bytes())["started_from"]
        except (OSError, ValueError, KeyError, TypeError):
            continue
        if started == record_id:
            found.append(path.parent.relative_to(results).as_posix())
    return found


def _records(record_id: str, calibrations: Path) -> list[str]:
    """Records that name this one as superseded or as their starting point."""
    if not calibrations.is_dir():
        return []
    entries, _ = read_registry(calibrations)
    return [
        entry.record_id
        for entry in entries
        if entry.record.supersedes == record_id
        or (entry.record.pedigree is not None and entry.record.pedigree.started_from == record_id)
    ]
