"""What every stage starts from: the run's facts, the parameters and the version id, out of the manifest."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import fogreduce
from fogreduce.constants import MICROSECONDS_PER_SECOND
from fogreduce.datasets.logs import TableLog
from fogreduce.datasets.run_logs import table_log_of
from fogreduce.datasets.store import Storage
from fogreduce.errors import BadInput
from fogreduce.estimate.every_record import Geometries
from fogreduce.estimate.uncertainty import StatedErrors
from fogreduce.metadata.facts import RunFacts
from fogreduce.physics.frames import AXES
from fogreduce.physics.redundancy import projection
from fogreduce.provenance.manifest_file import read_manifest_data

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Setup:
    """A run to be reduced.

    Attributes
    ----------
    manifest : mapping
        See `fogreduce.provenance.manifest`.
    out : Path
        The run's results folder.
    """

    manifest: Mapping[str, Any]
    out: Path

    @classmethod
    def read(cls, out: Path) -> Setup:
        """From the manifest in a results folder."""
        return cls(read_manifest_data(out), out)

    @cached_property
    def facts(self) -> RunFacts:
        """The run's metadata and calibration as arrays."""
        facts = RunFacts.of(self.manifest["run"], self.manifest["calibration_record"])
        if self.complete_records or facts.projection is None:
            return facts
        # Every record counts by the gyros' noise, the complete ones too.
        return replace(
            facts, projection=projection(facts.axes, Geometries(facts.axes, facts.white_noise).noise)
        )

    @cached_property
    def stated_errors(self) -> StatedErrors:
        """What run.yaml and the calibration record state as uncertain, defaults filled in."""
        covariance = self.manifest["calibration_record"].get("covariance")
        return StatedErrors.of_plain(self.manifest["run"], self.manifest["stated_uncertainty"], covariance)

    @property
    def parameters(self) -> Mapping[str, Any]:
        """Parameters of the reduction."""
        parameters: Mapping[str, Any] = self.manifest["parameters"]
        return parameters

    @property
    def complete_records(self) -> bool:
        """Whether x, y, z take complete records only; results of earlier versions always did."""
        return bool(self.parameters.get("complete_records", True))

    @property
    def version_id(self) -> str:
        """Identifies the inputs, calibration, code, libraries and parameters of this result."""
        return str(self.manifest["version_id"])

    @property
    def block_records(self) -> int:
        """Records worked on at a time."""
        return int(self.parameters["block_records"])

    @property
    def storage(self) -> Storage:
        """Layout of the datasets."""
        storage = self.parameters["storage"]
        level = storage["compression_level"] if storage["compression"] == "gzip" else None
        return Storage(storage["chunk_records"], level)

    @property
    def gyros(self) -> list[str]:
        """Names of the gyros: gyro1, gyro2, ..."""
        return [f"gyro{i + 1}" for i in range(self.facts.n_gyros)]

    @property
    def axes(self) -> list[str]:
        """Names of the projected axes; none for a unit of one or two gyros."""
        return list(AXES) if self.facts.projection is not None else []

    @property
    def attributes(self) -> dict[str, object]:
        """Global attributes that every dataset carries."""
        attributes: dict[str, object] = {
            "Conventions": "CF-1.11",
            "title": f"fogreduce: {self.manifest['campaign']} / {self.facts.run_id}",
            "source": f"fogreduce {fogreduce.__version__}",
            "version_id": self.version_id,
            "campaign": self.manifest["campaign"],
            "run_id": self.facts.run_id,
            "unit": self.facts.unit,
            "calibration": self.manifest["calibration"]["id"],
            "latitude_deg": self.facts.latitude_deg,
            "sample_rate_hz": self.facts.sample_rate_hz,
        }
        if self.manifest.get("label"):
            attributes["comment"] = self.manifest["label"]
        return attributes

    def dataset(self, stage: str) -> Path:
        """Where a stage's dataset lies."""
        return self.out / "datasets" / f"{stage}.nc"

    def table(self, name: str) -> Path:
        """Where a table lies."""
        return self.out / "tables" / f"{name}.csv"


class TableAngle:
    """The table's angle alpha(t), from the command or, where configured, from the encoder's log."""

    def __init__(self, setup: Setup, run_dir: Path | None) -> None:
        self._profile = setup.facts.profile
        self._log: TableLog | None = None
        if setup.parameters["alpha_source"] == "encoder":
            if run_dir is None:
                raise BadInput.at(
                    "--run",
                    "",
                    found="nothing",
                    expected="the run's folder, since reduction.alpha_source is encoder",
                )
            self._log = table_log_of(run_dir, setup.manifest["run"], setup.facts.start_us)
            if self._log is None:
                raise BadInput.at(
                    run_dir / "run.yaml",
                    "table_log",
                    found="no encoder log",
                    expected="one, since reduction.alpha_source is encoder",
                )

    def at(self, time_s: Array) -> Array:
        """Alpha [rad] at times [s], positive for a right-handed turn about the table's axis."""
        if self._log is None:
            return self._profile.angle_at(time_s)
        return self._log.angle_at(time_s)


def seconds(time_us: NDArray[np.int64]) -> Array:
    """Stamps [us] as seconds since the run's start."""
    return time_us / MICROSECONDS_PER_SECOND


def microseconds(time_s: Array) -> NDArray[np.int64]:
    """Seconds since the run's start as whole microseconds, rounded."""
    return np.rint(time_s * MICROSECONDS_PER_SECOND).astype(np.int64)
