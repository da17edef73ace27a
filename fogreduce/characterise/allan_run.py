"""Allan deviation of a reduced run: each gyro and x, y, z, over the longest segment of constant rate."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from fogreduce.characterise.allan_channel import KINDS, channel_of
from fogreduce.characterise.allan_freedom import Kind
from fogreduce.characterise.allan_result import Allan
from fogreduce.constants import SECONDS_PER_HOUR
from fogreduce.datasets.flags import UNUSABLE_AXES, UNUSABLE_RECORD
from fogreduce.errors import BadInput
from fogreduce.estimate.mean_curve import curve
from fogreduce.stages import angles
from fogreduce.stages.dataset import StageDataset
from fogreduce.stages.files import read_report
from fogreduce.stages.setup import Setup, seconds

if TYPE_CHECKING:
    import xarray as xr

Array = NDArray[np.float64]


_VARIABLES = ("pulse", "flag", "gyro_flag", "gyro_rate")


#: Variables of the records by name: `time` (N,) stamps [us] from the run's start, `pulse` and `flag` (N,),
#: `gyro_flag` and `gyro_rate` (n, N), `axis_rate` (3, N) where the unit has axes; rates in deg/s.
Records = Mapping[str, NDArray[Any]]


def allan_of_run(out: Path, kinds: Sequence[Kind] = KINDS) -> Allan:
    """Allan deviation of a run's results folder; see `fogreduce.allan`.

    Raises
    ------
    BadInput
        A dataset or report is missing, damaged, or of another version.
    """
    setup = Setup.read(out)
    found: dict[str, NDArray[Any]] = {}
    wanted = [("ingest", ["time", "pulse"]), ("calibrate", ["flag", "gyro_flag", "gyro_rate"])]
    if setup.axes:
        wanted.append(("remove_earth", ["axis_rate"]))
    for stage, names in wanted:
        with StageDataset(setup, stage) as source:
            parts = [part for _, part in source.blocks(names)]
        found |= {name: np.concatenate([part[name] for part in parts], axis=-1) for name in names}
    return _allan(setup, found, kinds, None, "QNBKR")


def allan_of_view(
    view: xr.Dataset, *, kinds: Sequence[Kind], factors: Sequence[int] | None, terms: str
) -> Allan:
    """The same of a Dataset of `open_run`, or of a part of its records."""
    source = view.encoding.get("source")
    if source is None:
        expected = "one as open_run gives it, or a part of its records (else hand over arrays)"
        raise BadInput.at(
            "the dataset", "encoding", found="no folder that it was opened from", expected=expected
        )
    setup = Setup.read(Path(source))
    start = np.datetime64(setup.facts.start_us, "us")
    time_us = (view["time"].values - start).astype("timedelta64[us]").astype(np.int64)
    found = {name: view[name].values for name in (*_VARIABLES, "axis_rate") if name in view}
    return _allan(setup, found | {"time": time_us}, kinds, factors, terms)


def _allan(
    setup: Setup, records: Records, kinds: Sequence[Kind], factors: Sequence[int] | None, terms: str
) -> Allan:
    segments = read_report(setup, "fit")["segments"]
    segment = max(segments, key=lambda item: float(item["stop_s"] - item["start_s"]))
    inside = _inside(setup, records, segment, len(segments))
    if not inside.any():
        raise BadInput.at(setup.out, "", found="no record of its longest segment", expected="some")
    time_s = seconds(records["time"][inside])
    place = records["pulse"][inside] - int(records["pulse"][inside].min())
    interval_s = 1.0 / setup.facts.sample_rate_hz
    channels = []
    for name, rate, usable in _channels(setup, records):
        left = rate[inside] - _sine(setup, segment, name, time_s)
        series = np.full(int(place.max()) + 1, np.nan)
        good = usable[inside] & np.isfinite(left)
        series[place[good]] = left[good] * SECONDS_PER_HOUR
        channels.append(channel_of(name, series, interval_s, kinds, factors, terms))
    manifest = setup.manifest
    about = {"campaign": manifest["campaign"], "run_id": manifest["run_id"], "version_id": setup.version_id}
    about |= {"label": manifest.get("label") or "", "segment": segment["segment"]}
    return Allan(channels, interval_s, about)


def _inside(setup: Setup, records: Records, segment: Mapping[str, Any], segments: int) -> NDArray[np.bool_]:
    """Usable records of a segment, the guard at its inner edges left out, each pulse once."""
    guard = float(setup.parameters["edge_guard_s"])
    time_s = seconds(records["time"])
    low = segment["start_s"] + (guard if segment["segment"] > 1 else 0.0)
    high = segment["stop_s"] - (guard if segment["segment"] < segments else 0.0)
    usable = (records["flag"] & UNUSABLE_RECORD) == 0
    inside: NDArray[np.bool_] = (time_s >= low) & (time_s < high) & usable
    return inside


def _channels(setup: Setup, records: Records) -> list[tuple[str, Array, NDArray[np.bool_]]]:
    """Name, rate [deg/s] and which samples are usable, of every gyro and axis."""
    rate, flags = records["gyro_rate"], records["gyro_flag"]
    found = [(name, rate[k], flags[k] == 0) for k, name in enumerate(setup.gyros)]
    if "axis_rate" in records:
        # Records of three gyros of four have rates only where they were asked for; their noise is another.
        whole = (records["flag"] & UNUSABLE_AXES) == 0
        found += [(name, records["axis_rate"][k], whole) for k, name in enumerate(setup.axes)]
    return found


def _sine(setup: Setup, segment: Mapping[str, Any], name: str, time_s: Array) -> Array:
    """The sine of a channel's fitted curve [deg/s]: offset and slope stay, the slope being a rate ramp."""
    item = angles.channel_of(segment, name)
    if item is None or not item["has_sine"]:
        return np.zeros_like(time_s)
    _, cosine, sine, _ = item["theta"]
    turning = curve(time_s, np.array([0.0, cosine, sine, 0.0, item["rate_rad_s"]]))
    if name in setup.gyros:
        k, facts = setup.gyros.index(name), setup.facts
        turning *= facts.polarity[k] / facts.scale_factor[k]
    return turning
