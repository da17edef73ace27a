"""Do the records of an archive fit the files that lie there? What fixity alone does not see.

A bag whose every checksum was made anew after a file was changed has perfect fixity. Its records then still
say what the file was: a manifest its run's inputs, outputs.json the results, the crate every file.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any
from urllib.parse import unquote

from fogreduce.archive.crate import CRATE
from fogreduce.archive.facts import Facts
from fogreduce.archive.hdf5 import Looked, look_at
from fogreduce.archive.schema import ArchiveRecord, RunEntry
from fogreduce.archive.write import RECORD
from fogreduce.errors import BadInput, Fault
from fogreduce.metadata.folder import load_calibration, load_run
from fogreduce.provenance.code import digest_of
from fogreduce.provenance.manifest_file import MANIFEST, OUTPUTS
from fogreduce.provenance.outputs import VERSIONS
from fogreduce.provenance.records import HashedFile, Manifest

Files = Mapping[str, tuple[str, int]]


def inconsistencies(facts: Facts, files: Files, campaign: str) -> Iterator[Fault]:
    """Every place in which the records and the files differ.

    Parameters
    ----------
    facts : Facts
        What the records say.
    files : mapping
        SHA-256 and bytes of each file by its path below ``data/``.
    campaign : str
        As bag-info.txt has it.
    """
    root = facts.root
    yield from _crate(facts, files)
    if facts.record is None:
        yield Fault(str(root / RECORD), "", "no such record", "the archive's record")
        return
    try:
        record = ArchiveRecord.from_data(facts.record, root / RECORD)
    except BadInput as error:
        yield from error.faults
        return
    if record.campaign != campaign:
        yield Fault(str(root / RECORD), "campaign", record.campaign, f"{campaign}, as bag-info.txt has it")
    package = "software/fogreduce/"
    sources = {p.removeprefix(package): root / p for p in files if p.startswith(package)}
    code = digest_of(sources, record.code_parts)
    if code != record.software["code_sha256"]:
        where, expected = "software.code_sha256", f"{code}, the code that lies in software/"
        yield Fault(str(root / RECORD), where, str(record.software["code_sha256"]), expected)
    entries = {entry.results: entry for entry in record.runs}
    by_folder = _by_results(files)
    datasets = look_at([root / path for path in sorted(files) if path.endswith(".nc")])
    for folder in sorted({*facts.manifests, *facts.outputs, *entries}):
        yield from _results(facts, files, folder, by_folder.get(folder, []), datasets)
        if folder in entries and folder in facts.manifests:
            yield from _run(facts, files, record.campaign, entries[folder], facts.manifests[folder], code)
        elif folder not in entries and f"/{VERSIONS}/" not in folder:
            yield Fault(str(root / folder), "", "results of a run", f"only those that {RECORD} lists")


def _by_results(files: Files) -> dict[str, list[str]]:
    """The files of each run's results: those in ``results/<campaign>/<run>`` or in a version of it."""
    found: dict[str, list[str]] = {}
    for path in files:
        parts = path.split("/")
        if parts[0] == "results":
            found.setdefault("/".join(parts[: 5 if parts[3:4] == [VERSIONS] else 3]), []).append(path)
    return found


def _results(
    facts: Facts, files: Files, folder: str, paths: list[str], datasets: Mapping[Path, Looked]
) -> Iterator[Fault]:
    """Results against their checksums, and each file's version against the manifest's."""
    root, manifest, outputs = facts.root, facts.manifests.get(folder), facts.outputs.get(folder)
    if manifest is None or outputs is None:
        name = MANIFEST if manifest is None else OUTPUTS
        yield Fault(str(root / folder / name), "", "no such record", "one with every run's results")
        return
    if outputs.version_id != manifest.version_id:
        expected = f"{manifest.version_id}, as the manifest has it"
        yield Fault(str(root / folder / OUTPUTS), "version_id", outputs.version_id, expected)
    for entry in outputs.files:
        yield from _against(facts, files, folder, entry, OUTPUTS)
    listed = {f"{folder}/{entry.name}" for entry in outputs.files} | {f"{folder}/{OUTPUTS}"}
    for path in paths:
        if path not in listed:
            yield Fault(str(root / path), "", "a file without a checksum", f"only what {OUTPUTS} lists")
        for found in sorted(facts.version_ids.get(path, set()) - {manifest.version_id}):
            yield Fault(str(root / path), "version_id", found, f"{manifest.version_id}, as the manifest")
        if path.endswith(".nc"):
            problems, version_id = datasets[root / path]
            for problem in problems:
                yield Fault(str(root / path), "", problem, "a dataset whole in itself")
            if not problems and version_id != manifest.version_id:
                expected = f"{manifest.version_id}, as the manifest"
                yield Fault(str(root / path), "version_id", str(version_id), expected)


