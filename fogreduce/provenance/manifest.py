"""The manifest of a run: what its numbers come from, and the version id derived from that.

It names the SHA-256 of every input, the calibration record, the code, the libraries and the parameters,
and carries the validated metadata, so that the stages need not validate again. It holds no path, no date
and no host: the same input and version give the same manifest.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping
from dataclasses import asdict
from importlib.metadata import version
from pathlib import Path
from typing import Any

import fogreduce
from fogreduce.constants import MANIFEST_SCHEMA
from fogreduce.datasets.readers import READERS
from fogreduce.datasets.readers.installed import software_of
from fogreduce.errors import BadInput
from fogreduce.metadata.assumed import assumed_of_record, assumed_of_run
from fogreduce.metadata.config import ReductionConfig
from fogreduce.metadata.folder import cross_check, load_calibration, load_campaign, load_run
from fogreduce.provenance.code import code_digest
from fogreduce.provenance.digest import VERSION_ID_DIGITS, data_digest, file_digest

_LIBRARIES = ("numpy", "h5py", "pydantic", "pyyaml")


def manifest(run_dir: Path, calibrations_dir: Path, parameters: Mapping[str, Any]) -> dict[str, Any]:
    """The manifest of a run.

    Parameters
    ----------
    run_dir : Path
        The run's folder.
    calibrations_dir : Path
        Folder of the calibration records.
    parameters : mapping
        The `reduction` part of the configuration; what is left out has its default.

    Raises
    ------
    BadInput
        With every fault of the run's metadata.
    """
    run = load_run(run_dir)
    record, record_path = load_calibration(calibrations_dir, run.calibration)
    cross_check(run, record, run_dir / "run.yaml")
    names = ["run.yaml", run.capture.file]
    names += [name for name in (run.temperature, run.table_log) if name is not None]
    campaign_dir = run_dir.resolve().parent.parent
    body: dict[str, Any] = {
        "schema": MANIFEST_SCHEMA,
        "inputs": [_input(run_dir, name) for name in names],
        "software": {
            "fogreduce": fogreduce.__version__,
            "code_sha256": code_digest(),
            "python": ".".join(map(str, sys.version_info[:3])),
            **{name: _version(name) for name in _LIBRARIES},
            **_reader_package(run.capture.format),
        },
        "campaign": campaign_dir.name,
        "run_id": run.run_id,
        "label": load_campaign(campaign_dir).label,
        "calibration": {"id": run.calibration, "sha256": file_digest(record_path)},
        "parameters": ReductionConfig.from_data(dict(parameters), "--parameters").model_dump(mode="json"),
        "run": run.model_dump(mode="json", exclude_none=True),
        "calibration_record": record.model_dump(mode="json", exclude_none=True),
        "stated_uncertainty": record.stated_uncertainty.model_dump(mode="json"),
        "assumed": [asdict(item) for item in assumed_of_record(record) + assumed_of_run(run)],
    }
    return {"schema": MANIFEST_SCHEMA, "version_id": data_digest(body)[:VERSION_ID_DIGITS], **body}


def _input(run_dir: Path, name: str) -> dict[str, Any]:
    path = run_dir / name
    try:
        return {"name": name, "bytes": path.stat().st_size, "sha256": file_digest(path)}
    except OSError as error:
        raise BadInput.at(path, "", found=error.strerror, expected="a readable input file") from None


def _reader_package(format_name: str) -> dict[str, str]:
    """The package that reads the capture, where it is not this one."""
    if format_name in READERS:
        return {}
    return software_of(format_name)


def _version(name: str) -> str:
    """Version of a library: from the module where it is loaded (free), else from its metadata (slower)."""
    module = sys.modules.get("yaml" if name == "pyyaml" else name)
    if module is not None:
        return str(module.__version__)
    return version(name)
