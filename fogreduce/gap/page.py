"""The page for people: what departs, where, why, how far it closes and what to run next, without
statistics.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from html import escape
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fogreduce.effects.table import EFFECTS
from fogreduce.gap import svg
from fogreduce.gap.diagnose import Diagnosis
from fogreduce.gap.fitted import simulated

Array = NDArray[np.float64]

_HEADLINES = {
    "no_gap": "The bench agrees with the simulator.",
    "explained": "The bench departs from the simulator, and the causes below explain it.",
    "partly_explained": "The bench departs from the simulator. The causes below explain a part; "
    "something is left.",
    "unexplained": "The bench departs from the simulator, and nothing in the catalogue explains it.",
}
_STYLE = """body{font:16px/1.5 sans-serif;max-width:960px;margin:2em auto;padding:0 1em;color:#222}
table{border-collapse:collapse;margin:1em 0}td,th{border-bottom:1px solid #ddd;padding:.3em
.8em;text-align:left}
.quiet{color:#5f5f5f}h1{font-size:1.5em}h2{font-size:1.15em;margin-top:2em}svg{width:100%;height:auto}"""


def figures(diagnosis: Diagnosis) -> dict[str, str]:
    """SVG figures by file name."""
    before, after, marks = _gap(diagnosis)
    names = [f"gyro{i + 1}" for i in range(diagnosis.data.n)]
    out = {
        "gap-gyros.svg": svg.traces(
            [(name, b, a) for name, b, a in zip(names, before, after, strict=True)],
            marks,
            "deg/h",
            "measured less predicted, each gyro, before and after the causes",
        )
    }
    projection = diagnosis.data.inputs[0].facts.projection
    if projection is not None:
        xyz = [
            ("xyz"[k], b, a)
            for k, (b, a) in enumerate(zip(projection @ before, projection @ after, strict=True))
        ]
        out["gap-xyz.svg"] = svg.traces(xyz, marks, "deg/h", "the same in x, y and z")
    rows = [
        (_place(p), p["sigma"], f"{p['sigma']:.1f} sigma, share {p['share']:.2f}")
        for p in diagnosis.document["where"]
    ]
    if rows:
        out["where.svg"] = svg.bars(rows, "where the gap lies", svg.BEFORE)
    members = [
        (_name(m), m["probability"], f"{m['probability']:.3f}")
        for c in diagnosis.document["causes"]
        for m in c["group"]
    ]
    if members:
        out["causes.svg"] = svg.bars(members, "probability of each cause and its rivals")
    closure = diagnosis.document["closure"]
    if closure is not None:
        lines = [
            (
                "the causes close",
                closure["fraction"],
                f"{100 * closure['fraction']:.1f} +- {100 * closure['std']:.1f} %",
            )
        ]
        if "placebo_fraction" in closure:
            lines.append(
                (
                    "a wrong effect closes",
                    closure["placebo_fraction"],
                    f"{100 * closure['placebo_fraction']:.1f} %",
                )
            )
        out["closure.svg"] = svg.bars(lines, "how far the gap closes on data that was not fitted")
    return out


def _gap(diagnosis: Diagnosis) -> tuple[Array, Array, list[tuple[float, str]]]:
    """Residual of each gyro through all runs (n, blocks), before and after; where runs begin."""
    data, state = diagnosis.data, diagnosis.verdict.state
    rows = state.ground.whiten.rows
    slow = [c for c in state.causes if c.slow]
    before = rows.stacked(data.residual).reshape(data.n, -1)
    change = np.zeros_like(before)
    if slow:
        change = (simulated(data.inputs, slow, rows) - state.ground.nominal).reshape(data.n, -1)
    starts = np.concatenate(([0], np.cumsum(rows.counts)[:-1])) / max(rows.per_gyro, 1)
    return before, before - change, list(zip(starts.tolist(), data.run_ids, strict=True))


def _name(item: Mapping[str, Any]) -> str:
    runs = "" if list(item["runs"]) == ["*"] else f" in {', '.join(item['runs'])}"
    return f"{item['effect']} {', '.join(item['channels'])}{runs}"


def _place(item: Mapping[str, Any]) -> str:
    runs = f" in {item['runs'][0]}" if len(item["runs"]) == 1 else ""
    return f"{', '.join(item['channels'])}: {item['feature'].replace('_', ' ')}{runs}"


def _table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    cells = "".join(f"<th>{escape(h)}</th>" for h in head)
    lines = "".join("<tr>" + "".join(f"<td>{escape(c)}</td>" for c in row) + "</tr>" for row in rows)
    return f"<table><tr>{cells}</tr>{lines}</table>"


def _number(value: Any) -> str:
    if isinstance(value, list):
        return "[" + ", ".join(_number(v) for v in value) + "]"
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def page(diagnosis: Diagnosis, drawn: Mapping[str, str], label: str | None = None) -> str:
    """The whole page; figures stand in it."""
    d = diagnosis.document
    parts = [f"<h1>{escape(d['campaign'])}: {_HEADLINES[d['verdict']]}</h1>"]
    if label:
        parts.append(f"<p><strong>{escape(label)}</strong></p>")
    parts.append(
        f"<p>Runs: {escape(', '.join(d['runs']))}. Probability that something is wrong "
        f"beyond noise and what the "
        f"calibration record states as uncertain: {d['gap_probability']:.3f}. Probability "
        f"that something outside the "
        f"catalogue takes part: {d['unknown_probability']:.3f}.</p>"
    )
    parts.append(
        "<h2>Measured less predicted</h2><p>Means over short blocks, one run after the "
        "other. What is flat and thin "
        "is noise.</p>" + drawn.get("gap-gyros.svg", "") + drawn.get("gap-xyz.svg", "")
    )
    if d["where"]:
        parts.append(
            "<h2>Where</h2><p>No cause is assumed here. <em>Sigma</em>: by how many times "
            "its expected scatter this "
            "place is off; above 5 chance is no explanation.</p>" + drawn["where.svg"]
        )
    if d["causes"]:
        rows = [
            [
                _name(c),
                EFFECTS[c["effect"]].equation,
                f"{c['probability']:.3f}",
                ", ".join(
                    f"{k} = {_number(p['value'])}"
                    + (f" +- {_number(p['std'])}" if p["std"] is not None else "")
                    for k, p in c["parameters"].items()
                ),
            ]
            for c in d["causes"]
        ]
        parts.append(
            "<h2>Which</h2>"
            + _table(("cause", "what it does", "probability", "parameters"), rows)
            + "<p>Rivals that these runs cannot exclude stand beside each cause.</p>"
            + drawn.get("causes.svg", "")
        )
    if d["closure"] is not None:
        parts.append(
            f"<h2>How far the gap closes</h2><p>The simulator was run again with the causes "
            f"in it and held against "
            f"data that the fit had not seen ({escape(d['closure']['held_out'])}). A wrong "
            f"effect, fitted just as "
            f"hard, should close nothing.</p>" + drawn["closure.svg"]
        )
    left = d["remainder"]
    parts.append(
        "<h2>What remains</h2><p>"
        + ("Something significant is left." if left["significant"] else "Nothing significant is left.")
        + "</p>"
    )
    if left["where"]:
        parts.append(_table(("where", "sigma"), [[_place(p), f"{p['sigma']:.1f}"] for p in left["where"]]))
    if d["next_run"] is not None:
        n = d["next_run"]
        parts.append(
            f"<h2>What to run next</h2><p>About axis {escape(str(n['table']['axis']))}, "
            f"{n['table']['profile'][0]['rate_deg_s']:g} deg/s for "
            f"{n['table']['profile'][0]['duration_s']:g} s, "
            f"orientation {escape(str(n['orientation']))}: {escape(n['why'])}.</p>"
        )
    parts.append('<p class="quiet">simulator.yaml beside this page puts the causes into the simulator.</p>')
    return (
        '<!DOCTYPE html><html lang="en"><head><meta charset="utf-8">'
        f"<title>{escape(d['campaign'])}: diagnosis</title><style>{_STYLE}</style></head><body>"
        + "\n".join(parts)
        + "</body></html>\n"
    )
