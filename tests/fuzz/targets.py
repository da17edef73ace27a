"""What is fuzzed: each kind of file, how it is spoilt, the commands that read it, what is forbidden in it."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple

import contract
import contract_yaml
from attempt import Command, attempt, warm
from fuzz_lab import (
    CAMPAIGN_DATA,
    EFFECTS_DATA,
    FOGCAP,
    GYROS,
    RATE_HZ,
    RECORD_DATA,
    RUN_DATA,
    FuzzLab,
)
from hdf5_mutations import restructured
from hypothesis import strategies as st
from judge import faults_of, faults_of_tables, quality
from mutations import BYTE_EDITS, TEXT_EDITS, edited, revalued

Forbidden = Callable[[bytes], list[str]]


class Spoilt(NamedTuple):
    """A spoilt file, and what is forbidden in it."""

    data: bytes
    forbidden: list[str]

    def __repr__(self) -> str:
        return f"{len(self.data)} bytes {self.data[:300]!r}, forbidden: {self.forbidden}"


@dataclass(frozen=True)
class Target:
    """One kind of file.

    Attributes
    ----------
    file : function
        Where it lies in a laboratory.
    spoil : function
        Strategy of spoilt files, from the laboratory.
    commands : function
        What reads it.
    weight : int
        Its share of the examples.
    prepare : function
        What the laboratory needs first.
    accepted : function
        Complaints about what a command that accepted the file has made of it.
    """

    file: Callable[[FuzzLab], Path]
    spoil: Callable[[FuzzLab], st.SearchStrategy[Spoilt]]
    commands: Callable[[FuzzLab], list[Command]]
    weight: int = 1
    prepare: Callable[[FuzzLab], object] = lambda lab: None
    accepted: Callable[[FuzzLab, bytes], list[str]] = lambda lab, data: []


@dataclass
class Figures:
    """What a series of examples cost, and how they ended."""

    accepted: int = 0
    refused: int = 0
    most_cpu_s: float = 0.0
    most_mb: float = 0.0
    stricter: dict[str, str] = field(default_factory=dict)


def made_ready(lab: FuzzLab, target: Target) -> None:
    """What the target needs, and every command run once on good files."""
    target.prepare(lab)
    before = lab.listing()
    warm(target.commands(lab))
    lab.tidy(before)


def try_one(lab: FuzzLab, target: Target, example: Spoilt, figures: Figures | None = None) -> list[str]:
    """Put a spoilt file into the laboratory, run what reads it, mend it; what was wrong with the answers."""
    data, forbidden = example
    path = target.file(lab)
    path.write_bytes(data)
    before = lab.listing()
    wrong = []
    try:
        for command in target.commands(lab):
            known = list(lab.listing())
            outcome = attempt(command)
            wrong += faults_of(outcome, forbidden, known, list(lab.listing()))
            if outcome.status == 0 and lab.out.is_dir():
                wrong += faults_of_tables(lab.out) + target.accepted(lab, data)
            if figures is not None:
                figures.accepted += outcome.status == 0
                figures.refused += outcome.status == 2
                figures.most_cpu_s = max(figures.most_cpu_s, outcome.cpu_s)
                figures.most_mb = max(figures.most_mb, outcome.peak_mb)
                if outcome.status == 2 and not forbidden:
                    words = outcome.err.split(": ", 1)[-1]
                    figures.stricter.setdefault(words[:60], outcome.err.strip()[:300])
    finally:
        lab.mend(path)
        lab.tidy(before)
    return wrong


def _judged(forbidden: Forbidden) -> Callable[[bytes], Spoilt]:
    return lambda data: Spoilt(data, forbidden(data))


def _edited(where: Callable[[FuzzLab], Path], edits: Any, forbidden: Forbidden = lambda data: []) -> Any:
    return lambda lab: edited(lab.good[where(lab)], edits).map(_judged(forbidden))


def _yaml(where: Callable[[FuzzLab], Path], data: dict[str, Any], forbidden: Forbidden) -> Any:
    def spoil(lab: FuzzLab) -> Any:
        both = edited(lab.good[where(lab)], TEXT_EDITS) | revalued(data)
        return both.map(_judged(forbidden))

    return spoil


def _counted(lab: FuzzLab, data: bytes) -> list[str]:
    """quality.csv against a count of the capture's own."""
    expected = contract.fogcap_counts(data, GYROS, RATE_HZ)
    found = quality(lab.out)
    least = expected.pop("stray_stamps")
    wrong = [
        f"quality.csv: {key} {found[key]}, not {value}"
        for key, value in expected.items()
        if found[key] != value
    ]
    if found["bad_stamp"] < least:
        wrong.append(f"quality.csv: {found['bad_stamp']} bad stamps of {least}")
    return wrong


def _effects_commands(lab: FuzzLab) -> list[Command]:
    return [lab.simulate("--effects", lab.effects)]


def _reduce(lab: FuzzLab) -> list[Command]:
    return [lab.check(lab.run), lab.reduce()]


def _with_encoder(lab: FuzzLab) -> list[Command]:
    return [lab.check(lab.run), lab.reduce("--parameters", '{"alpha_source": "encoder"}')]


def _dataset(stage: str) -> Callable[[FuzzLab], Path]:
    return lambda lab: lab.reduced / "datasets" / f"{stage}.nc"


def _hdf5(stage: str, *names: str) -> Any:
    """Half spoilt byte by byte, half through HDF5 itself."""
    where = _dataset(stage)
    return lambda lab: st.one_of(
        edited(lab.good[where(lab)], BYTE_EDITS).map(_judged(lambda data: [])),
        restructured(lab.good[where(lab)], names).map(lambda made: Spoilt(*made)),
    )


