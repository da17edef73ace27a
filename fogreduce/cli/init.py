"""``fogreduce init``: a campaign from loggers' files, or a run.yaml from a header; the rest is left TODO."""

from __future__ import annotations

import argparse
import contextlib
import os
import shlex
import tempfile
from dataclasses import dataclass
from pathlib import Path

from fogreduce.cli.stated import add_stated, bench_of, stated_of
from fogreduce.errors import BadInput

TODO = "TODO"
#: Lines of a CSV that are read at a time.
_RECORDS = 1 << 16


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the command's arguments."""
    parser.add_argument(
        "files",
        metavar="FILE",
        type=Path,
        nargs="+",
        help="a logger's file of any format, or a folder of them",
    )
    parser.add_argument(
        "--out",
        metavar="PATH",
        type=Path,
        help="the campaign's new folder (default: the first file's name, beside it); of a single fogcap-1 or "
        "csv-1 capture the run.yaml (default: beside the capture)",
    )
    add_stated(parser)


def run(args: argparse.Namespace) -> int:
    """Write what is asked for; an existing file is never touched."""
    if _is_capture(args):
        return _begin_run(args.files[0], args.out)
    from fogreduce.guess.campaign import begin_campaign, files_of

    files = files_of(args.files)
    stated, bench = stated_of(args), bench_of(args)
    first = args.files[0].absolute()
    out = args.out or first.parent / f"{first.name.split('.')[0]}-campaign"
    folders = begin_campaign(files, out, stated, bench)
    todo = sum(TODO in line.split("#")[0] for line in (folders[0] / "run.yaml").read_text().splitlines())
    print(f"{out}: {len(folders)} run{'s' if len(folders) > 1 else ''}, and the record of an ideal unit")
    left = (
        f"{todo} lines marked {TODO} at the top of each run.yaml; fill them in, then run" if todo else "next"
    )
    command = shlex.join(["fogreduce", "check", str(out), "--calibrations", str(out / "calibrations")])
    print(f"{left}: {command}")
    return 0


def _is_capture(args: argparse.Namespace) -> bool:
    """Whether a run.yaml alone is wanted: of one fogcap-1 or csv-1 capture, and no folder to make."""
    if len(args.files) != 1 or args.files[0].is_dir() or vars(stated_of(args)) != vars(stated_of(None)):
        return False
    if args.out is not None:
        return args.out.suffix in (".yaml", ".yml")
    from fogreduce.guess.capture import format_of

    try:
        return format_of(args.files[0]) in ("fogcap-1", "csv-1")
    except BadInput:
        return True  # its reader says what is wrong


def _begin_run(capture: Path, out: Path | None) -> int:
    """A run.yaml from a capture's header."""
    out = out or capture.parent / "run.yaml"
    text = run_yaml_text(capture.name, facts_of(capture), out.absolute().parent)
    _write_new(out, text)
    todo = sum(TODO in line.split("#")[0] for line in text.splitlines())
    print(f"{out}: {todo} lines marked {TODO}; fill them in, then run: {_check_command(out.parent)}")
    return 0


def _check_command(folder: Path) -> str:
    """The command that checks what was written: with the calibration records that lie nearest above."""
    above = folder.absolute().parents
    records = next((path / "calibrations" for path in above if (path / "calibrations").is_dir()), None)
    place = "calibrations" if records is None else os.path.relpath(records)
    return shlex.join(["fogreduce", "check", str(folder), "--calibrations", place])


@dataclass(frozen=True)
class CaptureFacts:
    """What a capture says of itself; None where it is silent."""

    format: str
    n_gyros: int
    unit: str | None = None
    start: str | None = None
    sample_rate_hz: float | None = None
    volts_per_count: float | None = None
    duration_s: float | None = None


def facts_of(capture: Path) -> CaptureFacts:
    """Read a capture's header, or a CSV's columns.

    Raises
    ------
    BadInput
        The file cannot be read, or is neither.
    """
    from fogreduce.datasets.readers import fogcap
    from fogreduce.metadata.instant import instant_text
    from fogreduce.units import instant_of

    try:
        with capture.open("rb") as stream:
            is_fogcap = stream.read(len(fogcap.MAGIC)) == fogcap.MAGIC
    except OSError as error:
        raise BadInput.at(capture, "", found=error.strerror, expected="a capture file") from None
    if not is_fogcap:
        return _facts_of_csv(capture)
    reader = fogcap.FogcapReader(capture)
    facts = reader.facts
    start = None
    with contextlib.suppress(OverflowError):  # a start beyond the calendar is as good as none
        start = instant_text(instant_of(facts.start_us or 0))
    duration_s = reader.n_records / facts.sample_rate_hz if facts.sample_rate_hz else None
    return CaptureFacts(
        fogcap.FORMAT,
        facts.n_gyros,
        facts.unit,
        start,
        facts.sample_rate_hz,
        facts.least_count,
        duration_s,
    )


