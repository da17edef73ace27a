"""The tables of many runs gathered into one, and the runs that have none, with the reason.

Lines are copied as they stand, one run at a time, so that every digit and flat memory are kept.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Iterator, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import TextIO

from fogreduce.datasets.atomic import whole_file
from fogreduce.errors import BadInput
from fogreduce.provenance.manifest_file import MANIFEST, read_record

#: Table of a run -> table of all runs.
GATHERED = {"drift": "drift_all", "rate_fit": "rates_all", "rates": "commanded_all"}

#: Results of earlier versions are without these.
_MAY_BE_ABSENT = ("rates",)

#: In front of the columns of a gathered table.
RUN_COLUMNS = ("campaign", "run_id", "label")
FAILED_COLUMNS = ("campaign", "run_id", "stage", "reason")

#: Logs of a run, in the order in which jobs write them; of a capture, where it is simulated.
_LOGS = ("capture", "manifest", "ingest", "calibrate", "project", "remove_earth", "fit", "drift")
_LONGEST_REASON = 500
#: Lines of a log that begin so are said beside results, and are no reason why there are none.
RED_FLAG, WARNING = "red flag: ", "warning: "


@dataclass(frozen=True)
class RunResults:
    """The results folder of a run, and what the run is called."""

    folder: Path
    campaign: str
    run_id: str


def write_summary(runs: Iterable[RunResults], out: Path) -> tuple[int, int]:
    """Write ``drift_all.csv``, ``rates_all.csv``, ``commanded_all.csv`` and ``failed.csv`` into `out`.

    Parameters
    ----------
    runs : iterable of RunResults
        In the order in which their rows shall stand.
    out : Path
        Folder for the tables; each appears whole or not at all.

    Returns
    -------
    gathered, failed : int
        How many runs went into the tables, and how many have none.
    """
    headers: dict[str, str] = {}
    gathered = failed = 0
    with ExitStack() as stack:

        def opened(name: str) -> TextIO:
            path = stack.enter_context(whole_file(out / f"{name}.csv"))
            return stack.enter_context(path.open("w", encoding="utf-8", newline=""))

        tables = {name: opened(into) for name, into in GATHERED.items()}
        failures = opened("failed")
        failures.write(",".join(FAILED_COLUMNS) + "\n")
        for run in runs:
            lines, problem = _tables_of(run)
            if problem:
                failures.write(_csv_line((run.campaign, run.run_id, *problem)) + "\n")
                failed += 1
                continue
            gathered += 1
            prefix = _csv_line((run.campaign, run.run_id, _label(run.folder)))
            for name, (header, *rows) in lines.items():
                if name not in headers:
                    headers[name] = header
                    tables[name].write(",".join((*RUN_COLUMNS, header)) + "\n")
                if header != headers[name]:
                    raise BadInput.at(
                        _table(run.folder, name), "line 1", found=header, expected=headers[name]
                    )
                tables[name].writelines(f"{prefix},{row}\n" for row in rows)
        for name in set(tables) - set(headers):
            tables[name].write(",".join(RUN_COLUMNS) + "\n")
    return gathered, failed


def why_not_reduced(run: RunResults) -> str:
    """Why a run has no tables; empty where it has."""
    problem = _tables_of(run)[1]
    return "" if problem is None else ": ".join(filter(None, problem))


def find_results(parent: Path) -> Iterator[RunResults]:
    """Every ``<campaign>/<run_id>`` below a results folder; names that begin with ``_`` or ``.`` are none."""
    for campaign in _folders(parent):
        for run in _folders(campaign):
            yield RunResults(run, campaign.name, run.name)


def one_result(folder: Path) -> RunResults:
    """The results of one run, wherever they lie: what it is called stands in its manifest."""
    manifest = _manifest(folder)
    return RunResults(folder, str(manifest.get("campaign", "")), str(manifest.get("run_id", folder.name)))


def _folders(parent: Path) -> list[Path]:
    return sorted(path for path in parent.iterdir() if path.is_dir() and path.name[0] not in "_.")


def _table(folder: Path, name: str) -> Path:
    return folder / "tables" / f"{name}.csv"


def _manifest(folder: Path) -> dict[str, object]:
    return read_record(folder / MANIFEST, "the run's manifest")


def _label(folder: Path) -> str:
    return str(_manifest(folder).get("label") or "")


def _tables_of(run: RunResults) -> tuple[dict[str, list[str]], tuple[str, str] | None]:
    """The lines of each table; or the stage that failed and why."""
    lines = {}
    try:
        version = str(_manifest(run.folder).get("version_id"))
        for name in GATHERED:
            path = _table(run.folder, name)
            if name in _MAY_BE_ABSENT and not path.exists():
                continue
            lines[name] = path.read_text(encoding="utf-8").splitlines()
            if not lines[name]:
                return {}, (name, f"{path}: found an empty file; expected a table")
            if any(found != version for found in _versions(lines[name])):
                return {}, (name, f"{path}: found rows of another version; expected {version}")
    except FileNotFoundError as error:
        return {}, why_none(run.folder, f"{error.filename}: found no such file; expected a table")
    except BadInput as error:
        return {}, why_none(run.folder, str(error))
    return lines, None


def _versions(lines: list[str]) -> Iterator[str]:
    """The version id of each row."""
    header, *rows = csv.reader(lines)
    place = header.index("version_id") if "version_id" in header else -1
    return (row[place] if place < len(row) else "" for row in rows)


def why_none(folder: Path, otherwise: str) -> tuple[str, str]:
    """Why a run has no tables: the first stage whose log says something, and what; without one, `otherwise`.

    Of a traceback the last line.
    """
    for stage in _LOGS:
        path = folder / "logs" / f"{stage}.log"
        try:
            said = path.read_text(encoding="utf-8", errors="replace").split("\n")
        except FileNotFoundError:
            continue
        said = [
            " ".join(line.split())
            for line in said
            if line.strip() and not line.startswith((RED_FLAG, WARNING))
        ]
        if any(line.startswith("Traceback") for line in said):
            said = said[-1:]
        if said:
            reason = " | ".join(said)
            return stage, reason if len(reason) <= _LONGEST_REASON else f"{reason[:_LONGEST_REASON]} ..."
    return "", otherwise


def _csv_line(fields: Sequence[str]) -> str:
    """Fields as one line of CSV, quoted where they must be."""
    text = io.StringIO()
    csv.writer(text, lineterminator="").writerow(fields)
    return text.getvalue()
