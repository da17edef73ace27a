"""The page for people: what departs, where, why, how far it closes and what to run next, without
statistics.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from html import escape
from math import floor, log10
from typing import Any

from fogreduce.diagnosis.diagnose import Diagnosis
from fogreduce.diagnosis.report.figures import figures, percent, place
from fogreduce.diagnosis.report.html import document, table
from fogreduce.diagnosis.report.words import captures_in_words, in_words
from fogreduce.effects.table import EFFECTS

_TENSIONS = 8  # the greatest tensions with the record that the page shows
_FAR = 10.0  # times what units of this class show: worth a word

__all__ = ["figures", "page"]

_HEADLINES = {
    "no_gap": "the bench agrees with the simulator",
    "explained": "the bench departs from the simulator, and the causes below explain it",
    "partly_explained": "the bench departs from the simulator; the causes below explain a part",
    "unexplained": "the bench departs from the simulator, and nothing in the catalogue explains it",
}
_STAGES = {
    "table": "as a true rotation would do",
    "gyro": "in what one gyro reads",
    "noise": "in the noise",
    "electronics": "in the converter",
    "link": "on the link",
}


def page(diagnosis: Diagnosis, drawn: Mapping[str, str], label: str | None = None) -> str:
    """The whole page; figures stand in it."""
    d = diagnosis.document
    parts = [f"<h1>{escape(d['campaign'])}: {_HEADLINES[d['verdict']]}</h1>"]
    if label:
        parts.append(f"<p><strong>{escape(label)}</strong></p>")
    parts.append(_summary(d))
    parts.append(_before_and_after(d, drawn))
    if d["where"]:
        parts.append(_where(d, drawn))
    if d["causes"]:
        parts.append(_which(d, drawn))
    if d["closure"] is not None and d["causes"]:
        parts.append(_closure(d["closure"], drawn))
        parts.append(_by_cause(d, drawn))
    if d["verdict"] != "no_gap":
        parts.append(_remains(d, drawn))
    parts.append(_tension(d))
    if d["next_run"] is not None:
        parts.append(_next_run(d["next_run"]))
    parts.append(_left_out(diagnosis))
    parts.append(_assumed(d))
    return document(f"{d['campaign']}: diagnosis", parts)


def _summary(d: Mapping[str, Any]) -> str:
    lines = []
    if d["verdict"] == "no_gap":
        lines.append(
            "Nothing departs from the prediction by more than noise and what the calibration record states "
            "as uncertain. Probability that something is wrong all the same: "
            f"{percent(d['gap_probability'])}."
        )
    for cause in d["causes"]:
        numbers = _parameters(cause, d["raw_unit"])
        line = f"<strong>{escape(in_words(cause))}</strong>{': ' + numbers if numbers else ''}, "
        if len(cause["group"]) > 1:
            line += (
                f"or one of {len(cause['group']) - 1} others that these runs cannot tell from it "
                f"(one of them all: {percent(cause['group_probability'])})."
            )
        else:
            line += f"probability {percent(cause['probability'])}."
        lines.append(line)
    if d["causes"] and d["closure"] is not None:
        c = d["closure"]
        lines.append(
            f"With {'it' if len(d['causes']) == 1 else 'them'} in the simulator, "
            f"{_closed(c)} of the gap closes on data that the fit did not see."
        )
    if d["verdict"] in ("unexplained", "partly_explained") and d["where"]:
        first = (d["remainder"]["where"] or d["where"])[0]
        lines.append(f"What is not explained shows {_STAGES[first['stage']]}, at {escape(place(first))}.")
    if d["verdict"] != "no_gap":
        lines.append(
            f"Probability that there is a gap: {percent(d['gap_probability'])}; that something outside the "
            f"catalogue takes part: {percent(d['unknown_probability'])}."
        )
    lines += [escape(line) for line in captures_in_words(d)]
    lines.append(f"Runs: {escape(', '.join(d['runs']))}.")
    return '<div class="box">' + "".join(f"<p>{line}</p>" for line in lines) + "</div>"


def _closed(closure: Mapping[str, Any]) -> str:
    return f"{100 * closure['fraction']:.1f} +- {100 * closure['std']:.1f} %"


def _before_and_after(d: Mapping[str, Any], drawn: Mapping[str, str]) -> str:
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
        + drawn.get("gap-gyros.svg", "")
        + drawn.get("gap-xyz.svg", "")
    )


def _where(d: Mapping[str, Any], drawn: Mapping[str, str]) -> str:
    return (
        "<h2>Where</h2><p>No cause is assumed here. <em>Sigma</em>: by how many times its expected scatter "
        "a place is off; up to 4 may be chance, and less than that is not shown. The row <em>table</em> is "
        "what all gyros show alike, as a true rotation would.</p>"
        + drawn["where.svg"]
        + "<p>Parts of the whole gap:</p>"
        + drawn["share.svg"]
    )


def _which(d: Mapping[str, Any], drawn: Mapping[str, str]) -> str:
    rows = [
        [
            escape(in_words(c)),
            escape(EFFECTS[c["effect"]].equation),
            percent(c["probability"]),
            _parameters(c, d["raw_unit"], "<br>"),
        ]
        for c in d["causes"]
    ]
    text = "<h2>Which</h2><p>What was found, with one standard deviation. " + (
        "Of causes stated at 90 %, nine in ten should be right.</p>"
    )
    text += table(("cause", "what it does", "probability", "size"), rows)
    text += '<p class="quiet">M_i: what gyro i reads; t: time since the run began.</p>'
    for cause in d["causes"]:
        if len(cause["group"]) > 1:
            text += (
                f"<p>These runs cannot tell <em>{escape(in_words(cause))}</em> from what stands with it "
                f"here. That it is one of them: {percent(cause['group_probability'])}.</p>"
            )
            rivals = [[escape(in_words(m)), percent(m["probability"])] for m in cause["group"]]
            text += table(("might be", "probability"), rivals)
    if len(d["causes"]) > 1 and all(len(c["group"]) == 1 for c in d["causes"]):
        text += drawn.get("causes.svg", "")
    return text


def _parameters(cause: Mapping[str, Any], raw_unit: str, between: str = ", ") -> str:
    """Sizes of a cause with units; one that is far beyond what such units show is said to be."""
    known = {p.name: p for p in EFFECTS[cause["effect"]].parameters}
    out = []
    for name, p in cause["parameters"].items():
        unit = known[name].unit_in(raw_unit) if name in known else ""
        text = f"{_number(p['value'], p['std'])} {unit}".strip()
        out.append(text if unit and len(cause["parameters"]) == 1 else f"{escape(name)} {text}")
        # what is usual in volts says nothing of readings in another unit
        usual = known[name].realistic if name in known and unit == known[name].unit else None
        if usual is not None and isinstance(p["value"], float) and abs(p["value"]) > _FAR * usual[1]:
            out.append(f"(units of this class show {usual[0]:g} to {usual[1]:g})")
    return between.join(out)


def _number(value: Any, std: Any) -> str:
    """A value with its error, both to two digits of the error."""
    if isinstance(value, list):
        errors = std if isinstance(std, list) else [None] * len(value)
        return "[" + ", ".join(_number(v, s) for v, s in zip(value, errors, strict=True)) + "]"
    if not isinstance(value, int | float):
        return escape(str(value))
    if not isinstance(std, int | float) or std <= 0.0:
        return f"{value:.4g}"
    digits = 1 - floor(log10(std))
    if not -7 < digits <= 5:
        return f"{value:.4g} +- {std:.2g}"
    return f"{round(value, digits):.{max(digits, 0)}f} +- {round(std, digits):.{max(digits, 0)}f}"


def _closure(closure: Mapping[str, Any], drawn: Mapping[str, str]) -> str:
    return (
        "<h2>How far the gap closes</h2><p>The simulator was run again with the causes in it and held "
        f"against data that the fit had not seen ({escape(closure['held_out'])}). A wrong effect, fitted "
        f"just as hard, should close nothing.</p>{drawn['closure.svg']}"
        f"<p>In numbers: {closure['before']:.1f} before, {closure['after']:.1f} after, "
        f"{closure['expected_if_closed']:.1f} expected if nothing were left "
        f'<span class="quiet">({escape(closure["measure"])})</span>.</p>'
    )


def _by_cause(d: Mapping[str, Any], drawn: Mapping[str, str]) -> str:
    """What each cause closes, where there are several."""
    if "waterfall.svg" not in drawn:
        return ""
    ranked = sorted((c for c in d["causes"] if c["closure"]), key=lambda c: c["closure"]["rank"])
    rows = [
        [
            escape(in_words(c)),
            f"{100 * c['closure']['alone']:.1f} &plusmn; {100 * c['closure']['alone_std']:.1f} %",
            f"{100 * c['closure']['removed']:.1f} &plusmn; {100 * c['closure']['removed_std']:.1f} %",
            f"{100 * c['closure']['cumulative']:.1f} %",
        ]
        for c in ranked
    ]
    return (
        "<h2>Cause by cause</h2><p>The simulator with one cause after the other in it, the one that closes "
        f"most first.</p>{drawn['waterfall.svg']}"
        + table(("cause", "closes alone", "lost without it", "running total"), rows)
    )


def _tension(d: Mapping[str, Any]) -> str:
    """What the runs say of the record's stated uncertainties."""
    rows = [
        [
            escape(in_words({**t, "parameters": {}})),
            f"{t['prior_std']:.3g} {escape(t['unit'])}",
            f"{t['value']:.3g} &plusmn; {t['std']:.2g} {escape(t['unit'])}",
            f"{t['sigma']:+.1f}",
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


def _remains(d: Mapping[str, Any], drawn: Mapping[str, str]) -> str:
    left = d["remainder"]
    text = "<h2>What remains</h2>"
    if not left["significant"]:
        return text + "<p>Nothing beyond noise and stated uncertainties.</p>"
    if left["departure_of_shape"]:
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
    if "left-gyros.svg" in drawn:
        text += "<p>The blue lines of above, each at its own scale:</p>" + drawn["left-gyros.svg"]
    return text + _kin(d["resembles"])


def _kin(resembles: Sequence[Mapping[str, Any]]) -> str:
    """What the unknown comes nearest to, in words."""
    if not resembles:
        return ""
    near = [
        f"{escape(one['effect'])} of {escape(' and '.join(one['channels']))}, which would close "
        f"{100 * one['closes']:.0f} +- {100 * one['std']:.0f} % of it"
        for one in resembles
    ]
    text = f"<p>In its shape it comes nearest to {near[0]}"
    if near[1:]:
        text += "; then to " + ", to ".join(near[1:])
    return text + ". These are no causes: where to begin looking.</p>"


def _next_run(n: Mapping[str, Any]) -> str:
    step = n["table"]["profile"][0]
    motion = "standing still" if step["rate_deg_s"] == 0 else f"{step['rate_deg_s']:g} deg/s"
    rows = [
        ["table", f"axis {escape(str(n['table']['axis']))}, {motion}, {step['duration_s']:g} s"],
        ["orientation", escape(", ".join(f"{a} {way}" for a, way in n["orientation"].items()))],
    ]
    if "temperature" in n:
        steps = ", then ".join(f"{t['sensor_degC']:g} degC at {t['time_s']:g} s" for t in n["temperature"])
        rows.append(["sensor temperature", steps])
    rows.append(["tells apart", "<br>".join(escape(name) for name in n["separates"]) or "none for sure"])
    more = " or more" if n["separates"] else " at best"
    rows.append(["by", f"{n['expected_sigma']:.1f} sigma{more}"])
    if n.get("leaves"):
        rows.append(["leaves open", "<br>".join(escape(name) for name in n["leaves"])])
    text = "<h2>What to run next</h2>" + table(("", ""), rows)
    if "verified" in n:
        text += _verified(n["verified"])
    return text


def _verified(found: Mapping[str, Any]) -> str:
    rows = [
        [
            escape(t["truth"]),
            escape(", ".join(t["causes"]) or t["verdict"].replace("_", " ")),
            percent(t["probability"]),
            "yes" if t["separated"] else "no",
        ]
        for t in found["truths"]
    ]
    return (
        "<p>That run was simulated, with each of these in turn as the truth, and diagnosed together with "
        "today's captures:</p>"
        + table(("if it is", "the diagnosis then says", "probability of the truth", "told apart"), rows)
        + ("" if found["separated"] else "<p>So this run would not tell all of these apart.</p>")
    )


def _assumed(d: Mapping[str, Any]) -> str:
    """Numbers that neither run.yaml nor the calibration record states, on which the verdict rests."""
    if not d["assumed"]:
        return ""
    rows = [
        [one["of"], one["key"], _value(one["value"]), one["reason"], ", ".join(one["runs"])]
        for one in d["assumed"]
    ]
    return (
        "<h2>What is assumed</h2><p>The files state none of these. The verdict rests on them; state what is "
        "known of the unit and of the bench.</p>" + table(("file", "key", "value taken", "why", "runs"), rows)
    )


def _value(value: Any) -> str:
    return ", ".join(f"{one:.4g}" for one in value) if isinstance(value, list) else f"{value:.4g}"


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
    if diagnosis.document["causes"]:
        said.append("simulator.yaml beside this page puts the causes into the simulator.")
    return "".join(f'<p class="quiet">{escape(line)}</p>' for line in said)
