"""What the catalogue's effects of table, site, mounting and wiring would change in block means."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from fogreduce.diagnosis.inference.candidate import EVERY, Candidate
from fogreduce.diagnosis.which.catalogue.builder import Builder

#: One number scales these: parameter, and the small step of the finite difference.
LINEAR_TABLE = {
    "table_rate_error": ("ppm", 1.0),
    "heading_error": ("deg", 0.01),
    "latitude_error": ("deg", 0.01),
}
DELAYS_S = (0.02, 0.05, 0.15, 0.4, 1.0, 2.0, 3.0)
HARMONICS = (1, 2, 3, 4, 5, 6, 8, 9, 10, 12, 18, 24, 36)


def table_candidates(build: Builder) -> Iterator[Candidate]:
    """Effects of table, site and mounting; what needs a rotation only where a run has one."""
    table = ["table"]
    for effect, (name, step) in LINEAR_TABLE.items():
        if effect in build.allowed:
            one = build.difference([(effect, table, {name: step})])
            yield build.of_table(effect, [one], 1, [{}], (name,), np.array([[step]]))
    if "mount_rotation" in build.allowed:
        tilts = [
            build.difference([("mount_rotation", table, {"mrad": tuple(t)})])
            for t in (0.1 * np.eye(3)).tolist()
        ]
        names = tuple(f"mrad[{k}]" for k in range(3))
        yield build.of_table("mount_rotation", tilts, 3, [{}], names, np.full((1, 3), 0.1))
    if not any(build.turning):
        return
    if "start_offset" in build.allowed:
        delays = [*DELAYS_S, *(-s for s in DELAYS_S)]
        late = [build.difference([("start_offset", table, {"s": s})]) for s in delays]
        yield build.of_table("start_offset", late, 1, [{} for _ in delays], ("s",), np.array(delays)[:, None])
    if "table_rate_ripple" in build.allowed:
        waves = [
            build.difference([("table_rate_ripple", table, {"ppm": 1.0, "harmonic": n, "phase_rad": phase})])
            for n in HARMONICS
            for phase in (0.0, np.pi / 2)
        ]
        grid = [{"harmonic": n} for n in HARMONICS]
        steps = np.ones((len(grid), 2))
        yield build.of_table("table_rate_ripple", waves, 2, grid, ("cos", "sin"), steps)


def wiring_candidates(build: Builder) -> Iterator[Candidate]:
    """A wrong sense of rotation, turned polarities, exchanged gyros."""
    rows = slice(0, build.whiten.rows.total)

    def exact(effect: str, channel: str, share: float, **parameters: Any) -> Candidate:
        one = build.difference([(effect, [channel], parameters)])
        stage = "table" if channel == "table" else "link"
        white = build.whiten(one[:, None])[:, None, :]
        return Candidate(
            effect,
            (channel,),
            EVERY,
            rows,
            white,
            (parameters,),
            (),
            np.ones((1, 1)),
            fixed=True,
            share=share,
            stage=stage,
            extra=parameters,
        )

    if "rotation_sense" in build.allowed and any(build.turning):
        yield exact("rotation_sense", "table", 1.0)
    for i, name in enumerate(build.names):
        if "polarity_error" in build.allowed:
            yield exact("polarity_error", name, 1.0 / build.n)
        for other in build.names[i + 1 :] if "channel_swap" in build.allowed else []:
            share = 2.0 / build.n / (build.n - 1)
            yield exact("channel_swap", name, share, **{"with": other})
