"""The configuration, the runs it asks for, and every file name of the workflow."""

import atexit
import hashlib
import json
import os
import shlex
import sys
from contextlib import ExitStack, suppress
from pathlib import Path

from fogreduce.reruns.clock import faults_of_inputs, make_old
from fogreduce.provenance.code import code_digest
from fogreduce.provenance.digest import data_digest, file_digest
from fogreduce.reruns.edited import edited, notes_of
from fogreduce.reruns.uses import REWRITTEN, rewritten, some_of, uses_in
from fogreduce.datasets.atomic import write_text
from fogreduce.datasets.readers.installed import installed_readers, software_of
from fogreduce.datasets.sole_writer import WORKFLOW, sole_writer, writers_inside
from fogreduce.errors import BadInput
from fogreduce.metadata.config import WorkflowConfig
from fogreduce.metadata.folder import several_records
from fogreduce.metadata.run_table import RunTable, list_runs


def stop(faults):
    """End the workflow over bad input or usage, as every command of fogreduce does."""
    print(faults, file=sys.stderr)
    sys.exit(2)


def checked(function, *arguments):
    """A call whose bad input ends the workflow with its one-line faults."""
    try:
        return function(*arguments)
    except BadInput as error:
        stop(error)


CONFIG = checked(WorkflowConfig.from_data, config, "configuration")
RESULTS = CONFIG.results_dir.rstrip("/")
RUN = f"{RESULTS}/{{campaign}}/{{run}}"
MADE = f"{RESULTS}/_captures"  # no campaign's name begins with an underscore
SUMMARY = f"{RESULTS}/_summary"

# With another environment numbers may differ: a parameter of every rule that computes some.
LOCK = hashlib.sha256((SOURCE / "requirements.lock").read_bytes()).hexdigest()


# Packages that read a laboratory's own formats are part of what a result comes from.
READERS = ", ".join(
    " ".join(software_of(name).values()) for name in checked(installed_readers)
)


wildcard_constraints:
    campaign=r"[A-Za-z0-9][A-Za-z0-9._-]{0,63}",
    run=r"[A-Za-z0-9][A-Za-z0-9._-]{0,63}",


#: What planning needs of campaigns and records: listed here, read by the workers, who may have none of them.
TABLE_FILE = Path(".snakemake", "fogreduce") / (
    data_digest([CONFIG.campaigns_dir, CONFIG.calibrations_dir, CONFIG.campaigns])[:16]
    + ".json"
)


def table_of_runs():
    """Every run of the configuration."""
    if not workflow.is_main_process and TABLE_FILE.is_file():
        return RunTable.read(TABLE_FILE)
    places = (CONFIG.campaigns_dir, CONFIG.calibrations_dir)
    table = checked(list_runs, *places, CONFIG.campaigns)
    if workflow.is_main_process:
        with suppress(OSError):  # workers that have the folders list them themselves
            write_text(TABLE_FILE, table.text())
    return table


TABLE = table_of_runs()
CAMPAIGNS = {name: Path(CONFIG.campaigns_dir) / name for name in TABLE.campaigns}
RUNS = [
    (name, run) for name, campaign in TABLE.campaigns.items() for run in campaign.runs
]
ABOUT = {name: campaign.about for name, campaign in TABLE.campaigns.items()}
MADE_CAMPAIGNS = {
    name for name, campaign in ABOUT.items() if campaign.captures_from is not None
}
if workflow.is_main_process:
    for campaign in TABLE.campaigns.values():
        for fault in campaign.left_out:
            print(f"left out: {fault}", file=sys.stderr)

#: What this process shares with the jobs that it sends, in Snakemake's words.
SHARED_USAGE = {usage.name for usage in workflow.storage_settings.shared_fs_usage}

if "SOURCES" not in SHARED_USAGE:

    # Snakemake brings its configuration to workers that share no files.
    configfile: TABLE_FILE


def run_wildcards():
    """Wildcards of all runs, for expand(..., zip)."""
    return {"campaign": [name for name, _ in RUNS], "run": [run for _, run in RUNS]}


