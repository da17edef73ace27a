"""Captures that the simulator makes with the causes in it: what they show as well is no sign of anything
further.

What the formulae of the causes leave out (counts that a repeat holds, struck samples that pass as readings,
edges within a block) grows with their size and stands in such captures just as in the measured ones.
"""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from fogreduce.datasets.atomic import write_text
from fogreduce.diagnosis import priors
from fogreduce.diagnosis.effects_file import effects_text, entry
from fogreduce.diagnosis.inference.causes import Cause
from fogreduce.diagnosis.inference.evidence import WhitenedResidual
from fogreduce.diagnosis.inference.findings import Finding
from fogreduce.diagnosis.inference.problem import State
from fogreduce.diagnosis.inference.search import Search
from fogreduce.diagnosis.inference.significance import significance
from fogreduce.diagnosis.observe.data import Data, read_data
from fogreduce.diagnosis.where.places import Place
from fogreduce.diagnosis.which.full_rate.statistics import FullRateStatistics
from fogreduce.errors import BadInput
from fogreduce.metadata.part import Part
from fogreduce.simulate.campaign import write_campaign
from fogreduce.simulate.plan import Options, prepare

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Source:
    """Where a campaign's metadata lie: folder, calibrations, the runs taken (empty: all), a data sheet."""

    campaign: Path
    calibrations: Path
    only: tuple[str, ...] = ()
    part: Part | None = None


@dataclass(frozen=True)
class Simulated:
    """A few simulated campaigns with a set of causes in them.

    Attributes
    ----------
    search, state : Search, State
        Of the measured captures: what the simulated ones are held against as well.
    source : Source
    """

    search: Search
    state: State
    source: Source

    @cached_property
    def campaigns(self) -> list[Data]:
        """The captures, read as measured ones are; none where the causes cannot be simulated."""
        causes = self.state.causes
        if not causes or any(c.unlogged for c in causes):
            return []
        out = []
        for seed in range(1, priors.SIMULATED + 1):
            try:
                out.append(_simulated(self.source, causes, seed))
            except BadInput:
                # a fitted number that an effects file does not take
                return []
        return out

    @cached_property
    def _residuals(self) -> list[WhitenedResidual]:
        """What the causes leave of each."""
        problem, model = self.state.problem, self.state.model
        metric = problem.metric.with_free(model.slopes)
        out = []
        for data in self.campaigns:
            y = problem.whiten(problem.whiten.rows.stacked(data.residual)[:, None])[:, 0]
            out.append(WhitenedResidual.of(metric, y - model.change))
        return out

    @cached_property
    def _findings(self) -> list[list[Finding]]:
        return [
            FullRateStatistics(data, self.search.allowed).findings(self.state.causes)
            for data in self.campaigns
        ]

    def left_of(self, place: Place) -> Place:
        """A place less what the simulated captures show there."""
        if place.family is not None:
            q = [residual.fit(place.family).q for residual in self._residuals]
        else:
            q = [
                max((f.snr2 for f in found if _same(f, place)), default=0.0) for found in self._findings
            ] or [0.0]
        shown = max(q, default=0.0)
        if significance(shown, place.degrees, place.trials) <= 0.0:
            return place
        left = max(np.sqrt(place.q) - priors.AS_SIMULATED * np.sqrt(shown), 0.0) ** 2
        return replace(place, q=left, sigma=significance(left, place.degrees, place.trials))


def _same(finding: Finding, place: Place) -> bool:
    return (finding.stage, finding.feature, finding.channels) == (place.stage, place.feature, place.channels)


def _simulated(source: Source, causes: Sequence[Cause], seed: int) -> Data:
    """Captures of all runs with the causes in them, read."""
    with tempfile.TemporaryDirectory() as scratch:
        effects, made = Path(scratch) / "effects.yaml", Path(scratch) / source.campaign.resolve().name
        write_text(effects, effects_text([entry(c) for c in causes]))
        options = Options(effects_file=effects, seed=seed, only_runs=source.only, part=source.part)
        write_campaign(prepare(source.campaign, source.calibrations, options), made)
        return read_data(made, source.calibrations, source.only, part=source.part)
