"""What the figures draw: a run's bins, fits and counts, read from its results folder."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from fogreduce.errors import BadInput
from fogreduce.plotting.style import Identity
from fogreduce.stages.files import read_json
from fogreduce.stages.read_bins import Family, read_bins
from fogreduce.stages.read_tables import read_rows
from fogreduce.stages.setup import Setup


@dataclass(frozen=True)
class Results:
    """A reduced run.

    Attributes
    ----------
    setup : Setup
        Manifest and facts.
    gyros, axes : Family
        The run in bins; `axes` is None for a unit of one or two gyros.
    fits, ingest : mapping
        reports/fit.json and reports/ingest.json.
    drift : list of dict
        Rows of tables/drift.csv, as text.
    rates : list of dict
        Rows of tables/rates.csv, likewise.
    """

    setup: Setup
    gyros: Family
    axes: Family | None
    fits: Mapping[str, Any]
    ingest: Mapping[str, Any]
    drift: list[dict[str, str]]
    rates: list[dict[str, str]]

    @classmethod
    def read(cls, out: Path) -> Results:
        """From a results folder; BadInput where a part is missing or belongs to another version."""
        setup = Setup.read(out)
        gyros, axes = read_bins(setup)
        return cls(
            setup,
            gyros,
            axes,
            _report(setup, "fit"),
            _report(setup, "ingest"),
            read_rows(setup.out, "drift", setup.version_id, setup.facts.raw_unit),
            read_rows(setup.out, "rates", setup.version_id, setup.facts.raw_unit),
        )

    @property
    def identity(self) -> Identity:
        """Campaign, run, version id and label."""
        manifest = self.setup.manifest
        run_id = str(manifest["run_id"])
        return Identity(
            str(manifest["campaign"]), run_id, self.setup.version_id, str(manifest.get("label") or "")
        )

    @property
    def segments(self) -> list[dict[str, Any]]:
        """The fits of each segment of constant rate."""
        return list(self.fits["segments"])

    @property
    def bin_s(self) -> float:
        """Length of a bin [s]."""
        return float(self.fits["bin_s"])

    @property
    def guard_s(self) -> float:
        """What the fit leaves out on both sides of an edge between segments [s]."""
        return float(self.setup.parameters["edge_guard_s"])

    @property
    def span_s(self) -> tuple[float, float]:
        """Times that a figure shows [s]: the commanded profile, and records after it."""
        return 0.0, max(float(self.segments[-1]["stop_s"]), float(self.gyros.time_s[-1]))


def _report(setup: Setup, name: str) -> dict[str, Any]:
    path = setup.out / "reports" / f"{name}.json"
    report = read_json(path)
    _same_version(setup, path, report.get("version_id"))
    return report


def _same_version(setup: Setup, path: Path, found: object) -> None:
    if found != setup.version_id:
        expected = f"{setup.version_id}, as the manifest has it"
        raise BadInput.at(path, "version_id", found=found, expected=expected)
