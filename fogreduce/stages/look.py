"""What does not fit about a run, found at ingest: errors stop it, warnings make a table."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from fogreduce.datasets.run_logs import table_log_of, temperatures_of
from fogreduce.errors import BadInput
from fogreduce.metadata.facts import RunFacts
from fogreduce.plausibility.finding import Finding, Seen
from fogreduce.plausibility.look import findings
from fogreduce.stages.setup import Setup
from fogreduce.stages.tables import write_table

COLUMNS = ("severity", "what", "where", "found", "expected", "version_id")


def look(facts: RunFacts, run: Mapping[str, Any], report: Mapping[str, Any], run_dir: Path) -> list[Finding]:
    """Warnings about a run.

    Parameters
    ----------
    facts : RunFacts
    run : mapping
        run.yaml.
    report : mapping
        What ingest says of the capture.
    run_dir : Path
        Where the logs lie.

    Raises
    ------
    BadInput
        What cannot be right.
    """
    seen = Seen(
        facts,
        run,
        report,
        temperatures_of(run_dir, run, facts.start_us),
        table_log_of(run_dir, run, facts.start_us),
    )
    found = findings(seen)
    errors = [finding.fault(str(run_dir)) for finding in found if finding.severity == "error"]
    if errors:
        raise BadInput(*errors)
    return found


def write_warnings(setup: Setup, found: list[Finding]) -> None:
    """Table ``warnings.csv``; header only where all fits."""
    write_table(
        setup.table("warnings"),
        COLUMNS,
        [
            [
                one.severity,
                one.what,
                _quoted(one.where),
                _quoted(one.found),
                _quoted(one.expected),
                setup.version_id,
            ]
            for one in found
        ],
    )


def _quoted(text: str) -> str:
    """A field of a table that may hold a comma."""
    return f'"{text.replace(chr(34), chr(39))}"' if "," in text or '"' in text else text
