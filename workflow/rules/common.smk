"""The configuration, the runs it asks for, and every file name of the workflow."""

import json
from pathlib import Path

from snakemake.exceptions import WorkflowError

from fogreduce.archive.digest import code_digest
from fogreduce.errors import BadInput
from fogreduce.metadata.config import WorkflowConfig
from fogreduce.metadata.folder import find_runs, is_name, list_campaigns, load_campaign


def checked(function, *arguments):
    """A call whose bad input ends the workflow with its one-line faults."""
    try:
        return function(*arguments)
    except BadInput as error:
        raise WorkflowError(str(error)) from None


CONFIG = checked(WorkflowConfig.from_data, config, "configuration")
RESULTS = CONFIG.results_dir.rstrip("/")
RUN = f"{RESULTS}/{{campaign}}/{{run}}"
MADE = f"{RESULTS}/_captures"  # no campaign's name begins with an underscore
SUMMARY = f"{RESULTS}/_summary"
STAGES = ("ingest", "calibrate", "project", "remove_earth", "fit", "drift")


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
        raise WorkflowError(
            f"{CONFIG.campaigns_dir}: found no campaign {missing[0]}; expected one, as configured"
        )
    return {name: folders[name] for name in CONFIG.campaigns or sorted(folders)}


CAMPAIGNS = campaign_folders()
FOUND = {name: find_runs(folder) for name, folder in CAMPAIGNS.items()}
RUNS = [(name, run.name) for name, (runs, _) in FOUND.items() for run in runs]
MADE_CAMPAIGNS = {
    name
    for name, folder in CAMPAIGNS.items()
    if checked(load_campaign, folder).captures_from is not None
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


def run_results(wildcards):
    """The folder of a run's results."""
    return f"{RESULTS}/{wildcards.campaign}/{wildcards.run}"


def run_folder(wildcards):
    """The folder that holds a run's run.yaml and capture."""
    parent = MADE if wildcards.campaign in MADE_CAMPAIGNS else CONFIG.campaigns_dir
    return f"{parent}/{wildcards.campaign}/runs/{wildcards.run}"


def run_inputs(wildcards):
    """What a run is reduced from: its folder where a rule makes it, else the files in it."""
    folder = run_folder(wildcards)
    if wildcards.campaign in MADE_CAMPAIGNS:
        return [folder]
    return sorted(str(path) for path in Path(folder).iterdir() if path.is_file())


def calibration_inputs(wildcards):
    """All calibration records of the folder: which one a run names is for its manifest to find out."""
    return sorted(str(path) for path in Path(CONFIG.calibrations_dir).glob("*/*.yaml"))


#: Campaigns that ask for their diagnosis.
DIAGNOSED = [
    name
    for name, folder in CAMPAIGNS.items()
    if checked(load_campaign, folder).diagnose and FOUND[name][0]
]


def diagnosed_inputs(wildcards):
    """Metadata, logs and captures of every run of a campaign; folders where a rule makes them."""
    if wildcards.campaign in MADE_CAMPAIGNS:
        return [
            f"{MADE}/{wildcards.campaign}/runs/{run.name}"
            for run in FOUND[wildcards.campaign][0]
        ]
    return sorted(
        str(path)
        for run in FOUND[wildcards.campaign][0]
        for path in run.iterdir()
        if path.is_file()
    )


def diagnosed_folder(wildcards):
    """The campaign's folder with its captures."""
    parent = MADE if wildcards.campaign in MADE_CAMPAIGNS else CONFIG.campaigns_dir
    return f"{parent}/{wildcards.campaign}"


def summary_tables():
    """The tables over all runs."""
    return [f"{SUMMARY}/{name}.csv" for name in ("drift_all", "rates_all", "failed")]


def is_reduced(folder):
    """Whether a run's drift table is there, and of the version that its manifest says."""
    manifest, drift = folder / "manifest.json", folder / "tables" / "drift.csv"
    if not (manifest.exists() and drift.exists()):
        return False
    version = json.loads(manifest.read_text())["version_id"]
    return all(
        line.endswith(f",{version}") for line in drift.read_text().splitlines()[1:]
    )


def failed_runs():
    """The runs that are not reduced, and the last line of each of their logs."""
    lines = ["", "These runs are not reduced:"]
    for campaign, run in RUNS:
        folder = Path(RESULTS) / campaign / run
        if is_reduced(folder):
            continue
        said = [
            line
            for log in sorted((folder / "logs").glob("*.log"))
            for line in log.read_text().splitlines()[-1:]
        ]
        lines.append(
            f"  {campaign}/{run}: {said[-1] if said else 'see the messages above'}"
        )
    return "\n".join(lines)
