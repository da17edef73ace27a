"""Effects of the link and the wiring: on the counts as they arrive."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fogreduce.constants import MISSING_COUNT
from fogreduce.effects.at import At
from fogreduce.effects.design import Departures, Design
from fogreduce.effects.gyro_names import gyro_index
from fogreduce.effects.model import Effect, Numbers, Parameter, Parameters, Stage

Counts = NDArray[np.int32]


def stuck_samples(counts: Counts, p: Numbers, at: At) -> Counts:
    """A count repeats the one before, which may itself be a repeat; the record's first cannot."""
    place = at.place
    stuck = place.generator.random(len(counts)) < p["fraction"]
    before = place.state.get("last")
    extended = np.concatenate(([counts[0] if before is None else before], counts))
    stuck = np.concatenate(([False], stuck))
    source = np.maximum.accumulate(np.where(stuck, 0, np.arange(len(extended))))
    repeated = extended[source][1:]
    place.state["last"] = repeated[-1]
    return repeated


def spikes(counts: Counts, p: Numbers, at: At) -> Counts:
    """Counts replaced by spurious ones, uniform over +-2^30, each independently."""
    generator = at.place.generator
    struck = generator.random(len(counts)) < p["fraction"]
    changed = counts.copy()
    changed[struck] = generator.integers(-(2**30), 2**30, int(struck.sum()), dtype=np.int32, endpoint=True)
    return changed


def dropouts(counts: Counts, p: Numbers, at: At) -> Counts:
    """Answers missing, each independently."""
    struck = at.place.generator.random(len(counts)) < p["fraction"]
    return np.where(struck, np.int32(MISSING_COUNT), counts)


def channel_swap(counts: Counts, p: Parameters, at: At) -> Counts:
    """The other gyro's column; the entry is applied to both gyros."""
    exchanged: Counts = at.columns[gyro_index(p["with"])]
    return exchanged


def polarity_error(counts: Counts, p: Numbers, at: At) -> Counts:
    """Counts of the other sign; a missing answer stays missing."""
    return np.where(counts == MISSING_COUNT, counts, -counts)


_LINK = (
    "the paper: its link has no checksum, and answers are lost; serial links in a laboratory: 1e-7 to 1e-3"
)


def _fraction() -> Parameter:
    return Parameter("fraction", "", "share of samples", off=0.0, low=0.0, high=1.0, realistic=(1e-6, 1e-2))


EFFECTS = (
    Effect(
        "dropouts",
        Stage.DROPOUTS,
        "answers missing (-2147483648), each independently",
        dropouts,
        _LINK,
        (_fraction(),),
        {"fraction": 0.01},
        words="misses answers",
        departures=Departures(bursts=1.5),
    ),
    Effect(
        "spikes",
        Stage.SPIKES,
        "counts replaced by spurious ones, uniform over +-2^30, each independently",
        spikes,
        _LINK,
        (_fraction(),),
        {"fraction": 1e-3},
        words="gives spurious counts now and then",
        departures=Departures(bursts=1.2),
    ),
    Effect(
        "stuck_samples",
        Stage.REPEATS,
        "a count repeats the one before, each independently",
        stuck_samples,
        "two clocks without a handshake: the share by which their rates differ, 1e-5 to 1e-1",
        (_fraction(),),
        {"fraction": 0.5},
        words="repeats its last count now and then",
        departures=Departures(bursts=1.5),
    ),
    Effect(
        "channel_swap",
        Stage.COLUMNS,
        "two gyros' columns exchanged",
        channel_swap,
        "a mistake of wiring: there or not",
        (Parameter("with", "", "the other gyro", kind="gyro"),),
        {"with": "gyro1"},
        mutual="with",
        words="has its column exchanged with another gyro's",
        design=Design(exact="switch"),
        departures=Departures(wanders=False),
    ),
    Effect(
        "polarity_error",
        Stage.POLARITY,
        "polarity_i is the other one than stated",
        polarity_error,
        "a mistake of wiring: there or not",
        (),
        {},
        words="has the other sign than stated",
        design=Design(exact="switch"),
        departures=Departures(wanders=False),
    ),
)
