"""The `capture` block of run.yaml: the raw capture's file, and how its numbers are to be read."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import BeforeValidator, Field, Strict, model_validator

from fogreduce.metadata.base import FileName, Model, Sign
from fogreduce.metadata.faults import unexpected
from fogreduce.metadata.patterns import FORMAT_PATTERN
from fogreduce.metadata.words import kind_of
from fogreduce.physics.raw_quantity import RawUnitName


def _column(value: object) -> object:
    if isinstance(value, bool) or not isinstance(value, int | str) or value == "" or value == 0:
        raise unexpected("a column's name, or its number from 1", found=kind_of(value))
    return value


Column = Annotated[
    str | int,
    BeforeValidator(_column),
    Field(json_schema_extra={"anyOf": [{"type": "string"}, {"type": "integer"}]}),
]


class Columns(Model):
    """Which column is what, by name or by number from 1."""

    time: Column | None = Field(default=None, description="time stamps; without it, records are numbered")
    gyros: Annotated[tuple[Column, ...], Strict(False)] = Field(
        min_length=1, description="raw readings, gyro after gyro"
    )
    sensor_temperature: Column | None = Field(
        default=None, description="of the sensors [degC]; serves where no temperature log is named"
    )
    electronics_temperature: Column | None = Field(
        default=None, description="of the electronics [degC]; serves where no temperature log is named"
    )
    table_angle: Column | None = Field(
        default=None, description="of the table's encoder [deg]; serves where no table_log is named"
    )

    @model_validator(mode="after")
    def _each_once(self) -> Self:
        given = [*self.gyros, *(getattr(self, key) for key in LOG_COLUMNS), self.time]
        named = [column for column in given if column is not None]
        if twice := [column for column in named if named.count(column) > 1]:
            raise unexpected("each column once", found=f"{twice[0]!r} twice")
        return self


#: Keys of `Columns` that serve as logs.
LOG_COLUMNS = ("sensor_temperature", "electronics_temperature", "table_angle")


class TimeColumn(Model):
    """What the numbers of the time column are."""

    unit: Literal["s", "ms", "us", "ns", "ticks", "iso8601"] = Field(
        default="s", description="s, ms, us, ns, ticks of a counter, or iso8601 (UTC where no zone is given)"
    )
    tick_s: float | None = Field(default=None, gt=0, le=1e6, description="length of a tick [s], for ticks")
    epoch: Literal["run", "unix", "gps"] = Field(
        default="run", description="what they count from: the run's start, 1970 (unix), 1980-01-06 (gps)"
    )

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        if (self.unit == "ticks") != (self.tick_s is not None):
            found = "nothing" if self.tick_s is None else f"{self.tick_s:g} with unit {self.unit}"
            raise unexpected("the length of a tick, with unit ticks alone", found=found, key="tick_s")
        if self.unit == "iso8601" and self.epoch != "run":
            raise unexpected("no epoch beside unit iso8601", found=self.epoch, key="epoch")
        return self


class Text(Model):
    """How a delimited text file is written."""

    delimiter: str = Field(
        default=",", min_length=1, max_length=10, description="one character, or the word whitespace"
    )
    decimal: Literal[".", ","] = Field(default=".", description="decimal mark")
    comment: str | None = Field(
        default=None, min_length=1, max_length=1, description="what a comment begins with; one character"
    )
    header: bool = Field(default=True, description="whether a line of column names stands before the records")
    skip_lines: int = Field(default=0, ge=0, le=100_000, description="lines before that, of whatever kind")
    skip_below_header: int = Field(
        default=0, ge=0, le=1000, description="lines between header and records, such as one of units"
    )
    missing: Annotated[tuple[str, ...], Strict(False)] = Field(
        default=("NaN", "nan", "NA", "null"), description="words for no answer, beside an empty field"
    )
    encoding: Literal["utf-8", "latin-1", "utf-16"] = Field(default="utf-8", description="of the text")

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        if self.delimiter != "whitespace" and len(self.delimiter) != 1:
            raise unexpected(
                "one character, or the word whitespace", found=f"the text {self.delimiter!r}", key="delimiter"
            )
        if self.delimiter == self.decimal:
            raise unexpected("another character than decimal", found=self.delimiter, key="delimiter")
        return self


class CaptureInfo(Model):
    """The raw capture: its file and how its numbers are to be read."""

    file: FileName = Field(description="capture's file, in the run's own folder")
    format: str = Field(
        pattern=FORMAT_PATTERN,
        description="fogcap-1, csv-1, table, hdf5, mat, npy, npz, tdms, parquet, or an installed one",
    )
    sample_rate_hz: float = Field(ge=0.01, le=10_000, description="sample rate [Hz]")
    raw_unit: RawUnitName = Field(
        default="V", description="unit of the raw readings; deg and rad are angle increments over a sample"
    )
    volts_per_count: float | None = Field(
        default=None, gt=0, le=1e6, description="volts a count stands for [V]; for raw_unit V alone"
    )
    least_count: float | None = Field(
        default=None,
        gt=0,
        le=1e6,
        description="least step of a raw reading [raw_unit], 1 by default for counts; not for raw_unit V",
    )
    polarity: Annotated[tuple[Sign, ...], Strict(False)] = Field(
        min_length=1, description="per gyro, the sign that turns raw readings into calibrated ones"
    )
    columns: Columns | None = Field(
        default=None, description="which column is what; for formats that hold columns"
    )
    time: TimeColumn | None = Field(
        default=None, description="what the time column's numbers are (default: seconds from the run's start)"
    )
    time_zero: float | int | str | None = Field(
        default=None,
        description="taken away from the time stamps: a number in their unit, an instant, or the word first",
    )
    text: Text | None = Field(default=None, description="how the text is written; for format table")
    dataset: str | None = Field(
        default=None,
        min_length=1,
        max_length=500,
        description="group, variable or struct that holds the columns; for hdf5, mat, npz, tdms",
    )

    @model_validator(mode="after")
    def _has_one_least_step(self) -> Self:
        """volts_per_count for volts, least_count for every other unit."""
        needed, refused = "least_count", "volts_per_count"
        what = f"least step of a raw reading [{self.raw_unit}]"
        if self.raw_unit == "V":
            needed, refused, what = refused, needed, "volts a count stands for [V]"
        if (given := getattr(self, refused)) is not None:
            expected = f"{needed} in its place, for raw_unit {self.raw_unit}"
            raise unexpected(expected, found=f"{given:g}", key=refused)
        if getattr(self, needed) is None and self.raw_unit != "count":
            raise unexpected(what, found="nothing", key=needed)
        return self

    @model_validator(mode="after")
    def _keys_of_the_format(self) -> Self:
        """Keys that the format has no use for are refused, those that it needs asked for."""
        if self.columns is not None and len(self.columns.gyros) != len(self.polarity):
            expected = f"{len(self.polarity)}, as many as capture.polarity has signs"
            raise unexpected(expected, found=f"{len(self.columns.gyros)} columns", key="columns.gyros")
        if self.format in COLUMN_FORMATS and self.columns is None:
            raise unexpected("which column is what: time, gyros", found="nothing", key="columns")
        for key, formats in _KEYS.items():
            is_bundled = self.format in ("fogcap-1", "csv-1", *COLUMN_FORMATS)
            if is_bundled and self.format not in formats and getattr(self, key) is not None:
                raise unexpected(f"no such key for format {self.format}", found="this key", key=key)
        return self


#: Formats that hold columns.
COLUMN_FORMATS = ("table", "hdf5", "mat", "npy", "npz", "tdms", "parquet")
_KEYS: dict[str, tuple[str, ...]] = {
    "columns": COLUMN_FORMATS,
    "time": COLUMN_FORMATS,
    "time_zero": ("csv-1", *COLUMN_FORMATS),
    "text": ("table",),
    "dataset": ("hdf5", "mat", "npz", "tdms"),
}
