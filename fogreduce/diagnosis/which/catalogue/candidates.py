"""Every effect at every place it may sit, as columns: what it would change in block means.

What an effect needs for that stands in its entry (`fogreduce.effects.design`). One that is not linear in all
its parameters has a grid of them; what has no amplitude (a swapped column, a dead zone of a given width) is
its exact difference and is not scaled.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from fogreduce.diagnosis.inference.candidate import Candidate
from fogreduce.diagnosis.which.catalogue.builder import Builder
from fogreduce.diagnosis.which.catalogue.exact import of_range, of_reading, of_volts, of_wiring
from fogreduce.diagnosis.which.catalogue.gyro import at_gyros, in_single_runs
from fogreduce.diagnosis.which.catalogue.table import of_table
from fogreduce.effects.model import Effect
from fogreduce.effects.table import EFFECTS

_EXACT = {"switch": of_wiring, "reading": of_reading, "volts": of_volts, "range": of_range}


def all_candidates(build: Builder) -> list[Candidate]:
    """Every candidate whose effect is allowed and does anything at all in these runs."""
    found = (one for name, effect in EFFECTS.items() if name in build.allowed for one in _of(effect, build))
    part = build.inputs[0].part
    sizes = {} if part is None else part.realistic()
    return [
        replace(one, realistic=sizes.get(EFFECTS[one.effect].sheet)) for one in found if np.any(one.columns)
    ]


def _of(effect: Effect, build: Builder) -> Iterator[Candidate]:
    design = effect.design
    if design is None or (effect.needs_temperature and not build.warm):
        return
    if design.turning and not any(build.turning):
        return
    if design.exact:
        yield from _EXACT[design.exact](effect, design, build)
    elif effect.channels != "gyro":
        yield from of_table(effect, design, build)
    elif design.one_run:
        yield from in_single_runs(effect, design, build)
    else:
        yield from at_gyros(effect, design, build)
