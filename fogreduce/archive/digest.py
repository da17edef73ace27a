"""SHA-256 of files, data and of the package's own code."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import fogreduce

_CHUNK = 1 << 20

#: Parts of the package that a reduction's numbers come from: with their hash a result names its code.
REDUCTION_PARTS = (
    "__init__.py",
    "constants.py",
    "errors.py",
    "units.py",
    "archive/digest.py",
    "archive/manifest.py",
    "datasets",
    "estimate",
    "metadata",
    "physics",
    "stages",
)


def file_digest(path: Path) -> str:
    """SHA-256 of a file's bytes, in hexadecimal."""
    digest = hashlib.sha256()
    with path.open("rb", buffering=0) as file:
        while chunk := file.read(_CHUNK):
            digest.update(chunk)
    return digest.hexdigest()


def data_digest(data: Any) -> str:
    """SHA-256 of plain data: its JSON with sorted keys and no white space."""
    text = json.dumps(data, sort_keys=True, separators=(",", ":"), allow_nan=False)
    return hashlib.sha256(text.encode()).hexdigest()


def code_digest(parts: Iterable[str] = REDUCTION_PARTS) -> str:
    """SHA-256 over the sources of parts of the package (files or folders below ``fogreduce``)."""
    root = Path(fogreduce.__file__).parent
    digest = hashlib.sha256()
    for part in sorted(parts):
        path = root / part
        for source in sorted(path.rglob("*.py")) if path.is_dir() else [path]:
            digest.update(source.relative_to(root).as_posix().encode() + b"\0")
            digest.update(hashlib.sha256(source.read_bytes()).digest())
    return digest.hexdigest()
