"""ro-crate-metadata.json: what lies in the archive and what it came from, as RO-Crate 1.1 (JSON-LD).

Profile: Workflow Run Crate 0.5 (a `CreateAction` a run, its instrument the Snakemake workflow, its
objects the inputs, its results the outputs). The same content gives the same text: entities have names
derived from paths and version ids, and `datePublished`, which the profile demands, is the day of the
campaign's latest run, not that of the archiving.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from typing import Any
from urllib.parse import quote

from fogreduce.archive.contents import Contents, RunRecord

CRATE = "ro-crate-metadata.json"
WORKFLOW = "software/Snakefile"

_SPECIFICATION = "https://w3id.org/ro/crate/1.1"
_WORKFLOW_CRATE = "https://w3id.org/workflowhub/workflow-ro-crate/1.0"
_PROFILES = {
    "https://w3id.org/ro/wfrun/process/0.5": ("Process Run Crate", "0.5"),
    "https://w3id.org/ro/wfrun/workflow/0.5": ("Workflow Run Crate", "0.5"),
    _WORKFLOW_CRATE: ("Workflow RO-Crate", "1.0"),
}
_FORMATS = {
    ".csv": "text/csv",
    ".fogcap": "application/octet-stream",
    ".json": "application/json",
    ".md": "text/markdown",
    ".nc": "application/x-netcdf",
    ".png": "image/png",
    ".py": "text/x-python",
    ".smk": "text/x-python",
    ".svg": "image/svg+xml",
    ".toml": "application/toml",
    ".yaml": "application/yaml",
}
_LICENSE = "software/LICENSE"

Entity = dict[str, Any]


def crate(
    contents: Contents, hashes: Mapping[str, str], sizes: Mapping[str, int], software: Mapping[str, str]
) -> str:
    """The text of ro-crate-metadata.json.

    Parameters
    ----------
    contents : Contents
        The campaign's archive.
    hashes, sizes : mapping
        SHA-256 and bytes of each file by its path in the archive.
    software : mapping
        Versions of ``fogreduce`` and ``snakemake``.
    """
    graph: list[Entity] = [
        {
            "@id": CRATE,
            "@type": "CreativeWork",
            "about": {"@id": "./"},
            "conformsTo": [{"@id": _SPECIFICATION}, {"@id": _WORKFLOW_CRATE}],
        },
        _root(contents, sorted(hashes)),
    ]
    graph += [
        {"@id": uri, "@type": "CreativeWork", "name": name, "version": version}
        for uri, (name, version) in _PROFILES.items()
    ]
    graph += [_file(path, hashes[path], sizes[path]) for path in sorted(hashes) if path != WORKFLOW]
    graph += _software(hashes, sizes, software)
    for run in contents.runs:
        graph += _action(run)
    data = {"@context": f"{_SPECIFICATION}/context", "@graph": graph}
    return json.dumps(data, indent=1, ensure_ascii=False, allow_nan=False) + "\n"


def _root(contents: Contents, paths: Iterable[str]) -> Entity:
    latest = max(str(run.manifest.run["started_at"]) for run in contents.runs)
    return {
        "@id": "./",
        "@type": "Dataset",
        "name": f"fogreduce archive of the campaign {contents.campaign}",
        "description": "Raw captures of gyros on a rate table, their metadata and calibration records, all "
        "that was derived from them, and the software that did it. datePublished is the latest run's day.",
        "datePublished": latest[:10],
        "license": {"@id": _LICENSE},
        "conformsTo": references(_PROFILES),
        "hasPart": [{"@id": file_id(path)} for path in paths],
        "mainEntity": {"@id": WORKFLOW},
        "mentions": references(map(_action_id, contents.runs)),
    }


def file_id(path: str) -> str:
    """The @id of a file: its path as a relative URI."""
    return quote(path)


def references(ids: Iterable[str]) -> list[Entity] | Entity:
    """References to entities, in the order given; a single one stands without a list."""
    found = [{"@id": name} for name in ids]
    return found[0] if len(found) == 1 else found


def _file(path: str, digest: str, size: int) -> Entity:
    suffix = path[path.rfind(".") :] if "." in path.rpartition("/")[2] else ""
    return {
        "@id": file_id(path),
        "@type": "File",
        "name": path,
        "contentSize": str(size),
        "sha256": digest,
        "encodingFormat": _FORMATS.get(suffix, "text/plain"),
    }


def _software(
    hashes: Mapping[str, str], sizes: Mapping[str, int], software: Mapping[str, str]
) -> list[Entity]:
    workflow = _file(WORKFLOW, hashes[WORKFLOW], sizes[WORKFLOW])
    return [
        {
            **workflow,
            "@type": ["File", "SoftwareSourceCode", "ComputationalWorkflow"],
            "name": "fogreduce: from raw captures to drift",
            "version": software["fogreduce"],
            "programmingLanguage": {"@id": "#snakemake"},
            "softwareRequirements": {"@id": "software/requirements.lock"},
        },
        {
            "@id": "#snakemake",
            "@type": ["ComputerLanguage", "SoftwareApplication"],
            "name": "Snakemake",
            "identifier": {"@id": "https://snakemake.readthedocs.io"},
            "url": {"@id": "https://snakemake.readthedocs.io"},
            "version": software["snakemake"],
        },
        {
            "@id": "#fogreduce",
            "@type": "Organization",
            "name": "the laboratory that ran fogreduce",
        },
    ]


def _action_id(run: RunRecord) -> str:
    return f"#reduction-{run.manifest.campaign}-{run.manifest.run_id}-{run.manifest.version_id}"


def _action(run: RunRecord) -> list[Entity]:
    manifest = run.manifest
    unit, _, version = manifest.calibration.id.partition("@")
    objects = [f"{run.inputs}/{entry.name}" for entry in manifest.inputs]
    objects.append(f"calibrations/{unit}/{version}.yaml")
    action = _action_id(run)
    parameters = [
        {
            "@id": f"{action}-{key}",
            "@type": "PropertyValue",
            "name": key,
            "value": value if isinstance(value, str | int | float) else json.dumps(value, sort_keys=True),
        }
        for key, value in {**manifest.parameters, "code_sha256": manifest.software["code_sha256"]}.items()
    ]
    return [
        {
            "@id": action,
            "@type": "CreateAction",
            "name": f"Reduction of {manifest.run_id}, version {manifest.version_id}",
            "description": f"code {manifest.software['code_sha256']}",
            "instrument": {"@id": WORKFLOW},
            "agent": {"@id": "#fogreduce"},
            "actionStatus": {"@id": "http://schema.org/CompletedActionStatus"},
            "object": references([*map(file_id, objects), *(str(item["@id"]) for item in parameters)]),
            "result": references(file_id(f"{run.results}/{file.name}") for file in run.outputs.files),
        },
        *parameters,
    ]
