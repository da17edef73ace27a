"""The version ids that the files of a run's results carry: of which manifest they are."""

from __future__ import annotations

import csv
import io
from pathlib import Path

from fogreduce.errors import BadInput
from fogreduce.provenance.manifest_file import parse_json


def ids_of_result(folder: Path, name: str) -> set[str]:
    """The version ids in a file of a run's results; none where it is of a kind that has none.

    Parameters
    ----------
    folder : Path
        The run's results.
    name : str
        The file's path in it, parted by /.
    """
    path = folder / name
    if path.suffix == ".nc":
        import h5py

        try:
            with h5py.File(path, "r") as file:
                return {str(file.attrs.get("version_id"))}
        except OSError as error:
            raise BadInput.at(path, "", found=str(error), expected="a dataset of the reduction") from None
    if name == "figures/index.json" or name.startswith(("tables/", "reports/")):
        return version_ids(path.read_bytes(), path) if path.suffix in (".csv", ".json") else set()
    return set()


def version_ids(raw: bytes, file: Path) -> set[str]:
    """The version ids that a table or a report carries."""
    if file.suffix == ".json":
        return {str(parse_json(raw, file).get("version_id"))}
    return _ids_of_table(raw, file)


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
