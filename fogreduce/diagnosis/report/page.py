"""The page for people: what departs, where, why, how far it closes and what to run next, without
statistics.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from html import escape
from typing import Any

from fogreduce.diagnosis.diagnose import Diagnosis
from fogreduce.diagnosis.observe.capture import SLOWEST_HZ
from fogreduce.diagnosis.report import next_run
from fogreduce.diagnosis.report.html import document, items, table
from fogreduce.diagnosis.report.stale import way_out
from fogreduce.diagnosis.report.words import (
    captures_in_words,
    closed,
    headline,
    is_group,
    mistakes_in_words,
    percent,
    place,
    sizes,
    titled,
)
from fogreduce.effects.table import EFFECTS
from fogreduce.pages.numbers import number, plus_minus

_TENSIONS = 8  # the greatest tensions with the record that the page shows

_STAGES = {
    "table": "as a true rotation would do",
    "gyro": "in what one gyro reads",
    "noise": "in the noise",
    "electronics": "in the converter",
    "link": "on the link",
}


def page(
    diagnosis: Diagnosis,
    shown: Mapping[str, str],
    proposed: Mapping[str, str],
    label: str | None = None,
    in_results: bool = False,
) -> str:
    """The whole page; figures stand in it.

    Parameters
    ----------
    diagnosis : Diagnosis
    shown : mapping
        Figures by file name, as HTML.
    proposed : mapping
        Files of the next run (`next_run.files`).
    label : str or None
        What every page of the campaign carries.
    in_results : bool
        Whether the pages of campaign and runs stand beside it.
    """
    d = diagnosis.document
    title = f"{d['campaign']}: {headline(d)}"
    parts = [links_back(d)] if in_results else []
    parts.append(f"<h1>{escape(title)}</h1>")
    if label:
        parts.append(f"<p><strong>{escape(label)}</strong></p>")
    parts.append(_summary(d, in_results))
    if d["next_run"] is not None:
        parts.append(next_run.section(d["next_run"], proposed))
    parts.append(_before_and_after(d, shown))
    if d["where"]:
        parts.append(_where(shown))
    if d["causes"]:
        parts.append(_which(d, shown))
    if d["closure"] is not None and d["causes"]:
        parts.append(_closure(d["closure"], shown))
        parts.append(_by_cause(d, shown))
    if d["verdict"] != "no_gap":
        parts.append(_remains(d, shown))
    parts.append(_tension(d))
    parts.append(_left_out(diagnosis))
    parts.append(_assumed(d))
    return document(title, parts)


def links_back(d: Mapping[str, Any]) -> str:
    """Back to the pages of the campaign, in whose results this page stands."""
    campaign_link = f'<a href="../index.html">{escape(d["campaign"])}</a>'
    return f'<nav><a href="../../index.html">campaigns</a> / {campaign_link}</nav>'


def runs_named(d: Mapping[str, Any], in_results: bool) -> str:
    """The line of runs; in the results each leads to its page."""
    names = [
        f'<a href="../{escape(run)}/index.html">{escape(run)}</a>' if in_results else escape(run)
        for run in d["runs"]
    ]
    return f"Runs: {', '.join(names)}."


def _summary(d: Mapping[str, Any], in_results: bool) -> str:
    parts = [_paragraph(escape(line)) for line in mistakes_in_words(d)]
    if d["verdict"] == "no_gap":
        parts.append(
            _paragraph(
                "Nothing departs from the prediction by more than noise and what the calibration record "
                "states as uncertain. Probability that something is wrong all the same: "
                f"{percent(d['gap_probability'])}."
            )
        )
    parts += _named(d)
    if d["causes"] and d["closure"] is not None:
        them = "it" if len(d["causes"]) == 1 else "them"
        words = "of the gap closes on data that the fit did not see."
        parts.append(_paragraph(f"With {them} in the simulator, {closed(d['closure'])} {words}"))
    if d["verdict"] in ("unexplained", "partly_explained") and d["where"]:
        first = (d["remainder"]["where"] or d["where"])[0]
        words = f"What is not explained shows {_STAGES[first['stage']]}, at {escape(place(first))}."
        parts.append(_paragraph(words))
    if d["verdict"] != "no_gap":
        parts.append(
            _paragraph(
                f"Probability that there is a gap: {percent(d['gap_probability'])}; that something outside "
                f"the catalogue takes part: {percent(d['unknown_probability'])}."
            )
        )
    parts.append(way_out(d))
    parts += [_paragraph(escape(line)) for line in captures_in_words(d)]
    parts.append(_paragraph(runs_named(d, in_results)))
    return f'<div class="box">{"".join(parts)}</div>'


def _paragraph(line: str) -> str:
    return f"<p>{line}</p>"


def _named(d: Mapping[str, Any]) -> list[str]:
    """Every cause; of a kind that several gyros have, one paragraph that opens into them."""
    kinds: dict[object, list[Mapping[str, Any]]] = {}
    for place_in_list, cause in enumerate(d["causes"]):
        kinds.setdefault(place_in_list if is_group(cause) else cause["effect"], []).append(cause)
    parts = []
    for members in kinds.values():
        if len(members) == 1:
            parts.append(_cause(members[0], d))
            continue
        name = escape(EFFECTS[members[0]["effect"]].title)
        inside = [
            f"{escape(titled(c))}: {'; '.join(escape(size) for size in sizes(c, d['raw_unit'], d['part']))}, "
            f"probability {percent(c['probability'])}"
            for c in members
        ]
        parts.append(f"<p><strong>{name}</strong>, at {len(members)} places:</p>{items(inside)}")
    return parts


def _cause(cause: Mapping[str, Any], d: Mapping[str, Any]) -> str:
    """A cause with its size, or a group with its members."""
    found = "; ".join(escape(size) for size in sizes(cause, d["raw_unit"], d["part"]))
    if not is_group(cause):
        more = f": {found}" if found else ""
        return _paragraph(
            f"<strong>{escape(titled(cause))}</strong>{more}, probability {percent(cause['probability'])}."
        )
    members = [
        f"<strong>{escape(titled(m))}</strong>, probability {percent(m['probability'])}"
        + (
            f": {found}"
            if found and m["effect"] == cause["effect"] and m["channels"] == cause["channels"]
            else ""
        )
        for m in cause["group"]
    ]
    return (
        f"<p>One of {len(members)}, which these runs cannot tell apart (that it is one of them: "
        f"{percent(cause['group_probability'])}):</p>{items(members)}"
    )


def _before_and_after(d: Mapping[str, Any], shown: Mapping[str, str]) -> str:
    words = (
        "Means over short blocks, one run after the other. What the calibration record leaves open (scale "
        "factors, biases, axes, headings, turn-on biases) is taken off first, at its most probable: it is no "
        "gap. "
    )
    if d["verdict"] == "no_gap":
        words += "What is left is noise."
    elif d["causes"]:
        words += "The blue line should be noise about zero; where it is not, something is left."
    else:
        words += "No cause was found, so there is no line for after."
    return (
        f"<h2>Measured less predicted</h2><p>{words}</p>"
        + shown.get("gap-gyros.svg", "")
        + shown.get("gap-xyz.svg", "")
    )


def _where(shown: Mapping[str, str]) -> str:
    return (
        "<h2>Where</h2><p>No cause is assumed here. <em>Sigma</em>: by how many times its expected scatter "
        "a place is off; up to 4 may be chance, and less than that is not shown. The row <em>table</em> is "
        "what all gyros show alike, as a true rotation would.</p>"
        + shown.get("where.svg", "")
        + "<p>Parts of the whole gap:</p>"
        + shown.get("share.svg", "")
    )


def _which(d: Mapping[str, Any], shown: Mapping[str, str]) -> str:
    rows = [
        [
            escape(titled(c)),
            percent(c["probability"]),
            "<br>".join(escape(size) for size in sizes(c, d["raw_unit"], d["part"])),
            f'{escape(_does(c))}<br><span class="quiet">{escape(_formula(c))}</span>',
        ]
        for c in d["causes"]
    ]
    text = "<h2>Which</h2><p>What was found, with one standard deviation. " + (
        "Of causes stated at 90 %, nine in ten should be right."
    )
    if any(is_group(c) for c in d["causes"]):
        text += " Of a group that these runs cannot tell apart, its most probable member."
    text += "</p>" + table(("cause", "probability", "size", "what it does"), rows)
    text += '<p class="quiet">M_i: what gyro i reads; t: time since the run began.</p>'
    return text + shown.get("causes.svg", "")


def _formula(cause: Mapping[str, Any]) -> str:
    return EFFECTS[cause["effect"]].equation.replace("+-", "\N{PLUS-MINUS SIGN}")


def _does(cause: Mapping[str, Any]) -> str:
    """What an effect does, its channels before it."""
    effect = EFFECTS[cause["effect"]]
    who = ", ".join(cause["channels"]) if effect.channels == "gyro" else f"the {effect.channels}"
    return f"{who} {effect.words or effect.title}"


def _closure(closure: Mapping[str, Any], shown: Mapping[str, str]) -> str:
    placebo = ""
    if "placebo_fraction" in closure:
        placebo = " A wrong effect, fitted just as hard, should close nothing."
    return (
        "<h2>How far the gap closes</h2><p>The simulator was run again with the causes in it and held "
        f"against data that the fit had not seen ({escape(closure['held_out'])}).{placebo}</p>"
        f"{shown.get('closure.svg', '')}"
        f"<p>In numbers: {closure['before']:.1f} before, {closure['after']:.1f} after, "
        f"{closure['expected_if_closed']:.1f} expected if nothing were left "
        f'<span class="quiet">({escape(closure["measure"])})</span>.</p>'
    )


def _by_cause(d: Mapping[str, Any], shown: Mapping[str, str]) -> str:
    """What each kind of cause closes, where there are several causes; it opens into its gyros and runs."""
    if "waterfall.svg" not in shown:
        return ""
    closure = d["closure"]
    text = (
        "<h2>Kind by kind</h2><p>The simulator with one kind of cause after the other in it, the one that "
        "closes most first; each bar is what it takes away, in per cent of the gap. The broken line is what "
        "noise and stated uncertainties make: down to there a gap is closed, and chance may lead a little "
        "beyond. A kind opens into its gyros and runs.</p>" + shown.get("waterfall.svg", "")
    )
    for kind in closure["kinds"]:
        mine = sorted(
            (c for c in d["causes"] if c["effect"] == kind["effect"] and c["closure"]),
            key=lambda c: c["closure"]["rank"],
        )
        rows = [[escape(titled(c)), *_part(c["closure"])] for c in mine]
        name = EFFECTS[kind["effect"]].title
        alone, removed, _ = _part(kind)
        summary = f"{escape(name)}: closes {alone} alone; {removed} is lost without it"
        header = ("cause", "closes alone", "lost without it", "running total")
        text += f"<details><summary>{summary}</summary>{table(header, rows)}</details>"
    return text


def _part(share: Mapping[str, Any]) -> list[str]:
    """A share of the closure: alone, lost without it, running total."""
    return [
        plus_minus(100 * share["alone"], 100 * share["alone_std"], "%"),
        plus_minus(100 * share["removed"], 100 * share["removed_std"], "%"),
        f"{100 * share['cumulative']:.1f} %",
    ]


def _tension(d: Mapping[str, Any]) -> str:
    """What the runs say of the record's stated uncertainties."""
    rows = [
        [
            escape(titled({**t, "parameters": {}})),
            f"\N{PLUS-MINUS SIGN} {number(t['prior_std'], 2)} {escape(t['unit'])}",
            plus_minus(t["value"], t["std"], escape(t["unit"])),
            f"{t['sigma']:+.1f}".replace("-", "\N{MINUS SIGN}"),
        ]
        for t in d["tension"][:_TENSIONS]
    ]
    if not rows:
        return ""
    return (
        "<h2>The calibration record, held against these runs</h2><p>What the record leaves open, as it "
        "states it and as the runs see it, beside the causes above; the last column in stated standard "
        "deviations. "
        "Beyond 3 the record is in doubt, also where nothing is called a gap.</p>"
        + table(("departure", "stated", "these runs", "sigma"), rows)
    )


