"""The configuration, the runs it asks for, and every file name of the workflow."""

import atexit
import hashlib
import json
import os
import re
import shlex
import sys
from contextlib import ExitStack
from functools import lru_cache
from pathlib import Path

from fogreduce.reruns.clock import faults_of_inputs, make_old
from fogreduce.provenance.code import code_digest
from fogreduce.provenance.digest import file_digest
from fogreduce.reruns.edited import edited, notes_of
from fogreduce.reruns.uses import REWRITTEN, rewritten, some_of, uses_in
from fogreduce.datasets.atomic import write_text
from fogreduce.datasets.readers.installed import installed_readers, software_of
from fogreduce.datasets.sole_writer import WORKFLOW, sole_writer, writers_inside
from fogreduce.errors import BadInput
from fogreduce.metadata.config import WorkflowConfig
from fogreduce.metadata.file_name import problem_of_file_name
from fogreduce.metadata.folder import (
    find_runs,
    is_name,
    list_campaigns,
    load_campaign,
    several_records,
)


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


def campaign_folders():
    """The campaigns of the configuration, by name."""
    folders = {
        path.name: path for path in checked(list_campaigns, CONFIG.campaigns_dir)
    }
    missing = [name for name in CONFIG.campaigns if name not in folders]
    if missing:
        stop(
            f"{CONFIG.campaigns_dir}: found no campaign {missing[0]}; expected one, as configured"
        )
    return {name: folders[name] for name in CONFIG.campaigns or sorted(folders)}


CAMPAIGNS = campaign_folders()
FOUND = {name: find_runs(folder) for name, folder in CAMPAIGNS.items()}
RUNS = [(name, run.name) for name, (runs, _) in FOUND.items() for run in runs]
ABOUT = {name: checked(load_campaign, folder) for name, folder in CAMPAIGNS.items()}
MADE_CAMPAIGNS = {
    name for name, campaign in ABOUT.items() if campaign.captures_from is not None
}

for _, faults in FOUND.values():
    for fault in faults:
        print(f"left out: {fault}", file=sys.stderr)


def run_wildcards():
    """Wildcards of all runs, for expand(..., zip)."""
    return {"campaign": [name for name, _ in RUNS], "run": [run for _, run in RUNS]}


def run_file(name):
    """A file of a run's results."""
    return f"{RUN}/{name}"


def run_folder(wildcards):
    """The folder that holds a run's run.yaml and capture."""
    parent = MADE if wildcards.campaign in MADE_CAMPAIGNS else CONFIG.campaigns_dir
    return f"{parent}/{wildcards.campaign}/runs/{wildcards.run}"


SMALL_BYTES = 1 << 16


@lru_cache(maxsize=None)
def files_in(folder):
    """The files of a folder, in order; hidden ones and those that no run.yaml may name are passed over."""
    with os.scandir(folder) as entries:
        return sorted(
            entry.path
            for entry in entries
            if entry.name[0] != "."
            and not problem_of_file_name(entry.name)
            and entry.is_file()
        )


def folder_of_run(wildcards, input):
    """The folder that holds a run's run.yaml and capture, where this job finds it."""
    made = wildcards.campaign in MADE_CAMPAIGNS
    return input.run[0] if made else os.path.dirname(input.run[0])


def campaign_file(wildcards):
    """The campaign's campaign.yaml, where it has one."""
    path = f"{CONFIG.campaigns_dir}/{wildcards.campaign}/campaign.yaml"
    return [path] if os.path.exists(path) else []


def files_of_campaign(wildcards):
    """The files of a campaign's own folder, campaign.yaml among them."""
    return files_in(f"{CONFIG.campaigns_dir}/{wildcards.campaign}")


def folder_of_campaign(wildcards, input):
    """The folder that holds a campaign.yaml, where this job finds it."""
    return os.path.dirname(input.about[0])


def old_campaign_file(wildcards):
    """The same for rules of a run, where what of it counts is a parameter: another text alone changes nothing."""
    if wildcards.campaign in MADE_CAMPAIGNS:
        return ancient([f"{MADE}/{wildcards.campaign}/campaign.yaml"])
    return ancient(campaign_file(wildcards))


def planned(*names):
    """The run.yaml and campaign.yaml of campaigns: which runs there are."""
    files = []
    for name in names:
        files += [str(run / "run.yaml") for run in FOUND[name][0]]
        files += [
            path
            for path in [f"{CONFIG.campaigns_dir}/{name}/campaign.yaml"]
            if os.path.exists(path)
        ]
    return files


