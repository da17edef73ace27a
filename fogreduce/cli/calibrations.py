"""``fogreduce calibrations list|show|diff|validate|page``: the calibration records of a folder."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from fogreduce.cli.options import add_calibrations
from fogreduce.errors import BadInput, Fault

if TYPE_CHECKING:
    from fogreduce.calibrate.registry import Entry

#: Changes beyond so many standard deviations are marked.
_CLEAR_SIGMA = 3.5


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What to do with the records, and its options."""
    asked = parser.add_subparsers(dest="asked", metavar="WHAT", required=True)
    command = asked.add_parser("list", help="every record: validity, what it supersedes, what used it")
    command.add_argument("unit", nargs="?", metavar="UNIT", help="the unit (default: all of them)")
    _add_places(command)
    command = asked.add_parser("show", help="a record: coefficients with errors, history, what used it")
    command.add_argument("record", metavar="UNIT@VERSION", help="the record")
    _add_places(command)
    command = asked.add_parser("diff", help="what two records of a unit differ in, with errors")
    command.add_argument("record", metavar="EARLIER", help="<unit>@<version>")
    command.add_argument("later", metavar="LATER", help="<unit>@<version>")
    add_calibrations(command)
    command = asked.add_parser("validate", help="every fault of the records, alone and together")
    command.add_argument("unit", nargs="?", metavar="UNIT", help="the unit (default: all of them)")
    _add_places(command)
    command = asked.add_parser("page", help="the page of a unit: each coefficient over its records")
    command.add_argument("unit", metavar="UNIT", help="the unit")
    command.add_argument("--out", type=Path, required=True, metavar="FILE", help="the page to write (.html)")
    _add_places(command)


def _add_places(parser: argparse.ArgumentParser) -> None:
    add_calibrations(parser)
    parser.add_argument("--results", type=Path, metavar="DIR", help="results, to say what used each record")


def run(arguments: argparse.Namespace) -> int:
    """Do what is asked."""
    return _DO[arguments.asked](arguments)


def _list(arguments: argparse.Namespace) -> int:
    from fogreduce.calibrate.registry import superseded_by

    entries, faults = _read(arguments)
    used = _used(arguments)
    rows = [("record", "valid from", "until", "gyros", "supersedes", "state", "SHA-256")]
    for entry in entries:
        record, later = entry.record, superseded_by(entries, entry.record_id)
        state = "superseded by " + ", ".join(later) if later else "in force"
        if used is not None:
            state += f"; {_runs(used.get(entry.record_id, []))}"
        rows.append(
            (
                entry.record_id,
                _day(record.valid_from),
                _day(record.valid_until) if record.valid_until else "open",
                str(record.n),
                record.supersedes or "none",
                state,
                entry.sha256[:12],
            )
        )
    print(_aligned(rows))
    if faults:
        raise BadInput(*faults)
    return 0


def _show(arguments: argparse.Namespace) -> int:
    from fogreduce.calibrate.coefficients import Coefficients
    from fogreduce.calibrate.registry import history, superseded_by
    from fogreduce.metadata.instant import instant_text
    from fogreduce.pages.numbers import number, plus_minus

    entries, entry = _one(arguments, arguments.record)
    record, found = entry.record, Coefficients.of(entry.record)
    until = f" until {instant_text(record.valid_until)}" if record.valid_until else " on"
    print(f"{entry.record_id}: valid from {instant_text(record.valid_from)}{until}; {record.procedure}")
    print(f"{entry.path}, SHA-256 {entry.sha256}")
    if record.pedigree is not None:
        of = record.pedigree
        print(f"derived from {len(of.runs)} runs of {of.campaign}, fogreduce {of.fogreduce}")
    unit = record.raw_unit.name
    rows = [
        (
            "gyro",
            "bias [deg/h]",
            f"scale factor [{unit}/(deg/s)]",
            "axis",
            "pointing [mrad]",
            "turn-on [deg/h]",
        )
    ]
    for i in range(record.n):
        scale = found.scale_factor[i]
        rows.append(
            (
                f"gyro{i + 1}",
                plus_minus(found.bias_deg_h[i], found.bias_std_deg_h[i]),
                plus_minus(scale, abs(scale) * found.scale_factor_std_rel[i]),
                "[" + ", ".join(f"{one:.6f}" for one in found.axes[i]) + "]",
                number(found.axis_std_rad[i] * 1e3),
                number(found.turn_on_bias_deg_h[i]),
            )
        )
    print(_aligned(rows))
    print("± one standard deviation" + _defaults(found.stated))
    print("history: " + " <- ".join(one.record_id for one in history(entries, entry.record_id)))
    if later := superseded_by(entries, entry.record_id):
        print("superseded by " + ", ".join(later))
    if (used := _used(arguments)) is not None:
        names = used.get(entry.record_id, [])
        print(f"used by {_runs(names)}" + (": " + ", ".join(names) if names else ""))
    return 0


