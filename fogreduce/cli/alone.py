"""After a kill -9: no command outlives its workflow, and a lock that a dead workflow left is taken away.

Snakemake locks a folder by files in ``.snakemake/locks``, which stay when it is killed; it then asks for
``--unlock``, since it cannot know whether another is at work. The kernel can: `hold` takes a lock that
ends with its process, however that ends.
"""

from __future__ import annotations

import os
import select
import signal
import sys
import threading
from pathlib import Path
from typing import IO

#: The process of the workflow that a command belongs to; it stands in the environment of the workflow's jobs.
WORKFLOW = "FOGREDUCE_WORKFLOW"


def hold(state: Path) -> IO[str] | None:
    """Hold a folder for as long as this process lives; remove Snakemake's locks where nobody else holds it.

    Parameters
    ----------
    state : Path
        The folder ``.snakemake``.

    Returns
    -------
    open file or None
        To be kept open. None where none can be had, on a file system without locks for one: Snakemake's own
        then decide alone.
    """
    import fcntl

    try:
        state.mkdir(exist_ok=True)
        file = (state / "fogreduce.lock").open("a+")
    except OSError:
        return None  # Snakemake will say what is wrong with its folder
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        _remove_locks(state / "locks", file)
    except BlockingIOError:
        pass  # another is at work
    except OSError:
        file.close()
        return None
    # Shared: whoever holds it, too, is counted in.
    fcntl.flock(file, fcntl.LOCK_SH)
    return file


def _remove_locks(locks: Path, file: IO[str]) -> None:
    """Remove left locks, unless another machine's: its workflow may live, where locks do not reach across."""
    left = list(locks.glob("*.lock"))
    file.seek(0)
    if left and file.read() != os.uname().nodename:
        return
    for path in left:
        path.unlink()
    file.seek(0)
    file.truncate()
    file.write(os.uname().nodename)
    file.flush()


def end_with_workflow() -> None:
    """Stop this process, as Ctrl-C does, as soon as the workflow that it belongs to is gone."""
    workflow = os.environ.get(WORKFLOW, "")
    if not workflow.isdecimal() or sys.platform != "linux":
        return
    try:
        handle = os.pidfd_open(int(workflow))
    except ProcessLookupError:
        sys.exit("stopped: its workflow is gone")
    except OSError:
        return  # a system without
    threading.Thread(target=_wait, args=(handle,), daemon=True).start()


def _wait(handle: int) -> None:
    select.select([handle], [], [])
    os.kill(os.getpid(), signal.SIGTERM)
