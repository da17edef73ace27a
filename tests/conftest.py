"""What the tests of the core share: the repository, the published run reduced once, a bench of made-up
runs."""

from __future__ import annotations

import csv
import json
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from archived_lab import ArchivedLab

REPOSITORY = Path(__file__).resolve().parents[1]
SHARED = REPOSITORY.parent / "shared"

Parameters = dict[str, Any] | None
Spoil = Callable[[Any, Any, Any], tuple[Any, Any, Any]] | None


@pytest.fixture(scope="session")
def repository() -> Path:
    """The repository's root."""
    return REPOSITORY


@pytest.fixture(scope="session")
def shared() -> Path:
    """The folder of papers, contracts and recordings beside the repository; skips where it is not there."""
    if not SHARED.is_dir():
        pytest.skip(f"no folder {SHARED}: its recordings are not part of the repository")
    return SHARED


def table_rows(path: Path) -> list[dict[str, str]]:
    """A CSV table as a list of rows by column."""
    with path.open(newline="") as file:
        return list(csv.DictReader(file))


class Reduced:
    """A reduced run: its results folder and what stands in it."""

    def __init__(self, out: Path) -> None:
        self.out = out

    def table(self, name: str) -> list[dict[str, str]]:
        return table_rows(self.out / "tables" / f"{name}.csv")

    def row(self, name: str, first: str) -> dict[str, str]:
        """The only row of a table whose first column says `first`."""
        rows = [row for row in self.table(name) if next(iter(row.values())) == first]
        assert len(rows) == 1, (name, first, rows)
        return rows[0]

    def report(self, name: str) -> dict[str, Any]:
        return json.loads((self.out / "reports" / f"{name}.json").read_text())

    def dataset(self, stage: str) -> Path:
        return self.out / "datasets" / f"{stage}.nc"

    def channel(self, name: str, segment: int = 1) -> dict[str, Any]:
        """The fit of one channel, every digit of it."""
        channels = self.report("fit")["segments"][segment - 1]["channels"]
        return next(item for item in channels if item is not None and item["channel"] == name)

    @property
    def setup(self) -> Any:
        from fogreduce.stages.setup import Setup

        return Setup.read(self.out)


def command(*words: object) -> None:
    """Run a command of ``fogreduce`` in this process; it must end well."""
    from fogreduce.cli.main import main

    assert main([str(word) for word in words]) == 0


def reduce_run(run_dir: Path, calibrations: Path, out: Path, parameters: Parameters = None) -> Reduced:
    """All stages in one pass: ``fogreduce reduce``."""
    told = ("--calibrations", calibrations, "--parameters", json.dumps(parameters or {}))
    command("reduce", run_dir, "--out", out, *told)
    return Reduced(out)


def reduce_by_stages(run_dir: Path, calibrations: Path, out: Path, parameters: Parameters = None) -> Reduced:
    """The same, stage after stage through files, as the nodes of the workflow do."""
    from fogreduce.cli.stage import STAGES

    told = ("--calibrations", calibrations, "--parameters", json.dumps(parameters or {}))
    command("manifest", run_dir, "--out", out, *told)
    for name in STAGES:
        command("stage", name, "--out", out, "--run", run_dir)
    return Reduced(out)


@pytest.fixture(scope="session")
def reduce() -> Callable[..., Reduced]:
    """`reduce_run`, for tests."""
    return reduce_run


class Published:
    """The published run, made by the product itself (``fogreduce simulate``) and reduced."""

    def __init__(self, root: Path) -> None:
        self.root = root
        self.calibrations = REPOSITORY / "calibrations"
        campaign = root / "published"
        source = REPOSITORY / "campaigns" / "published"
        command("simulate", source, "--calibrations", self.calibrations, "--out", campaign)
        self.run_dir = campaign / "runs" / "x-one-turn"
        self.reduced = reduce_run(self.run_dir, self.calibrations, root / "results")


