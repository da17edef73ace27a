"""``fogreduce check``: every fault of a run, a campaign or a metadata file, at once."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any, get_args

from fogreduce.cli.assumed import assumed_lines
from fogreduce.cli.options import add_calibrations
from fogreduce.errors import BadInput, Fault

if TYPE_CHECKING:
    from fogreduce.metadata.calibration import CalibrationRecord
    from fogreduce.metadata.run import Run

#: Records of a capture that are read at a time.
_RECORDS = 1 << 16


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the command's arguments."""
    parser.add_argument(
        "path",
        metavar="PATH",
        type=Path,
        help="folder of a run, a campaign or campaigns, or a metadata file",
    )
    add_calibrations(parser)


def run(args: argparse.Namespace) -> int:
    """Check what `args.path` is; a summary on standard output, or BadInput with every fault."""
    faults = Faults()
    summary = _checker_of(args.path)(args.path, args.calibrations, faults)
    for warning in faults.warnings:
        print(f"warning: {warning}", file=sys.stderr)
    if faults:
        raise BadInput(*dict.fromkeys(faults))  # a record's faults come up once for every run that names it
    number = len(faults.warnings)
    warned = f", {number} warning{'' if number == 1 else 's'}" if number else ""
    print(f"{args.path}: no faults{warned}; {summary}")
    for line in assumed_lines(args.path, args.calibrations):
        print(f"  {line}")
    return 0


class Faults(list[Fault]):
    """Every fault found so far, and the warnings, which are none."""

    def __init__(self) -> None:
        super().__init__()
        self.warnings: list[Fault] = []


Checker = Callable[[Path, Path, Faults], str]


def _checker_of(path: Path) -> Checker:
    """The check for what lies at `path`: appends faults, returns a summary."""
    try:
        if (path / "run.yaml").exists():
            return _check_run
        if (path / "runs").exists() or (path / "campaign.yaml").exists():
            return _check_campaign
    except PermissionError:
        raise BadInput.at(
            path, "", found="no permission to look into it", expected="a readable folder"
        ) from None
    if path.is_dir():
        if any(path.glob("*/runs")):
            return _check_campaigns
        expected = "a run, a campaign or a folder of campaigns"
        raise BadInput.at(path, "", found="a folder without run.yaml or runs", expected=expected)
    return _check_run if path.name == "run.yaml" else _check_file


def _check_file(path: Path, calibrations: Path, faults: Faults) -> str:
    """One metadata file, by its schema; a calibration record unless it says otherwise."""
    from fogreduce.metadata.campaign import Campaign
    from fogreduce.metadata.curves import Curves
    from fogreduce.metadata.effects_file import EffectsFile
    from fogreduce.metadata.folder import read_calibration
    from fogreduce.metadata.yaml12 import load_yaml

    schema = "fogreduce/campaign/1" if path.name == "campaign.yaml" else load_yaml(path).get("schema")
    for model in (Campaign, Curves, EffectsFile):
        if schema in get_args(model.model_fields["schema_id"].annotation):
            _collect(faults, model.from_yaml, path)
            return str(schema)
    record = _collect(faults, read_calibration, path)
    return f"calibration record of {record.n} gyros" if record else ""


def _check_campaigns(path: Path, calibrations: Path, faults: Faults) -> str:
    """Every campaign of a folder."""
    folders = sorted(runs.parent for runs in path.glob("*/runs") if runs.parent.name[0] != ".")
    counts = [_check_campaign(folder, calibrations, faults) for folder in folders]
    return "; ".join(f"{folder.name}: {count}" for folder, count in zip(folders, counts, strict=True))


def _check_campaign(path: Path, calibrations: Path, faults: Faults) -> str:
    """campaign.yaml, what it names, and all runs."""
    from fogreduce.archive.names import faults_of_names, plain_files
    from fogreduce.metadata.curves import Curves
    from fogreduce.metadata.folder import find_runs, is_name, load_campaign
    from fogreduce.metadata.patterns import NAME_IN_WORDS

    if not is_name(name := path.absolute().name or path.resolve().name):
        faults.append(Fault(str(path), "", f"a campaign called {name}", NAME_IN_WORDS))
    faults.extend(faults_of_names(plain_files(path)))
    campaign = _collect(faults, load_campaign, path)
    made = campaign.captures_from if campaign else None
    if made and made.curves:
        _collect(faults, Curves.from_yaml, path / made.curves)
    runs, bad_names = find_runs(path)
    faults.extend(bad_names)
    need_capture = campaign is not None and made is None
    for folder in _with_progress(runs):
        _check_run(folder, calibrations, faults, need_capture=need_capture)
    return f"{len(runs)} run{'s' if len(runs) > 1 else ''}"


