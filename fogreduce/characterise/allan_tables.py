"""The Allan deviation of a run as tables: allan.csv, noise.csv and spectrum.csv."""

from __future__ import annotations

from pathlib import Path

from fogreduce.characterise.allan_freedom import limits
from fogreduce.characterise.allan_result import Allan
from fogreduce.stages.tables import Cell, write_table

_LIMITS = ("low_68_deg_h", "high_68_deg_h", "low_95_deg_h", "high_95_deg_h")
_NUMBERS = ("value", "error", "upper_95", "significant", "square", "square_error", "samples", "missing")
_PLACE = ("segment", "version_id")
_FREEDOM = ("alpha", "freedom", "windows")
ALLAN_COLUMNS = ("channel", "kind", "tau_s", "deviation_deg_h", *_LIMITS, *_FREEDOM, *_PLACE)
NOISE_COLUMNS = ("channel", "symbol", "noise", "unit", *_NUMBERS, *_PLACE)
SPECTRUM_COLUMNS = ("channel", "frequency_hz", "density", "low_95", "high_95", "unit", "freedom", *_PLACE)
_DENSITY_UNIT = "(deg/h)^2/Hz"


def write_tables(result: Allan, folder: Path) -> list[Path]:
    """Write the three tables into a folder; every row carries segment and version."""
    tables = {
        "allan": (ALLAN_COLUMNS, _deviation_rows(result)),
        "noise": (NOISE_COLUMNS, _noise_rows(result)),
        "spectrum": (SPECTRUM_COLUMNS, _spectrum_rows(result)),
    }
    place: list[Cell] = [result.about["segment"], result.about["version_id"]]
    written = []
    for name, (columns, rows) in tables.items():
        written.append(folder / f"{name}.csv")
        write_table(written[-1], columns, [[*row, *place] for row in rows])
    return written


def _deviation_rows(result: Allan) -> list[list[Cell]]:
    rows: list[list[Cell]] = []
    for channel in result.channels:
        for kind, one in channel.deviations.items():
            limits_of = (one.low_68, one.high_68, one.low_95, one.high_95)
            columns = (one.tau_s, one.deviation, *limits_of, one.alpha, one.freedom, one.windows)
            for cells in zip(*(column.tolist() for column in columns), strict=True):
                rows.append([channel.name, kind, *cells])
    return rows


def _noise_rows(result: Allan) -> list[list[Cell]]:
    """Value and error are empty where the square is not positive; the upper limit always stands."""
    rows: list[list[Cell]] = []
    for channel in result.channels:
        for one in channel.coefficients:
            numbers: list[Cell] = [one.value, one.error, one.upper_95, "yes" if one.significant else "no"]
            numbers += [one.square, one.square_error, channel.samples, channel.missing]
            rows.append([channel.name, one.noise.symbol, one.noise.name, one.noise.unit, *numbers])
    return rows


def _spectrum_rows(result: Allan) -> list[list[Cell]]:
    rows: list[list[Cell]] = []
    for channel in result.channels:
        one = channel.spectrum
        low, high = (one.density * factor**2 for factor in limits(one.freedom, 0.95))
        for f, density, below, above, freedom in zip(
            *(column.tolist() for column in (one.frequency_hz, one.density, low, high, one.freedom)),
            strict=True,
        ):
            rows.append([channel.name, f, density, below, above, _DENSITY_UNIT, freedom])
    return rows