@pytest.fixture(scope="session")
def published(tmp_path_factory: pytest.TempPathFactory) -> Published:
    """The published run, simulated and reduced once a session (two seconds)."""
    return Published(tmp_path_factory.mktemp("published"))


# ---------------------------------------------------------------------------------- made-up runs

_TETRA_H = [
    [2.891714702786278e-01, 2.892335095117639e-01, 2.876136426324943e-01, 5.017305804843861e-01],
    [-4.639681532136366e-03, 7.052669198527741e-01, -7.041214018909228e-01, -1.744579996672102e-03],
    [8.144462476125298e-01, -4.097230037870795e-01, -4.108263813061506e-01, -8.696722162293962e-04],
]  # the paper's Table 1

_GOLDEN = (1 + 5**0.5) / 2
#: Axes through the faces of a dodecahedron: six gyros, no three of them in a plane.
_SIX = [
    [1, 0, _GOLDEN],
    [-1, 0, _GOLDEN],
    [0, _GOLDEN, 1],
    [0, _GOLDEN, -1],
    [_GOLDEN, 1, 0],
    [_GOLDEN, -1, 0],
]


def geometry(n: int) -> dict[str, Any]:
    """Axes (or H) of a unit of n gyros, as a calibration record has them."""
    if n <= 2:
        return {"axes": np.eye(3)[:n].tolist()}
    if n == 3:
        return {"H": np.eye(3).tolist()}
    if n == 4:
        return {"H": _TETRA_H}
    assert n == 6
    axes = np.array(_SIX) / np.linalg.norm(_SIX[0])
    return {"H": np.linalg.pinv(axes).tolist()}


