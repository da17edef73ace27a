"""What the link, the wiring and the clock do to a run's records."""

import numpy as np

from withheld.arrays import Counts, Flags, Stamps
from withheld.chain.campaign import Run
from withheld.effects.entry import Entry, select
from withheld.streams import stream

MISSING = -2147483648
SPURIOUS = 2**30


def _hits(entry: Entry, samples: int, rng: np.random.Generator) -> Flags:
    """Samples struck, (k,) bool; departure `burst`: of the same share, in runs of that mean length."""
    fraction, burst = entry.number("fraction"), entry.departure.get("burst", 1.0)
    starts = rng.random(samples) < fraction / burst
    if burst <= 1.0:
        return starts
    struck = np.zeros(samples, dtype=bool)
    for start in np.flatnonzero(starts):
        struck[start : start + rng.geometric(1.0 / burst)] = True
    return struck


def struck(
    run: Run, entry: Entry, number: int, gyro: int, samples: int, seed: int, campaign: str
) -> tuple[Flags, np.random.Generator]:
    """Samples of a gyro (from 0) that an entry strikes in a run, (samples,), and the generator after them.

    `number`: the entry's place among those of its effect in the run.
    """
    rng = stream(seed, campaign, "link", run.run_id, entry.effect, str(number), f"gyro{gyro + 1}")
    hits = _hits(entry, samples, rng)
    if entry.effect == "stuck_samples":
        hits[0] = False
    return hits, rng


def link(run: Run, entries: tuple[Entry, ...], counts: Counts, seed: int, campaign: str) -> Counts:
    """Stuck samples, spikes, dropouts, swapped columns, wrong polarity, in that order, (k, n) int64.

    A stuck sample repeats the one before it, which may itself be stuck; the first cannot be.  Departure
    `reach`: spurious counts reach that share of +-2^30.
    """
    out = counts.copy()
    for effect in ("stuck_samples", "spikes", "dropouts"):
        for number, e in enumerate(select(entries, run.run_id, effect)):
            for i in e.gyros():
                hits, rng = struck(run, e, number, i, len(out), seed, campaign)
                if effect == "stuck_samples":
                    source = np.maximum.accumulate(np.where(hits, 0, np.arange(len(out))))
                    out[:, i] = out[source, i]
                elif effect == "spikes":
                    reach = int(SPURIOUS * e.departure.get("reach", 1.0))
                    out[hits, i] = rng.integers(-reach, reach, int(hits.sum()), endpoint=True)
                else:
                    out[hits, i] = MISSING
    for e in select(entries, run.run_id, "channel_swap"):
        one, other = e.gyros()[0], int(e.parameters["with"][4:]) - 1
        out[:, [one, other]] = out[:, [other, one]]
    for e in select(entries, run.run_id, "polarity_error"):
        for i in e.gyros():
            out[:, i] = np.where(out[:, i] == MISSING, MISSING, -out[:, i])
    return out


def stamps_us(run: Run, entries: tuple[Entry, ...]) -> Stamps:
    """Time stamps, whole microseconds, (k,) uint64; `clock_error`: true time t is stamped t / (1 + e)."""
    t = np.arange(run.samples) / run.sample_rate_hz
    for e in select(entries, run.run_id, "clock_error"):
        t = t / (1.0 + e.number("ppm") * 1e-6)
    return np.rint(t * 1e6).astype(np.uint64)
