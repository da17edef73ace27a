"""A clock that was set back: what was written before lies in the future, and hides every change made now.

Snakemake makes a result anew where an input is newer. A result from the future is newer than all that anybody
writes until then, so it would stay as it is whatever happens to its inputs.
"""

from __future__ import annotations

import os
import time
from collections.abc import Iterable
from datetime import UTC, datetime
from pathlib import Path

from fogreduce.errors import Fault
from fogreduce.provenance.manifest_file import MANIFEST, OUTPUTS

#: Clocks of two machines that share a disk may differ by as much.
TOLERANCE_S = 5.0
#: The time that a result from the future is given [ns]: older than any input, so that inputs are looked into.
#: (Not 0, which Snakemake takes for no time at all.)
_OLD = (86_400_000_000_000, 86_400_000_000_000)


def from_the_future(path: Path) -> bool:
    """Whether a file that is there says that it will be written."""
    try:
        return path.stat().st_mtime > time.time() + TOLERANCE_S
    except OSError:
        return False


def make_old(results: Path, runs: Iterable[Path]) -> bool:
    """Give every file of the results that lies in the future a time older than any input's.

    Parameters
    ----------
    results : Path
        Folder of all results.
    runs : iterable of Path
        Those of the runs; only where one of them lies in the future is the rest looked at.

    Returns
    -------
    bool
        Whether there were any. Snakemake then compares the contents of small inputs with those it knows, and
        makes anew what has large ones.
    """
    if not any(from_the_future(run / name) for run in runs for name in (MANIFEST, OUTPUTS)):
        return False
    for folder, _, names in os.walk(results):
        for name in names:
            path = Path(folder, name)
            if from_the_future(path):
                os.utime(path, ns=_OLD, follow_symlinks=False)
    return True


def faults_of_inputs(paths: Iterable[str]) -> list[Fault]:
    """A fault for each input from the future: what is made of it would be older than it is."""
    found = []
    for path in map(Path, paths):
        if from_the_future(path):
            when = datetime.fromtimestamp(path.stat().st_mtime, UTC).strftime("%Y-%m-%dT%H:%M:%SZ")
            found.append(
                Fault(str(path), "", f"a time in the future, {when}", "a clock that is right, or `touch`")
            )
    return found
