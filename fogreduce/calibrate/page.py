"""The page of a derivation: what changed from the present record, by how much, and how well it is known."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from markupsafe import Markup

from fogreduce.calibrate.derive import Derivation
from fogreduce.calibrate.residuals import BLOCKS, Residual
from fogreduce.datasets.atomic import write_text
from fogreduce.metadata.yaml12 import dump_yaml
from fogreduce.pages.numbers import number, plus_minus
from fogreduce.pages.render import Crumb, page
from fogreduce.pages.svg import Panel, points, some_ticks

TEMPLATE = "derivation.html"
#: Where a campaign's results have it.
FOLDER = "_calibration"

#: Key in derivation.json -> words, unit.
_CHANGES = {
    "bias_deg_h": ("bias", "deg/h"),
    "scale_factor_ppm": ("scale factor", "ppm"),
    "axis1_mrad": ("axis, first direction", "mrad"),
    "axis2_mrad": ("axis, second direction", "mrad"),
}
#: A departure is marked from here on: of some dozens, chance makes one this large in one page of a hundred.
_CLEAR_SIGMA = 3.5


def write_page(derivation: Derivation, data: Mapping[str, Any], path: Path) -> None:
    """Write the page of a derivation.

    Parameters
    ----------
    derivation : Derivation
    data : mapping
        Its document (`fogreduce.calibrate.document`).
    path : Path
    """
    gyros = data["gyros"]
    context = {
        "data": data,
        "changes": [
            [
                {
                    "gyro": gyro["gyro"],
                    "value": plus_minus(change["value"], change["std"], unit)
                    if change["determined"]
                    else "not determined",
                    "stated": f"± {number(change['stated_std'], 2)} {unit}",
                    "sigma": f"{change['sigma']:.1f}" if change["determined"] else "",
                    "beyond": change["sigma"] > _CLEAR_SIGMA,
                    "what": words,
                }
                for key, (words, unit) in _CHANGES.items()
                for change in (gyro["change_from_present"][key],)
            ]
            for gyro in gyros
        ],
        "chart": _turn_on_chart(derivation, data),
        "residual_chart": _residual_chart(derivation, data),
        "rate_charts": [_rate_chart(derivation, i) for i in range(len(gyros))],
        "polynomial": bool(derivation.by_rate_polynomial),
        "departures": [
            one
            | {
                "shown": plus_minus(one["value"], one["std"], one["unit"]),
                "beyond": abs(one["value"]) > _CLEAR_SIGMA * one["std"],
            }
            for one in data["departures"]
        ],
        "runs": _runs(data),
        "noise": [
            {"gyro": gyro["gyro"]} | {key: _cell(value) for key, value in gyro["noise"].items()}
            for gyro in gyros
        ],
        "next_run": None if data["next_run"] is None else dump_yaml(data["next_run"]),
        "chi2": f"{data['chi2']['value']:.0f}",
        "freedom": f"{data['chi2']['degrees_of_freedom']:.0f}",
        "p_value": number(data["chi2"]["p_value"]),
    }
    in_results = path.resolve().parent.name == FOLDER
    crumbs = [Crumb(data["campaign"], "../index.html")] if in_results else []
    write_text(path, page(TEMPLATE, f"Calibration derived from {data['campaign']}", context, crumbs))


def _cell(value: object) -> str:
    return number(value) if isinstance(value, float) else str(value)


def _turn_on_chart(derivation: Derivation, data: Mapping[str, Any]) -> Markup:
    """Turn-on biases of each gyro over the runs, the band one standard deviation of what was found."""
    panels = []
    for i, gyro in enumerate(data["gyros"]):
        found = {one["run"]: one for one in data["turn_on"] if one["gyro"] == gyro["gyro"]}
        width = float(derivation.solution.turn_on_deg_h[i])
        panels.append(
            Panel(
                gyro["gyro"],
                "deg/h",
                [found[run]["deg_h"] if run in found else None for run in data["runs"]],
                errors=[found[run]["std_deg_h"] if run in found else None for run in data["runs"]],
                centre=0.0,
                limits=[(-width, width)] * len(data["runs"]),
                zero=True,
            )
        )
    return points(panels, some_ticks(data["runs"]), "Turn-on bias of each gyro in each run", height=90.0)


def _residual_chart(derivation: Derivation, data: Mapping[str, Any]) -> Markup:
    """What is left of each gyro's readings over time, one run after the other."""
    panels, first = [], dict.fromkeys(range(len(data["runs"])), 0)
    for i, gyro in enumerate(data["gyros"]):
        found = {(run, k): one for run, k, one in _numbered(derivation, i)}
        values: list[float | None] = []
        errors: list[float | None] = []
        for run in first:
            first[run] = len(values)
            for k in range(BLOCKS):
                one = found.get((run, k))
                values.append(None if one is None else one.deg_h)
                errors.append(None if one is None else one.std_deg_h)
        panels.append(Panel(gyro["gyro"], "deg/h", values, errors=errors, centre=0.0, zero=True))
    ticks = [(first[k] + BLOCKS // 2, name) for k, name in some_ticks(data["runs"])]
    return points(panels, ticks, "What is left of each gyro's readings, run after run", height=90.0)


def _numbered(derivation: Derivation, gyro: int) -> Iterator[tuple[int, int, Residual]]:
    """Run, number within the run, residual."""
    within: dict[int, int] = {}
    for one in derivation.residuals:
        if one.gyro == gyro:
            yield one.run, within.setdefault(one.run, 0), one
            within[one.run] += 1


def _rate_chart(derivation: Derivation, gyro: int) -> Markup:
    """Residuals of a gyro by segment in order of the rate: about the straight line, and the polynomial."""
    straight = [one for one in derivation.by_rate if one.gyro == gyro]
    curved = [one for one in derivation.by_rate_polynomial if one.gyro == gyro]
    panels = [
        Panel(
            name,
            "deg/h",
            [one.deg_h for one in found],
            errors=[one.std_deg_h for one in found],
            centre=0.0,
            zero=True,
        )
        for name, found in ((f"gyro{gyro + 1}", straight), ("polynomial", curved))
        if found
    ]
    ticks = some_ticks([number(one.rate_deg_s, 3) for one in straight], most=16)
    label = f"Residuals of gyro{gyro + 1} in order of the rate about its input axis [deg/s]"
    return points(panels, ticks, label, height=80.0)


def _runs(data: Mapping[str, Any]) -> list[list[str]]:
    """Run, then of each gyro the chi-square of its residuals over its degrees of freedom."""
    found = {
        (one["run"], one["gyro"]): f"{one['chi2'] / max(one['degrees_of_freedom'], 1):.2f}"
        for one in data["turn_on"]
    }
    return [[run, *(found.get((run, gyro["gyro"]), "") for gyro in data["gyros"])] for run in data["runs"]]
