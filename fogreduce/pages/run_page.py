"""The page of a run: what was run, with what, numbers, figures, what was flagged, versions."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from fogreduce.constants import EARTH_RATE_DEG_S, SECONDS_PER_HOUR
from fogreduce.pages import svg
from fogreduce.pages.attention import first_of_each, names_of
from fogreduce.pages.budget_bars import budget_bars
from fogreduce.pages.flags import FLAGS, flag
from fogreduce.pages.numbers import count, duration, number, plus_minus, rounding, size
from fogreduce.pages.overview import error_of, overview, real, report, whole_run
from fogreduce.pages.rate_difference import rate_difference
from fogreduce.pages.render import Crumb, page
from fogreduce.pages.verdict import combined, verdict
from fogreduce.physics.raw_quantity import unit_of_capture
from fogreduce.provenance.manifest_file import read_record
from fogreduce.provenance.records import Manifest, read_manifest
from fogreduce.stages.read_table import Row
from fogreduce.stages.read_tables import COLUMNS, read_rows

#: A page holds pictures up to so many bytes (as they stand in it); further ones are linked.
MOST_PICTURES = 750_000
_TYPES = {".svg": "image/svg+xml", ".png": "image/png"}

#: Figure -> what it shows, for who cannot see it too; in the order in which a page has them.
FIGURES = {
    "residuals_axes": "What the mean curve leaves of x, y and z, over the run",
    "allan": "Allan deviation of what the mean curves leave",
    "temperature": "Temperatures of sensors and electronics over the run",
    "flags": "Numbers of records out of the ordinary, by kind",
    "encoder": "The table's encoder beside the commanded angle",
    "residuals_gyros": "What the mean curve leaves of each gyro, over the run",
    "gyro_volts": "Output of each gyro in volts over the run, with the fitted mean curve",
    "gyro_raw": "Output of each gyro over the run, with the fitted mean curve",
    "rates": "Rates about x, y and z over the run, with the fitted mean curve",
    "angles": "Angles about x, y and z, integrated, beside the commanded ones",
}
#: Figures on the scale of what the table did: they show less than the rate less the commanded one.
_LINKED = ("rates", "angles")
_WHOLE = "whole\N{NO-BREAK SPACE}run"


def run_page(folder: Path, seen: dict[str, Any] | None = None) -> str:
    """The page of the run whose results lie in `folder`.

    Parameters
    ----------
    folder : Path
        Its results: manifest, tables, reports, and figures where they were drawn.
    seen : dict or None
        Its overview, where it is there already.

    Raises
    ------
    BadInput
        A part is missing or of another version than the manifest.
    """
    manifest = read_manifest(folder)
    version, raw_unit = manifest.version_id, unit_of_capture(manifest.run["capture"])
    seen = overview(folder) if seen is None else seen
    tables = {name: read_rows(folder, name, version, raw_unit) for name in COLUMNS}
    figures, linked, left_out = _figures(folder, version, seen)
    rate_figure = rate_difference(folder, report(folder, "fit", version), seen)
    drift, rates = whole_first(tables["drift"]), whole_first(tables["rates"])
    context = {
        "run": seen,
        "verdict": verdict(seen),
        "brief": _brief(seen),
        "whole": _whole_run(seen),
        "rate_figure": rate_figure,
        "chart": None if rate_figure else _chart(seen),
        "facts": _facts(manifest, seen),
        "notes": manifest.run.get("notes"),
        "attention": first_of_each(seen["attention"]),
        "drift": _drift_rows(drift, rates),
        "rates": _rate_rows(rates),
        "whole_drift": sum(row["segment"] == whole_run(drift) for row in drift),
        "whole_rates": sum(row["segment"] == whole_run(rates) for row in rates),
        "budget": budget_bars(tables["budget"]),
        "flags": [(flag(kind), count(times)) for kind, times in seen["flagged"].items()],
        "places": _places(folder, version),
        "unstable": tables["unstable"],
        "undetermined": _undetermined(tables),
        "rate_fit": _fit_rows(tables["rate_fit"], "axis", "deg_s", "deg_s2"),
        "gyro_fit": _fit_rows(tables["gyro_fit"], "gyro", raw_unit.suffix, raw_unit.slope_suffix),
        "raw_unit": raw_unit,
        "noise": [(gyro, number(value, 3, noughts=True)) for gyro, value in seen["noise"].items()],
        "encoder": _encoder_rows(tables["encoder"]),
        "figures": figures,
        "linked": linked,
        "left_out": left_out,
        "calibration": _calibration(manifest),
        "assumed": [(item.file, item.key, item.said) for item in manifest.assumed],
        "parameters": list(_flat(manifest.parameters)),
        "inputs": manifest.inputs,
        "software": manifest.software,
        "files": _files(folder),
    }
    crumbs = [Crumb("All campaigns", "../../index.html"), Crumb(seen["campaign"], "../index.html")]
    scripts = ["zoom.js"] if rate_figure else []
    return page("run.html", seen["run_id"], context, crumbs, seen["label"], scripts)


def _brief(seen: dict[str, Any]) -> str:
    """When, what was run and with which calibration, in a line."""
    did = f"table about {table_text(seen)} for {duration(seen['duration_s'])}"
    return f"{started(seen['started_at'])}; {did}; calibration {seen['calibration']}"


def _whole_run(seen: dict[str, Any]) -> list[dict[str, str]]:
    """Of each axis difference and drift of the whole run, with combined errors and with those by noise."""
    rows = []
    for axis in names_of("offset", [seen]) or names_of("drift", [seen]):
        row = {"axis": axis}
        for kind in ("offset", "drift"):
            entry = seen[kind].get(axis, {})
            row[kind] = plus_minus(entry.get("value"), combined(entry))
            row[f"{kind}_noise"] = (
                "" if entry.get("error") is None else f"± {number(entry['error'], 2, noughts=True)}"
            )
        rows.append(row)
    return rows


def whole_first(rows: list[Row]) -> list[Row]:
    """Rows of the whole run before those of segments."""
    whole = whole_run(rows)
    return sorted(rows, key=lambda row: row["segment"] != whole)


def _facts(manifest: Manifest, seen: dict[str, Any]) -> list[tuple[str, str]]:
    run = manifest.run
    site = run["site"]
    place = f"latitude {site['latitude_deg']:g}°"
    if site.get("name"):
        place = f"{site['name']}, {place}"
    steps = [
        f"{step['rate_deg_s']:g} deg/s for {duration(step['duration_s'])}" for step in run["table"]["profile"]
    ]
    shown = steps if len(steps) <= 8 else [*steps[:7], f"{len(steps) - 7} more steps"]
    capture = run["capture"]
    return [
        ("Unit", seen["unit"]),
        ("Started", started(seen["started_at"])),
        ("Length", duration(seen["duration_s"])),
        ("Table", f"about {seen['axis']}: " + "; ".join(shown)),
        ("Orientation", ", ".join(f"{axis} {way}" for axis, way in run["orientation"].items())),
        ("Site", place),
        ("Capture", _capture(capture)),
        ("Calibration", seen["calibration"]),
        ("Version", seen["version_id"]),
    ]


def _capture(capture: Mapping[str, Any]) -> str:
    """File, format and rate; the unit of its readings where these are no volts."""
    text = f"{capture['file']} ({capture['format']}), {capture['sample_rate_hz']:g} Hz"
    unit = capture.get("raw_unit", "V")
    return text if unit == "V" else f"{text}, readings in {unit}"


def started(text: str) -> str:
    """An instant as people read it."""
    return text.replace("T", " ").replace("Z", " UTC")


def table_text(overview: Mapping[str, Any]) -> str:
    """What the table did: ``x: 10, 0 deg/s``."""
    rates = overview["rates_deg_s"]
    shown = [f"{rate:g}" for rate in rates[:6]] + (["..."] if len(rates) > 6 else [])
    return f"{overview['axis']}: {', '.join(shown)}\N{NO-BREAK SPACE}deg/s".replace("-", "−")


def _drift_rows(rows: list[Row], rates: list[Row]) -> list[list[str]]:
    """Axis, segment, drift, mean rate less commanded, length, angles and their errors."""
    offsets = {(row["axis"], row["segment"]): _difference(row) for row in rates}
    size_deg_h, whole = _largest_rate(rates) * SECONDS_PER_HOUR, whole_run(rows)
    out = []
    for row in rows:
        values = {name: real(text) for name, text in row.items()}
        out.append(
            [
                row["axis"],
                _WHOLE if row["segment"] == whole else row["segment"],
                plus_minus(values["drift_deg_h"], error_of(row, "drift_", "deg_h")),
                offsets.get((row["axis"], row["segment"]), ""),
                duration(float(row["duration_s"])),
                number(values["nominal_deg"], 9),
                plus_minus(values["accumulated_error_deg"], error_of(row, "accumulated_", "deg")),
                number(rounding(values["drift_err_stated_deg_h"], size_deg_h), 2),
                plus_minus(values["integral_less_commanded_deg"], error_of(row, "integral_", "deg")),
            ]
        )
    return out


def _difference(row: Row) -> str:
    """Mean rate less the commanded one, and its error by noise [deg/h]."""
    noise = real(row["difference_err_noise_deg_s"])
    return plus_minus(real(row["difference_deg_h"]), None if noise is None else noise * SECONDS_PER_HOUR)


def _largest_rate(rates: list[Row]) -> float:
    """The largest rate that was taken away [deg/s]: a commanded one, or Earth's."""
    return max([EARTH_RATE_DEG_S, *(abs(real(row["commanded_deg_s"]) or 0.0) for row in rates)])


