"""fogreduce: from raw captures of redundant gyro units on a rate table to drift, traceably."""

from __future__ import annotations

import importlib
import sys
from types import ModuleType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from fogreduce.characterise.allan import allan as allan
    from fogreduce.datasets.campaign_view import open_campaign as open_campaign
    from fogreduce.datasets.view import open_run as open_run
    from fogreduce.python.diagnose import diagnose as diagnose
    from fogreduce.python.reduce import reduce as reduce
    from fogreduce.python.simulate import simulate as simulate

__version__ = "0.1.0"

#: What Python users call -> its module, imported only when it is asked for: xarray alone costs a second.
_FUNCTIONS = {
    "allan": ".characterise.allan",
    "diagnose": ".python.diagnose",
    "open_campaign": ".datasets.campaign_view",
    "open_run": ".datasets.view",
    "reduce": ".python.reduce",
    "simulate": ".python.simulate",
}
__all__ = ["__version__", *sorted(_FUNCTIONS)]


def __getattr__(name: str) -> Any:
    if name in _FUNCTIONS:
        return getattr(importlib.import_module(_FUNCTIONS[name], __name__), name)
    raise AttributeError(f"module 'fogreduce' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted({name for name in globals() if name.startswith("__")} | set(__all__))


class _Package(ModuleType):
    """The package: a subpackage that is imported does not take the place of the function of its name."""

    def __setattr__(self, name: str, value: object) -> None:
        if not (name in _FUNCTIONS and isinstance(value, ModuleType)):
            super().__setattr__(name, value)


sys.modules[__name__].__class__ = _Package
