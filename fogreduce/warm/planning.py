"""Two costs of Snakemake's planning that no job needs, taken away.

Planning makes some hundred Python objects a job, and keeps them: the search for garbage, which Python starts
after every few hundred, goes through all of them again and finds none.  And Snakemake holds every output
against its neighbours, as paths of ``pathlib``, to find one that lies inside another; sets of plain text say
sooner that none does.
"""

from __future__ import annotations

import gc
import hashlib
import inspect
import os
from collections.abc import Iterable
from typing import Any

#: Objects made, more than were given up, after which Python searches for garbage.
_OBJECTS = 100_000
#: SHA-256 of the source of ``DAG.check_directory_outputs`` (Snakemake 9.27) that `_check` stands before.
_KNOWN = "d5a17c047b46b717ffe29a3c4f4b2bed2b1105ee6ee05da39da2816c1f13d033"


def hasten(dag: type[Any]) -> None:
    """Take both away; a class of the DAG whose check reads otherwise than the one known keeps it."""
    gc.set_threshold(_OBJECTS, *gc.get_threshold()[1:])
    thorough = getattr(dag, "check_directory_outputs", None)
    if thorough is None or digest_of(thorough) != _KNOWN:
        return

    def check(self: Any) -> None:
        if any_inside(file for job in self.jobs for file in job.output):
            thorough(self)  # it finds out whether two jobs are concerned, and says which

    dag.check_directory_outputs = check


def digest_of(function: Any) -> str:
    """SHA-256 of a function's source; empty where it cannot be had."""
    try:
        return hashlib.sha256(inspect.getsource(function).encode()).hexdigest()
    except (OSError, TypeError):
        return ""


def any_inside(files: Iterable[str]) -> bool:
    """Whether one of these paths lies inside another."""
    # plain text, since paths of pathlib are what takes so long
    paths = {os.path.abspath(file) for file in files}  # noqa: PTH100
    above: set[str] = set()
    for path in paths:
        folder = os.path.dirname(path)  # noqa: PTH120
        while folder not in above:
            above.add(folder)
            folder = os.path.dirname(folder)  # noqa: PTH120
    return not paths.isdisjoint(above)
