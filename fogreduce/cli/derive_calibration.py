"""``fogreduce derive-calibration CAMPAIGN --out DIR``: a calibration record from the campaign itself."""

from __future__ import annotations

import argparse
from pathlib import Path

from fogreduce.cli.options import add_calibrations
from fogreduce.errors import BadInput

HELP = "derive bias, scale factor and axis of each gyro from a campaign: a candidate record and its page"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Options of the command."""
    parser.add_argument("campaign", type=Path, metavar="CAMPAIGN", help="the campaign's folder")
    parser.add_argument("--out", type=Path, required=True, metavar="DIR", help="folder for what is derived")
    parser.add_argument(
        "--record-version",
        metavar="VERSION",
        help="version of the candidate record (default: the present one's with -derived after it)",
    )
    parser.add_argument(
        "--only-runs", metavar="ID,...", default="", help="runs to use, by id (default: all of them)"
    )
    add_calibrations(parser)


def run(args: argparse.Namespace) -> int:
    """Derive; write the candidate record, the document and the page; a summary on standard output."""
    from fogreduce.calibrate.derive import derive
    from fogreduce.calibrate.document import document, summary
    from fogreduce.calibrate.page import write_page
    from fogreduce.calibrate.record import candidate
    from fogreduce.cli.raw import refuse_raw
    from fogreduce.datasets.atomic import write_text
    from fogreduce.metadata.folder import is_name
    from fogreduce.metadata.yaml12 import dump_yaml
    from fogreduce.stages.files import write_json

    refuse_raw("--out", args.out)
    found = derive(args.campaign, args.calibrations, [name for name in args.only_runs.split(",") if name])
    present = found.readings[0].record
    version = args.record_version or f"{present.version}-derived"
    if not is_name(version) or version == present.version:
        expected = f"a name of its own, other than {present.version}"
        raise BadInput.at("--record-version", "", found=version, expected=expected)
    record = None if found.undetermined else candidate(found, args.campaign, version)
    path = args.out / present.unit / f"{version}.yaml"
    if record is not None:
        text = dump_yaml(record)
        if path.exists() and path.read_text(encoding="utf-8") != text:
            expected = "a version that is not there yet (records are never rewritten): --record-version"
            raise BadInput.at(path, "", found="another record of this version", expected=expected)
        write_text(path, text)
    data = document(found, args.campaign, None if record is None else f"{present.unit}@{version}")
    write_json(args.out / "derivation.json", data)
    write_page(found, data, args.out / "index.html")
    print(summary(data))
    print(f"{args.out}: derivation.json, index.html" + ("" if record is None else f", {path}"))
    return 0
