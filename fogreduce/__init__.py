"""fogreduce: from raw captures of redundant gyro units on a rate table to drift, traceably."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from fogreduce.datasets.view import open_run as open_run

__version__ = "0.1.0"
__all__ = ["__version__", "open_run"]


def __getattr__(name: str) -> Any:
    # open_run needs xarray, whose import costs a second: only whoever asks for it pays.
    if name == "open_run":
        from fogreduce.datasets.view import open_run

        return open_run
    raise AttributeError(f"module 'fogreduce' has no attribute {name!r}")