def _rate_rows(rows: list[Row]) -> list[list[str]]:
    """Axis, segment, measured, commanded, difference, sigma, ppm, the sine that is left, verdict."""
    largest, whole = _largest_rate(rows), whole_run(rows)
    out = []
    for row in rows:
        values = {name: real(text) for name, text in row.items()}
        measured, wanted = (rounding(values[f"{of}_deg_s"], largest) for of in ("measured", "commanded"))
        difference = rounding(values["difference_deg_h"], largest * SECONDS_PER_HOUR)
        out.append(
            [
                row["axis"],
                _WHOLE if row["segment"] == whole else row["segment"],
                number(measured, 9),
                number(wanted, 9),
                plus_minus(difference, values["difference_err_deg_h"]),
                number(values["difference_sigma"], 3),
                number(values["difference_ppm"], 4),
                plus_minus(values["sine_deg_h"], values["sine_err_deg_h"]),
                row["verdict"] + (f": {row['looks_like']}" if row["looks_like"] else ""),
            ]
        )
    return out


def _chart(seen: dict[str, Any]) -> Any:
    """Drift and mean rate less commanded with their errors; nothing for a run without either."""
    names = names_of("offset", [seen])
    panels, said = [], []
    for kind, title in (("drift", "drift"), ("offset", "mean rate")):
        entries = [seen[kind].get(name, {}) for name in names]
        values, errors = ([entry.get(of) for entry in entries] for of in ("value", "error"))
        if any(value is not None for value in values):
            panels.append(svg.Panel(title, "deg/h", values, errors, zero=True))
            each = zip(names, values, errors, strict=True)
            said.append(f"{title} " + "; ".join(f"{name} {plus_minus(v, e)}" for name, v, e in each))
    if not panels:
        return None
    return svg.points(panels, list(enumerate(names)), f"In deg/h with standard errors: {'. '.join(said)}")


