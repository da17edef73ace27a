"""What of a machine can move a result's last digits: libraries, the CPU's features. No host, no path."""

from __future__ import annotations

import platform
import sys
from collections.abc import Mapping
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from typing import Any, TypeGuard

_LIBRARIES = ("h5py", "matplotlib", "numpy", "pydantic", "pyyaml", "scipy", "snakemake", "xarray")


@cache
def machine() -> dict[str, Any]:
    """The kind of machine this is.

    Returns
    -------
    dict
        ``python``, ``system``, ``machine``, ``byte_order``, ``libc``, ``libraries`` (name -> version),
        ``blas`` and ``cpu_features`` (those that numpy chooses its loops by).
    """
    import numpy as np

    config: dict[str, Any] = np.show_config(mode="dicts")  # type: ignore[assignment]
    simd = config.get("SIMD Extensions", {})
    blas = config.get("Build Dependencies", {}).get("blas", {})
    return {
        "python": platform.python_version(),
        "system": platform.system(),
        "machine": platform.machine(),
        "byte_order": sys.byteorder,
        "libc": " ".join(platform.libc_ver()).strip(),
        "libraries": {name: found for name in _LIBRARIES if (found := _version(name))},
        "blas": f"{blas.get('name', 'unknown')} {blas.get('version', '')}".strip(),
        "cpu_features": sorted({*simd.get("baseline", []), *simd.get("found", [])}),
    }


def _version(name: str) -> str | None:
    try:
        return version(name)
    except PackageNotFoundError:
        return None


def _texts(value: Any) -> TypeGuard[list[str]]:
    return isinstance(value, list) and all(isinstance(item, str) for item in value)


def differences(old: Mapping[str, Any], new: Mapping[str, Any]) -> list[str]:
    """What differs between two records, of machines for instance, a line each; none where nothing does."""
    lines = []
    for key in sorted({*old, *new}):
        before, after = old.get(key), new.get(key)
        if before == after:
            continue
        if isinstance(before, Mapping) and isinstance(after, Mapping):
            lines += [f"{key}: {line}" for line in differences(before, after)]
        elif _texts(before) and _texts(after):
            gone, came = sorted(set(before) - set(after)), sorted(set(after) - set(before))
            lines.append(f"{key}: without {' '.join(gone) or 'none'}, with {' '.join(came) or 'none'}")
        else:
            lines.append(f"{key}: {before} -> {after}")
    return lines
