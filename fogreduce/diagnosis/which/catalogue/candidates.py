"""Every effect at every place it may sit, as columns: what it would change in block means.

An effect that is not linear in all its parameters has a grid of them; what has no amplitude (a swapped
column, a dead zone of a given width) is its exact difference and is not scaled.
"""

from __future__ import annotations

import numpy as np

from fogreduce.diagnosis.inference.candidate import Candidate
from fogreduce.diagnosis.which.catalogue.builder import Builder
from fogreduce.diagnosis.which.catalogue.gyro import crosstalk_candidates, gyro_candidates
from fogreduce.diagnosis.which.catalogue.limits import dead_zone_candidates, saturation_candidates
from fogreduce.diagnosis.which.catalogue.table import table_candidates, wiring_candidates

_KINDS = (
    gyro_candidates,
    dead_zone_candidates,
    saturation_candidates,
    crosstalk_candidates,
    table_candidates,
    wiring_candidates,
)


def all_candidates(build: Builder) -> list[Candidate]:
    """Every candidate whose effect is allowed and does anything at all in these runs."""
    found = (one for kind in _KINDS for one in kind(build))
    return [one for one in found if one.effect in build.allowed and np.any(one.columns)]