def _remains(d: Mapping[str, Any], shown: Mapping[str, str]) -> str:
    left = d["remainder"]
    text = "<h2>What remains</h2>"
    if not left["significant"] and not left["where"]:
        return text + "<p>Nothing beyond noise and stated uncertainties.</p>"
    if not left["significant"]:
        text += (
            "<p>Nothing beyond noise and stated uncertainties. But one cause does just what it would do "
            "that a coil follows its temperature sensor late; perhaps there is one effect of another "
            "shape:</p>"
        )
    elif left["departure_of_shape"]:
        text += (
            "<p>Departures from the shapes that the catalogue gives the causes, no more than its formulae "
            "idealise. They show here:</p>"
        )
    else:
        text += "<p>Something that the causes do not explain. It shows here:</p>"
    rows = [
        [escape(place(p)), _STAGES[p["stage"]], f"{p['sigma']:.1f}"] for p in (left["where"] or d["where"])
    ]
    text += table(("where", "how", "sigma"), rows)
    if "left-gyros.svg" in shown:
        text += "<p>The blue lines of above, each at its own scale:</p>" + shown.get("left-gyros.svg", "")
    return text + _kin(d["resembles"])


def _kin(resembles: Sequence[Mapping[str, Any]]) -> str:
    """What the unknown comes nearest to, in words."""
    if not resembles:
        return ""
    near = [
        f"{escape(titled({'parameters': {}, 'runs': ['*'], **one}))}, which would close "
        f"{plus_minus(100 * one['closes'], 100 * one['std'], '%')} of it"
        for one in resembles
    ]
    text = f"<p>In its shape it comes nearest to {near[0]}"
    if near[1:]:
        text += "; then to " + ", to ".join(near[1:])
    return text + ". These are no causes: where to begin looking.</p>"