class Bench:
    """A campaign folder of made-up runs with their calibration records, and their reduction.

    Captures are made by the product's forward physics with stated noise unless a test writes its own.
    """

    def __init__(self, root: Path) -> None:
        self.root = root
        self.calibrations = root / "calibrations"
        self.campaign = root / "campaigns" / "made-up"
        self._reductions = 0

    def calibration(self, n: int) -> str:
        """Write the record of a unit of n gyros; its id."""
        from fogreduce.metadata.yaml12 import dump_yaml

        unit = f"UNIT-{n}"
        record = {
            "schema": "fogreduce/calibration/1",
            "unit": unit,
            "version": "v1",
            "valid_from": "2012-06-01T00:00:00Z",
            "procedure": "made up for a test",
            **geometry(n),
            "scale_factor_V_per_deg_s": [0.075 + 0.004 * i for i in range(n)],
            "bias_V": [2e-4 - 1e-4 * i for i in range(n)],
            "noise": {
                "angle_random_walk_deg_sqrt_h": [2e-3] * n,
                "bias_instability_deg_h": [0.03] * n,
                "rate_random_walk_deg_h_sqrt_h": [0.0] * n,
            },
        }
        path = self.calibrations / unit / "v1.yaml"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(dump_yaml(record))
        return f"{unit}@v1"

    def run(
        self,
        run_id: str = "r1",
        *,
        n: int = 4,
        profile: Sequence[tuple[float, float]] = ((3.0, 120.0),),
        sample_rate_hz: float = 64.0,
        file_format: str = "fogcap-1",
        seed: int = 1,
        noise: bool = True,
        spoil: Spoil = None,
        encoder: Callable[[Any], Any] | None = None,
        **changes: Any,
    ) -> Path:
        """Write a run with its capture; its folder.

        `spoil` may change stamps, pulse numbers and counts before they are written; `encoder` gives the
        angle [deg] of the table's log at times [s].
        """
        from fogreduce.metadata.yaml12 import dump_yaml

        calibration = self.calibration(n)
        here = self.campaign / "runs" / run_id
        here.mkdir(parents=True, exist_ok=True)
        name = "capture.csv" if file_format == "csv-1" else "capture.fogcap"
        run = {
            "schema": "fogreduce/run/1",
            "run_id": run_id,
            "unit": calibration.split("@")[0],
            "started_at": "2014-05-12T13:00:00Z",
            "site": {"latitude_deg": -23.21132308},
            "table": {
                "axis": "x",
                "profile": [{"rate_deg_s": rate, "duration_s": length} for rate, length in profile],
            },
            "orientation": {"x": "up", "z": "north"},
            "frame_signs": [1, 1, -1],
            "capture": {
                "file": name,
                "format": file_format,
                "sample_rate_hz": sample_rate_hz,
                "volts_per_count": 1e-7,
                "polarity": [1, -1, 1, 1, -1, 1][:n],
            },
            "calibration": calibration,
            **changes,
        }
        if encoder is not None:
            run["table_log"] = "table.csv"
            times = np.arange(0.0, sum(length for _, length in profile) + 1.0)
            rows = [f"{t:.3f},{angle:.9f}" for t, angle in zip(times, encoder(times), strict=True)]
            (here / "table.csv").write_text("\n".join(["time_s,angle_deg", *rows]) + "\n")
        (here / "run.yaml").write_text(dump_yaml(run))
        self.capture(here, seed=seed, noise=noise, spoil=spoil)
        return here

    def capture(
        self,
        run_dir: Path,
        *,
        seed: int = 1,
        noise: bool = True,
        spoil: Spoil = None,
    ) -> None:
        """Make the capture that a run.yaml asks for."""
        from fogreduce.metadata.facts import RunFacts
        from fogreduce.metadata.folder import load_calibration, load_run
        from fogreduce.simulate.capture import write_capture
        from fogreduce.simulate.forward import ForwardRun, SimulatedBlock
        from fogreduce.simulate.nominal_noise import NoiseCoefficients

        run = load_run(run_dir, need_capture=False)
        record, _ = load_calibration(self.calibrations, run.calibration)
        facts = RunFacts.of_models(run, record)
        stated = NoiseCoefficients.of(record.stated_noise.model_dump()) if noise else None
        blocks = list(ForwardRun(facts, stated, seed=seed).blocks())
        if spoil is not None:
            whole = (
                np.concatenate([block.time_us for block in blocks]),
                np.concatenate([block.pulse for block in blocks]),
                np.concatenate([block.counts for block in blocks], axis=1),
            )
            blocks = [SimulatedBlock(*spoil(*whole))]
        write_capture(run_dir / run.capture.file, run.capture.format, facts, blocks)

    def facts(self, run_dir: Path) -> Any:
        """The run's numbers."""
        from fogreduce.metadata.facts import RunFacts
        from fogreduce.metadata.folder import load_calibration, load_run

        run = load_run(run_dir, need_capture=False)
        return RunFacts.of_models(run, load_calibration(self.calibrations, run.calibration)[0])

    def reduce(self, run_dir: Path, parameters: Parameters = None) -> Reduced:
        """All stages in one pass, into a folder of its own."""
        self._reductions += 1
        return reduce_run(run_dir, self.calibrations, self.root / f"results-{self._reductions}", parameters)

    def reduce_by_stages(self, run_dir: Path, parameters: Parameters = None) -> Reduced:
        """Stage after stage through files, into a folder of its own."""
        self._reductions += 1
        out = self.root / f"results-{self._reductions}"
        return reduce_by_stages(run_dir, self.calibrations, out, parameters)


@pytest.fixture(scope="session")
def archived(tmp_path_factory: pytest.TempPathFactory) -> ArchivedLab:
    """Two runs simulated, reduced, summed up and archived; not to be changed by a test."""
    return ArchivedLab(tmp_path_factory.mktemp("archived"))


@pytest.fixture
def bag(archived: ArchivedLab, tmp_path: Path) -> Path:
    """A copy of the bag, to be spoilt."""
    return archived.copy(tmp_path / "bag")


@pytest.fixture
def bench(tmp_path: Path) -> Bench:
    """A bench of made-up runs."""
    return Bench(tmp_path)
