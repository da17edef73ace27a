"""The manifest of a run: what its numbers come from, and the version id derived from that.

It names the SHA-256 of every input, the calibration record, the code, the libraries and the parameters,
and carries the validated metadata, so that the stages need not validate again. It holds no path, no date
and no host: the same input and version give the same manifest.
"""

from __future__ import annotations

import sys
import threading
from collections.abc import Mapping
from importlib.metadata import version
from pathlib import Path
from typing import Any

import fogreduce
from fogreduce.archive.digest import code_digest, data_digest, file_digest
from fogreduce.errors import BadInput
from fogreduce.metadata.config import ReductionConfig
from fogreduce.metadata.folder import cross_check, load_calibration, load_campaign, load_run

SCHEMA = "fogreduce/manifest/1"
_LIBRARIES = ("numpy", "h5py", "pydantic", "pyyaml")
_ID_DIGITS = 16


class ManifestJob:
    """A manifest in the making: metadata are checked at once, files hashed in a thread meanwhile.

    Parameters
    ----------
    run_dir : Path
        The run's folder.
    calibrations_dir : Path
    parameters : mapping
        The `reduction` part of the configuration; what is left out has its default.

    Raises
    ------
    BadInput
        With every fault of the run's metadata.
    """

    def __init__(self, run_dir: Path, calibrations_dir: Path, parameters: Mapping[str, Any]) -> None:
        run = load_run(run_dir)
        record, record_path = load_calibration(calibrations_dir, run.calibration)
        cross_check(run, record, run_dir / "run.yaml")
        self._run_dir = run_dir
        self._names = ["run.yaml", run.capture.file]
        self._names += [name for name in (run.temperature, run.table_log) if name is not None]
        config = ReductionConfig.from_data(dict(parameters), "configuration")
        folder = run_dir.resolve()
        campaign_dir = folder.parent.parent
        self._facts: dict[str, Any] = {
            "campaign": campaign_dir.name,
            "run_id": run.run_id,
            "label": load_campaign(campaign_dir).label,
            "calibration": {"id": run.calibration, "sha256": file_digest(record_path)},
            "parameters": config.model_dump(mode="json"),
            "run": run.model_dump(mode="json", exclude_none=True),
            "calibration_record": record.model_dump(mode="json", exclude_none=True),
        }
        self._inputs: list[dict[str, Any]] = []
        self._error: OSError | None = None
        self._thread = threading.Thread(target=self._hash, daemon=True)
        self._thread.start()

    def _hash(self) -> None:
        try:
            for name in self._names:
                path = self._run_dir / name
                self._inputs.append({"name": name, "bytes": path.stat().st_size, "sha256": file_digest(path)})
        except OSError as error:
            self._error = error

    def manifest(self) -> dict[str, Any]:
        """The manifest, its version id included. Waits for the hashes."""
        self._thread.join()
        if self._error is not None:
            raise BadInput.at(
                self._error.filename, "", found=self._error.strerror, expected="a readable input file"
            )
        software = {
            "fogreduce": fogreduce.__version__,
            "code_sha256": code_digest(),
            "python": ".".join(map(str, sys.version_info[:3])),
            **{name: _version(name) for name in _LIBRARIES},
        }
        body = {"schema": SCHEMA, "inputs": self._inputs, "software": software, **self._facts}
        return {"schema": SCHEMA, "version_id": data_digest(body)[:_ID_DIGITS], **body}


def _version(name: str) -> str:
    """Version of a library: from the module where it is loaded (free), else from its metadata."""
    module = sys.modules.get("yaml" if name == "pyyaml" else name)
    return str(module.__version__) if module is not None else version(name)
