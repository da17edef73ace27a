"""The figures of a diagnosis: the gap before and after, the map of where, causes, closure."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fogreduce.diagnosis.diagnose import Diagnosis
from fogreduce.diagnosis.inference.model import simulated
from fogreduce.diagnosis.inference.noise_model import nuisances
from fogreduce.diagnosis.report.words import closed, is_group, percent, place, titled
from fogreduce.effects.table import EFFECTS
from fogreduce.pages import svg

Array = NDArray[np.float64]

_SURE = 0.999  # of causes that are all as probable a drawing says nothing


def figures(diagnosis: Diagnosis, width: float = svg.WIDE) -> dict[str, str]:
    """SVG figures by file name, drawn for a width."""
    before, after = _gap(diagnosis)
    data, document = diagnosis.data, diagnosis.document
    runs = list(zip(data.run_ids, (one.scene.blocks.count for one in data.inputs), strict=True))
    names = [f"gyro{i + 1}" for i in range(data.n)]
    changed = document["verdict"] != "no_gap" and not np.array_equal(before, after)
    panels = [(name, b, a if changed else None) for name, b, a in zip(names, before, after, strict=True)]
    words = "measured less predicted, each gyro"
    out = {"gap-gyros.svg": svg.traces(panels, runs, "deg/h", words, width)}
    if changed and document["remainder"]["significant"]:
        left = [(name, None, a) for name, a in zip(names, after, strict=True)]
        out["left-gyros.svg"] = svg.traces(left, runs, "deg/h", "what the causes leave, each gyro", width)
    projection = data.inputs[0].facts.projection
    if projection is not None:
        both = zip("xyz", projection @ before, projection @ after, strict=True)
        xyz = [(name, b, a if changed else None) for name, b, a in both]
        words = "measured less predicted, in x, y and z"
        out["gap-xyz.svg"] = svg.traces(xyz, runs, "deg/h", words, width)
    if document["where"]:
        out["where.svg"] = _map(diagnosis, width)
        rows = [(place(p), p["share"], f"{100 * p['share']:.1f} %") for p in document["where"]]
        out["share.svg"] = svg.bars(rows, "parts of the whole gap", svg.BEFORE, 1.0, width)
    doubtful = any(c["probability"] < _SURE for c in document["causes"])
    if (len(document["causes"]) > 1 and doubtful) or any(is_group(c) for c in document["causes"]):
        members = [
            (titled(m), m["probability"], percent(m["probability"]))
            for c in document["causes"]
            for m in c["group"]
        ]
        label = "probability of each cause and its rivals"
        out["causes.svg"] = svg.bars(members, label, svg.AFTER, 1.0, width)
    if document["closure"] is not None and document["causes"]:
        falls = waterfall(document)
        if falls:
            words = "the gap, what each kind of cause takes away, what noise makes and what is left"
            out["waterfall.svg"] = svg.steps(falls, words, width, mark=falls[-2].end)
        label = "how far the gap closes"
        out["closure.svg"] = svg.bars(_closed(document["closure"]), label, svg.AFTER, 1.0, width)
    return out


def _closed(closure: Mapping[str, Any]) -> list[tuple[str, float, str]]:
    rows = [("the causes close", closure["fraction"], closed(closure))]
    if "placebo_fraction" in closure:
        wrong = closure["placebo_fraction"]
        rows.append(("a wrong effect closes", wrong, f"{100 * wrong + 0.0:.1f} %".replace("-0.0", "0.0")))
    return rows


def waterfall(document: Mapping[str, Any]) -> list[svg.Step]:
    """The gap, what kind after kind of cause takes away as it enters the simulator, what noise makes, what is
    left; empty for one cause. Lengths are shares of all that was summed before, noise in it.
    """
    closure, count = document["closure"], Counter(c["effect"] for c in document["causes"])
    if len(document["causes"]) < 2 or not closure["kinds"]:
        return []
    noise = min(closure["expected_if_closed"] / max(closure["before"], 1e-300), 1.0)
    rows, last = [svg.Step("before, noise in it", "gap: 100.0 %", 0.0, 1.0, svg.BEFORE)], 0.0
    for kind in closure["kinds"]:
        name = EFFECTS[kind["effect"]].title
        if count[kind["effect"]] > 1:
            name += f", {count[kind['effect']]} places"
        start, end = (noise + (1.0 - closed) * (1.0 - noise) for closed in (last, kind["cumulative"]))
        rows.append(svg.Step(name, _percent(last - kind["cumulative"], "+.1f"), start, end, svg.AFTER))
        last = kind["cumulative"]
    words = f"{_percent(noise / max(1.0 - noise, 1e-9), '.2g')} beside it"
    rows.append(svg.Step("what noise explains", words, 0.0, noise, svg.QUIET))
    left = noise + (1.0 - closure["fraction"]) * (1.0 - noise)
    error = f" \N{PLUS-MINUS SIGN} {max(100 * closure['std'], 0.1):.1f} %"
    words = _percent(1.0 - closure["fraction"], ".1f").removesuffix(" %") + error
    return [*rows, svg.Step("what is left of the gap", words, noise, left, svg.BEFORE)]


def _percent(share: float, digits: str) -> str:
    return f"{100 * share + 0.0:{digits}} %".replace("-", "\N{MINUS SIGN}")


def _map(diagnosis: Diagnosis, width: float) -> str:
    """Channels against runs: the largest sigma of the places there."""
    places, runs = diagnosis.document["where"], diagnosis.document["runs"]
    gyros = [f"gyro{i + 1}" for i in range(diagnosis.data.n)]
    others = [name for name in ("table", "clock") if any(name in p["channels"] for p in places)]
    channels = [*gyros, *others]
    cells = np.zeros((len(channels), len(runs)))
    words = [["" for _ in runs] for _ in channels]
    for p in places:
        for i, channel in enumerate(channels):
            for r, run in enumerate(runs):
                if channel in p["channels"] and run in p["runs"] and p["sigma"] > cells[i, r]:
                    cells[i, r] = p["sigma"]
                    words[i][r] = p["feature"].replace("_", " ")
    return svg.grid(channels, runs, cells, words, "where the gap lies: channels against runs", width)


def _gap(diagnosis: Diagnosis) -> tuple[Array, Array]:
    """Residual of each gyro through all runs (n, blocks) [deg/h], before and after the causes.

    What the record leaves open (scale factors, biases, axes, azimuths, turn-on biases) is no gap: its most
    probable part beside the causes is taken off both.
    """
    data, state = diagnosis.data, diagnosis.verdict.state
    problem, rows = state.problem, state.problem.whiten.rows
    slow = [c for c in state.causes if c.slow]
    before = rows.stacked(data.residual)
    change = simulated(data.inputs, slow, rows) - problem.nominal if slow else np.zeros_like(before)
    actions = [c.action(data.run_ids, data.n) for c in slow]
    left = before - change
    columns = nuisances(data.inputs, actions)
    white = problem.whiten(columns)
    y = problem.whiten(left[:, None])[:, 0]
    part = np.linalg.solve(np.eye(columns.shape[1]) + white.T @ white, white.T @ y)
    allowed = columns @ part
    stated = data.inputs[0].record.stated_uncertainty.turn_on_bias_deg_h
    for (i, r), matrix in problem.whiten.filters.items():
        here = rows.of(i, r)
        one = matrix.sum(axis=1)
        allowed[here] += stated[i] ** 2 * float(one @ (matrix @ (left - allowed)[here]))
    shape = (data.n, -1)
    return (before - allowed).reshape(shape), (left - allowed).reshape(shape)
