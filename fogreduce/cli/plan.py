"""``fogreduce plan RUN --out DIR``: the run.yaml files of a campaign that determines a test report."""

from __future__ import annotations

import argparse
from pathlib import Path

from fogreduce.cli.options import add_calibrations
from fogreduce.errors import BadInput


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Options of the command."""
    parser.add_argument(
        "run", type=Path, metavar="RUN", help="folder of a run on the same bench, which needs no capture"
    )
    parser.add_argument("--out", type=Path, required=True, metavar="DIR", help="folder for the campaign")
    parser.add_argument(
        "--largest-rate",
        type=float,
        default=10.0,
        metavar="DEG_S",
        help="largest rate of the staircases [deg/s] (default: 10)",
    )
    parser.add_argument(
        "--definitions", type=Path, metavar="FILE", help="YAML file of definitions (default: IEEE's)"
    )
    add_calibrations(parser)


def run(args: argparse.Namespace) -> int:
    """Write the campaign, and beside it what the uncertainties will be."""
    import csv
    import io

    import numpy as np

    from fogreduce.characterise.definitions import read_definitions
    from fogreduce.characterise.plan import duration_s, expected_quantities, planned_runs
    from fogreduce.datasets.atomic import write_text
    from fogreduce.metadata.folder import load_calibration, load_run
    from fogreduce.metadata.raw_folder import refuse_raw
    from fogreduce.metadata.run import FASTEST_DEG_S, Run
    from fogreduce.metadata.yaml12 import dump_yaml

    refuse_raw("--out", args.out)
    if not 0.1 <= args.largest_rate <= FASTEST_DEG_S:
        raise BadInput.at("--largest-rate", "", found=args.largest_rate, expected="0.1 deg/s or more")
    if (args.out / "runs").exists():
        raise BadInput.at(args.out, "", found="a campaign", expected="a new folder, so that no run is lost")
    choices = read_definitions(args.definitions)
    pattern = load_run(args.run, need_capture=False)
    record, _ = load_calibration(args.calibrations, pattern.calibration)
    plain = pattern.model_dump(mode="json", exclude_none=True)
    planned = planned_runs(plain, args.largest_rate)
    runs = [Run.from_data(one, args.out / "runs" / name / "run.yaml") for name, one in planned.items()]
    quantities = expected_quantities(runs, record, choices, np.random.default_rng(0))
    text = io.StringIO()
    rows = csv.writer(text, lineterminator="\n")
    rows.writerow(("quantity", "of", "unit", "standard_uncertainty", "needs"))
    for one in quantities:
        rows.writerow((one.name, one.of, one.unit, "" if one.std is None else f"{one.std:.3g}", one.needs))
    for name, data in planned.items():
        write_text(args.out / "runs" / name / "run.yaml", dump_yaml(data))
    write_text(args.out / "campaign.yaml", dump_yaml({"title": f"Test of {pattern.unit}, as planned"}))
    expected = args.out.absolute().with_name(args.out.absolute().name + ".expected.csv")
    write_text(expected, text.getvalue())
    left = sorted({one.name.replace("_", " ") for one in quantities if one.value is None})
    print(f"{args.out}: {len(runs)} runs, {duration_s(planned) / 3600:.1f} h on the table")
    print(f"{expected}: the uncertainty of each quantity; left open: {', '.join(left) or 'nothing'}")
    return 0