def run_file(name):
    """A file of a run's results."""
    return f"{RUN}/{name}"


def files_of_run(campaign, run):
    """The files of a run's folder."""
    folder = f"{CONFIG.campaigns_dir}/{campaign}/runs/{run}"
    return [f"{folder}/{name}" for name in TABLE.campaigns[campaign].runs[run].files]


def folder_of_run(wildcards, input):
    """The folder that holds a run's run.yaml and capture, where this job finds it."""
    made = wildcards.campaign in MADE_CAMPAIGNS
    return input.run[0] if made else os.path.dirname(input.run[0])


def beside_runs(wildcards, name):
    """A file of the campaign's own folder, where it is there."""
    path = f"{CONFIG.campaigns_dir}/{wildcards.campaign}/{name}"
    return [path] if name in TABLE.campaigns[wildcards.campaign].files else []


def files_of_campaign(wildcards):
    """The files of a campaign's own folder, campaign.yaml among them."""
    names = TABLE.campaigns[wildcards.campaign].files
    return [f"{CONFIG.campaigns_dir}/{wildcards.campaign}/{name}" for name in names]


def folder_of_campaign(wildcards, input):
    """The folder that holds a campaign.yaml, where this job finds it."""
    return os.path.dirname(input.about[0])


def old_campaign_file(wildcards):
    """The same for rules of a run, where what of it counts is a parameter: another text alone changes nothing."""
    if wildcards.campaign in MADE_CAMPAIGNS:
        return ancient([f"{MADE}/{wildcards.campaign}/campaign.yaml"])
    return ancient(beside_runs(wildcards, "campaign.yaml"))


def campaign_file_of_runs(wildcards):
    """The campaign.yaml, where it says something that runs are reduced with: what else it says concerns no run."""
    about = ABOUT[wildcards.campaign]
    says = about.label or about.calibration or wildcards.campaign in MADE_CAMPAIGNS
    return old_campaign_file(wildcards) if says else []


#: Whether jobs see the folders as they are; where they do not, each needs as input all that it reads.
SHARED = "INPUT_OUTPUT" in SHARED_USAGE


def planned(*names):
    """The run.yaml and campaign.yaml of campaigns, which say what runs there are, for jobs that see no folders.

    Elsewhere they are no inputs: one run.yaml with a time in the future would fail the tables over all runs.
    """
    files = []
    for name in [] if SHARED else names:
        folder = f"{CONFIG.campaigns_dir}/{name}"
        files += [f"{folder}/runs/{run}/run.yaml" for run in TABLE.campaigns[name].runs]
        if "campaign.yaml" in TABLE.campaigns[name].files:
            files.append(f"{folder}/campaign.yaml")
    return files


def folder_of_campaigns(wildcards, input):
    """The folder of all campaigns, where this job finds it."""
    if SHARED:
        return CONFIG.campaigns_dir
    first = input.planned[0]
    parts = 2 if first.endswith("campaign.yaml") else 4
    for _ in range(parts):
        first = os.path.dirname(first)
    return first


def of_runs(name, *campaigns):
    """A file of the results of every run of campaigns."""
    return [
        f"{RESULTS}/{campaign}/{run}/{name}"
        for campaign, run in RUNS
        if campaign in campaigns
    ]


def folder_of_records(wildcards, input):
    """The folder of the calibration records, where this job finds it."""
    return os.path.dirname(os.path.dirname(input.calibrations[0]))


def run_inputs(wildcards):
    """What a run is reduced from: its folder where a rule makes it, else the files in it."""
    if wildcards.campaign in MADE_CAMPAIGNS:
        return [f"{MADE}/{wildcards.campaign}/runs/{wildcards.run}"]
    return files_of_run(wildcards.campaign, wildcards.run)


def run_says(wildcards):
    """Digest of what a run's files say."""
    return TABLE.campaigns[wildcards.campaign].runs[wildcards.run].says


