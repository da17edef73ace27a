"""What a bag's records say of its other files, taken from their bytes while these are hashed."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from fogreduce.archive.crate import CRATE
from fogreduce.archive.write import RECORD
from fogreduce.errors import BadInput, Fault
from fogreduce.provenance.manifest_file import MANIFEST, OUTPUTS, parse_json
from fogreduce.provenance.records import Manifest, Outputs, manifest_of
from fogreduce.provenance.version_ids import version_ids


@dataclass
class Facts:
    """Records of a bag by their path below ``data/``; faults of those that are not valid.

    Attributes
    ----------
    root : Path
        The bag's folder ``data``.
    manifests, outputs : dict
        By the folder that they lie in.
    version_ids : dict
        The version ids that each table and report carries.
    record, crate : dict or None
        archive.json and ro-crate-metadata.json.
    """

    root: Path
    manifests: dict[str, Manifest] = field(default_factory=dict)
    outputs: dict[str, Outputs] = field(default_factory=dict)
    version_ids: dict[str, set[str]] = field(default_factory=dict)
    record: dict[str, Any] | None = None
    crate: dict[str, Any] | None = None
    faults: list[Fault] = field(default_factory=list)

    @staticmethod
    def wants(path: str) -> bool:
        """Whether a file's bytes are looked at."""
        folder, _, name = path.rpartition("/")
        if path in (CRATE, RECORD):
            return True
        if not path.startswith("results/"):
            return False
        return name in (MANIFEST, OUTPUTS) or folder.endswith(("/tables", "/reports"))

    def add(self, path: str, raw: bytes) -> None:
        """Take the facts out of a file."""
        try:
            self._add(path, raw)
        except BadInput as error:
            self.faults += error.faults

    def _add(self, path: str, raw: bytes) -> None:
        folder, _, name = path.rpartition("/")
        file = self.root / path
        if path == CRATE:
            self.crate = parse_json(raw, file)
        elif path == RECORD:
            self.record = parse_json(raw, file)
        elif name == MANIFEST:
            self.manifests[folder] = manifest_of(parse_json(raw, file), file)
        elif name == OUTPUTS:
            self.outputs[folder] = Outputs.from_data(parse_json(raw, file), file)
        elif name.endswith((".json", ".csv")):
            self.version_ids[path] = version_ids(raw, file)
