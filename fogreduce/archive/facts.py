"""What a bag's records say of its other files, taken from their bytes while these are hashed."""

from __future__ import annotations

import csv
import io
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from fogreduce.archive.crate import CRATE
from fogreduce.archive.records import MANIFEST, OUTPUTS, Manifest, Outputs, manifest_of, parse_json
from fogreduce.archive.write import RECORD
from fogreduce.errors import BadInput, Fault


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
        elif name.endswith(".json"):
            found = parse_json(raw, file).get("version_id")
            self.version_ids[path] = {str(found)}
        elif name.endswith(".csv"):
            self.version_ids[path] = _ids_of_table(raw, file)


def _ids_of_table(raw: bytes, file: Path) -> set[str]:
    """The version ids in a table's column of that name; every row must have as many fields as the header."""
    try:
        rows = csv.reader(io.StringIO(raw.decode(), newline=""), strict=True)
        header = next(rows, [])
        ids = set()
        for number, row in enumerate(rows, 2):
            if len(row) != len(header):
                found = f"{len(row)} fields"
                raise BadInput.at(
                    file, f"line {number}", found=found, expected=f"{len(header)}, as its header"
                )
            if "version_id" in header:
                ids.add(row[header.index("version_id")])
    except (csv.Error, UnicodeDecodeError) as error:
        raise BadInput.at(file, "", found=str(error), expected="a CSV table in UTF-8") from None
    return ids
