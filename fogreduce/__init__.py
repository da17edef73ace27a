"""fogreduce: from raw captures of redundant gyro units on a rate table to drift, traceably."""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from fogreduce.characterise.allan import allan as allan
    from fogreduce.datasets.view import open_run as open_run

__version__ = "0.1.0"

#: What Python users call -> its module, imported only when it is asked for: xarray alone costs a second.
_FUNCTIONS = {
    "allan": "fogreduce.characterise.allan",
    "open_run": "fogreduce.datasets.view",
}
__all__ = ["__version__", *sorted(_FUNCTIONS)]


def __getattr__(name: str) -> Any:
    if name in _FUNCTIONS:
        return getattr(importlib.import_module(_FUNCTIONS[name]), name)
    raise AttributeError(f"module 'fogreduce' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted({*globals(), *_FUNCTIONS})
