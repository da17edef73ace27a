"""From one cell of a table back to the bytes that it came from, each hash checked on the way."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from fogreduce.errors import BadInput
from fogreduce.provenance.cell import Cell, CellName, find_cell
from fogreduce.provenance.code import code_digest, digest_of
from fogreduce.provenance.digest import file_digest
from fogreduce.provenance.manifest_file import MANIFEST
from fogreduce.provenance.records import HashedFile, Outputs, read_outputs
from fogreduce.provenance.stages import STAGES, stages_of
from fogreduce.trace.places import RunPlace

#: What of a calibration record says where it comes from.
_PEDIGREE = ("unit", "version", "procedure", "valid_from", "valid_until")


class Hashes:
    """SHA-256 of files and of code, each read once."""

    def __init__(self) -> None:
        self._files: dict[Path, str] = {}
        self._code: dict[tuple[Path | None, tuple[str, ...]], str] = {}

    def of(self, path: Path) -> str:
        """A file's hash."""
        if path not in self._files:
            self._files[path] = file_digest(path)
        return self._files[path]

    def of_code(self, place: RunPlace) -> str:
        """The hash of the source at hand: the archive's own, or that which runs."""
        key = (place.package, tuple(place.code_parts))
        if key not in self._code:
            self._code[key] = _code_at_hand(place)
        return self._code[key]


def trace(place: RunPlace, name: CellName, hashes: Hashes | None = None) -> dict[str, Any]:
    """The chain of one cell.

    Parameters
    ----------
    place : RunPlace
        The run.
    name : CellName
        The cell.
    hashes : Hashes, optional
        To be shared by many calls: what was hashed in one is not read again in the next.

    Returns
    -------
    dict
        Plain data: ``cell``, ``run``, ``code``, ``stages`` (the last first), ``calibration``, ``inputs``,
        ``capture``. A file's entry says ``verified`` where its bytes were read and have that hash.

    Raises
    ------
    BadInput
        No such cell; or a file on the way is not what the records say.
    """
    hashes = Hashes() if hashes is None else hashes
    outputs = read_outputs(place.results)
    if outputs.version_id != place.manifest.version_id:
        expected = f"{place.manifest.version_id}, as the manifest has it"
        raise BadInput.at(place.results, "version_id", found=outputs.version_id, expected=expected)
    cell = find_cell(place.results, name)
    listed = {entry.name: entry for entry in outputs.files}
    for needed in (f"tables/{cell.table}", MANIFEST):
        if needed not in listed:
            raise BadInput.at(place.results / needed, "", found="no checksum", expected="one in outputs.json")
    code = _code(place, hashes)
    return {
        "cell": _cell(cell, place),
        "table": _checked(place.results / "tables" / cell.table, listed[f"tables/{cell.table}"], hashes),
        "run": {
            "campaign": place.manifest.campaign,
            "run_id": place.manifest.run_id,
            "version_id": place.manifest.version_id,
            "manifest": _checked(place.results / MANIFEST, listed[MANIFEST], hashes),
        },
        "code": code,
        "machine": outputs.machine,
        "stages": _stages(place, outputs, cell, hashes, at_hand=code["source_at_hand"]),
        "calibration": _calibration(place, hashes),
        "inputs": [_checked(place.inputs / entry.name, entry, hashes) for entry in place.manifest.inputs],
        "capture": _capture(place, hashes),
    }


def _cell(cell: Cell, place: RunPlace) -> dict[str, Any]:
    return {
        "name": cell.name,
        "run": place.name,
        "line": cell.line,
        "value": cell.value,
        "uncertainty": cell.uncertainty,
    }


def _checked(path: Path, entry: HashedFile, hashes: Hashes) -> dict[str, Any]:
    """A file whose bytes are read and held against the record."""
    if not path.is_file():
        raise BadInput.at(path, "", found="no such file", expected=f"one of {entry.bytes} bytes")
    if (found := hashes.of(path)) != entry.sha256:
        raise BadInput.at(path, "", found=f"SHA-256 {found}", expected=f"{entry.sha256}, as recorded")
    return {"file": str(path), "bytes": entry.bytes, "sha256": entry.sha256, "verified": True}


def _code(place: RunPlace, hashes: Hashes) -> dict[str, Any]:
    """The software; its hash checked where its source is at hand."""
    stated = str(place.manifest.software.get("code_sha256"))
    return {**place.manifest.software, "source_at_hand": hashes.of_code(place) == stated}


def _code_at_hand(place: RunPlace) -> str:
    if place.package is None:
        return code_digest()
    sources = {path.relative_to(place.package).as_posix(): path for path in place.package.rglob("*.py")}
    return digest_of(sources, place.code_parts)


def _stages(
    place: RunPlace, outputs: Outputs, cell: Cell, hashes: Hashes, *, at_hand: bool
) -> list[dict[str, Any]]:
    manifest = place.manifest
    package = place.package or Path(__file__).parents[1]
    listed = {entry.name: entry for entry in outputs.files}
    chain = []
    for stage in reversed(stages_of(cell.table)):
        facts = STAGES[stage]
        source = package / "stages" / f"{stage}.py"
        chain.append(
            {
                "stage": stage,
                "code": f"fogreduce/stages/{stage}.py",
                "code_sha256": hashes.of(source) if at_hand and source.is_file() else None,
                "parameters": {
                    key: manifest.parameters[key] for key in facts.parameters if key in manifest.parameters
                },
                "run": {key: manifest.run[key] for key in facts.run if key in manifest.run},
                "calibration": {
                    key: manifest.calibration_record[key]
                    for key in facts.calibration
                    if key in manifest.calibration_record
                },
                "reads": list(facts.reads),
                "writes": [
                    {"file": name, "bytes": listed[name].bytes, "sha256": listed[name].sha256}
                    for name in facts.writes
                    if name in listed and (not name.startswith("tables/") or name == f"tables/{cell.table}")
                ],
            }
        )
    return chain


def _calibration(place: RunPlace, hashes: Hashes) -> dict[str, Any]:
    used = place.manifest.calibration
    unit, _, version = used.id.partition("@")
    path = place.calibrations / unit / f"{version}.yaml"
    if not path.is_file():
        raise BadInput.at(path, "", found="no such file", expected=f"the record {used.id}")
    entry = HashedFile(name=path.name, bytes=path.stat().st_size, sha256=used.sha256)
    record = place.manifest.calibration_record
    return {
        "id": used.id,
        **_checked(path, entry, hashes),
        "pedigree": {key: record[key] for key in _PEDIGREE if key in record},
    }


def _capture(place: RunPlace, hashes: Hashes) -> dict[str, Any]:
    run = place.manifest.run
    manifest = place.results / MANIFEST
    try:
        name = run["capture"]["file"]
        facts = {key: run["capture"][key] for key in ("format", "sample_rate_hz")}
        facts |= {key: run[key] for key in ("started_at", "unit")}
    except (KeyError, TypeError) as error:
        raise BadInput.at(manifest, "run", found=f"no {error}", expected="a run.yaml's content") from None
    entry = next((item for item in place.manifest.inputs if item.name == name), None)
    if entry is None:
        raise BadInput.at(manifest, "inputs", found=f"no {name}", expected="the capture")
    return {**_checked(place.inputs / name, entry, hashes), **facts}