def _undetermined(tables: dict[str, list[Row]]) -> list[list[str]]:
    """Channel, segment, and which parameters of its curve the record does not determine, with the reason."""
    return [
        [row[name], row["segment"], row["undetermined"]]
        for table, name in (("rate_fit", "axis"), ("gyro_fit", "gyro"))
        for row in tables[table]
        if row["undetermined"]
    ]


def _fit_rows(rows: list[Row], name: str, unit: str, slope: str) -> list[list[str]]:
    """Channel, segment, then a, b, d, e with errors, scatter and records."""
    out = []
    for row in rows:
        cells = [row[name], row["segment"]]
        for letter, of in (("a", unit), ("b", unit), ("d", "rad"), ("e", slope)):
            cells.append(plus_minus(real(row[f"{letter}_{of}"]), error_of(row, f"{letter}_", of)))
        out.append([*cells, number(real(row[f"sigma_{unit}"]), 3), row["records"]])
    return out


def _encoder_rows(rows: list[Row]) -> list[list[str]]:
    """Segment, commanded rate, rate and lag by the encoder with errors, ripple."""
    return [
        [
            row["segment"],
            number(real(row["commanded_deg_s"]), 9),
            plus_minus(real(row["rate_deg_s"]), real(row["rate_err_deg_s"])),
            plus_minus(real(row["lag_s"]), real(row["lag_err_s"])),
            number(real(row["ripple_deg"]), 3),
        ]
        for row in rows
    ]