def folder_of_campaigns(wildcards, input):
    """The folder of all campaigns, where this job finds it."""
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
    folder = run_folder(wildcards)
    return [folder] if wildcards.campaign in MADE_CAMPAIGNS else files_in(folder)


def run_says(wildcards):
    """Digest of a run's small files and of the large ones' sizes.

    Snakemake goes by times, and does not see what was edited while the clock stood earlier.
    """
    digest = hashlib.sha256()
    for path in files_in(CAMPAIGNS[wildcards.campaign] / "runs" / wildcards.run):
        size = os.stat(path).st_size
        said = Path(path).read_bytes() if size <= SMALL_BYTES else b"%d" % size
        digest.update(hashlib.sha256(said).digest())
    return digest.hexdigest()


def run_label(wildcards):
    """The campaign's label, which stands in every result of its runs."""
    return ABOUT[wildcards.campaign].label or ""


RUN_LABEL = run_label if any(about.label for about in ABOUT.values()) else ""


CALIBRATIONS = sorted(
    str(path) for path in Path(CONFIG.calibrations_dir).glob("*/*.yaml")
)
NAMED_RECORD = re.compile(
    r"""^calibration:[ ]*['"]?([\w.-]+)@([\w.-]+)['"]?[ ]*(?:\#.*)?$""", re.MULTILINE
)


@lru_cache(maxsize=None)
def calibration_of(campaign, run):
    """The calibration record that a run names; all of them where that is for its manifest to find out."""
    text = (CAMPAIGNS[campaign] / "runs" / run / "run.yaml").read_text(errors="replace")
    named = NAMED_RECORD.search(text) or NAMED_RECORD.search(
        f"calibration: {ABOUT[campaign].calibration}"
    )
    record = (
        f"{CONFIG.calibrations_dir}/{'/'.join(named.groups())}.yaml" if named else ""
    )
    return [record] if record in CALIBRATIONS else CALIBRATIONS


def calibration_inputs(wildcards):
    """The calibration record that a run is reduced with."""
    return calibration_of(wildcards.campaign, wildcards.run)


def campaign_calibrations(wildcards):
    """The calibration records that the runs of a campaign are reduced with."""
    runs = FOUND[wildcards.campaign][0]
    return sorted(
        {path for run in runs for path in calibration_of(wildcards.campaign, run.name)}
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
        for fault in faults_of_inputs(files_in(f"{CAMPAIGNS[campaign]}/runs/{run}")):
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
        for run in FOUND[campaign][0]
        for path in calibration_of(campaign, run.name)
    }
    return any(record_id(path) in REWRITTEN_RECORDS for path in named)


#: Campaigns that ask for their diagnosis.
DIAGNOSED = [
    name
    for name, campaign in ABOUT.items()
    if campaign.diagnose and FOUND[name][0] and not uses_rewritten(name)
]


#: Campaigns whose unit is to have a test report.
REPORTED = [
    name
    for name, campaign in ABOUT.items()
    if campaign.report and FOUND[name][0] and not uses_rewritten(name)
]


def is_of_one_record(campaign):
    """Whether a campaign's runs all name one calibration record; says so where they do not."""
    of_record = {}
    for run in FOUND[campaign][0]:
        named = calibration_of(campaign, run.name)
        if len(named) == 1:
            of_record.setdefault(record_id(named[0]), []).append(run.name)
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
    and FOUND[name][0]
    and not uses_rewritten(name)
    and is_of_one_record(name)
]

#: Units of the campaigns' records.
UNITS = sorted(
    {
        Path(path).parts[-2]
        for name in CAMPAIGNS
        for run in FOUND[name][0]
        for path in calibration_of(name, run.name)
    }
)


def diagnosed_inputs(wildcards):
    """Metadata, logs and captures of every run of a campaign; folders where a rule makes them."""
    if wildcards.campaign in MADE_CAMPAIGNS:
        return [
            f"{MADE}/{wildcards.campaign}/runs/{run.name}"
            for run in FOUND[wildcards.campaign][0]
        ]
    return sorted(
        path for run in FOUND[wildcards.campaign][0] for path in files_in(run)
    )


def diagnosed_folder(wildcards, input):
    """The campaign's folder with its captures, where this job finds it."""
    folder = os.path.dirname(os.path.dirname(input.runs[0]))
    made = wildcards.campaign in MADE_CAMPAIGNS
    return folder if made else os.path.dirname(folder)


def beside_runs(wildcards, name):
    """A file of the campaign's own folder, where it is there."""
    path = Path(CONFIG.campaigns_dir) / wildcards.campaign / name
    return [str(path)] if path.is_file() else []


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