def _assumed(d: Mapping[str, Any]) -> str:
    """Numbers that neither run.yaml nor the calibration record states, on which the verdict rests."""
    if not d["assumed"]:
        return ""
    sheet = ""
    if d["part"] is not None:
        sheet = f"<p>Data sheet: {escape(d['part']['product'])} ({escape(d['part']['source'])}).</p>"
    rows = [
        [one["of"], one["key"], _value(one["value"]), one["reason"], ", ".join(one["runs"])]
        for one in d["assumed"]
    ]
    return (
        "<h2>What is assumed</h2><p>The files state none of these. The verdict rests on them; state what is "
        "known of the unit and of the bench.</p>"
        + table(("file", "key", "value taken", "why", "runs"), rows)
        + sheet
    )


def _value(value: Any) -> str:
    return ", ".join(map(number, value)) if isinstance(value, list) else number(value)


def _left_out(diagnosis: Diagnosis) -> str:
    """What cannot be said of this campaign, and why; where the files are."""
    facts, said = diagnosis.data.inputs[0].facts, []
    if facts.projection is None:
        many = "s" if facts.n_gyros > 1 else ""
        said.append(f"A unit of {facts.n_gyros} gyro{many} has no x, y and z: they are left out.")
    if facts.n_gyros <= 3:
        said.append(
            "With no more than three gyros nothing tells a true rotation from what gyros do by themselves, "
            "but the way it changes from run to run."
        )
    if any(one.scene.temperature is None for one in diagnosis.data.inputs):
        said.append(
            "Not every run has a temperature log: what a temperature does is known by its smoothness alone, "
            "without numbers, and stays out of simulator.yaml."
        )
    if max((run.pieces for run in diagnosis.data.full), default=0) == 0:
        said.append("Too few samples for a spectrum: noise levels, lines and filters are not looked for.")
    elif facts.sample_rate_hz < SLOWEST_HZ:
        said.append("A log this slow shows noise levels; lines and filters are not looked for.")
    if diagnosis.document["causes"]:
        said.append("simulator.yaml beside this page puts the causes into the simulator.")
    return "".join(f'<p class="quiet">{escape(line)}</p>' for line in said)