def run_label(wildcards):
    """The campaign's label, which stands in every result of its runs."""
    return ABOUT[wildcards.campaign].label or ""


RUN_LABEL = run_label if any(about.label for about in ABOUT.values()) else ""


CALIBRATIONS = [f"{CONFIG.calibrations_dir}/{record}" for record in TABLE.records]


def calibration_of(campaign, run):
    """The calibration record that a run names; all of them where that is for its manifest to find out."""
    records = TABLE.campaigns[campaign].runs[run].records
    return [f"{CONFIG.calibrations_dir}/{record}" for record in records]


def calibration_inputs(wildcards):
    """The calibration record that a run is reduced with."""
    return calibration_of(wildcards.campaign, wildcards.run)


def campaign_calibrations(wildcards):
    """The calibration records that the runs of a campaign are reduced with."""
    runs = TABLE.campaigns[wildcards.campaign].runs
    return sorted(
        {path for run in runs for path in calibration_of(wildcards.campaign, run)}
    )


def check_times():
    """Results that a clock gave times in the future must not hide what has changed since."""
    if make_old(Path(RESULTS), [Path(RESULTS, *run) for run in RUNS]):
        print(
            f"{RESULTS}: written in the future, by a clock that was set back since; inputs are compared anew",
            file=sys.stderr,
        )
    kept = [run for run in RUNS if run[0] not in MADE_CAMPAIGNS]
    for campaign, run in kept:
        for fault in faults_of_inputs(files_of_run(campaign, run)):
            print(fault, file=sys.stderr)


# "2/20" asks for the 2nd, the 22nd, the 42nd run and so on.
ASKED = os.environ.get("FOGREDUCE_BATCH", "1/1")
#: What this process has locked; the system unlocks it when the process ends, however it ends.
LOCKS = ExitStack()
atexit.register(LOCKS.close)
# Workers, and batches of one campaign, write side by side: what they share is the lock of who sent them.
if not workflow.is_main_process or ASKED != "1/1":
    os.environ[WORKFLOW] = str(os.getpid())


def lock_results():
    """See to it that nobody else writes the results while this workflow is at work; its jobs share its lock."""
    checked(LOCKS.enter_context, sole_writer(Path(RESULTS)))
    if found := writers_inside(Path(RESULTS), depth=2):
        stop("\n".join(found))
    os.environ[WORKFLOW] = str(os.getpid())


def results_are_free():
    """Whether nobody writes the results now."""
    try:
        with sole_writer(Path(RESULTS)):
            return True
    except BadInput:
        return False


#: Whether what stands in the results may be mended; where another is at work, `lock_results` ends this workflow.
MAY_MEND = workflow.is_main_process and results_are_free()

if MAY_MEND:
    check_times()


def record_id(path):
    """The id of the record in a file, as its path says."""
    return "@".join(Path(path).with_suffix("").parts[-2:])


def find_rewritten():
    """Records whose file is no more what results were reduced with: their runs are not reduced."""
    if not workflow.is_main_process:
        return {}
    folders = [Path(RESULTS, *run) for run in RUNS if Path(RESULTS, *run).is_dir()]
    digests = {record_id(path): file_digest(Path(path)) for path in CALIBRATIONS}
    found = rewritten(uses_in(folders, Path(RESULTS)), digests)
    for record, names in found.items():
        print(
            f"{record}: not what {some_of(names)} used; a record that was used is never rewritten",
            file=sys.stderr,
        )
    note = Path(RESULTS) / REWRITTEN
    if found:
        write_text(note, json.dumps(found, indent=1) + "\n")
    else:
        note.unlink(missing_ok=True)
    return found


REWRITTEN_RECORDS = find_rewritten()


