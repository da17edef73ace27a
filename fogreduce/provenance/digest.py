"""SHA-256 of files and of plain data."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

_CHUNK = 1 << 20
#: Of the digest of a manifest's content, its version id.
VERSION_ID_DIGITS = 16


def file_digest(path: Path, progress: Callable[[int], None] = lambda read: None) -> str:
    """SHA-256 of a file's bytes, in hexadecimal; `progress` hears how many bytes each reading brought."""
    digest = hashlib.sha256()
    with path.open("rb", buffering=0) as file:
        while chunk := file.read(_CHUNK):
            digest.update(chunk)
            progress(len(chunk))
    return digest.hexdigest()


def data_digest(data: Any) -> str:
    """SHA-256 of plain data: its JSON with sorted keys and no white space."""
    text = json.dumps(data, sort_keys=True, separators=(",", ":"), allow_nan=False)
    return hashlib.sha256(text.encode()).hexdigest()
