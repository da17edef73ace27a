"""What a planned campaign would show, as text, as tables on disk and as a page."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Mapping, Sequence
from html import escape
from pathlib import Path
from typing import Any

from fogreduce.datasets.atomic import write_text
from fogreduce.diagnosis.report.html import document, table
from fogreduce.effects.table import EFFECTS

JSON, CSV, PAGE = "detectable.json", "detectable.csv", "detectable.html"
_COLUMNS = ("effect", "channels", "runs", "parameter", "unit", "amplitude", "seen", "at", "not_told_from")
_HEAD = ("effect", "smallest amplitude seen", "unit", "where")


def write_detectable(found: Mapping[str, Any], out: Path) -> None:
    """detectable.csv, detectable.html and, last, detectable.json into a folder, which need not exist."""
    write_text(out / CSV, _csv(found["effects"]))
    write_text(out / PAGE, _page(found))
    write_text(out / JSON, json.dumps(found, indent=1, allow_nan=False, ensure_ascii=False) + "\n")


def in_text(found: Mapping[str, Any]) -> str:
    """A line an effect, then what could not be told apart."""
    rows = [_HEAD, *_summary(found["effects"])]
    widths = [max(len(row[k]) for row in rows) for k in range(3)]
    lines = [_title(found), ""]
    for row in rows:
        cells = [cell.ljust(width) for cell, width in zip(row, [*widths, 0], strict=True)]
        lines.append("  ".join(cells).rstrip())
    for name, why in found["not_shown"].items():
        lines.append(f"{name.ljust(widths[0])}  no amplitude: {why}")
    lines += ["", _not_separated(found)]
    lines += [f"  {'; '.join(group)}" for group in found["groups"]]
    return "\n".join(lines)


def _title(found: Mapping[str, Any]) -> str:
    return (
        f"{found['campaign']}: {len(found['runs'])} runs. Smallest amplitude that would be seen with a "
        f"probability of {found['probability']:g}"
    )


def _not_separated(found: Mapping[str, Any]) -> str:
    if not found["groups"]:
        return f"All effects could be told apart at a signal-to-noise ratio of {found['snr']:g}."
    return f"Not told apart at a signal-to-noise ratio of {found['snr']:g} (one group a line):"


def _summary(rows: Sequence[Mapping[str, Any]]) -> list[tuple[str, str, str, str]]:
    """One line for each effect and shape: from the best to the worst of its places."""
    out = []
    for key in dict.fromkeys((row["effect"], _shape(row)) for row in rows):
        same = [row for row in rows if (row["effect"], _shape(row)) == key]
        sizes = sorted(row["amplitude"] for row in same if row["amplitude"] is not None)
        blind = sum(not row["seen"] for row in same)
        if sizes:
            low, high = f"{sizes[0]:.3g}", f"{sizes[-1]:.3g}"
            size = low if low == high else f"{low} to {high}"
        else:
            size = "seen" if blind < len(same) else "not seen at any"
        channels = list(dict.fromkeys(name for row in same for name in row["channels"]))
        where = ", ".join(channels) + (f"; {key[1]}" if key[1] else "")
        if 0 < blind < len(same):
            where += f" ({blind} of {len(same)} places at no amplitude)"
        out.append((key[0], size, same[0]["unit"], where))
    return out


def _shape(row: Mapping[str, Any]) -> str:
    """Other parameters in words, less those that differ from gyro to gyro."""
    effect = EFFECTS[row["effect"]]
    shapes = {p.name for p in effect.parameters if p.kind == "choice" or p.frame}
    shapes |= set((effect.design.shown if effect.design else None) or {})
    given = {name: value for name, value in row["at"].items() if name in shapes}
    if effect.channels == "table" and "along" in row["at"]:
        given["along"] = row["at"]["along"]
    if effect.design is not None and effect.design.alike and len(row["channels"]) > 1:
        return "all alike"
    return ", ".join(f"{k} {_value(v)}" for k, v in given.items())


def _value(value: Any) -> str:
    if isinstance(value, list):
        return "[" + ", ".join(f"{v:g}" for v in value) + "]"
    return f"{value:g}" if isinstance(value, float) else str(value)


def _csv(rows: Sequence[Mapping[str, Any]]) -> str:
    out = io.StringIO()
    lines = csv.writer(out, lineterminator="\n")
    lines.writerow(_COLUMNS)
    for row in rows:
        at = "; ".join(f"{k}={_value(v)}" for k, v in row["at"].items())
        amplitude = "" if row["amplitude"] is None else f"{row['amplitude']:.6g}"
        lines.writerow(
            [
                row["effect"],
                " ".join(row["channels"]),
                " ".join(row["runs"]),
                row["parameter"],
                row["unit"],
                amplitude,
                str(row["seen"]).lower(),
                at,
                "; ".join(row["not_told_from"]),
            ]
        )
    return out.getvalue()


def _does(name: str) -> str:
    """What an effect does, in words and as a formula."""
    effect = EFFECTS[name]
    who = {"gyro": "a gyro", "table": "the table", "clock": "the clock"}[effect.channels]
    who = "gyros" if effect.smallest_group > 1 else who
    formula = escape(effect.equation.replace("+-", "\N{PLUS-MINUS SIGN}"))
    if not effect.words:
        return formula
    return f'{who} {escape(effect.words)}<br><span class="quiet">{formula}</span>'


def _page(found: Mapping[str, Any]) -> str:
    percent = f"{100.0 * found['probability']:g} %"
    lines = [
        [escape(EFFECTS[name].title), escape(f"{size} {unit}".strip()), escape(where), _does(name)]
        for name, size, unit, where in _summary(found["effects"])
    ]
    lines += [
        [escape(EFFECTS[name].title), "none", escape(why), _does(name)]
        for name, why in found["not_shown"].items()
    ]
    groups = "".join(f"<li>{escape('; '.join(group))}</li>" for group in found["groups"])
    return document(
        f"{found['campaign']}: what these runs would show",
        [
            f"<h1>{escape(found['campaign'])}: what these runs would show, before they are made</h1>",
            f"<p>Runs: {escape(', '.join(found['runs']))}. An effect of the amplitude below, or a larger "
            f"one, would be seen as a gap in {percent} of all cases, beside the noise and the uncertainties "
            "that the calibration record states. Two numbers: the best and the worst of the places.</p>",
            "<h2>How small</h2>",
            table(("effect", "smallest amplitude seen", "where", "what it does"), lines),
            "<h2>What could not be told apart</h2>",
            f"<p>{escape(_not_separated(found))}</p>" + (f"<ul>{groups}</ul>" if groups else ""),
            '<p class="quiet">detectable.csv beside this page has every place by itself.</p>',
        ],
    )
