"""Causes as the simulator takes them: entries of an effects file, and its text."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from fogreduce.diagnosis.inference.causes import Cause
from fogreduce.metadata.yaml12 import dump_yaml

_SCHEMA = "fogreduce/effects/1"


def entry(cause: Cause, runs: Sequence[str] | None = None) -> dict[str, Any]:
    """A cause as an entry; `runs`: those that it acts in, where they are not its own."""
    return {
        "effect": cause.effect,
        "channels": list(cause.channels),
        "runs": list(cause.runs if runs is None else runs),
        "parameters": cause.parameters(),
    }


def effects_text(entries: Sequence[dict[str, Any]]) -> str:
    """An effects file with these entries."""
    return dump_yaml({"schema": _SCHEMA, "effects": plain(list(entries))})


def plain(value: Any) -> Any:
    """Numbers of numpy as plain ones, tuples as lists."""
    if isinstance(value, dict):
        return {key: plain(v) for key, v in value.items()}
    if isinstance(value, list | tuple):
        return [plain(v) for v in value]
    if isinstance(value, np.generic):
        return value.item()
    return value
