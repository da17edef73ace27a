"""What of a workflow's messages reaches a terminal, its log, its end."""

from __future__ import annotations

import logging
from enum import Enum
from pathlib import Path

import pytest

from fogreduce.cli.workflow_messages import FailedJob, Messages, choose_messages, failed_lines, result_lines


class Event(Enum):
    RUN_INFO = "run_info"
    JOB_INFO = "job_info"
    JOB_ERROR = "job_error"
    GROUP_ERROR = "group_error"


@pytest.fixture
def logger() -> logging.Logger:
    made = logging.Logger("workflow")
    made.setLevel(logging.INFO)
    return made


def test_failed_jobs_are_kept_with_their_logs(logger: logging.Logger) -> None:
    messages = Messages(nothing_to_do=lambda: pytest.fail("there was something to do"))
    logger.addHandler(messages)
    logger.info("Job stats", extra={"event": Event.RUN_INFO, "stats": {"total": 2}})
    logger.info("rule fit", extra={"event": Event.JOB_INFO})
    logger.error("Error", extra={"event": Event.JOB_ERROR, "rule_name": "fit", "log": ["a/logs/fit.log"]})
    jobs = [{"rule_name": "drift", "log": []}]
    logger.error("Error", extra={"event": Event.GROUP_ERROR, "job_error_info": jobs})
    assert [(job.rule, job.log) for job in messages.failed] == [("fit", "a/logs/fit.log"), ("drift", "")]


def test_where_nothing_is_to_be_done_the_end_is_told_nevertheless(logger: logging.Logger) -> None:
    told: list[str] = []
    logger.addHandler(Messages(nothing_to_do=lambda: told.append("end")))
    logger.info("Building DAG of jobs...")
    assert told == []
    logger.info("Nothing to be done (all requested files are present and up to date).")
    assert told == ["end"]


@pytest.mark.parametrize("dry_run", [False, True])
def test_the_log_has_what_a_terminal_is_spared(
    logger: logging.Logger, tmp_path: Path, capsys: pytest.CaptureFixture[str], dry_run: bool
) -> None:
    terminal, log = logging.StreamHandler(), logging.FileHandler(tmp_path / "log")
    for handler in (terminal, log):
        handler.addFilter(lambda record: "rule" not in record.getMessage())  # as --quiet does
        logger.addHandler(handler)
    choose_messages(logger, dry_run=dry_run)
    said = ["Select jobs to execute...", "rule fit", "RuleException:\nCalledProcessError", "a warning"]
    for message in said:
        logger.info(message)
    log.close()
    assert (tmp_path / "log").read_text() == "\n".join([*said, ""])
    assert capsys.readouterr().err.split("\n")[:-1] == ("\n".join(said).split("\n") if dry_run else said[-1:])


def test_jobs_beside_the_runs_that_failed(tmp_path: Path) -> None:
    messages = Messages(nothing_to_do=lambda: None)
    log = tmp_path / "lab" / "a" / "logs" / "figures.log"
    log.parent.mkdir(parents=True)
    log.write_text("one\nlast   line\n\n")
    for rule, path in (
        ("figures", str(log)),
        ("ingest", f"{tmp_path}/lab/b/logs/ingest.log"),
        ("bag", "none"),
    ):
        record = logging.makeLogRecord({"event": Event.JOB_ERROR, "rule_name": rule, "log": [path]})
        messages.emit(record)
    assert list(failed_lines(messages.failed, [f"{tmp_path}/lab/b"])) == [
        f"  figures: {log}: last line",
        "  bag: none: no message",
    ]


def test_the_end_of_runs_of_which_none_was_asked_for(tmp_path: Path) -> None:
    assert list(result_lines(tmp_path, [("lab", "a")], pages=True)) == []
    (tmp_path / "lab/a/tables").mkdir(parents=True)
    (tmp_path / "lab/a/tables/drift.csv").write_text("axis\n")
    assert list(result_lines(tmp_path, [("lab", "a"), ("lab", "b")], pages=False)) == [
        "2 runs: 1 reduced; 1 not reduced"
    ]


def test_a_run_with_a_failed_job_is_not_counted_as_reduced(tmp_path: Path) -> None:
    for run in ("a", "b"):
        (tmp_path / f"lab/{run}/tables").mkdir(parents=True)
        (tmp_path / f"lab/{run}/tables/drift.csv").write_text("axis\n")
    failed = [FailedJob("manifest", f"{tmp_path}/lab/b/logs/manifest.log")]
    assert list(result_lines(tmp_path, [("lab", "a"), ("lab", "b")], failed, pages=False)) == [
        "2 runs: 1 reduced; 1 not made anew, with results of before"
    ]
