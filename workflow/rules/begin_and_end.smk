"""How the workflow begins; what it says at its end, and what it writes where something failed.

A Snakefile that uses this one as a module calls `begin`, `end_well` and `end_badly` in its own handlers.
"""

import csv
import shlex
import subprocess
import sys
import tempfile
from pathlib import Path

from fogreduce.cli.workflow_messages import (
    Messages,
    choose_messages,
    failed_lines,
    result_lines,
)
from fogreduce.warm.start import start
from snakemake.logging import logger


def say_result():
    """How many runs are reduced, flagged and failed, and the page to open."""
    for line in result_lines(
        Path(RESULTS), RUNS, MESSAGES.failed, pages=CONFIG.pages.enabled
    ):
        print(line, file=sys.stderr)
    if "archive" in workflow.dag_settings.targets and not MESSAGES.failed:
        print(f"Bags in {RESULTS}/_archive", file=sys.stderr)


#: What Snakemake says goes to its log whole; a terminal sees how far it is.
MESSAGES = Messages(nothing_to_do=say_result)
if workflow.is_main_process:
    logger.addHandler(MESSAGES)
    choose_messages(logger, dry_run=workflow.output_settings.dryrun)


def begin():
    """Lock the results, and start the server of the jobs' commands where it is wanted."""
    lock_results()
    if CONFIG.warm_server:
        start()


def end_well():
    """Of a workflow in which every job was done."""
    MESSAGES.end()
    say_result()


def end_badly():
    """Of a workflow in which jobs failed: tables and pages of the rest, and what failed."""
    MESSAGES.end()
    print(summarize_failed(), file=sys.stderr)
    pages_of_failures()
    say_result()
    for line in missing_bags():
        print(line, file=sys.stderr)


def summarize(out):
    """Gather with what is there; nothing, or what went wrong."""
    done = subprocess.run(
        ["fogreduce", "summary", "--results", RESULTS, "--out", out]
        + ["--campaigns", CONFIG.campaigns_dir, *CONFIG.campaigns],
        capture_output=True,
        text=True,
        check=False,
    )
    return done.stderr if done.returncode else ""


def summarize_failed():
    """The summary of a workflow that failed, with what is there; the runs that are not reduced, and why."""
    wrong = summarize(SUMMARY)
    if not wrong:
        return failures(SUMMARY)
    # No room there, or no right: which runs failed is said nevertheless.
    try:
        with tempfile.TemporaryDirectory() as out:
            return wrong + (summarize(out) or failures(out))
    except OSError:
        return wrong


def failures(summary):
    """The runs that are not reduced, and why, as a summary says; the jobs that failed beside them."""
    with open(f"{summary}/failed.csv", newline="") as file:
        failed = list(csv.DictReader(file))
    lines = [
        f"  {row['campaign']}/{row['run_id']}: {row['reason'] or 'see its logs'}"
        for row in failed
    ]
    folders = [f"{RESULTS}/{row['campaign']}/{row['run_id']}" for row in failed]
    others = list(failed_lines(MESSAGES.failed, folders))
    if failed:
        lines = ["These runs are not reduced:", *lines]
    if others:
        lines += ["These jobs failed" + (" too:" if failed else ":"), *others]
    return "\n".join(["", *lines])


def missing_bags():
    """Of a call for archives: the campaigns without a bag of these results, why, and what archives the rest."""
    if "archive" not in workflow.dag_settings.targets:
        return
    with open(f"{SUMMARY}/failed.csv", newline="") as file:
        failed = [(row["campaign"], row["run_id"]) for row in csv.DictReader(file)]
    for name in CAMPAIGNS:
        if runs := [run for campaign, run in failed if campaign == name]:
            command = ["fogreduce", "archive", RESULTS, "--only", name]
            command += ["--campaigns", CONFIG.campaigns_dir]
            command += ["--calibrations", CONFIG.calibrations_dir]
            command += ["--out", f"{RESULTS}/_archive", "--by-digest"]
            yield f"No bag of {name}, since {some_of(runs)} failed; one without: {shlex.join(command)}"


def pages_of_failures():
    """The pages of campaigns of which runs failed: no rule makes them, as it lacks those runs' pages.

    Called once the summary is written, which says which those are. The pages are dated back, so that the next
    call makes them anew.
    """
    if not (CONFIG.pages.enabled and os.path.exists(f"{SUMMARY}/failed.csv")):
        return
    with open(f"{SUMMARY}/failed.csv", newline="") as file:
        failed = {row["campaign"] for row in csv.DictReader(file)}
    # Those too that wait for a figure, a run's page or a diagnosis that failed.
    pages = [(name, f"{RESULTS}/{name}/index.html") for name in CAMPAIGNS]
    pages += [(name, f"{RESULTS}/{name}/{run}/index.html") for name, run in RUNS]
    failed |= {name for name, page in pages if not os.path.exists(page)}
    pages = [("campaign", Path(RESULTS) / campaign) for campaign in sorted(failed)]
    for of, folder in [*pages, ("index", Path(RESULTS))]:
        if not folder.is_dir():
            continue
        command = ["fogreduce", "page", of, folder]
        subprocess.run([*command, "--campaigns", CONFIG.campaigns_dir], check=False)
        if (folder / "index.html").exists():
            os.utime(folder / "index.html", (1, 1))  # at 0 Snakemake sees no date