def _facts_of_csv(capture: Path) -> CaptureFacts:
    """A CSV's columns, and the rate and length that its times tell where they are right."""
    import numpy as np

    from fogreduce.constants import MICROSECONDS_PER_SECOND
    from fogreduce.datasets.readers import csv1

    gyros, _ = csv1.read_columns(capture)
    try:
        blocks = csv1.CsvReader(capture, {"sample_rate_hz": 1.0}, 0).blocks(_RECORDS)
        time_s = np.concatenate([block.time_us for block in blocks]) / MICROSECONDS_PER_SECOND
    except BadInput:
        return CaptureFacts(csv1.FORMAT, gyros)  # `fogreduce check` names the line
    steps = np.diff(time_s)
    middle = float(np.median(steps)) if steps.size else 0.0
    if middle <= 0.0:
        return CaptureFacts(csv1.FORMAT, gyros)
    # Stamps are rounded to microseconds: the mean of the steps that are one pulse long tells the rate better.
    one = steps[np.abs(steps - middle) < 0.25 * middle]
    rate = float(f"{1.0 / float(one.mean()):.6g}")
    duration_s = round(float(time_s.max()) * rate + 1.0) / rate
    return CaptureFacts(csv1.FORMAT, gyros, sample_rate_hz=rate, duration_s=float(f"{duration_s:.9g}"))


def run_yaml_text(capture: str, facts: CaptureFacts, folder: Path) -> str:
    """The run.yaml of a capture, with TODO where the capture does not say.

    Parameters
    ----------
    capture : str
        The capture's file name.
    facts : CaptureFacts
        What it says of itself.
    folder : Path
        The run's folder: gives the run's name, and the logs that lie there.
    """
    source = "columns" if facts.format == "csv-1" else "header"
    log = {key: "" if (folder / name).is_file() else "# " for key, name in _LOGS.items()}
    return f"""\
# Begun by `fogreduce init` from the {source} of {capture!r}.
# Replace each {TODO}, then run `fogreduce check`.
schema: fogreduce/run/1
run_id: {_scalar(folder.name)}  # equals the folder's name
unit: {_scalar(facts.unit)}  # the unit under test
started_at: {facts.start or TODO}  # start of record and profile, with zone: 2014-05-12T13:00:00Z
site:
  latitude_deg: {TODO}  # signed, north positive
  # latitude_uncertainty_deg: 0.001  # 1 sigma
table:
  axis: {TODO}  # x, y, z of the unit frame, or [ux, uy, uz]
  profile:  # commanded rate about that axis, piecewise constant, in order
    - {{rate_deg_s: {TODO}, duration_s: {_scalar(facts.duration_s)}}}
  # rate_uncertainty_ppm: 5  # 1 sigma
orientation:  # two unit axes at t = 0, each one of up, down, north, south, east, west
  x: {TODO}
  z: {TODO}
# azimuth_deg: 0.0  # then turned about local up by this much, clockwise seen from above
# azimuth_uncertainty_deg: 0.05  # 1 sigma
# frame_signs: [1, 1, 1]  # the sign with which each projected axis reads a positive rotation
capture:
  file: {_scalar(capture)}
  format: {facts.format}
  sample_rate_hz: {_scalar(facts.sample_rate_hz)}
  volts_per_count: {_scalar(facts.volts_per_count)}
  polarity: [{", ".join([TODO] * facts.n_gyros)}]  # 1 or -1 a gyro: turns raw volts into calibrated volts
calibration: {_scalar(f"{facts.unit or TODO}@{TODO}")}  # <unit>@<version>
{log["temperature"]}temperature: {_LOGS["temperature"]}
{log["table_log"]}table_log: {_LOGS["table_log"]}
# notes: free text
"""


_LOGS = {"temperature": "temperature.csv", "table_log": "table.csv"}


def _scalar(value: object) -> str:
    """A value as it stands in YAML; TODO for None."""
    from fogreduce.metadata.yaml12 import dump_yaml

    return TODO if value is None else dump_yaml({"v": value}).removeprefix("v: ").rstrip("\n")


def _write_new(path: Path, text: str) -> None:
    """Write `text` to a file that must not be there yet: whole, or not at all."""
    if path.exists() or path.is_symlink():
        raise BadInput.at(
            path, "", found="a file already there", expected="a new file (it is not overwritten)"
        )
    try:
        descriptor, temporary = tempfile.mkstemp(prefix=f".{path.name}.", dir=path.parent)
    except OSError as error:
        raise BadInput.at(
            path, "", found=error.strerror, expected="a folder that can be written to"
        ) from None
    try:
        with os.fdopen(descriptor, "w", encoding="utf-8") as stream:
            stream.write(text)
        Path(temporary).chmod(0o644)
        os.link(temporary, path)  # unlike a rename, fails where the name has been taken meanwhile
    except OSError as error:
        raise BadInput.at(path, "", found=error.strerror, expected="a new file that can be written") from None
    finally:
        with contextlib.suppress(FileNotFoundError):
            Path(temporary).unlink()
