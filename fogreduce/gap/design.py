"""The next run: which one separates the rivals that are still alive, and with what significance."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import combinations
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fogreduce.gap.blocks import Blocks
from fogreduce.gap.capture import RunInput
from fogreduce.gap.causes import Cause
from fogreduce.gap.noise_model import Metric, nuisances, whitener
from fogreduce.gap.predict import Scene
from fogreduce.gap.search import Search
from fogreduce.gap.verdict import Verdict
from fogreduce.metadata.run import Run
from fogreduce.simulate.plan import facts_of

Array = NDArray[np.float64]

_MOST_RIVALS = 4
_SECOND = {"x": ("z", "north"), "y": ("x", "north"), "z": ("y", "north")}
_WORDS = {0.0: "standing still"}


def next_run(search: Search, verdict: Verdict) -> dict[str, Any] | None:
    """The run that best separates the rivals of the first cause that has any; None where none has."""
    for one in verdict.named:
        rivals = [o for o, _ in one.group[:_MOST_RIVALS] if o.fit is not None]
        if len(rivals) < 2:
            continue
        own = verdict.state.causes[one.index]
        causes = [own if o.key == own.key else o.cause() for o in rivals]
        return _best(search, causes)
    return None


def _best(search: Search, causes: list[Cause]) -> dict[str, Any] | None:
    """The least separation among the rivals, at its greatest."""
    best: tuple[float, Run] | None = None
    for run in _runs(search.data.inputs[0].run, search):
        here = _input(search.data.inputs[0], run)
        least = _separation(search, here, causes)
        if best is None or least > best[0]:
            best = (least, run)
    if best is None or best[0] <= 0.0:
        return None
    sigma, run = best
    rate = run.table.profile[0].rate_deg_s
    axis = run.table.axis if isinstance(run.table.axis, str) else [float(v) for v in run.table.axis]
    motion = _WORDS.get(rate, f"turning at {rate:g} deg/s")
    names = [_name(c) for c in causes]
    return {
        "separates": names,
        "table": {
            "axis": axis,
            "profile": [{"rate_deg_s": rate, "duration_s": run.table.profile[0].duration_s}],
        },
        "orientation": dict(run.orientation),
        "expected_sigma": round(float(sigma), 3),
        "why": f"{motion}, the least separated pair of {', '.join(names)} would differ by {sigma:.1f} sigma "
        "where these runs cannot tell them apart",
    }


def _name(cause: Cause) -> str:
    runs = "" if cause.runs == ("*",) else f" in {', '.join(cause.runs)}"
    return f"{cause.effect} {', '.join(cause.channels)}{runs}"


def _runs(first: Run, search: Search) -> Iterator[Run]:
    """Runs that might be next: about each axis, both senses, slow, still; as long as the longest so far."""
    longest = max(one.run.duration_s for one in search.data.inputs)
    fastest = max(
        (abs(s.rate_deg_s) for one in search.data.inputs for s in one.run.table.profile), default=0.0
    )
    fast = fastest if fastest >= 1.0 else 10.0
    data = first.model_dump(mode="json")
    for axis, (other, direction) in _SECOND.items():
        for way in ("up", "down"):
            for rate in (fast, -fast, fast / 3.0, 0.5, 0.0):
                yield Run.from_data(
                    {
                        **data,
                        "table": {
                            **data["table"],
                            "axis": axis,
                            "profile": [{"rate_deg_s": rate, "duration_s": longest}],
                        },
                        "orientation": {axis: way, other: direction},
                    },
                    "next run",
                )


def _input(pattern: RunInput, run: Run) -> RunInput:
    facts = replace(facts_of(run, pattern.record), run_id="next")
    run = run.model_copy(update={"run_id": "next"})
    return RunInput(run, pattern.record, facts, Scene(facts, None, Blocks.of(facts)), pattern.folder)


def _separation(search: Search, here: RunInput, causes: list[Cause]) -> float:
    """Least distance between the rivals' predictions for a run [sigma]."""
    blocks, facts = here.scene.blocks, here.facts
    sizes = np.full((facts.n_gyros, blocks.count), blocks.length_s * facts.sample_rate_hz)
    whiten = whitener([here], [sizes], search.fast.level)
    metric = Metric.of(whiten(nuisances([here])))
    plain = here.scene.block_means()
    changes = []
    for cause in causes:
        needs_log = cause.effect.startswith("temperature")
        elsewhere = cause.runs != ("*",)
        if needs_log or elsewhere:
            changes.append(np.zeros(whiten.rows.total))
            continue
        action = cause.action(["next"], facts.n_gyros)
        changes.append(whiten.rows.stacked([here.scene.block_means([action]) - plain]))
    white = [whiten(c[:, None]) for c in changes]
    return min(float(np.sqrt(max(metric.gram(a - b, a - b)[0, 0], 0.0))) for a, b in combinations(white, 2))