def _places(folder: Path, version: str) -> list[dict[str, str]]:
    """Where in the capture: the first few of each kind."""
    ingest = report(folder, "ingest", version)
    out = [
        {
            "what": FLAGS["lost"],
            "where": ", ".join(
                f"pulse {hole['first_pulse']}"
                + (f" and {hole['pulses'] - 1} more" if hole["pulses"] > 1 else "")
                for hole in ingest["lost_places"]
            ),
        }
    ]
    for kind, places in ingest["places"].items():
        where = ", ".join(f"{place['time_s']:.3f} s (record {place['record']})" for place in places)
        out.append({"what": flag(kind), "where": where})
    return [entry for entry in out if entry["where"]]


def _figures(
    folder: Path, version: str, seen: Mapping[str, Any]
) -> tuple[list[dict[str, str]], list[tuple[str, str]], dict[str, str]]:
    """Pictures for the page; names and titles of those that are linked; those not drawn, with the reason."""
    path = folder / "figures" / "index.json"
    if not path.is_file():
        return [], [], {}
    index = read_record(path, "the list of the run's figures")
    names = [str(name) for name in index.get("figures", ()) if Path(str(name)).name == name]
    if index.get("version_id") != version:
        return [], [], {}
    shown, linked, spent = [], [], 0
    stems = dict.fromkeys(Path(name).stem for name in names)
    for stem in sorted(
        stems, key=lambda stem: list(FIGURES).index(stem) if stem in FIGURES else len(FIGURES)
    ):
        files = [folder / "figures" / name for name in names if Path(name).stem == stem]
        files = [file for file in files if file.suffix in _TYPES and file.is_file()]
        if not files or (stem == "flags" and not seen["flagged"]):  # a chart of zeros
            continue
        smallest = min(files, key=lambda file: (file.stat().st_size, file.name))
        title = FIGURES.get(stem, stem.replace("_", " "))
        cost = 4 * smallest.stat().st_size // 3
        if stem in _LINKED or spent + cost > MOST_PICTURES:
            linked.append((f"figures/{smallest.name}", title))
            continue
        spent += cost
        data = b64encode(smallest.read_bytes()).decode()
        shown.append({"title": title, "data": f"data:{_TYPES[smallest.suffix]};base64,{data}"})
    left_out = index.get("left_out", {})
    return shown, linked, left_out if isinstance(left_out, dict) else {}


def _calibration(manifest: Manifest) -> list[tuple[str, str]]:
    record = manifest.calibration_record
    raw_unit = unit_of_capture(manifest.run["capture"])
    until = record.get("valid_until")
    valid = f"from {started(str(record.get('valid_from')))}" + (
        f" until {started(str(until))}" if until else ""
    )
    rows = [
        ("Record", manifest.calibration.id),
        ("Procedure", str(record.get("procedure", ""))),
        ("Valid", valid),
        (f"Scale factors [{raw_unit.name}/(deg/s)]", _list(record[raw_unit.scale_factor_key])),
        (f"Biases [{raw_unit.name}]", _list(record[raw_unit.bias_key])),
        ("SHA-256 of the record", manifest.calibration.sha256),
    ]
    return rows


def _list(values: list[float]) -> str:
    return ", ".join(number(value, 9) for value in values)


def _flat(data: dict[str, Any], before: str = "") -> Any:
    for key, value in data.items():
        if isinstance(value, dict):
            yield from _flat(value, f"{before}{key}.")
        else:
            yield f"{before}{key}", str(value)


def _files(folder: Path) -> list[tuple[str, str]]:
    """Tables, reports and datasets beside the page, with their sizes."""
    paths = [folder / "manifest.json"]
    for name, pattern in (("tables", "*.csv"), ("reports", "*.json"), ("datasets", "*.nc")):
        paths += sorted((folder / name).glob(pattern))
    return [(path.relative_to(folder).as_posix(), size(path.stat().st_size)) for path in paths]