def _check_run(path: Path, calibrations: Path, faults: Faults, *, need_capture: bool = True) -> str:
    """run.yaml, the files it names, its calibration record and its capture's header."""
    from fogreduce.metadata.folder import cross_check, load_calibration, load_run, named_calibration
    from fogreduce.physics.raw_quantity import unit_in_use

    path = path.parent if path.name == "run.yaml" else path
    run = _collect(faults, load_run, path, need_capture=need_capture)
    _left_to_do(path / "run.yaml", faults)
    record_id = run.calibration if run else named_calibration(path)
    loaded = _collect(faults, load_calibration, calibrations, record_id) if record_id else None
    if run is None or loaded is None:
        return ""
    record = loaded[0]
    _collect(faults, cross_check, run, record, path / "run.yaml")
    in_one_unit = unit_in_use(run.capture.raw_unit) == record.raw_unit
    before = len(faults)
    _check_logs(path, run, faults)
    if in_one_unit and (path / run.capture.file).exists():
        with_logs = len(faults) == before
        faults.warnings += _collect(faults, _check_capture, path, run, record, with_logs=with_logs) or []
    return f"{record.n} gyros, {run.n_expected} records expected, calibration {run.calibration}"


def _left_to_do(path: Path, faults: Faults) -> None:
    """Values that `fogreduce init` left to be filled in and that may pass for what is asked for, a name."""
    from fogreduce.cli.init import TODO
    from fogreduce.metadata.yaml12 import load_yaml

    try:
        data = load_yaml(path)
    except BadInput:
        return  # said already
    faulty = {fault.where for fault in faults if fault.file == str(path)}
    for key, value in data.items():
        if isinstance(value, str) and TODO in value.split("@") and key not in faulty:
            faults.append(Fault(str(path), key, TODO, "the value itself, filled in"))


def _check_capture(folder: Path, run: Run, record: CalibrationRecord, *, with_logs: bool) -> list[Fault]:
    """The capture against run.yaml and the record, header and records; warnings about it and its logs."""
    from fogreduce.datasets.readers.contradictions import open_run_capture
    from fogreduce.metadata.config import OutliersConfig
    from fogreduce.metadata.facts import RunFacts
    from fogreduce.stages.ingest import Ingest
    from fogreduce.stages.look import look

    facts = RunFacts.of_models(run, record)
    capture = open_run_capture(folder, run, facts)
    ingest = Ingest(facts, OutliersConfig().threshold_sigma)
    for _ in ingest.blocks(capture, _RECORDS):
        pass
    if not with_logs:  # they are bad, which is said already
        return []
    found = look(facts, run.model_dump(mode="json"), ingest.report(capture), folder)
    return [finding.fault(str(folder)) for finding in found]


def _check_logs(path: Path, run: Run, faults: Faults) -> None:
    """The logs beside the capture, line by line."""
    from fogreduce.datasets.run_logs import table_log_of, temperatures_of

    plain = run.model_dump(mode="json")
    _collect(faults, temperatures_of, path, plain, run.start_us)
    _collect(faults, table_log_of, path, plain, run.start_us)


def _with_progress(runs: list[Path]) -> Iterable[Path]:
    """The same runs, with a bar on a terminal once two seconds have passed."""
    if not sys.stderr.isatty():
        return runs
    from tqdm import tqdm

    bar: Iterable[Path] = tqdm(runs, desc="check", unit="run", delay=2, leave=False)
    return bar


def _collect(faults: Faults, function: Callable[..., Any], *args: object, **options: object) -> Any:
    """Call `function`; where its input is bad, keep the faults and return None."""
    try:
        return function(*args, **options)
    except BadInput as error:
        faults.extend(error.faults)
        return None
