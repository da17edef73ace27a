"""Dead zones and clipping: exact differences about where a reading stops to follow the rate, not scaled."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

import numpy as np

from fogreduce.constants import SECONDS_PER_HOUR
from fogreduce.diagnosis.inference.candidate import Candidate
from fogreduce.diagnosis.which.catalogue.builder import Builder
from fogreduce.effects.at import At, Place
from fogreduce.effects.selection import Action
from fogreduce.effects.table import EFFECTS
from fogreduce.simulate.forward import ForwardRun
from fogreduce.simulate.streams import stream

WIDTHS_DEG_H = np.geomspace(0.05, 250.0, 56)
_CLIPS = np.linspace(0.5, 0.98, 9)


def dead_zone_candidates(build: Builder) -> Iterator[Candidate]:
    """A dead zone at each gyro, of a grid of widths and either kind."""
    if "dead_zone" not in build.allowed:
        return
    effect = EFFECTS["dead_zone"]
    for kind in ("threshold", "subtractive"):
        parts = []
        for one in build.inputs:
            blocks, place = one.scene.blocks, Place("", 0, (), build.n, partial(stream, 0, "gap"))
            early = [a for a in build.base if _is_early(a)]
            forward = ForwardRun(one.facts, None, early, one.scene.temperature, turning=one.scene.turning)
            m = forward.readings(blocks.time_s)
            at = At(place, blocks.time_s, 1.0, forward.motion, forward.axes[0], None, m, m[0])
            changes = [
                blocks.means(effect.forward(m, {"deg_h": width, "kind": kind}, at) - m)
                for width in WIDTHS_DEG_H.tolist()
            ]
            parts.append(np.array(changes) * SECONDS_PER_HOUR)
        grid = tuple({"deg_h": width, "kind": kind} for width in WIDTHS_DEG_H.tolist())
        for i in range(build.n):
            columns = np.concatenate([part[:, i] for part in parts], axis=1).T
            if np.any(columns):
                rows = build.whiten.rows.of(i)
                yield build.at_gyro(
                    "dead_zone",
                    i,
                    build.whiten(columns, rows)[:, :, None],
                    grid=grid,
                    fixed=True,
                    share=0.5 / build.n,
                )


def _is_early(one: Action) -> bool:
    return one.effect.stage < EFFECTS["dead_zone"].stage


def saturation_candidates(build: Builder) -> Iterator[Candidate]:
    """Clipping of each gyro: where its converter seems to rest, or at shares of its largest reading."""
    if "saturation" not in build.allowed:
        return
    facts = build.inputs[0].facts
    limits = []
    for i in range(build.n):
        largest = max(
            float(np.abs(p[i]).max()) / SECONDS_PER_HOUR * abs(facts.scale_factor[i]) for p in build.plain
        )
        limits.append([build.rails[i]] if i in build.rails else (_CLIPS * largest).tolist())
    # what clips one gyro changes no other: all are clipped at once
    columns = [
        build.difference(
            [
                ("saturation", [name], {"volts": own[min(k, len(own) - 1)]})
                for name, own in zip(build.names, limits, strict=True)
            ]
        )
        for k in range(max(len(own) for own in limits))
    ]
    for i, own in enumerate(limits):
        white = build.gyro_columns(i, columns[: len(own)])[:, :, None]
        grid = tuple({"volts": v} for v in own)
        yield build.at_gyro("saturation", i, white, grid=grid, fixed=True)
