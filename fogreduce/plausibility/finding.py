"""What a look at a capture finds: an error, or a warning that is repeated where results are shown."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from fogreduce.datasets.logs import TableLog, TemperatureLog
from fogreduce.errors import Fault
from fogreduce.metadata.facts import RunFacts


@dataclass(frozen=True)
class Finding:
    """One thing about a run that does not fit.

    Attributes
    ----------
    severity : str
        ``error`` or ``warning``.
    what : str
        Its kind, one word.
    file, key : str
        The file it was found in, and the key of run.yaml (or the place) that it concerns.
    found, expected : str
    """

    severity: str
    what: str
    file: str
    key: str
    found: str
    expected: str

    @property
    def where(self) -> str:
        """File and key."""
        return f"{self.file}: {self.key}" if self.key else self.file

    def fault(self, folder: str) -> Fault:
        """For the user, the file's folder before its name."""
        return Fault(f"{folder}/{self.file}" if folder else self.file, self.key, self.found, self.expected)


@dataclass(frozen=True)
class Seen:
    """A run as its capture and logs show it.

    Attributes
    ----------
    facts : RunFacts
        The run's numbers.
    run : mapping
        run.yaml.
    report : mapping
        What ingest says of the capture (`fogreduce.stages.ingest.Ingest.report`).
    temperature, table : log or None
    """

    facts: RunFacts
    run: Mapping[str, Any]
    report: Mapping[str, Any]
    temperature: TemperatureLog | None = None
    table: TableLog | None = None

    @property
    def capture(self) -> str:
        """The capture's file name."""
        return str(self.run["capture"]["file"])

    @property
    def records(self) -> int:
        """Records in the capture."""
        return int(self.report["records"])

    def warning(self, what: str, key: str, found: str, expected: str, file: str | None = None) -> Finding:
        """A warning about the capture, or another file."""
        return Finding("warning", what, file or self.capture, key, found, expected)
