"""A trace as a page for people, the cell first, the capture's bytes last."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from typing import Any


def trace_text(trace: Mapping[str, Any]) -> str:
    """The page."""
    return "\n".join(_lines(trace)) + "\n"


def _lines(trace: Mapping[str, Any]) -> Iterator[str]:
    cell, run, code = trace["cell"], trace["run"], trace["code"]
    yield f"{cell['name']}  of {cell['run']}"
    yield _line("value", cell["value"] or "empty")
    for name, value in cell["uncertainty"].items():
        yield _line(name, value or "empty")
    yield _line("table", f"line {cell['line']} of {_file(trace['table'])}")
    yield _line("version", f"{run['version_id']}, {_file(run['manifest'])}")
    libraries = ", ".join(f"{k} {v}" for k, v in code.items() if k not in ("code_sha256", "source_at_hand"))
    at_hand = (
        "its source is at hand and has that hash" if code["source_at_hand"] else "its source is not here"
    )
    yield _line("code", f"{libraries}; sha256 {code['code_sha256']}: {at_hand}")
    yield _line("machine", f"{trace['machine'].get('machine')}, {trace['machine'].get('blas')}")
    for stage in trace["stages"]:
        yield ""
        yield f"from stage {stage['stage']}  ({stage['code']}, sha256 {stage['code_sha256'] or 'not known'})"
        for key, value in stage["parameters"].items():
            yield _line(key, _value(value))
        for key, value in {**stage["run"], **stage["calibration"]}.items():
            yield _line(key, _value(value))
        for item in stage["writes"]:
            yield _line("wrote", f"{item['file']}, {item['bytes']} bytes, sha256 {item['sha256']}")
    calibration = trace["calibration"]
    yield ""
    yield f"with the calibration record {calibration['id']}"
    yield _line("file", _file(calibration))
    for key, value in calibration["pedigree"].items():
        yield _line(key, _value(value))
    yield ""
    yield "from the inputs"
    capture = trace["capture"]
    for item in trace["inputs"]:
        if item["file"] != capture["file"]:
            yield _line("file", _file(item))
    yield _line("capture", _file(capture))
    yield _line("began", f"{capture['started_at']}, unit {capture['unit']}, {capture['sample_rate_hz']} Hz")


def _line(key: str, text: str) -> str:
    return f"  {key:<28} {text}"


def _file(item: Mapping[str, Any]) -> str:
    checked = "verified" if item.get("verified") else "as recorded"
    return f"{item['file']}, {item['bytes']} bytes, sha256 {item['sha256']} ({checked})"


def _value(value: Any) -> str:
    return value if isinstance(value, str) else json.dumps(value)