def _diff(arguments: argparse.Namespace) -> int:
    from fogreduce.calibrate.coefficients import Coefficients, changes
    from fogreduce.pages.numbers import plus_minus

    _, earlier = _one(arguments, arguments.record)
    _, later = _one(arguments, arguments.later)
    one, other = earlier.record, later.record
    if one.unit != other.unit or one.n != other.n:
        found = f"{later.record_id}, of {other.n} gyros"
        raise BadInput.at("LATER", "", found=found, expected=f"a record of {one.unit}, of {one.n} gyros")
    days = (other.valid_from - one.valid_from).total_seconds() / 86400
    print(f"{earlier.record_id} -> {later.record_id}, {days:.0f} days later")
    rows = [("gyro", "of", "change", "unit", "sigma")]
    for change in changes(Coefficients.of(one), Coefficients.of(other)):
        mark = " *" if change.sigma > _CLEAR_SIGMA else ""
        value = plus_minus(change.value, change.std)
        rows.append((f"gyro{change.gyro + 1}", change.name, value, change.unit, f"{change.sigma:.1f}{mark}"))
    print(_aligned(rows))
    print(f"± both records' standard deviations together; * beyond {_CLEAR_SIGMA}")
    return 0


def _validate(arguments: argparse.Namespace) -> int:
    from fogreduce.calibrate.registry import faults_between
    from fogreduce.reruns.uses import rewritten, some_of, uses_below

    entries, faults = _read(arguments)
    faults += faults_between(entries)
    if arguments.results is not None:
        digests = {entry.record_id: entry.sha256 for entry in entries}
        paths = {entry.record_id: str(entry.path) for entry in entries}
        for record_id, names in rewritten(uses_below(arguments.results), digests).items():
            found = f"another content than {some_of(names)} used"
            expected = "the record as it was; a changed one needs a version of its own"
            faults.append(Fault(paths[record_id], "", found, expected))
    if faults:
        raise BadInput(*dict.fromkeys(faults))
    print(f"{arguments.calibrations}: {len(entries)} record{'' if len(entries) == 1 else 's'}, no faults")
    return 0


def _page(arguments: argparse.Namespace) -> int:
    from fogreduce.calibrate.unit_page import FOLDER, unit_page
    from fogreduce.datasets.atomic import write_text

    if arguments.out.suffix != ".html":
        raise BadInput.at("--out", "", found=arguments.out, expected="the name of an .html file")
    entries, faults = _read(arguments)
    if faults:
        raise BadInput(*faults)
    in_results = arguments.out.resolve().parent.name == FOLDER
    write_text(arguments.out, unit_page(arguments.unit, entries, _used(arguments), in_results))
    print(arguments.out)
    return 0


def _read(arguments: argparse.Namespace) -> tuple[list[Entry], list[Fault]]:
    from fogreduce.calibrate.registry import read_registry

    return read_registry(arguments.calibrations, arguments.unit)


def _one(arguments: argparse.Namespace, record_id: str) -> tuple[list[Entry], Entry]:
    """A record that must be there, among those of its unit that can be read."""
    from fogreduce.calibrate.registry import read_registry
    from fogreduce.metadata.folder import load_calibration

    load_calibration(arguments.calibrations, record_id)
    entries, _ = read_registry(arguments.calibrations, record_id.partition("@")[0])
    return entries, next(entry for entry in entries if entry.record_id == record_id)


def _used(arguments: argparse.Namespace) -> dict[str, list[str]] | None:
    """Record -> results reduced with it; None where no results were named."""
    if arguments.results is None:
        return None
    from fogreduce.reruns.uses import uses_below

    used: dict[str, list[str]] = {}
    for use in uses_below(arguments.results):
        if not use.version:
            used.setdefault(use.record_id, []).append(use.results)
    return used


def _runs(names: Sequence[str]) -> str:
    return f"{len(names) or 'no'} run{'' if len(names) == 1 else 's'}"


def _defaults(stated: frozenset[str]) -> str:
    """What is the project's and not the record's."""
    from fogreduce.metadata.calibration import Uncertainty

    absent = [key for key in Uncertainty.model_fields if key not in stated]
    return f"; of {', '.join(absent)} the record states none: the project's defaults" if absent else ""


def _day(instant: object) -> str:
    return str(instant)[:10]


def _aligned(rows: Sequence[Sequence[str]]) -> str:
    widths = [max(len(row[k]) for row in rows) for k in range(len(rows[0]))]
    return "\n".join(
        "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip() for row in rows
    )


_DO: dict[str, Callable[[argparse.Namespace], int]] = {
    "list": _list,
    "show": _show,
    "diff": _diff,
    "validate": _validate,
    "page": _page,
}