def _run(
    facts: Facts, files: Files, campaign: str, entry: RunEntry, manifest: Manifest, code: str
) -> Iterator[Fault]:
    """A run's manifest against its inputs, its calibration record and the code."""
    root = facts.root
    here = str(root / entry.results / MANIFEST)
    for where, found, expected in (
        ("campaign", manifest.campaign, campaign),
        ("run_id", manifest.run_id, entry.run_id),
        ("version_id", manifest.version_id, entry.version_id),
    ):
        if found != expected:
            yield Fault(here, where, found, f"{expected}, as {RECORD} has it")
    if (stated := manifest.software.get("code_sha256")) != code:
        yield Fault(here, "software.code_sha256", str(stated), f"{code}, the code that lies in software/")
    for file in manifest.inputs:
        yield from _against(facts, files, entry.inputs, file, MANIFEST)
    unit, _, version = manifest.calibration.id.partition("@")
    record = f"calibrations/{unit}/{version}.yaml"
    if record not in files:
        yield Fault(str(root / record), "", "no such file", "the record that the manifest names")
    elif files[record][0] != manifest.calibration.sha256:
        expected = f"{manifest.calibration.sha256}, as {here} has it"
        yield Fault(str(root / record), "", f"SHA-256 {files[record][0]}", expected)
    else:
        yield from _metadata(facts, entry, manifest)


def _metadata(facts: Facts, entry: RunEntry, manifest: Manifest) -> Iterator[Fault]:
    """run.yaml and the calibration record: valid, and what the manifest made of them."""
    root = facts.root
    try:
        run = load_run(root / entry.inputs, need_capture=False)  # it is there: one of the inputs
        record, path = load_calibration(root / "calibrations", manifest.calibration.id)
    except BadInput as error:
        yield from error.faults
        return
    for file, made, stated in (
        (root / entry.inputs / "run.yaml", run.model_dump(mode="json", exclude_none=True), manifest.run),
        (path, record.model_dump(mode="json", exclude_none=True), manifest.calibration_record),
    ):
        for key in sorted(stated):
            # A later version may know further keys, with defaults; those that were stated must stand.
            if not _holds(made.get(key), stated[key]):
                yield Fault(str(file), key, str(made.get(key)), f"{stated[key]}, as the manifest has it")


def _holds(made: Any, stated: Any) -> bool:
    if isinstance(made, dict) and isinstance(stated, dict):
        return all(key in made and _holds(made[key], value) for key, value in stated.items())
    return bool(made == stated)


def _against(facts: Facts, files: Files, folder: str, entry: HashedFile, record: str) -> Iterator[Fault]:
    """A file against what a record says of it."""
    path = f"{folder}/{entry.name}"
    if path not in files:
        yield Fault(str(facts.root / path), "", "no such file", f"one, as {record} of its run lists it")
        return
    digest, size = files[path]
    if size != entry.bytes:
        yield Fault(str(facts.root / path), "", f"{size} bytes", f"{entry.bytes}, as {record} of its run")
    elif digest != entry.sha256:
        expected = f"{entry.sha256}, as {record} of its run has it"
        yield Fault(str(facts.root / path), "", f"SHA-256 {digest}", expected)


def _crate(facts: Facts, files: Files) -> Iterator[Fault]:
    """The crate lists every file, and each as it is."""
    file = str(facts.root / CRATE)
    graph = facts.crate.get("@graph") if facts.crate is not None else None
    if not isinstance(graph, list) or not all(isinstance(entity, dict) for entity in graph):
        yield Fault(file, "@graph", "no list of entities", "an RO-Crate 1.1")
        return
    described: dict[str, dict[str, Any]] = {}
    for entity in graph:
        kinds = entity.get("@type")
        if "File" in (kinds if isinstance(kinds, list) else [kinds]):
            described[unquote(str(entity.get("@id")))] = entity
    for path in sorted({*files, *described} - {CRATE}):
        if path not in files:
            yield Fault(str(facts.root / path), "", "no such file", f"one, as {CRATE} lists it")
        elif path not in described:
            yield Fault(
                str(facts.root / path), "", "a file that is not described", f"only what {CRATE} lists"
            )
        else:
            stated = described[path].get("sha256"), described[path].get("contentSize")
            if stated != (files[path][0], str(files[path][1])):
                found = f"SHA-256 {files[path][0]}, {files[path][1]} bytes"
                yield Fault(
                    str(facts.root / path), "", found, f"{stated[0]}, {stated[1]} bytes, as {CRATE} has it"
                )
