"""Small campaigns with round numbers, for tests of the bench."""

import numpy as np

from withheld.chain.campaign import Campaign, Run, Unit
from withheld.chain.injector import World, exact_world, run_counts
from withheld.effects.entry import Entry

SCALE = 0.1  # V per deg/s
COUNTS_PER_DEG_H = SCALE / 3600.0 / 1e-7
UP_Y = (("y", "up"), ("x", "north"))


def unit(n: int = 3, **changes: object) -> Unit:
    """Three gyros at right angles (or a fourth along (1, 1, 1)), no bias, a little of every noise."""
    axes = np.eye(3) if n == 3 else np.vstack([np.eye(3), np.ones(3) / np.sqrt(3)])
    h = np.linalg.pinv(axes)
    values: dict[str, object] = {
        "name": "T-1",
        "version": "1",
        "H": tuple(tuple(row) for row in h.tolist()),
        "scale_factor": (SCALE,) * n,
        "bias": (0.0,) * n,
        "scale_factor_rel": (2e-5,) * n,
        "bias_sd": (1e-9,) * n,
        "axis_rad": (2e-5,) * n,
        "turn_on_deg_h": (0.05,) * n,
        "arw_deg_sqrt_h": (0.002,) * n,
        "instability_deg_h": (0.03,) * n,
        "rrw_deg_h_sqrt_h": (0.0,) * n,
    }
    return Unit(**{**values, **changes})  # type: ignore[arg-type]


def run(run_id: str = "r1", rate: float = 0.0, duration: float = 20.0, **changes: object) -> Run:
    """A turn about x, upright, at latitude 0, all polarities +."""
    values: dict[str, object] = {
        "run_id": run_id,
        "started_at": "2026-01-01T00:00:00Z",
        "latitude_deg": 0.0,
        "axis": (1.0, 0.0, 0.0),
        "profile": ((rate, duration),),
        "orientation": (("x", "up"), ("z", "north")),
        "azimuth_deg": 0.0,
        "polarity": (1, 1, 1),
        "sample_rate_hz": 64.0,
    }
    return Run(**{**values, **changes})  # type: ignore[arg-type]


def campaign(*runs: Run, n: int = 3, **changes: object) -> Campaign:
    """A campaign of these runs with the round unit."""
    return Campaign("hand", unit(n, **changes), runs or (run(),))


def change(of: Campaign, *entries: Entry, number: int = 0) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Times [s], counts without and counts with the effects, in the exact mode."""
    one = of.runs[number]
    _, before = run_counts(exact_world(of), one)
    _, after = run_counts(exact_world(of, entries), one)
    return np.arange(one.samples) / one.sample_rate_hz, before, after


def world(of: Campaign, *entries: Entry) -> World:
    """The exact mode."""
    return exact_world(of, entries)


def on(effect, gyro="gyro1", **parameters):
    """An effect at a gyro, in every run."""
    return Entry(effect, (gyro,), ("*",), parameters)


#: Both senses, and a standstill.
THREE = (run("a", 8.0, 200.0), run("b", -8.0, 200.0), run("c", 0.0, 200.0))
