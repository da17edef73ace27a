"""``fogreduce curve OUT``: the mean curve of a reduced run by Levenberg-Marquardt, beside the linear fit."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fogreduce.errors import BadInput, FogreduceError

if TYPE_CHECKING:
    from fogreduce.estimate.levenberg_marquardt import FreeFit
    from fogreduce.physics.raw_quantity import RawUnit
    from fogreduce.stages.fit import Segment
    from fogreduce.stages.setup import Setup

_ROW = "  {:<12}{:>22}{:>14}{:>22}"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the command's arguments."""
    parser.add_argument("out", metavar="OUT", type=Path, help="results of a run, as reduce --out wrote them")
    parser.add_argument(
        "--channel",
        metavar="NAME",
        help="x, y, z, gyro1, ... (default: x, y and z, or all gyros of a unit that gives none)",
    )
    parser.add_argument(
        "--free-rate", action="store_true", help="fit c too (default: held at the table's rate)"
    )


def run(arguments: argparse.Namespace) -> int:
    """Print each channel's curve, segment by segment. A channel is held in memory whole."""
    from fogreduce.progress import progress
    from fogreduce.stages.files import read_report
    from fogreduce.stages.setup import Setup

    setup = Setup.read(arguments.out)
    names = setup.axes + setup.gyros
    if arguments.channel is not None and arguments.channel not in names:
        raise BadInput.at("--channel", "", found=arguments.channel, expected="one of " + ", ".join(names))
    channels = [arguments.channel] if arguments.channel else setup.axes or setup.gyros
    fits = read_report(setup, "fit")
    lines = [f"{setup.manifest['campaign']} / {setup.facts.run_id}, version {setup.version_id}"]
    undetermined = 0
    with progress(len(channels), "channels") as advance:
        for done, channel in enumerate(channels):
            advance(done)
            for segment, linear, time_s, values in _segments(setup, fits, channel):
                lines.append(_heading(channel, segment, time_s.size, arguments.free_rate))
                try:
                    found = _fit(segment, linear, time_s, values, free_rate=arguments.free_rate)
                except FogreduceError as error:
                    undetermined += 1
                    lines.append(f"  {error}")
                else:
                    rows = _rows(channel, linear, found, setup.facts.raw_unit)
                    lines += [_ROW.format(*row) for row in rows]
    print("\n".join(lines))
    if undetermined:
        print(f"{arguments.out}: {undetermined} curves could not be fitted", file=sys.stderr)
    return 1 if undetermined else 0


def _segments(setup: Setup, fits: dict[str, Any], channel: str) -> list[tuple[Segment, Any, Any, Any]]:
    """Each segment with the linear fit of the channel in it, and the times and values that this rests on."""
    from fogreduce.stages.nodes.fit import fit_of

    time_s, values = _usable(setup, channel)
    chooser = fit_of(setup, time_s.size)
    found = []
    for segment, plain in zip(chooser.segments, fits["segments"], strict=True):
        linear = next((item for item in plain["channels"] if item and item["channel"] == channel), None)
        inside = chooser.inside(segment, time_s) if len(chooser.segments) > 1 else slice(None)
        found.append((segment, linear, time_s[inside], values[inside]))
    return found


def _usable(setup: Setup, channel: str) -> tuple[Any, Any]:
    """Times [s] and values of a channel's records that count in estimates."""
    import numpy as np

    from fogreduce.datasets.flags import UNUSABLE_AXES, UNUSABLE_RECORD
    from fogreduce.physics.quantization import raw_from_counts
    from fogreduce.stages.dataset import StageDataset
    from fogreduce.stages.setup import seconds

    is_gyro = channel in setup.gyros
    variable = setup.facts.raw_unit.variable if is_gyro else "axis_rate"
    row = (setup.gyros if is_gyro else setup.axes).index(channel)
    unusable = UNUSABLE_AXES if setup.complete_records and not is_gyro else UNUSABLE_RECORD
    times, values = [], []
    with StageDataset(setup, "ingest" if is_gyro else "remove_earth") as source:
        names = ("time", "flag", variable, *(["gyro_flag"] if is_gyro else []))
        packed = is_gyro and source.has_counts()
        for _, part in source.blocks(names):
            usable = (part["flag"] & unusable) == 0
            if is_gyro:
                usable &= part["gyro_flag"][row] == 0
            elif not setup.complete_records:
                usable &= np.isfinite(part[variable][row])
            kept = part[variable][row : row + 1, usable]
            times.append(seconds(part["time"][usable]))
            values.append((raw_from_counts(kept, setup.facts.least_count) if packed else kept)[0])
    return np.concatenate(times), np.concatenate(values)


def _fit(segment: Segment, linear: Any, time_s: Any, values: Any, *, free_rate: bool) -> FreeFit:
    from fogreduce.estimate.levenberg_marquardt import fit_curve

    if linear is None:
        raise FogreduceError("the linear fit found that the records do not determine a mean curve")
    rate = linear["rate_rad_s"] if linear["has_sine"] else 0.0
    return fit_curve(time_s, values, rate, free_rate=free_rate)


def _heading(channel: str, segment: Segment, records: int, free_rate: bool) -> str:
    rate = "free" if free_rate and segment.basis.has_sine else "held at the table's rate"
    span = f"{segment.start_s:g} to {segment.stop_s:g} s"
    heading = f"{channel}, segment {segment.number} ({span}, {segment.rate_deg_s:g} deg/s): {records} records"
    return f"{heading}, c {rate}\n" + _ROW.format("parameter", "value", "std error", "linear fit")


def _rows(channel: str, linear: Any, found: FreeFit, raw_unit: RawUnit) -> list[tuple[str, str, str, str]]:
    """Parameter, value, standard error, the linear fit's value."""
    import numpy as np

    from fogreduce.estimate.mean_curve import amplitude_and_phase

    unit, slope_unit = ("deg_s", "deg_s2")
    if channel.startswith("gyro"):
        unit, slope_unit = raw_unit.suffix, raw_unit.slope_suffix
    theta, errors = found.theta, np.sqrt(np.diag(found.covariance))
    old, old_covariance = np.array(linear["theta"]), np.array(linear["covariance"])
    rows: list[tuple[str, float, float, float]] = [(f"a_{unit}", theta[0], errors[0], old[0])]
    if linear["has_sine"]:
        b, b_err, d, d_err = amplitude_and_phase(theta, found.covariance)
        old_b, _, old_d, _ = amplitude_and_phase(old, old_covariance)
        rows.append((f"b_{unit}", b, b_err, old_b))
        rows.append(("c_rad_s", theta[4], errors[4], linear["rate_rad_s"]))
        rows.append(("d_rad", d, d_err, old_d))
    rows.append((f"e_{slope_unit}", theta[3], errors[3], old[3]))
    rows.append((f"sigma_{unit}", found.sigma, np.nan, linear["sigma"]))
    return [(name, f"{new:.15g}", _error(err), f"{old:.15g}") for name, new, err, old in rows]


def _error(number: float) -> str:
    """A standard error; nothing where there is none, as for a parameter that was held."""
    return f"{number:.4g}" if number > 0 else ""
