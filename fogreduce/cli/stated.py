"""Options of ``fogreduce init``: what the user knows of files and bench."""

from __future__ import annotations

import argparse
import re
from typing import TYPE_CHECKING, Any

from fogreduce.errors import BadInput
from fogreduce.physics.raw_quantity import RAW_UNITS

if TYPE_CHECKING:
    from fogreduce.guess.capture import Stated
    from fogreduce.guess.document import Bench

_COLUMNS = ("time", "gyros", "sensor_temperature", "electronics_temperature", "table_angle")


def add_stated(parser: argparse.ArgumentParser) -> None:
    """Declare them."""
    files = parser.add_argument_group("what you know of the files")
    files.add_argument("--format", metavar="NAME", help="format, where the file does not tell")
    files.add_argument("--rate", metavar="HZ", type=float, help="sample rate")
    files.add_argument("--unit", choices=RAW_UNITS, help="unit of the readings")
    files.add_argument(
        "--columns",
        metavar="LIST",
        help="which column is what, by name or number: time=1,gyros=2:4 or time=t,gyros=gx,gy,gz; also "
        + ", ".join(_COLUMNS[2:]),
    )
    files.add_argument(
        "--time-unit", choices=("s", "ms", "us", "ns", "ticks"), help="unit of the time column"
    )
    files.add_argument("--tick", metavar="S", type=float, help="length of a tick, for --time-unit ticks")
    files.add_argument("--epoch", choices=("run", "unix", "gps"), help="what the time column counts from")
    bench = parser.add_argument_group("what no file tells")
    bench.add_argument(
        "--name", metavar="UNIT", default="UNIT-1", help="name of the unit (default: %(default)s)"
    )
    bench.add_argument("--latitude", metavar="DEG", type=float, help="latitude, north positive")
    bench.add_argument("--orientation", metavar="LIST", help="two unit axes at the start: x=up,z=north")
    bench.add_argument("--axis", choices=("x", "y", "z"), help="the table's axis in the unit frame")
    bench.add_argument(
        "--profile", metavar="LIST", help="commanded rates and how long: 3:600,-3:600 [deg/s, s]"
    )


def stated_of(args: argparse.Namespace | None) -> Stated:
    """What is stated of the files; nothing without arguments."""
    from fogreduce.guess.capture import Stated

    if args is None:
        return Stated()
    columns = columns_in(args.columns) if args.columns else None
    return Stated(args.format, args.rate, args.unit, columns, args.time_unit, args.tick, args.epoch)


def bench_of(args: argparse.Namespace) -> Bench:
    """What is stated of the bench."""
    from fogreduce.guess.document import Bench

    orientation = dict(_pairs("--orientation", args.orientation, "=")) if args.orientation else {}
    profile = None
    if args.profile:
        profile = [_step(rate, time) for rate, time in _pairs("--profile", args.profile, ":")]
    return Bench(args.latitude, orientation, args.axis, profile, args.name)


def columns_in(text: str) -> dict[str, Any]:
    """Columns by their keys: ``time=t,gyros=gx,gy,gz`` or, by number, ``time=1,gyros=2:4``."""
    found: dict[str, Any] = {}
    parts = re.split(rf"(?:^|,)({'|'.join(_COLUMNS)})=", text)
    if parts[0] or len(parts) < 3:
        expected = "KEY=COLUMN,... with keys of " + ", ".join(_COLUMNS)
        raise BadInput.at("--columns", "", found=text, expected=expected)
    for key, value in zip(parts[1::2], parts[2::2], strict=True):
        if key != "gyros":
            found[key] = _column(value)
        elif re.fullmatch(r"[0-9]+:[0-9]+", value):
            first, last = map(int, value.split(":"))
            found[key] = list(range(first, last + 1))
        else:
            found[key] = [_column(name) for name in value.split(",")]
    return found


def _column(text: str) -> str | int:
    return int(text) if re.fullmatch(r"[0-9]+", text) else text


def _pairs(option: str, text: str, between: str) -> list[tuple[str, str]]:
    pairs = [tuple(part.strip() for part in item.split(between)) for item in text.split(",")]
    if any(len(pair) != 2 for pair in pairs):
        raise BadInput.at(option, "", found=text, expected=f"A{between}B,A{between}B")
    return [(pair[0], pair[1]) for pair in pairs]


def _step(rate: str, time: str) -> tuple[float, float]:
    try:
        return float(rate), float(time)
    except ValueError:
        expected = "RATE:DURATION in deg/s and s"
        raise BadInput.at("--profile", "", found=f"{rate}:{time}", expected=expected) from None
