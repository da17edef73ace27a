"""The next run, ready to use: run.yaml as a campaign takes it, and the temperatures to go through."""

from __future__ import annotations

from collections.abc import Mapping
from html import escape
from typing import Any

from fogreduce.diagnosis.diagnose import Diagnosis
from fogreduce.diagnosis.next.runs import RUN_ID, run_document, temperature, temperature_text
from fogreduce.diagnosis.report.html import table
from fogreduce.diagnosis.report.words import percent, titled_name
from fogreduce.metadata.yaml12 import dump_yaml

RUN_FILE, TEMPERATURE_FILE = f"{RUN_ID}/run.yaml", f"{RUN_ID}/temperature.csv"
_HEAD = """\
# The run that `fogreduce diagnose` proposes. Copy this folder into the campaign's runs; set started_at, and
# azimuth_deg if the unit does not lie as orientation has it.
"""
_SOAK = "# temperature.csv is the plan: the logger's file takes its place.\n"


def files(diagnosis: Diagnosis) -> dict[str, str]:
    """Texts by file name; none where no run is proposed."""
    if diagnosis.next_run is None:
        return {}
    inputs, proposal = diagnosis.data.inputs, diagnosis.next_run.proposal
    log = temperature(inputs, proposal)
    head = _HEAD + (_SOAK if log is not None else "")
    out = {RUN_FILE: head + dump_yaml(run_document(inputs[0].run, proposal, log is not None))}
    if log is not None:
        out[TEMPERATURE_FILE] = temperature_text(log)
    return out


def motion(found: Mapping[str, Any]) -> str:
    """What the table does, in words."""
    axis, step = found["table"]["axis"], found["table"]["profile"][0]
    turning = f"turning at {step['rate_deg_s']:g} deg/s" if step["rate_deg_s"] else "standing still"
    way = found["orientation"][axis]
    return f"{turning} about {axis} ({axis} {way}) for {step['duration_s']:g} s".replace(
        "-", "\N{MINUS SIGN}"
    )


def section(found: Mapping[str, Any], texts: Mapping[str, str]) -> str:
    """What to run next, and how far that would tell."""
    rows = [
        ["table", escape(motion(found))],
        ["orientation", escape(", ".join(f"{a} {way}" for a, way in found["orientation"].items()))],
    ]
    if "temperature" in found:
        steps = ", then ".join(
            f"{t['sensor_degC']:g} degC at {t['time_s']:g} s" for t in found["temperature"]
        )
        rows.append(["sensor temperature", steps])
    rows.append(["tells apart", _names(found["separates"]) or "none for sure"])
    more = " or more" if found["separates"] else " at best"
    rows.append(["by", f"{found['expected_sigma']:.1f} sigma{more}"])
    if found.get("leaves"):
        rows.append(["leaves open", _names(found["leaves"])])
    text = "<h2>What to run next</h2>" + table(("", ""), rows)
    text += (
        f'<p><a href="{RUN_FILE}">{RUN_FILE}</a> is that run, ready to be copied into the campaign.</p>'
        f"<details><summary>Its run.yaml</summary><pre>{escape(texts[RUN_FILE])}</pre></details>"
    )
    return text + (_verified(found["verified"]) if "verified" in found else "")


def _names(names: list[str]) -> str:
    return "<br>".join(escape(titled_name(name)) for name in names)


def _verified(found: Mapping[str, Any]) -> str:
    rows = [
        [
            escape(titled_name(t["truth"])),
            escape(", ".join(titled_name(c) for c in t["causes"]) or t["verdict"].replace("_", " ")),
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