def _figures(lab: FuzzLab) -> list[Command]:
    from fogreduce.figures.results import Results

    return [lambda: Results.read(lab.reduced)]


def _view(lab: FuzzLab) -> list[Command]:
    from fogreduce.datasets.view import open_run

    def look() -> None:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # xarray's, of attributes: whoever uses it from Python sees them
            view = open_run(lab.reduced)
        with view:
            str(view)

    return [look]


def _bag(lab: FuzzLab) -> list[Command]:
    """What `fogreduce verify` asks of a dataset in a bag."""
    from fogreduce.archive.hdf5 import look_at

    return [lambda: look_at([_dataset("ingest")(lab)])]


#: What the contract forbids in the bytes of a file, for the kinds of which it says so.
FORBIDDEN: dict[str, Forbidden] = {
    "fogcap-1": lambda data: contract.fogcap(data, **FOGCAP),
    "csv-1": lambda data: contract.csv_capture(data, GYROS),
    "run.yaml": lambda data: contract_yaml.forbidden(data, contract_yaml.run(GYROS)),
    "campaign.yaml": lambda data: contract_yaml.forbidden(data, contract_yaml.campaign),
    "calibration record": lambda data: contract_yaml.forbidden(data, contract_yaml.calibration(GYROS)),
    "temperature log": contract.temperatures,
    "encoder log": contract.table_log,
    "effects file": lambda data: contract_yaml.forbidden(data, contract_yaml.effects),
}

TARGETS: dict[str, Target] = {
    "fogcap-1": Target(
        lambda lab: lab.capture,
        _edited(lambda lab: lab.capture, BYTE_EDITS, FORBIDDEN["fogcap-1"]),
        _reduce,
        weight=3,
        accepted=_counted,
    ),
    "csv-1": Target(
        lambda lab: lab.csv,
        _edited(lambda lab: lab.csv, TEXT_EDITS, FORBIDDEN["csv-1"]),
        lambda lab: [lab.reduce()],
        weight=2,
        prepare=lambda lab: lab.use_csv(),
    ),
    "run.yaml": Target(
        lambda lab: lab.yaml,
        _yaml(lambda lab: lab.yaml, RUN_DATA, FORBIDDEN["run.yaml"]),
        _reduce,
        weight=3,
    ),
    "campaign.yaml": Target(
        lambda lab: lab.campaign / "campaign.yaml",
        _yaml(lambda lab: lab.campaign / "campaign.yaml", CAMPAIGN_DATA, FORBIDDEN["campaign.yaml"]),
        lambda lab: [lab.check(lab.campaign), lab.simulate()],
        weight=2,
    ),
    "calibration record": Target(
        lambda lab: lab.record,
        _yaml(lambda lab: lab.record, RECORD_DATA, FORBIDDEN["calibration record"]),
        _reduce,
        weight=3,
    ),
    "temperature log": Target(
        lambda lab: lab.run / "temperature.csv",
        _edited(lambda lab: lab.run / "temperature.csv", TEXT_EDITS, FORBIDDEN["temperature log"]),
        _reduce,
    ),
    "encoder log": Target(
        lambda lab: lab.run / "table.csv",
        _edited(lambda lab: lab.run / "table.csv", TEXT_EDITS, FORBIDDEN["encoder log"]),
        _with_encoder,
    ),
    "effects file": Target(
        lambda lab: lab.effects,
        _yaml(lambda lab: lab.effects, EFFECTS_DATA, FORBIDDEN["effects file"]),
        _effects_commands,
        weight=2,
    ),
    "ingest.nc": Target(
        _dataset("ingest"),
        _hdf5("ingest", "time", "pulse", "volts", "flag", "gyro_flag"),
        lambda lab: [lab.stage("calibrate"), lab.stage("fit")],
        weight=2,
    ),
    "calibrate.nc": Target(
        _dataset("calibrate"),
        _hdf5("calibrate", "time", "gyro_rate", "flag"),
        lambda lab: [lab.stage("project")],
    ),
    "project.nc": Target(
        _dataset("project"),
        _hdf5("project", "time", "axis_rate", "flag"),
        lambda lab: [lab.stage("remove_earth")],
    ),
    "remove_earth.nc": Target(
        _dataset("remove_earth"), _hdf5("remove_earth", "axis_rate"), lambda lab: [lab.stage("fit")]
    ),
    "bins.nc": Target(_dataset("bins"), _hdf5("bins", "time", "volts_mean", "axis_rate_count"), _figures),
    "open_run": Target(_dataset("ingest"), _hdf5("ingest", "time", "volts", "gyro_flag"), _view),
    "a bag's dataset": Target(
        _dataset("ingest"),
        lambda lab: _hdf5("ingest", "time", "volts")(lab).map(lambda made: made._replace(forbidden=[])),
        _bag,
    ),
    "manifest.json": Target(
        lambda lab: lab.reduced / "manifest.json",
        _edited(lambda lab: lab.reduced / "manifest.json", TEXT_EDITS),
        lambda lab: [lab.stage("calibrate"), lab.stage("drift")],
    ),
    "fit.json": Target(
        lambda lab: lab.reduced / "reports" / "fit.json",
        _edited(lambda lab: lab.reduced / "reports" / "fit.json", TEXT_EDITS),
        lambda lab: [lab.stage("drift")],
    ),
}