def find_edited():
    """Outputs that were edited by hand, by run and rule, those of earlier calls among them."""
    path = Path(RESULTS) / "_edited.json"
    notes = json.loads(path.read_text()) if path.is_file() else {}
    if not MAY_MEND:
        return notes
    before = json.dumps(notes, indent=1)
    for campaign, run in RUNS:
        changed = edited(Path(RESULTS) / campaign / run)
        for name in changed:
            print(
                f"{RESULTS}/{campaign}/{run}/{name}: not what its checksum says; made anew",
                file=sys.stderr,
            )
        if changed:
            notes[f"{campaign}/{run}"] = notes_of(notes, f"{campaign}/{run}", changed)
    if (after := json.dumps(notes, indent=1)) != before:
        write_text(path, after)
    return notes


EDITED = find_edited() or ""


# Snakemake evaluates each function for each job, at a third of a millisecond: a plain text where one will do.


def edited_outputs(by):
    """What was ever found edited of the outputs of a rule: while it stays the same, they stand."""
    return EDITED and (
        lambda wildcards: EDITED.get(f"{wildcards.campaign}/{wildcards.run}", {}).get(
            by, ""
        )
    )


def uses_rewritten(campaign):
    """Whether a campaign's runs name a record that was rewritten: nothing is then made of them."""
    named = {
        path
        for run in TABLE.campaigns[campaign].runs
        for path in calibration_of(campaign, run)
    }
    return any(record_id(path) in REWRITTEN_RECORDS for path in named)


#: Campaigns that ask for their diagnosis.
DIAGNOSED = [
    name
    for name, campaign in ABOUT.items()
    if campaign.diagnose and TABLE.campaigns[name].runs and not uses_rewritten(name)
]


#: Campaigns whose unit is to have a test report.
REPORTED = [
    name
    for name, campaign in ABOUT.items()
    if campaign.report and TABLE.campaigns[name].runs and not uses_rewritten(name)
]


def is_of_one_record(campaign):
    """Whether a campaign's runs all name one calibration record; says so where they do not."""
    of_record = {}
    for run in TABLE.campaigns[campaign].runs:
        named = calibration_of(campaign, run)
        if len(named) == 1:
            of_record.setdefault(record_id(named[0]), []).append(run)
    if len(of_record) > 1:
        print(
            f"derives no record: {several_records(CAMPAIGNS[campaign], of_record)}",
            file=sys.stderr,
        )
    return len(of_record) <= 1


#: Campaigns of which a calibration is to be derived: those of one record alone, as the command asks.
DERIVED = [
    name
    for name, campaign in ABOUT.items()
    if campaign.derive
    and TABLE.campaigns[name].runs
    and not uses_rewritten(name)
    and is_of_one_record(name)
]

#: Units of the campaigns' records.
UNITS = sorted(
    {
        Path(path).parts[-2]
        for name in CAMPAIGNS
        for run in TABLE.campaigns[name].runs
        for path in calibration_of(name, run)
    }
)


def diagnosed_inputs(wildcards):
    """Metadata, logs and captures of every run of a campaign; folders where a rule makes them."""
    if wildcards.campaign in MADE_CAMPAIGNS:
        return [
            f"{MADE}/{wildcards.campaign}/runs/{run}"
            for run in TABLE.campaigns[wildcards.campaign].runs
        ]
    return sorted(
        path
        for run in TABLE.campaigns[wildcards.campaign].runs
        for path in files_of_run(wildcards.campaign, run)
    )


def diagnosed_folder(wildcards, input):
    """The campaign's folder with its captures, where this job finds it."""
    folder = os.path.dirname(os.path.dirname(input.runs[0]))
    made = wildcards.campaign in MADE_CAMPAIGNS
    return folder if made else os.path.dirname(folder)


def report_options(wildcards, input):
    """Options for the files that are there."""
    given = {"--limits": input.limits, "--definitions": input.definitions}
    return " ".join(
        f"{option} {shlex.quote(str(path))}"
        for option, paths in given.items()
        for path in ([paths] if isinstance(paths, str) else paths)
    )


def summary_tables():
    """The tables over all runs."""
    names = ("drift_all", "rates_all", "commanded_all", "failed")
    return [f"{SUMMARY}/{name}.csv" for name in names]
