"""A trace as PROV-JSON (W3C PROV-DM): entities with their hashes, activities, and who used what."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

_PREFIX = {
    "prov": "http://www.w3.org/ns/prov#",
    "xsd": "http://www.w3.org/2001/XMLSchema#",
    "fog": "urn:fogreduce:",
}


def prov(trace: Mapping[str, Any]) -> dict[str, Any]:
    """The PROV-JSON document of a trace (`fogreduce.trace.chain.trace`)."""
    run = trace["run"]
    at = f"fog:{run['campaign']}/{run['run_id']}/{run['version_id']}"
    software = f"fog:code/{trace['code']['code_sha256']}"
    calibration = f"fog:calibration/{trace['calibration']['id']}"
    inputs = {_base(item["file"]): f"fog:sha256/{item['sha256']}" for item in trace["inputs"]}
    cell, table = f"{at}/cell/{_token(trace['cell']['name'])}", f"{at}/{_in_results(trace['table']['file'])}"
    entities: dict[str, Any] = {
        cell: {
            "prov:label": trace["cell"]["name"],
            "prov:value": trace["cell"]["value"],
            **{f"fog:{_token(name)}": value for name, value in trace["cell"]["uncertainty"].items()},
        },
        table: _file(trace["table"]),
        f"{at}/manifest.json": _file(run["manifest"]),
        calibration: {
            **_file(trace["calibration"]),
            "prov:label": trace["calibration"]["id"],
            **{f"fog:{key}": str(value) for key, value in trace["calibration"]["pedigree"].items()},
        },
    }
    for item in trace["inputs"]:
        entities[inputs[_base(item["file"])]] = _file(item)
    capture = inputs[_base(trace["capture"]["file"])]
    entities[capture] |= {"fog:started_at": trace["capture"]["started_at"], "prov:type": "fog:capture"}
    document: dict[str, Any] = {
        "prefix": _PREFIX,
        "entity": entities,
        "activity": {},
        "agent": {
            software: {
                "prov:type": {"$": "prov:SoftwareAgent", "type": "prov:QUALIFIED_NAME"},
                **{f"fog:{key}": str(value) for key, value in trace["code"].items()},
            }
        },
        "used": {},
        "wasGeneratedBy": {},
        "wasAssociatedWith": {},
        "wasDerivedFrom": {
            "_:cell": {"prov:generatedEntity": cell, "prov:usedEntity": table},
            "_:table": {"prov:generatedEntity": table, "prov:usedEntity": capture},
        },
    }
    for stage in trace["stages"]:
        _stage(document, stage, at, software, calibration, list(inputs.values()))
    return document


def _stage(
    document: dict[str, Any],
    stage: Mapping[str, Any],
    at: str,
    software: str,
    calibration: str,
    inputs: list[str],
) -> None:
    """One activity, with what it used and made."""
    name = f"{at}/stage/{stage['stage']}"
    facts = {"parameters": stage["parameters"], "run": stage["run"], "calibration": stage["calibration"]}
    document["activity"][name] = {
        "prov:label": stage["stage"],
        "fog:code_sha256": str(stage["code_sha256"]),
        **{f"fog:{key}": _text(value) for key, value in facts.items()},
    }
    document["wasAssociatedWith"][f"_:agent-{stage['stage']}"] = {
        "prov:activity": name,
        "prov:agent": software,
    }
    read = [f"{at}/manifest.json", calibration]
    for item in stage["reads"]:
        read += inputs if item == "inputs" else [f"{at}/{item}"]
    for k, entity in enumerate(read):
        document["entity"].setdefault(entity, {})
        document["used"][f"_:used-{stage['stage']}-{k}"] = {"prov:activity": name, "prov:entity": entity}
    for k, item in enumerate(stage["writes"]):
        entity = f"{at}/{item['file']}"
        document["entity"][entity] = document["entity"].get(entity, {}) | _file(item)
        document["wasGeneratedBy"][f"_:made-{stage['stage']}-{k}"] = {
            "prov:entity": entity,
            "prov:activity": name,
        }


def _file(item: Mapping[str, Any]) -> dict[str, Any]:
    return {"fog:file": item["file"], "fog:bytes": item["bytes"], "fog:sha256": item["sha256"]}


def _base(file: str) -> str:
    return file.rpartition("/")[2]


def _in_results(file: str) -> str:
    return "/".join(file.split("/")[-2:])


def _token(text: str) -> str:
    return "".join(letter if letter.isalnum() or letter in "-._/" else "_" for letter in text)


def _text(value: Any) -> str:
    return json.dumps(value, sort_keys=True)
