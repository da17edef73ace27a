"""What a workflow says of itself: all of it in its log, a bar on a terminal, at the end what matters.

Snakemake's messages are records of the standard library's `logging`, which its own means sort here.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterable, Iterator
from contextlib import ExitStack, suppress
from dataclasses import dataclass
from pathlib import Path

from fogreduce.progress import Progress, progress, silent

_NOTHING = "Nothing to be done"
#: What Snakemake says whenever a job has ended; of failed ones, the end says why.
_OF_EACH_JOB = (
    "Select jobs to execute",
    "Execute ",
    "RuleException",
    "Exiting because a job execution failed",
)


@dataclass(frozen=True)
class FailedJob:
    """A job that failed: its rule, and its log where the rule has one."""

    rule: str
    log: str


class Messages(logging.Handler):
    """Shows on a terminal how far the workflow is, and keeps which jobs failed.

    Parameters
    ----------
    nothing_to_do : callable
        Called where everything is there already: Snakemake then calls none of its own handlers.
    """

    def __init__(self, nothing_to_do: Callable[[], None]) -> None:
        super().__init__()
        self._nothing_to_do = nothing_to_do
        self._bar = ExitStack()
        self._advance: Progress = silent
        self._jobs = self._started = 0
        self.failed: list[FailedJob] = []

    def emit(self, record: logging.LogRecord) -> None:
        """One of Snakemake's messages."""
        event = str(getattr(getattr(record, "event", None), "value", ""))
        if event == "run_info":
            self._jobs = int(getattr(record, "stats", {}).get("total", 0))
        elif event == "job_info" and self._jobs:
            if not self._started:
                self._advance = self._bar.enter_context(progress(self._jobs, "jobs"))
            self._started += 1
            self._advance(min(self._started, self._jobs))
        elif event == "job_error":
            self._keep(getattr(record, "rule_name", "?"), getattr(record, "log", None))
        elif event == "group_error":
            for job in getattr(record, "job_error_info", None) or ():
                self._keep(job.get("rule_name", "?"), job.get("log"))
        elif record.getMessage().startswith(_NOTHING):
            self._nothing_to_do()

    def _keep(self, rule: str, logs: Iterable[object] | None) -> None:
        self.failed.append(FailedJob(rule, str(next(iter(logs or ()), ""))))

    def end(self) -> None:
        """Take the bar away, before the end is told."""
        self._bar.close()

    def close(self) -> None:
        """As the handler is taken away."""
        self.end()
        super().close()


def choose_messages(logger: logging.Logger, *, dry_run: bool) -> None:
    """What of Snakemake's messages goes where, beyond what ``--quiet`` says.

    The log file takes every message: what a terminal is spared is wanted there. A dry run is asked for to see
    what would be done, so it says it. And nobody is told twice a second that jobs are being selected.

    Parameters
    ----------
    logger : logging.Logger
        Snakemake's.
    dry_run : bool
    """
    for handler in logger.handlers:
        if dry_run or isinstance(handler, logging.FileHandler):
            for quiet in list(handler.filters):
                handler.removeFilter(quiet)
        elif isinstance(handler, logging.StreamHandler):
            handler.addFilter(lambda record: not record.getMessage().startswith(_OF_EACH_JOB))


def result_lines(
    results: Path, runs: Iterable[tuple[str, str]], failed: Iterable[FailedJob] = (), *, pages: bool
) -> Iterator[str]:
    """The end of a workflow in words: how many runs are reduced, flagged, failed, and the page to open.

    Parameters
    ----------
    results : Path
        Folder of all results.
    runs : iterable of (campaign, run)
        Those that the workflow is about.
    failed : iterable of FailedJob
        A run with one among them that has results has those of an earlier call, in part at least.
    pages : bool
        Whether it writes pages, which know what is flagged.
    """
    from fogreduce.errors import BadInput
    from fogreduce.pages.overview import kept_overview
    from fogreduce.pages.verdict import FLAGGED, verdicts

    number = reduced = earlier = 0
    logs = [job.log for job in failed]
    overviews = []
    for campaign, run in runs:
        number += 1
        folder = results / campaign / run
        if not (folder / "tables" / "drift.csv").is_file():
            continue
        if any(log.startswith(f"{folder}/") for log in logs):
            earlier += 1
            continue
        reduced += 1
        if pages:
            with suppress(BadInput):
                overviews.append(kept_overview(folder))
    if not reduced + earlier:
        return
    said = f"{number} run{'' if number == 1 else 's'}: {reduced} reduced"
    if pages:
        overviews.sort(key=lambda seen: (seen["started_at"], seen["campaign"], seen["run_id"]))
        flagged = sum(verdict.state == FLAGGED for verdict in verdicts(overviews))
        said += f", of these {flagged} flagged"
    if earlier:
        said += f"; {earlier} not made anew, with results of before"
    missing = number - reduced - earlier
    yield said + (f"; {missing} not reduced" if missing else "")
    if pages and (page := results / "index.html").is_file():
        yield f"Open {page}"


def failed_lines(jobs: Iterable[FailedJob], not_reduced: Iterable[str]) -> Iterator[str]:
    """Jobs that failed beside the runs that are not reduced: rule, log and the log's last line.

    Parameters
    ----------
    jobs : iterable of FailedJob
    not_reduced : iterable of str
        Folders of results of runs whose failure is told already.
    """
    prefixes = tuple(f"{folder}/" for folder in not_reduced)
    for job in jobs:
        if job.log.startswith(prefixes):
            continue
        try:
            said = Path(job.log).read_text(encoding="utf-8", errors="replace").split("\n")
        except OSError:
            said = []
        last = next((" ".join(line.split()) for line in reversed(said) if line.strip()), "no message")
        yield f"  {job.rule}: {job.log}: {last}" if job.log else f"  {job.rule}"
